//! Kernels that make receivers of a G-buffer's pixels. Their textures are read by the entry point.

use crate::{
    gbuffer::{Pixel, ViewParams, from_depth, from_position},
    kernel::{NOWHERE, store},
};

/// The texel of pixel `id`; `None` where there is none.
#[inline(always)]
pub fn texel(id: usize, params: &ViewParams) -> Option<[u32; 2]> {
    if id >= params.count as usize || params.width == 0 {
        return None;
    }
    let pixel = params.first + id as u32;
    Some([pixel % params.width, pixel / params.width])
}

/// The receiver of pixel `id`, from a stored world position. Returns whether it is refused.
#[inline(always)]
pub fn snap_position(
    id: usize,
    params: &ViewParams,
    position: [f32; 4],
    normal: [f32; 4],
    receivers: &mut [[i32; 3]],
) -> bool {
    put(id, params, from_position(params, position, normal), receivers)
}

/// The receiver of pixel `id`, from a stored depth. Returns whether it is refused.
#[inline(always)]
pub fn snap_depth(
    id: usize,
    params: &ViewParams,
    [x, y]: [u32; 2],
    depth: f32,
    normal: [f32; 4],
    receivers: &mut [[i32; 3]],
) -> bool {
    put(id, params, from_depth(params, x, y, depth, normal), receivers)
}

#[inline(always)]
fn put(id: usize, params: &ViewParams, pixel: Pixel, receivers: &mut [[i32; 3]]) -> bool {
    let mut point = NOWHERE;
    if let Pixel::Receiver(p) = pixel {
        point = [p.x, p.y, p.z];
    }
    store(receivers, params.first as usize + id, point);
    matches!(pixel, Pixel::Refused)
}
