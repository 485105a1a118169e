//! Kernels: what one thread of a GPU does for one id. They are plain functions over slices, so that a processor runs them as well.

// A kernel's arguments are its bindings.
#![allow(clippy::too_many_arguments)]

pub mod microquads;
pub mod stochastic;
