//! Time on the device, stage by stage: a compute pass for each, between two timestamps.

use umbra4_core::stage::TABLE;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePassTimestampWrites, Device, Features,
    QUERY_SET_MAX_QUERIES, QuerySet, QuerySetDescriptor, QueryType,
};

use crate::{GpuError, error::guarded};

/// Timestamps of one run.
#[derive(Debug)]
pub(crate) struct Timing {
    set: QuerySet,
    ticks: Buffer,
    stages: Vec<&'static str>,
}

impl Timing {
    /// `None` where the device has no timestamps.
    pub(crate) fn new(device: &Device) -> Result<Option<Self>, GpuError> {
        if !device.features().contains(Features::TIMESTAMP_QUERY) {
            return Ok(None);
        }
        let label = Some("umbra4 timestamps");
        guarded(device, "allocates timestamps", || {
            let set = device.create_query_set(&QuerySetDescriptor {
                label,
                ty: QueryType::Timestamp,
                count: QUERY_SET_MAX_QUERIES,
            });
            let ticks = device.create_buffer(&BufferDescriptor {
                label,
                size: u64::from(QUERY_SET_MAX_QUERIES) * size_of::<u64>() as u64,
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            Some(Self { set, ticks, stages: Vec::new() })
        })
    }

    /// Starts a run.
    pub(crate) fn begin(&mut self) {
        self.stages.clear();
    }

    /// The timestamps of the next pass; `None` once the set is full.
    pub(crate) fn writes(&mut self, stage: &'static str) -> Option<ComputePassTimestampWrites<'_>> {
        let first = 2 * self.stages.len() as u32;
        if first + 2 > QUERY_SET_MAX_QUERIES {
            return None;
        }
        self.stages.push(stage);
        Some(ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// Ends a run: its ticks go to [`Timing::ticks`].
    pub(crate) fn end(&self, encoder: &mut CommandEncoder) {
        let queries = 2 * self.stages.len() as u32;
        if queries > 0 {
            encoder.resolve_query_set(&self.set, 0..queries, &self.ticks, 0);
        }
    }

    /// Two u64 a pass: when it began, and when it ended.
    pub(crate) fn ticks(&self) -> &Buffer {
        &self.ticks
    }

    /// The stages of the run's passes, in order.
    pub(crate) fn stages(&self) -> &[&'static str] {
        &self.stages
    }
}

/// Seconds that each stage took, by name, in the order of the table of stages, after those that are none of the table's; those that did not run
/// are missing. `period`: see [`wgpu::Queue::get_timestamp_period`].
pub(crate) fn seconds(stages: &[&'static str], ticks: &[u64], period: f32) -> Vec<(&'static str, f64)> {
    let mut sums: Vec<(&'static str, f64)> = Vec::new();
    for (stage, pass) in stages.iter().zip(ticks.chunks_exact(2)) {
        let time = pass[1].saturating_sub(pass[0]) as f64 * f64::from(period) * 1.0e-9;
        add(&mut sums, stage, time);
    }
    sums.sort_by_key(|(stage, _)| TABLE.iter().position(|info| info.name == *stage));
    sums
}

/// Adds the seconds of a stage to those that it has taken already.
pub(crate) fn add(sums: &mut Vec<(&'static str, f64)>, stage: &'static str, seconds: f64) {
    match sums.iter_mut().find(|(known, _)| *known == stage) {
        Some((_, sum)) => *sum += seconds,
        None => sums.push((stage, seconds)),
    }
}
