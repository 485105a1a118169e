//! Radii of the finest level, raised by closest occluders: in steps, since each reads what the one before has found of neighbours.

use umbra4_core::kernel::{fetch, store};

use crate::stochastic::{
    closest::{closest, filtered_with},
    elementary::Elementary,
    params::LensParams,
    tiles::{MERGED, has, tile_of},
};

/// The radius of the closest occluder of texel `id`.
#[inline(always)]
pub fn find_closest(id: usize, params: &LensParams, tiles: &[u32], samples: &[Elementary], found: &mut [f32]) {
    if id < params.count as usize {
        let needed = has(tile_of(id, params), MERGED, params, tiles);
        store(found, id, if needed { closest(id, params, samples) } else { 0.0 });
    }
}

/// The radius that texel `id` is filtered with.
#[inline(always)]
pub fn raise_radii(
    id: usize,
    params: &LensParams,
    tiles: &[u32],
    samples: &[Elementary],
    found: &[f32],
    raised: &mut [f32],
) {
    if id < params.count as usize {
        store(raised, id, filtered_with(id, params, tiles, samples, found));
    }
}

/// Gives it to the sample of texel `id`.
#[inline(always)]
pub fn lend_radii(id: usize, params: &LensParams, raised: &[f32], samples: &mut [Elementary]) {
    if id < params.count as usize && id < samples.len() {
        samples[id].radius = fetch(raised, id, 0.0);
    }
}
