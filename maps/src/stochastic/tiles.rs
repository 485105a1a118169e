//! Active and data tiles (section 7.5), of 16 × 16 texels: what no receiver looks at is not gathered, and what no active tile reads is not even
//! merged. A tile says in bits what is needed of it.

use glam::IVec3;
use umbra4_core::kernel::fetch;

use crate::stochastic::{
    elementary::Elementary,
    float::larger,
    gather::{self, Gathered, kept_share},
    lookup,
    params::{ACTIVE_TILES, LensParams},
};

/// Texels along each side of a tile.
pub const TILE: u32 = 16;
/// Its texels are gathered and resolved.
pub const ACTIVE: u32 = 1;
/// Its samples are read by active tiles of its level, or by data tiles of the next.
pub const DATA: u32 = 2;
/// Its samples, of the finest level, may lend their radius to those of data tiles.
pub const MERGED: u32 = 4;

/// Tiles along each side of a level.
#[inline(always)]
pub fn tiles_across(params: &LensParams, level: u32) -> u32 {
    let size = params.level_size(level);
    size.div_ceil(TILE)
}

/// Where the tiles of a level start among those of all.
#[inline(always)]
pub fn tiles_start(params: &LensParams, level: u32) -> u32 {
    let (mut start, mut below) = (0, 0);
    while below < level {
        let across = tiles_across(params, below);
        start += across * across;
        below += 1;
    }
    start
}

/// The tile of texel `id` of the level, among those of the level.
#[inline(always)]
pub fn tile_in_level(id: usize, params: &LensParams) -> u32 {
    let size = params.level_size(params.level).max(1);
    let (column, row) = (id as u32 % size, id as u32 / size);
    row / TILE * tiles_across(params, params.level) + column / TILE
}

/// The tile of texel `id` of the level, among those of all.
#[inline(always)]
pub fn tile_of(id: usize, params: &LensParams) -> u32 {
    tiles_start(params, params.level) + tile_in_level(id, params)
}

/// Whether a tile, among those of all, has `bit`. Where tiles are not told apart, all have all.
#[inline(always)]
pub fn has(tile: u32, bit: u32, params: &LensParams, tiles: &[u32]) -> bool {
    !params.is(ACTIVE_TILES) || fetch(tiles, tile as usize, 0) & bit != 0
}

/// The tiles of the finest level, least and largest column and row, that a receiver looks at: see [`looked_at`].
#[inline(always)]
pub fn tiles_looked_at(point: IVec3, params: &LensParams) -> Option<[u32; 4]> {
    let [left, top, right, bottom] = looked_at(point, params)?;
    Some([left / TILE, top / TILE, right / TILE, bottom / TILE])
}

/// The texels of the finest level that a receiver looks up on the plane, with those around them that are smoothed into them: least and largest column
/// and row, inside the map. `None` where it does not look at the plane.
#[inline(always)]
pub fn looked_at(point: IVec3, params: &LensParams) -> Option<[u32; 4]> {
    let placed = params.place(point);
    let [x, y] = lookup::place_in_map(placed, params)?;
    if lookup::plane_weight(params, 1.0 / placed.z) <= 0.0 {
        return None;
    }
    let last = params.size as i32 - 1;
    let inside = |at: i32| {
        if at < 0 {
            0
        } else if at > last {
            last as u32
        } else {
            at as u32
        }
    };
    let (x, y) = ((x + 0.5) as i32, (y + 0.5) as i32);
    Some([inside(x - 2), inside(y - 2), inside(x + 1), inside(y + 1)])
}

/// Whether tile `id` of the level, which is above the finest, is needed: an active tile of the level below interpolates from it, or from what is
/// smoothed into that.
#[inline(always)]
pub fn active_above(id: usize, params: &LensParams, tiles: &[u32]) -> bool {
    let level = params.level;
    let across = tiles_across(params, level).max(1);
    let (column, row) = (id as i32 % across as i32, id as i32 / across as i32);
    let (below, start) = (tiles_across(params, level - 1) as i32, tiles_start(params, level - 1) as i32);
    // Two tiles of the level below lie over one of this; a ring of one more is nearer than what is smoothed and interpolated.
    let mut y = 2 * row - 1;
    while y <= 2 * row + 2 {
        let mut x = 2 * column - 1;
        while x <= 2 * column + 2 {
            if x >= 0
                && y >= 0
                && x < below
                && y < below
                && fetch(tiles, (start + y * below + x) as usize, 0) & ACTIVE != 0
            {
                return true;
            }
            x += 1;
        }
        y += 1;
    }
    false
}

