//! A shadow map, drawn from the light's centre onto a plane that is parallel to the light.
//!
//! Seed: Schwarz, Stamminger 2008, section 1: occluders are rebuilt from the texels of one shadow map.
//!
//! The light's frame has its two steps and its normal as axes. A point is `x` steps along the rows' direction, `y` along the
//! columns', and `z` before the light, in units of the *near distance*, the least at which occluders are drawn. A texel holds the
//! *inverse depth* `ι = 1/z` of what is nearest, 0 where there is nothing: it is linear over the map on every plane, and so is the
//! way a texel moves on the light as `ι` changes ([`crate::microquad::projection`]). As positive floats order like their
//! bits, texels are `u32`, and the nearest of many triangles is the largest word, in whatever order they come.

use glam::{IVec3, IVec4, Vec4};

use crate::arithmetic::Arithmetic;

/// Least and greatest number of texels along an edge of a map; powers of two.
pub const SIZES: core::ops::RangeInclusive<u32> = 16..=4096;

/// How world and map correspond. All members are vectors of four, so that the layout is the same in Rust, SPIR-V and WGSL.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MapFrame {
    /// The light's centre, lattice units; and the texels along each edge of the map.
    pub(crate) center: IVec4,
    /// Homogeneous column per lattice unit (texels times depth); and texels per step and inverse depth, along the rows.
    pub(crate) across: Vec4,
    /// Homogeneous row per lattice unit; and texels per step and inverse depth, along the columns.
    pub(crate) down: Vec4,
    /// Near distances per lattice unit, away from the light; and the offset of inverse depths, in texels of slope.
    pub(crate) toward: Vec4,
}

/// Where a point lies on the map, before the division by its depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OnMap {
    /// Column of texels times depth. Texel i spans columns `i..i + 1`.
    pub x: f32,
    /// Row of texels times depth.
    pub y: f32,
    /// Depth, near distances.
    pub z: f32,
}

impl MapFrame {
    /// Texels along each edge.
    #[inline(always)]
    pub fn size(&self) -> u32 {
        self.center.w as u32
    }

    /// Where a lattice point lies.
    #[inline(always)]
    pub fn place(&self, a: Arithmetic, p: IVec3) -> OnMap {
        let [x, y, z] = [(p.x - self.center.x) as f32, (p.y - self.center.y) as f32, (p.z - self.center.z) as f32];
        let dot = |axis: Vec4| a.add(a.sum_of_products(axis.x, x, axis.y, y), a.mul(axis.z, z));
        OnMap { x: dot(self.across), y: dot(self.down), z: dot(self.toward) }
    }
}

/// The word of texel (`x`, `y`), 0 outside of the map.
#[inline(always)]
pub fn texel(map: &[u32], size: u32, x: u32, y: u32) -> u32 {
    let index = y.wrapping_mul(size).wrapping_add(x) as usize;
    if x < size && y < size && index < map.len() { map[index] } else { 0 }
}
