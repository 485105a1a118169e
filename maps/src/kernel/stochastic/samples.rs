//! Samples move to a plane: each is put at the head of the list of the texel where it lands, and lists are merged.

use umbra4_core::kernel::store;

use crate::stochastic::{
    elementary::Elementary,
    params::LensParams,
    reproject::{END, landing, on_plane},
    tiles::{MERGED, has, tile_of},
};

/// Empties the list of texel `id`.
#[inline(always)]
pub fn clear_lists(id: usize, params: &LensParams, heads: &mut [u32]) {
    if id < params.count as usize {
        store(heads, id, END);
    }
}

/// Puts the sample of texel `id` at the head of a list. `exchange(head, value)` puts a value in and returns what was there, as an atomic
/// where there are several threads. What order lists get depends on those; what is made of them does not.
#[inline(always)]
pub fn link_samples(
    id: usize,
    params: &LensParams,
    heads: &mut [u32],
    next: &mut [u32],
    exchange: impl Fn(&mut u32, u32) -> u32,
) {
    if id >= params.count as usize {
        return;
    }
    let at = landing(id, params) as usize;
    if at < heads.len() {
        store(next, id, exchange(&mut heads[at], id as u32));
    }
}

/// Texel `id` of the plane.
#[inline(always)]
pub fn merge_samples(
    id: usize,
    params: &LensParams,
    tiles: &[u32],
    heads: &[u32],
    next: &[u32],
    depths: &[f32],
    samples: &mut [Elementary],
) {
    if id < params.count as usize {
        let needed = has(tile_of(id, params), MERGED, params, tiles);
        store(samples, id, if needed { on_plane(id, params, heads, next, depths) } else { Elementary::NONE });
    }
}
