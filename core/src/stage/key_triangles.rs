//! Stage `key_triangles`: what every triangle offers to the full-coverage test, and its orientation.

use glam::IVec3;

use crate::{
    edge_plane::Occluder,
    frame::LightFrame,
    light::LatticeLight,
    proj4::{Keys, triangle_keys},
};

#[cfg(not(target_arch = "spirv"))]
use crate::proj4::VertexKeys;

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

/// As [`key_triangles`], with what its vertices bring: `vertex_keys` is as long as `vertices`.
#[cfg(not(target_arch = "spirv"))]
#[inline]
pub fn key_between(
    id: usize,
    frame: &LightFrame,
    light: &LatticeLight,
    vertices: &[IVec3],
    vertex_keys: &[VertexKeys],
    triangles: &[[u32; 3]],
) -> Option<(Keys, Occluder)> {
    let [a, b, c] = triangles.get(id)?.map(|vertex| vertex as usize);
    let corners = [*vertices.get(a)?, *vertices.get(b)?, *vertices.get(c)?];
    let between = vertex_keys.get(a)?.and(vertex_keys.get(b)?).and(vertex_keys.get(c)?);
    if between.touches() {
        return keys_of(frame, light, corners);
    }
    Some((between.for_light(), Occluder::facing(light, corners)?))
}
