//! What a run did.

use umbra4_core::Counts;

/// What a run did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Pairs and fallbacks. All zero where they were not asked for.
    pub counts: Counts,
}
