//! Levels are put together, from coarse to fine (section 7.2, step 3): each adds what the next coarser one has, interpolated. As it is read, a
//! level is smoothed by 1-2-1 along both axes.
//!
//! The paper smooths by a box of 3 × 3. With 1-2-1 each of the four classes of texels that interleaving tells apart weighs the same, whichever is in the
//! middle: their noise is gone, not only fainter.

use umbra4_core::kernel::fetch;

use crate::stochastic::{
    gather::Gathered,
    grid::column_and_row,
    params::{LensParams, SMOOTHED},
};

/// What was gathered around texel (`column`, `row`) of the level, smoothed where that is asked for. Beyond the border, the border's.
#[inline(always)]
pub fn smoothed(column: i32, row: i32, params: &LensParams, gathered: &[Gathered]) -> Gathered {
    let (size, start) = (params.level_size(params.level) as i32, params.level_start(params.level) as i32);
    if !params.is(SMOOTHED) {
        return nearest(column, row, size, start, gathered);
    }
    let mut sum = Gathered::NONE;
    let mut k = 0;
    while k < 9 {
        let (x, y) = (k % 3 - 1, k / 3 - 1);
        let weight = (if x == 0 { 0.5 } else { 0.25 }) * (if y == 0 { 0.5 } else { 0.25 });
        sum = sum.plus(&nearest(column + x, row + y, size, start, gathered), weight);
        k += 1;
    }
    sum
}

/// Texel `id` of the level, resolved: what it gathered, and what the next coarser level, which is resolved already, has there. On the finest
/// level weights become one (eq. 7). `coarser` are the texels of all levels from `start` on.
#[inline(always)]
pub fn resolved(id: usize, params: &LensParams, gathered: &[Gathered], coarser: &[Gathered], start: u32) -> Gathered {
    let (column, row) = column_and_row(id, params.level_size(params.level));
    let mut sum = smoothed(column, row, params, gathered);
    if params.level + 1 < params.levels {
        sum = sum.plus(&upsampled(column, row, params, coarser, start), 1.0);
    }
    if params.level == 0 { sum.normalised() } else { sum }
}

/// The next coarser level at the middle of texel (`column`, `row`) of this one, bilinearly.
#[inline(always)]
pub fn upsampled(column: i32, row: i32, params: &LensParams, coarser: &[Gathered], start: u32) -> Gathered {
    let level = params.level + 1;
    let (size, start) = (params.level_size(level) as i32, params.level_start(level).wrapping_sub(start) as i32);
    // A fine texel's middle is a quarter of a coarse texel away from its parent's.
    let (own_x, own_y) = (column / 2, row / 2);
    let (other_x, other_y) = (own_x + column % 2 * 2 - 1, own_y + row % 2 * 2 - 1);
    Gathered::NONE
        .plus(&nearest(own_x, own_y, size, start, coarser), 0.75 * 0.75)
        .plus(&nearest(other_x, own_y, size, start, coarser), 0.25 * 0.75)
        .plus(&nearest(own_x, other_y, size, start, coarser), 0.75 * 0.25)
        .plus(&nearest(other_x, other_y, size, start, coarser), 0.25 * 0.25)
}

/// The texel of a level, of `size` texels each way from `start` on, that is nearest to a place which may lie beyond the border.
#[inline(always)]
fn nearest(x: i32, y: i32, size: i32, start: i32, texels: &[Gathered]) -> Gathered {
    let (x, y) = (clamped(x, size), clamped(y, size));
    fetch(texels, (start + y * size + x) as usize, Gathered::NONE)
}

#[inline(always)]
fn clamped(at: i32, size: i32) -> i32 {
    if at < 0 {
        0
    } else if at >= size {
        size - 1
    } else {
        at
    }
}
