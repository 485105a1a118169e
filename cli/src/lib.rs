//! The program `umbra4`, as a library: models and lights from files, a camera, primary visibility, pictures.
//!
//! Shadows themselves come from `umbra4-core` (the arithmetic) and `umbra4-cpu` (the threads); with the feature `gpu`, from
//! `umbra4-wgpu` too. The feature `plot-png` draws the plot of a report in pixels.
#![cfg_attr(test, allow(clippy::unwrap_used))] // in a test, a panic is the message

pub mod args;
pub mod array_file;
pub mod bounds;
pub mod builtin;
pub mod camera;
pub mod casters;
pub mod commands;
pub mod description;
pub mod error;
pub mod executor;
pub mod fit;
pub mod fractions;
pub mod frames;
pub mod in_file;
pub mod light;
pub mod light_file;
pub mod lighting;
pub mod model;
pub mod on_lattice;
pub mod output;
pub mod output_folder;
pub mod picture;
pub mod primary;
pub mod report;
pub mod scene;
pub mod scene_file;
pub mod shade;
pub mod srgb;
pub mod stages;
