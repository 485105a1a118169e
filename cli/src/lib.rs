//! The program `umbra4`, as a library: models and lights from files, a camera, primary visibility, pictures.
//!
//! Shadows themselves come from `umbra4-core` (the arithmetic) and `umbra4-cpu` (the threads).

pub mod array_file;
pub mod in_file;
pub mod light_file;
pub mod model;
pub mod output;
