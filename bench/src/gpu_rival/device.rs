//! Buffers of the rival, and results back on the host.

use umbra4_wgpu::{
    Gpu, GpuError, guarded,
    wgpu::{
        Buffer, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, Device, PollType,
        util::{BufferInitDescriptor, DeviceExt},
    },
};

/// What the device was doing when it was lost.
const DOING: &str = "traced rays";

fn bindable(device: &Device, what: &'static str, bytes: u64) -> Result<(), GpuError> {
    let limits = device.limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    if bytes > limit { Err(GpuError::TooLarge { what, bytes, limit }) } else { Ok(()) }
}

/// A buffer that kernels read, with contents; an empty one has an element, since nothing empty can be bound.
pub fn filled<T: bytemuck::Pod>(device: &Device, what: &'static str, elements: &[T]) -> Result<Buffer, GpuError> {
    let nothing = [T::zeroed()];
    let contents = bytemuck::cast_slice(if elements.is_empty() { &nothing } else { elements });
    bindable(device, what, contents.len() as u64)?;
    let descriptor = BufferInitDescriptor { label: Some(what), contents, usage: BufferUsages::STORAGE };
    guarded(device, "allocate a buffer", || device.create_buffer_init(&descriptor))
}

/// A buffer of zeros that kernels write.
pub fn zeros(gpu: &Gpu, what: &'static str, bytes: u64) -> Result<Buffer, GpuError> {
    bindable(&gpu.device, what, bytes)?;
    guarded(&gpu.device, "allocate a buffer", || {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let descriptor = BufferDescriptor { label: Some(what), size: bytes, usage, mapped_at_creation: false };
        let buffer = gpu.device.create_buffer(&descriptor);
        let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        encoder.clear_buffer(&buffer, 0, None);
        gpu.queue.submit([encoder.finish()]);
        buffer
    })
}

/// Waits until the device has done all that it was given.
pub fn wait(device: &Device) -> Result<(), GpuError> {
    match device.poll(PollType::wait_indefinitely()) {
        Ok(_) => Ok(()),
        Err(error) => Err(GpuError::Lost { doing: DOING, reason: error.to_string() }),
    }
}

/// The contents of a buffer.
pub fn read<T: bytemuck::Pod>(gpu: &Gpu, source: &Buffer) -> Result<Vec<T>, GpuError> {
    gpu.read(source, source.size())
}