/// Whether tile `id` of the level holds data: an active one of its level is beside it, or a data tile of the next coarser level, whose bits are known
/// already, is made of it.
#[inline(always)]
pub fn holds_data(id: usize, params: &LensParams, tiles: &[u32]) -> bool {
    let level = params.level;
    let across = tiles_across(params, level).max(1) as i32;
    let (column, row) = (id as i32 % across, id as i32 / across);
    if level + 1 < params.levels {
        let above = tiles_across(params, level + 1) as i32;
        let at = tiles_start(params, level + 1) as i32 + row / 2 * above + column / 2;
        if fetch(tiles, at as usize, 0) & DATA != 0 {
            return true;
        }
    }
    // Texels look 8 texels far: not beyond the next tile.
    any_around(column, row, 1, ACTIVE, params, tiles)
}

/// Whether tile `id` of the finest level is merged: the closest occluder of a data tile's sample, 32 texels away, or one that is smoothed into that, may
/// lie in it.
#[inline(always)]
pub fn is_merged(id: usize, params: &LensParams, tiles: &[u32]) -> bool {
    let across = tiles_across(params, 0).max(1) as i32;
    any_around(id as i32 % across, id as i32 / across, 3, DATA, params, tiles)
}

/// Whether a tile of the level, at most `distance` away, has a bit.
#[inline(always)]
fn any_around(column: i32, row: i32, distance: i32, bit: u32, params: &LensParams, tiles: &[u32]) -> bool {
    let across = tiles_across(params, params.level) as i32;
    let start = tiles_start(params, params.level) as i32;
    let mut y = row - distance;
    while y <= row + distance {
        let mut x = column - distance;
        while x <= column + distance {
            let inside = x >= 0 && y >= 0 && x < across && y < across;
            if inside && fetch(tiles, (start + y * across + x) as usize, 0) & bit != 0 {
                return true;
            }
            x += 1;
        }
        y += 1;
    }
    false
}

/// The largest radius, finest texels, of the samples that tile `id` of the level keeps a share of; below 0 where it keeps none.
#[inline(always)]
pub fn widest(id: usize, params: &LensParams, samples: &[Elementary]) -> f32 {
    let (size, start) = (params.level_size(params.level), params.level_start(params.level));
    let across = tiles_across(params, params.level).max(1);
    let (left, top) = (id as u32 % across * TILE, id as u32 / across * TILE);
    let mut widest = NOTHING_KEPT;
    let mut k = 0;
    while k < TILE * TILE {
        let (x, y) = (left + k % TILE, top + k / TILE);
        if x < size && y < size {
            let sample = fetch(samples, (start + y * size + x) as usize, Elementary::NONE);
            if sample.weight > 0.0 && kept_share(params, sample.radius) > 0.0 {
                widest = larger(widest, sample.radius);
            }
        }
        k += 1;
    }
    widest
}

/// [`widest`] of a tile of which nothing is kept.
pub const NOTHING_KEPT: f32 = -1.0;

/// How far the texels of tile `id` of the level have to look, texels of the level; below 0 where there is nothing to find.
#[inline(always)]
pub fn search_radius(id: usize, params: &LensParams, widest: &[f32]) -> i32 {
    let across = tiles_across(params, params.level).max(1) as i32;
    let start = tiles_start(params, params.level) as i32;
    let (column, row) = (id as i32 % across, id as i32 / across);
    let mut most = NOTHING_KEPT;
    let mut k = 0;
    while k < 9 {
        let (x, y) = (column + k % 3 - 1, row + k / 3 - 1);
        if x >= 0 && y >= 0 && x < across && y < across {
            most = larger(most, fetch(widest, (start + y * across + x) as usize, NOTHING_KEPT));
        }
        k += 1;
    }
    if most < 0.0 { -1 } else { gather::search_radius(params, most) }
}

/// What texel `id` of the level, in tile `tile` of the level, gathers: see [`gather::gathered`].
#[inline(always)]
pub fn gathered(id: usize, tile: usize, params: &LensParams, widest: &[f32], samples: &[Elementary]) -> Gathered {
    let search = search_radius(tile, params, widest);
    if search < 0 { Gathered::NONE } else { gather::gathered(id, search, params, samples) }
}
