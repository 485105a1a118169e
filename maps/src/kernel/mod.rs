//! Kernels: what one thread of a GPU does for one id. They are plain functions over slices, so that a processor runs them as well.

pub mod microquads;
