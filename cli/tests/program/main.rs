//! The program and its library, in one binary: each that is linked takes its time.
#![allow(clippy::unwrap_used)] // in a test, a panic is the message

mod casters;
mod common;
mod errors;
mod masks;
mod materials;
mod render;
mod report;
mod scene_files;
