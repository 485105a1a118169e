//! Where filter planes lie. The paper partitions a range evenly, and leaves open how receivers could decide (section 9).
//!
//! Between two planes the error grows about with the square of their distance, that is, with 1/λ² where planes have the density λ over inverse depth q. For
//! receivers of density p, the mean error ∫ p/λ² is least, for a given number of planes ∫ λ, where λ is proportional to p^(1/3).

use crate::stochastic::{options::Placement, params::DepthRange};

/// Bins of a histogram of receivers over inverse depth.
pub const BINS: usize = 256;

/// The bin of a receiver at inverse depth `at`.
#[inline]
pub fn bin(depths: DepthRange, at: f32) -> usize {
    let (low, high) = (1.0 / depths.far, 1.0 / depths.near);
    let place = (at - low) / (high - low) * BINS as f32;
    // NaN, of a range that is a point, and what is below are 0.
    (place as usize).min(BINS - 1)
}

/// Writes the inverse depths of planes, from the nearest to the farthest. `histogram`: receivers by [`bin`]. Planes are the
/// same where all receivers are at one depth.
pub fn place(planes: &mut [f32], placement: Placement, depths: DepthRange, histogram: &[u32; BINS]) {
    let (low, high) = (1.0 / depths.far, 1.0 / depths.near);
    let last = planes.len().saturating_sub(1).max(1) as f32;
    let single = planes.len() == 1;
    let density = |bin: &u32| libm_cbrt(*bin as f32);
    let whole: f32 = histogram.iter().map(density).sum();
    let count: u32 = histogram.iter().fold(0, |sum, bin| sum.saturating_add(*bin));
    for (index, plane) in planes.iter_mut().enumerate() {
        // From the nearest to the farthest.
        let part = if single { 0.5 } else { index as f32 / last };
        *plane = match placement {
            Placement::Depth => 1.0 / (depths.near + (depths.far - depths.near) * part),
            Placement::InverseDepth => high + (low - high) * part,
            // One plane: the median.
            Placement::Receivers if single => {
                let middle = below(histogram, |bin| *bin as f32, count as f32 * 0.5);
                low + (high - low) * middle
            }
            Placement::Receivers => low + (high - low) * below(histogram, density, whole * (1.0 - part)),
        }
        .max(low.min(high))
        .min(high.max(low));
    }
}

/// The place, of all bins 0..=1, below which lie `wanted` of the sum of `density`.
fn below(histogram: &[u32; BINS], density: impl Fn(&u32) -> f32, wanted: f32) -> f32 {
    let mut sum = 0.0;
    for (bin, own) in histogram.iter().map(density).enumerate() {
        if own > 0.0 && sum + own >= wanted {
            let part = ((wanted - sum) / own).clamp(0.0, 1.0);
            return (bin as f32 + part) / BINS as f32;
        }
        sum += own;
    }
    1.0
}

/// The cube root of a number that is not negative, by Newton's steps from a first guess that is right to a few per cent.
fn libm_cbrt(x: f32) -> f32 {
    if x <= 0.0 {
        return 0.0;
    }
    let mut root = f32::from_bits(x.to_bits() / 3 + 0x2a51_19f2);
    for _ in 0..3 {
        root -= (root - x / (root * root)) / 3.0;
    }
    root
}
