//! Shadow maps whose texels look from random places of the light: Liktor, Spassov, Mückl, Dachsbacher, "Stochastic Soft Shadow
//! Mapping", 2015. Sections and equations are theirs.
//!
//! Every texel holds the nearest hit of one ray, from a place of its own on the light ([`strata`], [`thin_lens`], [`trace`]). For each
//! of several planes parallel to the light, samples are moved to where their rays cross it ([`reproject`]), blurred by their circle of
//! confusion ([`confusion`], [`closest`]), and gathered as moments of depth ([`moments`], [`gather`], [`resolve`]). A receiver
//! looks up the two nearest planes ([`lookup`]).
//!
//! Units. *Light frame*: (a, b) along the light's edges, in halves of them, from its middle, so that the light is `−1..=1` squared,
//! whatever its shape; d along its normal, in halves of its longer edge. A *tangent* is a/d, b/d. *Inverse depth* is 1/d: the
//! circle of confusion and everything that moves between planes is linear in it.

pub mod area_frame;
pub mod closest;
pub mod confusion;
pub mod elementary;
#[cfg(not(target_arch = "spirv"))]
pub mod fit;
pub(crate) mod float;
pub mod gather;
pub(crate) mod grid;
pub mod lookup;
pub mod moments;
#[cfg(not(target_arch = "spirv"))]
pub mod options;
pub mod params;
#[cfg(not(target_arch = "spirv"))]
pub mod placement;
pub mod reproject;
pub mod resolve;
pub mod strata;
pub mod thin_lens;
pub mod tiles;
pub mod trace;
pub mod tree;

#[cfg(not(target_arch = "spirv"))]
pub use options::{Basis, Centers, Footprint, Placement, StochasticError, StochasticOptions};
