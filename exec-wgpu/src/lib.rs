//! Exact soft shadows of area lights on the GPU: the stages of `umbra4-core` as compute passes, through wgpu.
//!
//! The kernels are compiled from the same Rust source as the CPU's and lie in this crate as SPIR-V, so that stable Rust
//! builds it. Masks, lit counts and visibility are the same bits as those of any other executor.

mod casters;
mod checks;
mod clouds;
mod device_kernel;
mod error;
mod executor;
mod frame;
mod from_maps;
mod gpu;
mod host;
mod image;
mod light_run;
mod modules;
mod pipelines;
mod readback;
mod recorder;
mod scene;
mod scratch;
mod shadows;
mod stages;
mod statistics;
mod submit;
mod timing;
mod told;
mod trial;
mod usable;

pub use casters::CasterIndex;
pub use device_kernel::DeviceKernel;
pub use error::{GpuError, guarded};
pub use executor::WgpuExecutor;
pub use frame::{
    Emitted, Frame, GBuffer, History, Image, Indices, Instances, Lamp, Light, LightImage, Mesh, Resolution, Surface,
    Vertices,
};
pub use from_maps::{ShadowMap, StochasticShadows};
pub use gpu::{AdapterReport, Choice, Gpu, adapters};
pub use image::VisibilityFormat;
pub use modules::{code, manifest};
pub use pipelines::Loading;
pub use scene::{LatticeReceivers, LatticeScene};
pub use shadows::{Snapped, SoftShadows};
pub use statistics::Statistics;
pub use umbra4_core::{Precision, kernel::status::Status};
pub use umbra4_maps as maps;
pub use usable::{Lack, lacks};
pub use wgpu;
