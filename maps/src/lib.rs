//! Approximate soft shadows from shadow maps, for the same scenes, lights and receivers as the exact ones of `umbra4-core`:
//! what accuracy costs can only be told beside something cheaper. As in core, this crate holds the arithmetic, once, as pure
//! functions without allocation; executors bring memory and threads.
//!
//! - [`microquad`]: Schwarz, Stamminger, "Microquad Soft Shadow Mapping Revisited", 2008.
//! - [`stochastic`]: Liktor, Spassov, Mückl, Dachsbacher, "Stochastic Soft Shadow Mapping", 2015.
//!
//! [`Technique`] is the switch between them and the exact system.
#![no_std]
#![forbid(unsafe_code)]

pub mod arithmetic;
#[cfg(not(target_arch = "spirv"))]
pub mod curve;
pub mod draw;
pub mod kernel;
pub mod microquad;
pub mod pyramid;
pub mod shadow_map;
pub mod stochastic;
#[cfg(not(target_arch = "spirv"))]
pub mod technique;

#[cfg(not(target_arch = "spirv"))]
pub use technique::Technique;
