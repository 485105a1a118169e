//! Samples move to a plane (sections 6 and 7.4): each to the texel where its ray crosses it. Several may land in one, none in another; those of one
//! are a list, and are merged into their mean, with their number for a weight.

use crate::stochastic::{
    elementary::{Elementary, sample},
    params::LensParams,
    slice::fetch,
    strata,
};

/// The end of a list.
pub const END: u32 = u32::MAX;

/// The texel of the plane in which the sample of texel `id` lands, or [`END`] where it leaves the map.
#[inline(always)]
pub fn landing(id: usize, params: &LensParams) -> u32 {
    let size = params.size.max(1);
    let (column, row) = (id as u32 % size, id as u32 / size);
    let shift = params.lens().shift(strata::light_position(column, row, params.seed), params.plane);
    let (x, y) = (column as f32 + 0.5 + shift.x, row as f32 + 0.5 + shift.y);
    let end = params.size as f32;
    // Truncated, which is floored above 0. Written so that NaN is outside.
    if x >= 0.0 && y >= 0.0 && x < end && y < end { y as u32 * size + x as u32 } else { END }
}

/// Texel `id` of the plane: the mean of its list, which begins at `heads` and goes on at `next`.
#[inline(always)]
pub fn merged(id: usize, params: &LensParams, heads: &[u32], next: &[u32], depths: &[f32]) -> Elementary {
    let mut sum = Elementary::NONE;
    let mut at = fetch(heads, id, END);
    // A list is no longer than the map: a wrong one ends too.
    let mut rounds = 0;
    while at != END && rounds < depths.len() {
        let own = sample(at as usize, id, params, depths);
        sum = sum.plus(&own, 1.0, own.offset);
        at = fetch(next, at as usize, END);
        rounds += 1;
    }
    sum.mean()
}
