//! Buffers of a run, kept for the next: they grow when more is asked for, and never shrink.

use std::collections::HashMap;

use wgpu::{Buffer, BufferDescriptor, BufferUsages, Device};

use crate::{GpuError, error::guarded};

/// Storage buffers, by what they hold.
#[derive(Debug, Default)]
pub(crate) struct Scratch(HashMap<&'static str, Buffer>);

impl Scratch {
    /// A storage buffer for `count` elements at least; an empty one still has one, since nothing empty can be bound.
    pub(crate) fn fit<T>(&mut self, device: &Device, what: &'static str, count: u64) -> Result<Buffer, GpuError> {
        let bytes = (count.max(1) * size_of::<T>() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
        let known = self.0.get(what);
        if let Some(buffer) = known.filter(|buffer| buffer.size() >= bytes) {
            return Ok(buffer.clone());
        }
        let limits = device.limits();
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if bytes > limit {
            return Err(GpuError::TooLarge { what, bytes, limit });
        }
        // One that has grown once may grow again: half as much more.
        let size = known.map_or(bytes, |buffer| bytes.max(buffer.size() / 8 * 12).min(limit));
        let size = size / wgpu::COPY_BUFFER_ALIGNMENT * wgpu::COPY_BUFFER_ALIGNMENT;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let allocate = |size| {
            guarded(device, "allocates a buffer", || {
                device.create_buffer(&BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false })
            })
        };
        // Near the end of the memory, what is asked for and no more.
        let buffer = allocate(size).or_else(|_| allocate(bytes))?;
        self.0.insert(what, buffer.clone());
        Ok(buffer)
    }
}
