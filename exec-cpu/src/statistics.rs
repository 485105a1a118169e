//! What a run did, and where its time went.

use std::time::Duration;

use umbra4_core::{
    Counts,
    stage::{Stage, TABLE},
};

/// What a run did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Pairs and fallbacks.
    pub counts: Counts,
    /// Entries of receivers in the cells of the grid; over the number of receivers, the sample redundancy of Wang et al.
    /// 2016, table 2. 0 where the hierarchy is the index.
    pub receiver_entries: u64,
    /// Entries of triangles in the cells of the grid, of all blocks of receivers.
    pub triangle_entries: u64,
    /// Seconds spent in each stage that ran, in the order of the data flow.
    pub seconds_by_stage: Vec<(&'static str, f64)>,
}

impl Statistics {
    /// Seconds of all stages together.
    pub fn seconds(&self) -> f64 {
        self.seconds_by_stage.iter().map(|(_, seconds)| seconds).sum()
    }

    /// Adds what another run did.
    pub(crate) fn include(&mut self, other: &Self) {
        self.counts = self.counts.plus(other.counts);
        self.receiver_entries += other.receiver_entries;
        self.triangle_entries += other.triangle_entries;
        other.seconds_by_stage.iter().for_each(|(name, seconds)| self.add_seconds(name, *seconds));
        self.sort();
    }

    /// Stages in the order of the data flow, where some of it came later.
    pub(crate) fn sort(&mut self) {
        let place = |name: &str| TABLE.iter().position(|info| info.name == name);
        self.seconds_by_stage.sort_by_key(|(name, _)| place(name));
    }

    /// Adds the time of one pass to its stage.
    pub(crate) fn add(&mut self, stage: Stage, time: Duration) {
        self.add_seconds(stage.info().name, time.as_secs_f64());
    }

    /// Adds seconds to a stage, which may be none of the table's.
    pub(crate) fn add_seconds(&mut self, name: &'static str, more: f64) {
        match self.seconds_by_stage.iter_mut().find(|(n, _)| *n == name) {
            Some((_, seconds)) => *seconds += more,
            None => self.seconds_by_stage.push((name, more)),
        }
    }
}
