//! What is needed of every tile. Words start as 0. A thread sets bits of words that others read meanwhile, though not those bits, or set too:
//! `set(word, bits)` is atomic where there are several threads.

use glam::IVec3;
use umbra4_core::kernel::fetch;

use crate::stochastic::{
    params::LensParams,
    tiles::{ACTIVE, DATA, MERGED, active_above, holds_data, is_merged, tiles_across, tiles_looked_at, tiles_start},
};

/// The tiles of the finest level that receiver `id` looks at.
#[inline(always)]
pub fn mark_looked_at(
    id: usize,
    params: &LensParams,
    receivers: &[[i32; 3]],
    tiles: &mut [u32],
    set: impl Fn(&mut u32, u32),
) {
    if id >= params.count as usize || id >= receivers.len() {
        return;
    }
    let p = fetch(receivers, id, [0; 3]);
    if let Some([left, top, right, bottom]) = tiles_looked_at(IVec3::new(p[0], p[1], p[2]), params) {
        let across = tiles_across(params, 0);
        let mut row = top;
        while row <= bottom {
            let mut column = left;
            while column <= right {
                let tile = (row * across + column) as usize;
                // Most receivers find it marked.
                if tile < tiles.len() && tiles[tile] & ACTIVE == 0 {
                    set(&mut tiles[tile], ACTIVE);
                }
                column += 1;
            }
            row += 1;
        }
    }
}

/// Tile `id` of a level above the finest: whether the level below, which is marked, interpolates from it.
#[inline(always)]
pub fn mark_active(id: usize, params: &LensParams, tiles: &mut [u32], set: impl Fn(&mut u32, u32)) {
    let tile = tiles_start(params, params.level) as usize + id;
    if id < params.count as usize && tile < tiles.len() && params.level > 0 && active_above(id, params, tiles) {
        set(&mut tiles[tile], ACTIVE);
    }
}

/// Tile `id` of a level: whether it holds data. The next coarser level is done.
#[inline(always)]
pub fn mark_data(id: usize, params: &LensParams, tiles: &mut [u32], set: impl Fn(&mut u32, u32)) {
    let tile = tiles_start(params, params.level) as usize + id;
    if id < params.count as usize && tile < tiles.len() && holds_data(id, params, tiles) {
        set(&mut tiles[tile], DATA);
    }
}

/// Tile `id` of the finest level: whether its samples are merged.
#[inline(always)]
pub fn mark_merged(id: usize, params: &LensParams, tiles: &mut [u32], set: impl Fn(&mut u32, u32)) {
    if id < params.count as usize && id < tiles.len() && is_merged(id, params, tiles) {
        set(&mut tiles[id], MERGED);
    }
}
