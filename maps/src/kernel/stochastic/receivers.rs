//! Receivers: what planes say of them, and what they see in the end.

use glam::IVec3;
use umbra4_core::{
    Facing,
    kernel::{fetch, store},
};

use crate::stochastic::{gather::Gathered, lookup, params::LensParams};

#[inline(always)]
fn point(receivers: &[[i32; 3]], id: usize) -> IVec3 {
    let p = fetch(receivers, id, [0; 3]);
    IVec3::new(p[0], p[1], p[2])
}

/// Adds what the plane says of receiver `id` to what others said. Sums start as 0.
#[inline(always)]
pub fn look_up(id: usize, params: &LensParams, receivers: &[[i32; 3]], plane: &[Gathered], sums: &mut [Gathered]) {
    if id < params.count as usize {
        let so_far = fetch(sums, id, Gathered::NONE);
        store(sums, id, lookup::looked_up(point(receivers, id), so_far, params, plane));
    }
}

/// The fraction of the light that receiver `id` sees. `facings` holds the words of all receivers' [`Facing`]s, or of none.
#[inline(always)]
pub fn find_visibility(
    id: usize,
    params: &LensParams,
    receivers: &[[i32; 3]],
    facings: &[u32],
    sums: &[Gathered],
    visibility: &mut [f32],
) {
    if id < params.count as usize {
        let facing = Facing::from_word(fetch(facings, id, Facing::UNKNOWN.word()));
        let sum = fetch(sums, id, Gathered::NONE);
        store(visibility, id, lookup::seen(point(receivers, id), facing, &sum, params));
    }
}
