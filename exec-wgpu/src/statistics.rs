//! What a run did.

use std::time::Duration;

use umbra4_core::Counts;

/// What a run did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// From the first upload to the last result, as the host saw it. Kernels that had to be compiled are not in it.
    pub time: Duration,
    /// Pairs and fallbacks; `None` where they were not asked for ([`crate::WgpuExecutor::with_counts`]).
    pub counts: Option<Counts>,
}
