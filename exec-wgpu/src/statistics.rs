//! What a run did.

use std::time::Duration;

use umbra4_core::{Counts, stage::Stage};

/// What a run did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// From the first upload to the last result, as the host saw it. Kernels that had to be compiled are not in it.
    pub time: Duration,
    /// Pairs and fallbacks; `None` where they were not asked for ([`crate::WgpuExecutor::with_counts`]).
    pub counts: Option<Counts>,
    /// Seconds of every stage that ran, as the device's timestamps have it; empty where they were not asked for
    /// ([`crate::WgpuExecutor::with_stage_times`]), or where there are none.
    pub stages: Vec<(Stage, f64)>,
}
