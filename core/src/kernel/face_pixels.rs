//! Kernels that find which way a G-buffer's pixels face. Its texture is read by the entry point.

use crate::{
    facing::Facing,
    gbuffer::{ViewParams, decode_normal},
    kernel::{fetch, half::standing, store},
};

/// Which way pixel `id` faces, by its normal: a word of [`Facing`].
#[inline(always)]
pub fn face_pixel(id: usize, params: &ViewParams, normal: [f32; 4], facings: &mut [u32]) {
    let facing = Facing::of(decode_normal(params.normals, normal));
    store(facings, params.first.wrapping_add(id as u32) as usize, facing.word());
}

/// Which way half pixel `id` faces: as the pixel does whose receiver it has.
#[inline(always)]
pub fn thin_facings(id: usize, params: &ViewParams, receivers: &[[i32; 3]], facings: &[u32], thinned: &mut [u32]) {
    if id >= params.count as usize {
        return;
    }
    let mut facing = Facing::UNKNOWN.word();
    if let Some(pixel) = standing(id, params, receivers) {
        facing = fetch(facings, pixel as usize, facing);
    }
    store(thinned, id, facing);
}
