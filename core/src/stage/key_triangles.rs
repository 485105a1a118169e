//! Stage `key_triangles`: what every triangle offers to the full-coverage test, and its orientation.

use glam::IVec3;

use crate::{
    edge_plane::LightGrid,
    frame::LightFrame,
    light::LatticeLight,
    occluder::{Facing, Occluder},
    plane_offset::moved_keys,
    proj4::{Keys, triangle_keys},
};

/// Keys and oriented corners of triangle `id`. `None` where it blocks nothing: behind the light, degenerate, in the
/// light's plane (or there is no such triangle, or it names a vertex that does not exist).
#[inline]
pub fn key_triangles(
    id: usize,
    frame: &LightFrame,
    light: &LatticeLight,
    vertices: &[IVec3],
    triangles: &[[u32; 3]],
) -> Option<(Keys, Occluder)> {
    let [a, b, c] = *triangles.get(id)?;
    let corners = [*vertices.get(a as usize)?, *vertices.get(b as usize)?, *vertices.get(c as usize)?];
    keys_of(frame, light, corners)
}

/// How the triangles of a caster cast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Casting {
    /// Whether they are those of a closed mesh: only those cast that face away from the light, told for every sample.
    pub closed: bool,
    /// By how many lattice units their planes are moved towards the light ([`crate::plane_offset`]).
    pub offset: u32,
}

/// As [`keys_of`], of a triangle of a caster.
#[inline]
pub fn keys_of_caster(grid: &LightGrid, corners: [IVec3; 3], casting: Casting) -> Option<(Keys, Occluder)> {
    let keys = triangle_keys(&grid.frame, &corners)?;
    let facing = Facing::of(&grid.light, corners);
    let occluder = if casting.closed { facing.closed_occluder(corners)? } else { facing.occluder(corners)? };
    Some((moved_keys(grid, &occluder, keys, casting.offset), occluder))
}

/// As [`key_triangles`], of a triangle given by its corners.
#[inline]
pub fn keys_of(frame: &LightFrame, light: &LatticeLight, corners: [IVec3; 3]) -> Option<(Keys, Occluder)> {
    let keys = triangle_keys(frame, &corners)?;
    Some((keys, Occluder::facing(light, corners)?))
}
