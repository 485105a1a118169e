//! What a run did.

use std::time::Duration;

use umbra4_core::Counts;

/// What a run did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// From the first upload to the last result, as the host saw it. Kernels that had to be compiled are not in it.
    pub time: Duration,
    /// Pairs and fallbacks; `None` where they were not asked for ([`crate::WgpuExecutor::with_counts`]).
    pub counts: Option<Counts>,
    /// Seconds of every stage that ran, by its name, as the device's timestamps have it; empty where they were not asked for
    /// ([`crate::WgpuExecutor::with_stage_times`]), or where there are none.
    pub stages: Vec<(&'static str, f64)>,
}
