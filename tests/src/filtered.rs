//! Are two lists of filtered visibility the same, but for what floats decide? Unlike masks, they are sums of floats, and devices round differently.

use thiserror::Error;

/// One step of a picture of 8 bits. The exponential of a GPU is off by up to `3 + 2|x|` units in the last place, 43 at the default exponent, so that
/// moments of depth are off by up to 1e-5 of themselves. Variance, of which a least is kept
/// ([`umbra4_maps::stochastic::StochasticOptions::least_deviation`]: a hundredth of the squared mean), is off by less than 1/400 then, and
/// visibility by a quarter of that at most. Plain variance has no exponential, but quotients that are 2.5 units off: of it this is measured, not proven.
pub const TOLERANCE: f32 = 1.0 / 256.0;

/// Receivers that may differ by more than [`TOLERANCE`], of all, on a GPU. A ray that grazes an edge may hit one triangle here and another there, a sample
/// that crosses a plane on the border of two texels may land in the other, and so move the receivers whose footprints hold it. That is
/// rare: places are off by a few millionths of the map. An allowance, not a measurement: on hardware this has not run yet.
pub const SHARE: f64 = 1.0 / 500.0;

/// The same on a software driver: sums, products and quotients are the processor's to the bit, and only the exponential differs, which decides nothing.
pub const SOFTWARE_SHARE: f64 = 0.0;

/// What was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Receivers compared.
    pub receivers: usize,
    /// Those that differ at all.
    pub differing: usize,
    /// Those that differ by more than [`TOLERANCE`].
    pub beyond: usize,
    /// The largest difference.
    pub largest: f32,
}

impl Agreement {
    /// Both together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            receivers: self.receivers + other.receivers,
            differing: self.differing + other.differing,
            beyond: self.beyond + other.beyond,
            largest: self.largest.max(other.largest),
        }
    }
}

/// How two results differ.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Disagreement {
    /// The results have different lengths.
    #[error("{expected} receivers expected, got {got}")]
    Length {
        /// Receivers expected.
        expected: usize,
        /// Receivers got.
        got: usize,
    },
    /// There is nothing to compare.
    #[error("nothing to compare")]
    Empty,
    /// Not a fraction: NaN, or outside `0.0..=1.0`.
    #[error("receiver {receiver} sees {value} of the light")]
    NoFraction {
        /// Which.
        receiver: usize,
        /// What it sees.
        value: f32,
    },
    /// Too many receivers differ by more than the tolerance.
    #[error("{} of {} receivers differ by more than {TOLERANCE}, by up to {}", .0.beyond, .0.receivers, .0.largest)]
    Beyond(Agreement),
}

/// Compares what receivers see.
///
/// # Errors
/// Lengths that differ; nothing to compare; something that is no fraction; more than a `share` beyond [`TOLERANCE`].
pub fn agree(expected: &[f32], got: &[f32], share: f64) -> Result<Agreement, Disagreement> {
    if expected.len() != got.len() {
        return Err(Disagreement::Length { expected: expected.len(), got: got.len() });
    }
    if expected.is_empty() {
        return Err(Disagreement::Empty);
    }
    let mut agreement = Agreement { receivers: expected.len(), ..Agreement::default() };
    for (receiver, (a, b)) in expected.iter().zip(got).enumerate() {
        for value in [*a, *b] {
            if !(0.0..=1.0).contains(&value) {
                return Err(Disagreement::NoFraction { receiver, value });
            }
        }
        let difference = (a - b).abs();
        agreement.differing += usize::from(difference > 0.0);
        agreement.beyond += usize::from(difference > TOLERANCE);
        agreement.largest = agreement.largest.max(difference);
    }
    if agreement.beyond as f64 > share * agreement.receivers as f64 {
        return Err(Disagreement::Beyond(agreement));
    }
    Ok(agreement)
}
