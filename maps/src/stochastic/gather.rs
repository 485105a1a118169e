//! The pre-filter (sections 5.3 and 7.2): every texel of every level gathers the samples whose footprints hold it, within a fixed radius. What is too
//! wide for a level goes to the next coarser one, continuously (eq. 8).

use umbra4_core::kernel::fetch;

use crate::stochastic::{
    confusion::{coverage, half_extents},
    elementary::Elementary,
    float::{larger, within},
    grid::column_and_row,
    moments::Moments,
    params::{INTERLEAVED, LensParams, PROJECTED, RECTANGULAR},
};

/// R_G: how far a texel looks, texels of its level.
pub const RADIUS: i32 = 8;

/// A sum of weights, and of moments times weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Gathered {
    /// α of eq. 7, summed up.
    pub weight: f32,
    /// Moments times α.
    pub moments: Moments,
}

impl Gathered {
    /// Nothing.
    pub const NONE: Self = Self { weight: 0.0, moments: [0.0; 4] };

    /// This and `weight` times another.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, other: &Self, weight: f32) -> Self {
        let m = self.moments;
        let o = other.moments;
        Self {
            weight: self.weight + weight * other.weight,
            moments: [m[0] + weight * o[0], m[1] + weight * o[1], m[2] + weight * o[2], m[3] + weight * o[3]],
        }
    }

    /// Moments alone, with a weight of one; nothing stays nothing.
    #[inline(always)]
    #[must_use]
    pub fn normalised(self) -> Self {
        if self.weight > 0.0 { Self { weight: 1.0, ..Self::NONE.plus(&self, 1.0 / self.weight) } } else { Self::NONE }
    }
}

/// The share of a sample that the next coarser level takes (eq. 8): none below 0.4 R_G, all above 0.5 R_G. `radius` in texels of its level.
#[inline(always)]
pub fn coarse_share(radius: f32) -> f32 {
    let reach = RADIUS as f32;
    within((radius - 0.4 * reach) / (0.1 * reach), 0.0, 1.0)
}

/// The share that a level keeps; the coarsest keeps all.
#[inline(always)]
pub fn kept_share(params: &LensParams, radius: f32) -> f32 {
    if params.level + 1 < params.levels { 1.0 - coarse_share(radius / texel_width(params.level)) } else { 1.0 }
}

/// Texels of the finest level that one of a level is wide.
#[inline(always)]
pub fn texel_width(level: u32) -> f32 {
    (1_u32 << level) as f32
}

/// Texel `id` of the level above `params.level`: the mean of what its four texels of this level hand on.
#[inline(always)]
pub fn coarser(id: usize, params: &LensParams, samples: &[Elementary]) -> Elementary {
    let (own, start) = (params.level_size(params.level), params.level_start(params.level));
    let size = params.level_size(params.level + 1).max(1);
    let (column, row) = (id as u32 % size, id as u32 / size);
    let width = texel_width(params.level);
    let mut sum = Elementary::NONE;
    let mut child = 0;
    while child < 4 {
        let (right, down) = (child % 2, child / 2);
        let (x, y) = (2 * column + right, 2 * row + down);
        if x < own && y < own {
            let sample = fetch(samples, (start + y * own + x) as usize, Elementary::NONE);
            let weight = sample.weight * coarse_share(sample.radius / width);
            // From the middle of the coarse texel to that of the fine one.
            let away = [(right as f32 - 0.5) * width, (down as f32 - 0.5) * width];
            let offset = [sample.offset[0] + away[0], sample.offset[1] + away[1]];
            if weight > 0.0 {
                sum = sum.plus(&sample, weight, offset);
            }
        }
        child += 1;
    }
    sum.mean()
}

/// How far a texel of the level has to look to find every sample of at most `widest` (finest texels), texels of the level.
#[inline(always)]
pub fn search_radius(params: &LensParams, widest: f32) -> i32 {
    let least = params.least_radius;
    let widest = larger(widest / texel_width(params.level), least);
    // A footprint's middle lies up to its radius away from the texel that holds it, and up to half a texel for having been merged.
    let reach = if params.is(PROJECTED) { 2.0 * widest + 2.0 } else { widest + 1.5 };
    if reach < RADIUS as f32 { reach as i32 } else { RADIUS }
}

/// What texel `id` of the level gathers from samples within `search` texels (eq. 7 before it is divided): those whose footprint covers it, each with
/// weight 1/ρ², or rather one over the product of both half-extents, times what it covers of the texel.
#[inline(always)]
pub fn gathered(id: usize, search: i32, params: &LensParams, samples: &[Elementary]) -> Gathered {
    let size = params.level_size(params.level) as i32;
    let start = params.level_start(params.level) as i32;
    let (column, row) = column_and_row(id, params.level_size(params.level));
    let width = texel_width(params.level);
    let step = if params.is(INTERLEAVED) { 2 } else { 1 };
    let (projected, rectangular) = (params.is(PROJECTED), params.is(RECTANGULAR));
    // Whole steps: a texel sees those samples that differ from it by even numbers.
    let first = -(search / step * step);
    let mut sum = Gathered::NONE;
    let mut y = first;
    while y <= search {
        let mut x = first;
        while x <= search {
            let (at_x, at_y) = (column + x, row + y);
            if at_x >= 0 && at_y >= 0 && at_x < size && at_y < size {
                let sample = fetch(samples, (start + at_y * size + at_x) as usize, Elementary::NONE);
                if sample.weight > 0.0 {
                    let half = half_extents(params, sample.radius, width);
                    let (mut away_x, mut away_y) = (x as f32 * width, y as f32 * width);
                    if projected {
                        away_x += sample.offset[0];
                        away_y += sample.offset[1];
                    }
                    let covered = coverage(rectangular, half, away_x, away_y, width);
                    if covered > 0.0 {
                        let weight = covered * sample.weight * kept_share(params, sample.radius) / (half.x * half.y);
                        sum = sum.plus(&Gathered { weight: 1.0, moments: sample.moments }, weight);
                    }
                }
            }
            x += step;
        }
        y += step;
    }
    sum
}
