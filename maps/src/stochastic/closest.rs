//! The radius of the closest occluding sample (sections 5.2 and 7.2): where a surface is partly occluded, its own samples are too sparse for
//! their small radii, and holes would stay. Of the neighbours that occlude a sample, the one with the smallest circle lends it its radius.
//!
//! Twelve neighbours within 32 texels stand for all. What they give is noisy, and smoothed.

use umbra4_core::kernel::fetch;

use crate::stochastic::{
    confusion::{covers, half_extents},
    elementary::Elementary,
    float::{larger, smaller},
    grid::column_and_row,
    params::{LensParams, PROJECTED, RECTANGULAR},
    tiles::{self, DATA},
};

/// Neighbours that are asked.
pub const NEIGHBOURS: usize = 12;
/// How far they lie at most, texels.
pub const SEARCH_RADIUS: i32 = 32;
/// How far the smoothing reaches, texels.
pub const SMOOTH_RADIUS: i32 = 2;

/// Where neighbours lie, texels: a Poisson-disc pattern, no two closer than 14 texels.
pub const OFFSETS: [[i32; 2]; NEIGHBOURS] = [
    [3, -5],
    [-14, 4],
    [8, 12],
    [-4, -21],
    [20, -10],
    [-25, -11],
    [-8, 21],
    [25, 8],
    [14, -27],
    [-27, 15],
    [12, 28],
    [-31, 1],
];

/// A Gaussian of a deviation of one texel, along one axis, by distance.
const GAUSS: [f32; 3] = [1.0, 0.606_530_66, 0.135_335_28];

/// The radius of the closest of the neighbours that occlude texel `id` of the finest level, finest texels; 0 where none does.
#[inline(always)]
pub fn closest(id: usize, params: &LensParams, samples: &[Elementary]) -> f32 {
    let own = fetch(samples, id, Elementary::NONE);
    if own.weight <= 0.0 {
        return 0.0;
    }
    let size = params.size as i32;
    let (column, row) = column_and_row(id, params.size);
    let mut least = f32::MAX;
    let mut k = 0;
    while k < NEIGHBOURS {
        let [x, y] = OFFSETS[k];
        let (x, y) = (column + x, row + y);
        if x >= 0 && y >= 0 && x < size && y < size {
            let other = fetch(samples, (y * size + x) as usize, Elementary::NONE);
            if occludes(&other, &own, [(x - column) as f32, (y - row) as f32], params) {
                least = smaller(least, other.radius);
            }
        }
        k += 1;
    }
    if least < f32::MAX { least } else { 0.0 }
}

/// Whether `other`, whose texel lies `away` from that of `own`, is nearer to the light, and its footprint holds the middle of the other's.
#[inline(always)]
pub fn occludes(other: &Elementary, own: &Elementary, away: [f32; 2], params: &LensParams) -> bool {
    let (mut x, mut y) = (away[0], away[1]);
    if params.is(PROJECTED) {
        x += other.offset[0] - own.offset[0];
        y += other.offset[1] - own.offset[1];
    }
    other.weight > 0.0
        && other.inverse_depth > own.inverse_depth
        && covers(params.is(RECTANGULAR), half_extents(params, other.radius, 1.0), x, y)
}

/// What [`closest`] found around texel `id`, smoothed by a Gaussian over 5 × 5 texels. Texels without a sample say nothing.
#[inline(always)]
pub fn smoothed(id: usize, params: &LensParams, samples: &[Elementary], found: &[f32]) -> f32 {
    let size = params.size as i32;
    let (column, row) = column_and_row(id, params.size);
    let (mut sum, mut weights) = (0.0, 0.0);
    let mut y = -SMOOTH_RADIUS;
    while y <= SMOOTH_RADIUS {
        let mut x = -SMOOTH_RADIUS;
        while x <= SMOOTH_RADIUS {
            let (at_x, at_y) = (column + x, row + y);
            if at_x >= 0 && at_y >= 0 && at_x < size && at_y < size {
                let at = (at_y * size + at_x) as usize;
                if fetch(samples, at, Elementary::NONE).weight > 0.0 {
                    let weight = gauss(x) * gauss(y);
                    sum += weight * fetch(found, at, 0.0);
                    weights += weight;
                }
            }
            x += 1;
        }
        y += 1;
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

#[inline(always)]
fn gauss(distance: i32) -> f32 {
    let distance = if distance < 0 { -distance } else { distance } as usize;
    if distance < GAUSS.len() { GAUSS[distance] } else { 0.0 }
}

/// The radius that texel `id` is filtered with: ρ of section 5.2, but for the limit to what is raised. Of texels that nothing is gathered from
/// (`tiles`), the sample's own.
#[inline(always)]
pub fn filtered_with(id: usize, params: &LensParams, tiles: &[u32], samples: &[Elementary], found: &[f32]) -> f32 {
    if tiles::has(tiles::tile_of(id, params), DATA, params, tiles) {
        raised(id, params, samples, found)
    } else {
        fetch(samples, id, Elementary::NONE).radius
    }
}

/// The same of a texel that is gathered from.
#[inline(always)]
pub fn raised(id: usize, params: &LensParams, samples: &[Elementary], found: &[f32]) -> f32 {
    let own = fetch(samples, id, Elementary::NONE).radius;
    if params.widest_raise > 0.0 {
        larger(own, smaller(smoothed(id, params, samples, found), params.widest_raise))
    } else {
        own
    }
}
