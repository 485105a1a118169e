//! Kernel `key_triangles`: keys and place on the curve of one triangle.

use glam::IVec3;

use crate::{
    kernel::{fetch, light_params::LightParams, point, store},
    occluder::Occluder,
    order::{Entry, code},
    proj4::{Keys, NOTHING},
};

/// The corners of triangle `id`; `None` where one is missing.
#[inline(always)]
pub(super) fn corners(id: usize, vertices: &[[i32; 3]], triangles: &[[u32; 3]]) -> Option<[IVec3; 3]> {
    let [a, b, c] = fetch(triangles, id, [u32::MAX; 3]);
    Some([point(vertices, a as usize)?, point(vertices, b as usize)?, point(vertices, c as usize)?])
}

/// Keys and orientation of triangle `id`; `None` where it blocks nothing.
#[inline(always)]
pub(super) fn triangle<T: LightParams>(
    id: usize,
    params: &T,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
) -> Option<(Keys, Occluder)> {
    params.triangle(corners(id, vertices, triangles)?)
}

/// Triangle `id`; those that block nothing come last in the order.
#[inline(always)]
pub fn key_triangles<T: LightParams>(
    id: usize,
    params: &T,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    keys: &mut [Keys],
    order: &mut [Entry],
) {
    if id >= params.pass().count as usize {
        return;
    }
    let mut entry = Entry { code: Entry::ABSENT, index: id as u32 };
    let mut own = NOTHING;
    if let Some((found, _)) = triangle(id, params, vertices, triangles) {
        own = found;
        entry.code = code(&params.codes(), &own);
    }
    store(keys, id, own);
    store(order, id, entry);
}
