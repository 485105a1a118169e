//! Runs umbra4's exact soft-shadow stages on CPU threads.

mod executor;
mod masks;
mod scene;

pub use executor::{CpuExecutor, ExecutorError, Index, Precision, Statistics};
pub use masks::Masks;
pub use scene::{Occluders, Receivers, SceneError};
pub use umbra4_core as core;
