//! Runs umbra4's exact soft-shadow stages on CPU threads: memory, scheduling and instruction sets for the geometry of
//! `umbra4-core`.

mod arrangement;
mod casters;
mod closed;
mod cloud;
mod cloud_light;
mod cloud_masks;
mod cloud_triangles;
mod executor;
mod from_maps;
mod grid;
mod hard_shadows;
mod hierarchy;
mod lights;
mod masks;
mod morton;
mod neighbours;
mod open_sides;
mod order;
mod punctual;
mod reduction;
mod run;
mod scatter;
mod scene;
mod silhouette;
mod statistics;
mod triangles;
mod word;

pub use casters::{Caster, CasterError, CasterIndex};
pub use closed::ClosedParts;
pub use cloud_masks::CloudMasks;
pub use executor::{CpuExecutor, ExecutorError};
pub use from_maps::{ShadowMap, StochasticShadows};
pub use grid::{Binning, GridOptions, Index};
pub use hard_shadows::HardShadows;
pub use lights::{Lit, Sides, Source};
pub use masks::Masks;
pub use scene::{Occluders, Receivers, SceneError};
pub use statistics::Statistics;
pub use umbra4_core as core;
pub use umbra4_core::Precision;
pub use umbra4_core::stage::resolve_cells::Rows;
pub use umbra4_cpu_kernels::Isa;
pub use umbra4_maps as maps;
pub use word::CpuWord;
