//! Kernels of [`crate::stochastic`]. Of each id they fetch, call the function that holds the arithmetic, and store. [`passes`] says in which order they run.
//!
//! Ids of a level's kernels are its texels, or its tiles; the parameters name the level.

pub mod levels;
pub mod light_field;
#[cfg(not(target_arch = "spirv"))]
pub mod passes;
pub mod radii;
pub mod receivers;
pub mod samples;
pub mod tiles;

/// Stage: the tree over triangles.
pub const BOUND_TRIANGLES: &str = "bound_triangles";
/// Stage: the map itself.
pub const SAMPLE_LIGHT_FIELD: &str = "sample_light_field";
/// Stage: samples move to a plane.
pub const REPROJECT: &str = "reproject";
/// Stage: radii are raised, and coarser levels made.
pub const FIND_RADII: &str = "find_radii";
/// Stage: the pre-filter.
pub const FILTER_LEVELS: &str = "filter_levels";
/// Stage: receivers look planes up.
pub const LOOK_UP: &str = "look_up";
