//! Buffers of the rival, and results back on the host.

use std::sync::mpsc;

use umbra4_wgpu::{
    Gpu, GpuError,
    wgpu::{
        Buffer, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, Device, ErrorFilter, MapMode, PollType,
        util::{BufferInitDescriptor, DeviceExt},
    },
};

/// What the device was doing when it was lost.
const DOING: &str = "traced rays";

/// Catches what wgpu would else panic with.
pub fn guarded<T>(device: &Device, doing: &'static str, work: impl FnOnce() -> T) -> Result<T, GpuError> {
    let memory = device.push_error_scope(ErrorFilter::OutOfMemory);
    let validation = device.push_error_scope(ErrorFilter::Validation);
    let done = work();
    let refused = pollster::block_on(validation.pop());
    let exhausted = pollster::block_on(memory.pop());
    match (exhausted, refused) {
        (Some(_), _) => Err(GpuError::OutOfMemory { doing }),
        (_, Some(error)) => Err(GpuError::Refused { doing, reason: error.to_string() }),
        _ => Ok(done),
    }
}

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
    let Gpu { device, queue, .. } = gpu;
    let lost = |reason: String| GpuError::Lost { doing: DOING, reason };
    let staging = guarded(device, "read results", || {
        let staging = device.create_buffer(&BufferDescriptor {
            label: Some("rival's readback"),
            size: source.size(),
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
        queue.submit([encoder.finish()]);
        staging
    })?;
    let (sender, receiver) = mpsc::channel();
    staging.map_async(MapMode::Read, .., move |result| {
        // The receiver lives until the result is there.
        let _ = sender.send(result);
    });
    wait(device)?;
    let mapped = receiver.recv().map_err(|error| lost(error.to_string()))?;
    mapped.map_err(|error| lost(error.to_string()))?;
    let view = staging.get_mapped_range(..).map_err(|error| lost(error.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&view[..]))
}
