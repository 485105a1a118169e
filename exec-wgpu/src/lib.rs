//! Exact soft shadows of area lights on the GPU: the stages of `umbra4-core` as compute passes, through wgpu.
//!
//! The kernels are compiled from the same Rust source as the CPU's and lie in this crate as SPIR-V, so that stable Rust
//! builds it. Masks, lit counts and visibility are the same bits as those of any other executor.

mod error;
mod executor;
mod gpu;
mod modules;
mod pipelines;
mod readback;
mod recorder;
mod run;
mod scene;
mod sort;
mod statistics;

pub use error::GpuError;
pub use executor::WgpuExecutor;
pub use gpu::{AdapterReport, Choice, Gpu, adapters};
pub use modules::{code, manifest};
pub use scene::LatticeScene;
pub use statistics::Statistics;
pub use umbra4_core::Precision;
pub use wgpu;
