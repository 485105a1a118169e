//! Samples move to a plane (sections 6 and 7.4): each to the texel where its ray crosses it. Several may land in one, none in another; those of one
//! are a list, and are merged into their mean, with their number for a weight.

use umbra4_core::kernel::fetch;

use crate::stochastic::{
    elementary::{Elementary, sample},
    params::LensParams,
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

/// The least sample from `from` on of the list that begins at `head` and goes on at `next`; [`END`] where there is none.
#[inline(always)]
fn least_from(from: u32, head: u32, next: &[u32]) -> u32 {
    let (mut least, mut at) = (END, head);
    // A list is no longer than the map: a wrong one ends too.
    let mut rounds = 0;
    while at != END && rounds < next.len() {
        if at >= from && at < least {
            least = at;
        }
        at = fetch(next, at as usize, END);
        rounds += 1;
    }
    least
}

/// Texel `id` of the plane: the mean of its list, which begins at `heads` and goes on at `next`. Lists are short, about as many samples as
/// land in a texel. Threads put them together in any order, so that samples are added up from the least to the last: the sum is always the same.
#[inline(always)]
pub fn merged(id: usize, params: &LensParams, heads: &[u32], next: &[u32], depths: &[f32]) -> Elementary {
    let mut sum = Elementary::NONE;
    let head = fetch(heads, id, END);
    let mut at = least_from(0, head, next);
    while at != END {
        let own = sample(at as usize, id, params, depths);
        sum = sum.plus(&own, 1.0, own.offset);
        at = least_from(at + 1, head, next);
    }
    sum.mean()
}

/// Texel `id` of the plane: what [`merged`] says, or, in focus, its own sample.
#[inline(always)]
pub fn on_plane(id: usize, params: &LensParams, heads: &[u32], next: &[u32], depths: &[f32]) -> Elementary {
    if params.moves() { merged(id, params, heads, next, depths) } else { sample(id, id, params, depths) }
}
