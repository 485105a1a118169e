//! What a run did, in counts.

/// A count. A GPU thread counts what one receiver does, without 64-bit integers.
#[cfg(not(target_arch = "spirv"))]
pub type Tally = u64;
/// A count. A GPU thread counts what one receiver does, without 64-bit integers.
#[cfg(target_arch = "spirv")]
pub type Tally = u32;

/// Counts of one run. A pair is a receiver and a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Pairs on which the full-coverage test was asked.
    pub pairs_tested: Tally,
    /// Pairs that passed it: their planes were set up.
    pub pairs_kept: Tally,
    /// Pairs of which at least one light sample is blocked. (Where the sample is doubtful, and another triangle blocks it
    /// already, the pair is not looked at again and not counted.)
    pub pairs_relevant: Tally,
    /// Pairs of a receiver and an edge of the silhouette on which the full-coverage test was asked.
    pub edges_tested: Tally,
    /// Those that passed it.
    pub edges_kept: Tally,
    /// Receivers of which the silhouette left too much in doubt, and that went by all triangles.
    pub receivers_lost: Tally,
    /// Signs that f32 could not certify and that were redone in integers.
    pub fallbacks: Tally,
}

impl Counts {
    /// The sums of both.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            pairs_tested: self.pairs_tested + other.pairs_tested,
            pairs_kept: self.pairs_kept + other.pairs_kept,
            pairs_relevant: self.pairs_relevant + other.pairs_relevant,
            edges_tested: self.edges_tested + other.edges_tested,
            edges_kept: self.edges_kept + other.edges_kept,
            receivers_lost: self.receivers_lost + other.receivers_lost,
            fallbacks: self.fallbacks + other.fallbacks,
        }
    }
}
