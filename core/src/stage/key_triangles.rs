//! Stage `key_triangles`: what every triangle offers to the full-coverage test, and its orientation.

use glam::IVec3;

use crate::{
    frame::LightFrame,
    light::LatticeLight,
    occluder::Occluder,
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

/// As [`key_triangles`], of a triangle given by its corners.
#[inline]
pub fn keys_of(frame: &LightFrame, light: &LatticeLight, corners: [IVec3; 3]) -> Option<(Keys, Occluder)> {
    let keys = triangle_keys(frame, &corners)?;
    Some((keys, Occluder::facing(light, corners)?))
}
