//! Exact soft shadows of area lights by generalised ("4D") rasterisation: the geometry.
//!
//! For every receiver point an occlusion mask is computed, one bit per light sample, 1 where a triangle blocks the
//! segment from the receiver to that sample. This crate holds every line of arithmetic that decides a bit, once, as pure
//! functions without allocation; executors (`umbra4-cpu` and others) bring memory and threads.
//!
//! Seed: Wang, Zhao, Meng, Popescu, "4D-rasterization for Fast Soft Shadow Rendering", 2016.
#![no_std]
#![forbid(unsafe_code)]

pub mod bit_mask;
pub mod doubt;
pub mod edge_plane;
pub mod exact;
pub mod executor;
pub mod frame;
pub mod grid;
pub mod hierarchy;
pub mod lanes;
pub mod lattice;
pub mod light;
pub mod mask_word;
pub mod order;
pub mod outline;
pub mod plan;
pub mod precision;
pub mod proj4;
pub mod real;
pub mod row_mask;
pub mod serial;
pub mod side;
pub mod stage;
pub mod statistics;
pub mod surface;
pub mod wide;

pub use glam;

pub use executor::Executor;
pub use lanes::Lanes;
pub use lattice::{Bounds, Lattice, LatticeError, SnapError};
pub use light::{AreaLight, LatticeLight, LightError};
pub use mask_word::{MaskWord, PairWord};
pub use plan::{IndexKind, Pass, Plan, SceneFacts};
pub use precision::{Exact, Fast, PrecisionMode};
pub use statistics::Counts;
pub use surface::Lift;
