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
pub mod cloud_extent;
pub mod cloud_pair;
pub mod doubt;
pub mod edge_plane;
pub mod exact;
pub mod facing;
pub mod frame;
pub mod gbuffer;
pub mod half;
pub mod hierarchy;
pub mod irradiance;
pub mod jitter;
pub mod jittered_rows;
pub mod kernel;
pub mod lanes;
pub mod layers;
pub mod light;
pub mod mask_word;
pub mod mesh;
pub mod occluder;
pub mod order;
pub mod outline;
pub mod params;
pub mod plane_cell;
pub mod plane_offset;
pub mod precision;
pub mod proj4;
pub mod punctual;
pub mod punctual_frame;
pub mod ratio;
pub mod real;
pub mod row_mask;
pub mod shaft;
pub mod side;
pub mod snap;
pub mod stage;
pub mod statistics;
pub mod surface;
pub mod surface_words;
pub mod terminator;
pub(crate) mod texel;
pub mod texture;
pub mod tint;
pub mod trace;
pub mod view;
pub mod wide;

// What only the host does: no kernel reaches it.
#[cfg(not(target_arch = "spirv"))]
pub mod accumulate;
#[cfg(not(target_arch = "spirv"))]
pub mod any_light;
#[cfg(not(target_arch = "spirv"))]
pub mod area_light;
#[cfg(not(target_arch = "spirv"))]
pub mod closed;
#[cfg(not(target_arch = "spirv"))]
pub mod cloud;
#[cfg(not(target_arch = "spirv"))]
pub mod cloud_order;
#[cfg(not(target_arch = "spirv"))]
pub mod cloud_table;
#[cfg(not(target_arch = "spirv"))]
pub mod cloud_tiles;
#[cfg(not(target_arch = "spirv"))]
pub mod corner;
#[cfg(not(target_arch = "spirv"))]
pub mod depth;
#[cfg(not(target_arch = "spirv"))]
pub mod edge_trace;
#[cfg(not(target_arch = "spirv"))]
pub mod emission;
#[cfg(not(target_arch = "spirv"))]
pub mod executor;
#[cfg(not(target_arch = "spirv"))]
pub mod grid;
#[cfg(not(target_arch = "spirv"))]
pub mod jittered_edges;
#[cfg(not(target_arch = "spirv"))]
pub mod keyed_mesh;
#[cfg(not(target_arch = "spirv"))]
pub mod lattice;
#[cfg(not(target_arch = "spirv"))]
pub mod packed_caster;
#[cfg(not(target_arch = "spirv"))]
pub mod plan;
#[cfg(not(target_arch = "spirv"))]
pub mod punctual_light;
#[cfg(not(target_arch = "spirv"))]
pub mod serial;
#[cfg(not(target_arch = "spirv"))]
pub mod silhouette;
#[cfg(not(target_arch = "spirv"))]
pub mod volume_light;

pub use glam;

pub use facing::Facing;
pub use jitter::Jitter;
pub use lanes::Lanes;
pub use layers::Layers;
pub use light::LatticeLight;
pub use mask_word::{MaskWord, PairWord};
pub use precision::{Exact, Fast, Precision, PrecisionMode};
pub use punctual::Punctual;
pub use statistics::Counts;
pub use surface::Lift;

#[cfg(not(target_arch = "spirv"))]
pub use any_light::AnyLight;
#[cfg(not(target_arch = "spirv"))]
pub use area_light::{AreaLight, LightError};
#[cfg(not(target_arch = "spirv"))]
pub use executor::Executor;
#[cfg(not(target_arch = "spirv"))]
pub use lattice::{Bounds, Lattice, LatticeError, SnapError};
#[cfg(not(target_arch = "spirv"))]
pub use packed_caster::{CasterWork, PackedCaster};
#[cfg(not(target_arch = "spirv"))]
pub use plan::{CasterFacts, IndexKind, Pass, Plan, SceneFacts, Work};
#[cfg(not(target_arch = "spirv"))]
pub use punctual_light::{DirectionalLight, PointLight, PunctualLightError};
#[cfg(not(target_arch = "spirv"))]
pub use volume_light::{EllipsoidLight, SphereLight, TubeLight, VolumeLightError};
