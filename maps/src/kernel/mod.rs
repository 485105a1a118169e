//! Kernels: what one thread of a GPU does for one id. They are plain functions over slices, so that a processor runs them as well.
//! [`TABLE`] says what each is bound to.

// A kernel's arguments are its bindings.
#![allow(clippy::too_many_arguments)]

pub mod microquads;
pub mod stochastic;
mod table;

pub use table::{BUILD_PYRAMID, DRAW_MAP, GATHER, MapKernel, MapKernelInfo, MapParamsKind, MapSlot, TABLE};
