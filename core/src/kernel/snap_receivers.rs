//! Kernels that make receivers of a G-buffer's pixels. Their textures are read by the entry point.

use crate::{
    gbuffer::{Pixel, ViewParams, by_owner, decode_normal, from_depth, from_position},
    kernel::{NOWHERE, key_triangles::corners, store},
    surface::{Upwards, by_normal},
};

/// The texel of pixel `id`; `None` where there is none.
#[inline(always)]
pub fn texel(id: usize, params: &ViewParams) -> Option<[u32; 2]> {
    if id >= params.count as usize || params.width == 0 {
        return None;
    }
    let pixel = params.first.wrapping_add(id as u32);
    Some([pixel % params.width, pixel / params.width])
}

/// Which way a pixel with this normal is lifted.
#[inline(always)]
pub fn upwards(params: &ViewParams, normal: [f32; 4]) -> Upwards {
    by_normal(decode_normal(params.normals, normal))
}

/// The same for a pixel that shows triangle `owner − 1` of all; 0 where it shows none of them.
#[inline(always)]
pub fn upwards_of(
    params: &ViewParams,
    normal: [f32; 4],
    owner: u32,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
) -> Upwards {
    let normal = decode_normal(params.normals, normal);
    // Beyond the frame's triangles may lie those of another.
    if owner == 0 || owner > params.triangles {
        return by_normal(normal);
    }
    match corners(owner as usize - 1, vertices, triangles) {
        Some(corners) => by_owner(corners, normal),
        None => by_normal(normal),
    }
}

/// The receiver of pixel `id`, from a stored world position. Returns whether it is refused.
#[inline(always)]
pub fn snap_position(
    id: usize,
    params: &ViewParams,
    position: [f32; 4],
    upwards: Upwards,
    receivers: &mut [[i32; 3]],
) -> bool {
    put(id, params, from_position(params, position, upwards), receivers)
}

/// The receiver of pixel `id`, from a stored depth. Returns whether it is refused.
#[inline(always)]
pub fn snap_depth(
    id: usize,
    params: &ViewParams,
    [x, y]: [u32; 2],
    depth: f32,
    upwards: Upwards,
    receivers: &mut [[i32; 3]],
) -> bool {
    put(id, params, from_depth(params, x, y, depth, upwards), receivers)
}

#[inline(always)]
fn put(id: usize, params: &ViewParams, pixel: Pixel, receivers: &mut [[i32; 3]]) -> bool {
    let mut point = NOWHERE;
    if let Pixel::Receiver(p) = pixel {
        point = [p.x, p.y, p.z];
    }
    store(receivers, params.first.wrapping_add(id as u32) as usize, point);
    matches!(pixel, Pixel::Refused)
}
