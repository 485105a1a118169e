//! Results back on the host. For scripts and tests: an engine keeps them on the device.

use std::sync::mpsc;

use wgpu::{Buffer, BufferDescriptor, BufferUsages, CommandEncoder, Device, MapMode, PollType};

use crate::GpuError;

/// A copy of `bytes` bytes of `source` from byte `from` on, to be read once `encoder` is submitted.
pub(crate) fn copy(device: &Device, encoder: &mut CommandEncoder, source: &Buffer, from: u64, bytes: u64) -> Buffer {
    let staging = device.create_buffer(&BufferDescriptor {
        label: Some("umbra4 readback"),
        size: bytes,
        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    encoder.copy_buffer_to_buffer(source, from, &staging, 0, bytes);
    staging
}

/// Waits for a copy and hands its elements over.
pub(crate) fn read<T: bytemuck::Pod>(device: &Device, staging: &Buffer) -> Result<Vec<T>, GpuError> {
    let lost = |reason: String| GpuError::Lost { doing: "computed masks", reason };
    let (sender, receiver) = mpsc::channel();
    staging.map_async(MapMode::Read, .., move |result| {
        // The receiver outlives the call of this closure, or nobody waits any more.
        let _ = sender.send(result);
    });
    device.poll(PollType::wait_indefinitely()).map_err(|error| lost(error.to_string()))?;
    receiver
        .recv()
        .map_err(|error| lost(error.to_string()))
        .and_then(|result| result.map_err(|error| lost(error.to_string())))?;
    let view = staging.get_mapped_range(..).map_err(|error| lost(error.to_string()))?;
    let elements = bytemuck::pod_collect_to_vec(&view[..]);
    drop(view);
    staging.unmap();
    Ok(elements)
}
