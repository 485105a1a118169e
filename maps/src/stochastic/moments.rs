//! Visibility that can be filtered before it is asked for (section 5.1): moments of depth, and the bound by Chebyshev's inequality.

use glam::Vec2;

use crate::stochastic::float::{larger, smaller};

/// Moments: mean and mean square, of depth, or of `e^(c·z)` and then of `−e^(−c·z)`.
pub type Moments = [f32; 4];

/// Moments of one depth. `exponent` is 0 for plain variance.
#[inline(always)]
pub fn of_depth(exponent: f32, z: f32) -> Moments {
    if exponent > 0.0 {
        let [up, down] = warped(exponent, z);
        [up, up * up, down, down * down]
    } else {
        [z, z * z, 0.0, 0.0]
    }
}

/// `e^(c·z)` and `−e^(−c·z)`.
#[inline(always)]
fn warped(exponent: f32, z: f32) -> [f32; 2] {
    let e = Vec2::new(exponent * z, -exponent * z).exp();
    [e.x, -e.y]
}

/// The largest share of a distribution with this mean and mean square that can lie at `at` or beyond (eq. 5).
#[inline(always)]
pub fn chebyshev(mean: f32, square: f32, at: f32, least_variance: f32) -> f32 {
    let beyond = at - mean;
    if beyond <= 0.0 {
        return 1.0;
    }
    let variance = larger(square - mean * mean, least_variance);
    // Scaled by what is beyond: squares of warped depths do not overflow in the sum. Both may be 0 where floats end.
    let spread = variance / beyond / beyond;
    if spread >= f32::MAX { 1.0 } else { spread / (spread + 1.0) }
}

/// The fraction of light that a receiver at depth `z` sees, in `0.0..=1.0`. `least_deviation`: of depth.
#[inline(always)]
pub fn visibility(exponent: f32, moments: &Moments, z: f32, least_deviation: f32) -> f32 {
    if exponent > 0.0 {
        let [up, down] = warped(exponent, z);
        // A small deviation of depth is c·f(z) times as much of f.
        let deviation = [exponent * least_deviation * up, exponent * least_deviation * down];
        let by_up = chebyshev(moments[0], moments[1], up, deviation[0] * deviation[0]);
        let by_down = chebyshev(moments[2], moments[3], down, deviation[1] * deviation[1]);
        smaller(by_up, by_down)
    } else {
        chebyshev(moments[0], moments[1], z, least_deviation * least_deviation)
    }
}
