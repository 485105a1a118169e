//! Lights that fill a volume: a set of points, its samples, that shine to all sides. A mask has a bit for each.
//!
//! Seed: Sintorn, Eisemann and Assarsson 2008, section 4, whose light samples may lie anywhere. Departure: a bit is decided by
//! the planes themselves, exactly; their lookup table is [`crate::cloud_table`].
//!
//! **The rule** is that of [`crate::exact`], sample by sample: a triangle blocks a sample from a receiver iff the two lie strictly on
//! opposite sides of its plane, and the three edge determinants, oriented by the receiver's side, are ≥ 0. So a sample in the
//! receiver itself is never blocked, nor one in the plane of the triangle.

use glam::IVec3;
use thiserror::Error;

use crate::{
    punctual::{self, Punctual},
    snap::LIMIT,
};

/// Most samples of a cloud.
pub const MAX_CLOUD: usize = 1024;

/// Bits of a mask's word.
pub const WORD_BITS: usize = 32;

/// Words of the longest mask.
pub const MAX_CLOUD_WORDS: usize = MAX_CLOUD / WORD_BITS;

/// The mask of one receiver: bit k of word w is sample `32·w + k`, 1 where it is blocked; bits beyond the last sample are 0.
pub type CloudMask = [u32; MAX_CLOUD_WORDS];

/// Why a set of samples is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CloudError {
    /// There are none, or too many.
    #[error("{count} samples, outside 1..={MAX_CLOUD}")]
    Count {
        /// How many were given.
        count: usize,
    },
    /// A sample lies outside the lattice, whose coordinates lie strictly between −2^29 and 2^29.
    #[error("sample {index} is at {sample}, outside the lattice (±2^29)")]
    OutsideLattice {
        /// Index of the sample.
        index: usize,
        /// Where it is.
        sample: IVec3,
    },
}

/// The samples of a light on the lattice, in a buffer of the caller's. Some may lie in the same place.
///
/// ```
/// use umbra4_core::{cloud::Cloud, glam::IVec3};
/// let cloud = Cloud::new([IVec3::ZERO, IVec3::new(4, 0, 2)])?;
/// assert_eq!((cloud.samples().len(), cloud.words()), (2, 1));
/// assert_eq!(cloud.bounds(), [IVec3::ZERO, IVec3::new(4, 0, 2)]);
/// # Ok::<(), umbra4_core::cloud::CloudError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cloud<S> {
    samples: S,
    low: IVec3,
    high: IVec3,
}

impl<S: AsRef<[IVec3]>> Cloud<S> {
    /// Of lattice points, as they are.
    ///
    /// # Errors
    /// No samples, or more than [`MAX_CLOUD`]; the first that lies outside the lattice.
    pub fn new(samples: S) -> Result<Self, CloudError> {
        let points = samples.as_ref();
        if points.is_empty() || points.len() > MAX_CLOUD {
            return Err(CloudError::Count { count: points.len() });
        }
        let (mut low, mut high) = (IVec3::MAX, IVec3::MIN);
        for (index, &sample) in points.iter().enumerate() {
            if sample.max_element() >= LIMIT || sample.min_element() <= -LIMIT {
                return Err(CloudError::OutsideLattice { index, sample });
            }
            (low, high) = (low.min(sample), high.max(sample));
        }
        Ok(Self { samples, low, high })
    }

    /// The samples, in the order of a mask's bits.
    pub fn samples(&self) -> &[IVec3] {
        self.samples.as_ref()
    }

    /// Words of a mask.
    pub fn words(&self) -> usize {
        self.samples().len().div_ceil(WORD_BITS)
    }

    /// Smallest and largest coordinates of the samples, lattice.
    pub fn bounds(&self) -> [IVec3; 2] {
        [self.low, self.high]
    }
}

/// Whether the triangle blocks the sample from p: the rule as it stands above.
pub fn blocks(sample: IVec3, p: IVec3, triangle: [IVec3; 3]) -> bool {
    punctual::blocks(Punctual::at_sample(sample), p, triangle)
}
