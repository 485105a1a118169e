//! Time on the device: two timestamps a submission.

use umbra4_wgpu::{
    Gpu, GpuError, guarded,
    wgpu::{
        Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePassTimestampWrites, Features,
        QUERY_RESOLVE_BUFFER_ALIGNMENT, QuerySet, QuerySetDescriptor, QueryType,
    },
};

use super::device::read;

/// Timestamps of a number of submissions of one pass each.
pub struct Clock {
    /// Of the submission under way.
    set: QuerySet,
    /// Of all of them, as far apart as the device wants.
    ticks: Buffer,
}

impl Clock {
    /// `None` where the device has no timestamps.
    pub fn new(gpu: &Gpu, submissions: u32) -> Result<Option<Self>, GpuError> {
        let device = &gpu.device;
        if !device.features().contains(Features::TIMESTAMP_QUERY) {
            return Ok(None);
        }
        let label = Some("rival's timestamps");
        guarded(device, "allocate timestamps", || {
            let set = device.create_query_set(&QuerySetDescriptor { label, ty: QueryType::Timestamp, count: 2 });
            let ticks = device.create_buffer(&BufferDescriptor {
                label,
                size: u64::from(submissions.max(1)) * QUERY_RESOLVE_BUFFER_ALIGNMENT,
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            Some(Self { set, ticks })
        })
    }

    /// For the pass of a submission.
    pub fn writes(&self) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Keeps what the pass of a submission wrote.
    pub fn keep(&self, encoder: &mut CommandEncoder, submission: u32) {
        let at = u64::from(submission) * QUERY_RESOLVE_BUFFER_ALIGNMENT;
        encoder.resolve_query_set(&self.set, 0..2, &self.ticks, at);
    }

    /// Seconds of all passes together.
    pub fn seconds(&self, gpu: &Gpu) -> Result<f64, GpuError> {
        let ticks: Vec<u64> = read(gpu, &self.ticks)?;
        let submissions = ticks.chunks_exact(QUERY_RESOLVE_BUFFER_ALIGNMENT as usize / size_of::<u64>());
        let sum: u64 = submissions.map(|pass| pass[1].saturating_sub(pass[0])).sum();
        Ok(sum as f64 * f64::from(gpu.queue.get_timestamp_period()) * 1e-9)
    }
}
