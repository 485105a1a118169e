//! Elementary occluders: what a texel of a filter plane holds.

use umbra4_core::kernel::fetch;

use crate::stochastic::{confusion, moments, params::LensParams, strata, trace::MISS};

/// Samples that were merged into one.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Elementary {
    /// How many they are; 0 where there is none, and all else is 0 too.
    pub weight: f32,
    /// The larger half-extent of their footprint, finest texels.
    pub radius: f32,
    /// Inverse depth.
    pub inverse_depth: f32,
    /// From the middle of the texel to the middle of the footprint, finest texels.
    pub offset: [f32; 2],
    /// Of depth.
    pub moments: moments::Moments,
}

impl Elementary {
    /// No sample.
    pub const NONE: Self = Self { weight: 0.0, radius: 0.0, inverse_depth: 0.0, offset: [0.0; 2], moments: [0.0; 4] };

    /// The weighted sum of this and `weight` times another, of which [`Elementary::mean`] makes a mean.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, other: &Self, weight: f32, offset: [f32; 2]) -> Self {
        let (own, more) = (self.moments, other.moments);
        Self {
            weight: self.weight + weight,
            radius: self.radius + weight * other.radius,
            inverse_depth: self.inverse_depth + weight * other.inverse_depth,
            offset: [self.offset[0] + weight * offset[0], self.offset[1] + weight * offset[1]],
            moments: [
                own[0] + weight * more[0],
                own[1] + weight * more[1],
                own[2] + weight * more[2],
                own[3] + weight * more[3],
            ],
        }
    }

    /// The mean of what was summed up; the weight stays the sum.
    #[inline(always)]
    #[must_use]
    pub fn mean(self) -> Self {
        if self.weight <= 0.0 {
            return Self::NONE;
        }
        let one = 1.0 / self.weight;
        let m = self.moments;
        Self {
            weight: self.weight,
            radius: self.radius * one,
            inverse_depth: self.inverse_depth * one,
            offset: [self.offset[0] * one, self.offset[1] * one],
            moments: [m[0] * one, m[1] * one, m[2] * one, m[3] * one],
        }
    }
}

/// The depth at which the ray of a texel ends: where it hits nothing, with the farthest receiver.
#[inline(always)]
pub fn depth(texel: usize, params: &LensParams, depths: &[f32]) -> f32 {
    let depth = fetch(depths, texel, MISS);
    if depth >= MISS { params.far } else { depth }
}

/// The sample of texel `source` on the plane, as one that has landed in texel `at`.
#[inline(always)]
pub fn sample(source: usize, at: usize, params: &LensParams, depths: &[f32]) -> Elementary {
    let size = params.size.max(1);
    let (column, row) = (source as u32 % size, source as u32 / size);
    let depth = depth(source, params, depths);
    let inverse_depth = 1.0 / depth;
    let from = strata::light_position(column, row, params.seed);
    let shift = params.lens().shift(from, inverse_depth);
    let (at_column, at_row) = (at as u32 % size, at as u32 / size);
    Elementary {
        weight: 1.0,
        radius: confusion::radius(params.widest_scale(), inverse_depth, params.plane),
        inverse_depth,
        offset: [shift.x + (column as f32 - at_column as f32), shift.y + (row as f32 - at_row as f32)],
        moments: moments::of_depth(params.exponent, params.z(depth)),
    }
}
