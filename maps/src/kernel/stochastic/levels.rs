//! The levels of a plane: coarser samples from finer ones, how far each level has to look, what it gathers, and all put together.

use umbra4_core::kernel::store;

use crate::stochastic::{
    elementary::Elementary,
    gather::{Gathered, coarser},
    params::LensParams,
    resolve::resolved,
    tiles::{self, ACTIVE, DATA, has, tile_in_level, tile_of, tiles_start},
};

/// The sample of texel `id` of a level above the finest, from those of the level below.
#[inline(always)]
pub fn coarsen_samples(id: usize, params: &LensParams, tiles: &[u32], samples: &mut [Elementary]) {
    if id < params.count as usize && params.level > 0 {
        let needed = has(tile_of(id, params), DATA, params, tiles);
        let below = params.with_level(params.level - 1);
        let sample = if needed { coarser(id, &below, samples) } else { Elementary::NONE };
        store(samples, params.level_start(params.level) as usize + id, sample);
    }
}

/// The widest radius in tile `id` of a level.
#[inline(always)]
pub fn find_widest(id: usize, params: &LensParams, samples: &[Elementary], widest: &mut [f32]) {
    if id < params.count as usize {
        let at = tiles_start(params, params.level) as usize + id;
        store(widest, at, tiles::widest(id, params, samples));
    }
}

/// What texel `id` of a level gathers.
#[inline(always)]
pub fn gather_samples(
    id: usize,
    params: &LensParams,
    tiles: &[u32],
    widest: &[f32],
    samples: &[Elementary],
    gathered: &mut [Gathered],
) {
    if id < params.count as usize {
        let needed = has(tile_of(id, params), ACTIVE, params, tiles);
        let tile = tile_in_level(id, params) as usize;
        let sum = if needed { tiles::gathered(id, tile, params, widest, samples) } else { Gathered::NONE };
        store(gathered, params.level_start(params.level) as usize + id, sum);
    }
}

/// Texel `id` of a level, with the next coarser one, which is resolved.
#[inline(always)]
pub fn resolve_level(
    id: usize,
    params: &LensParams,
    tiles: &[u32],
    gathered: &[Gathered],
    resolved_levels: &mut [Gathered],
) {
    if id < params.count as usize {
        let needed = has(tile_of(id, params), ACTIVE, params, tiles);
        let sum = if needed { resolved(id, params, gathered, resolved_levels, 0) } else { Gathered::NONE };
        store(resolved_levels, params.level_start(params.level) as usize + id, sum);
    }
}
