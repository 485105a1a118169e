//! The program and its library, in one binary: each that is linked takes its time.

mod casters;
mod common;
mod errors;
mod masks;
mod materials;
mod render;
mod report;
mod scene_files;
