//! Dispatches, collected first: their parameters go into one buffer, then they are encoded into one pass.

use std::sync::Arc;

use umbra4_core::{
    kernel::{Kernel, WORKGROUP},
    params::{Params, PassParams},
};
use wgpu::{
    BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferBinding, BufferSize, BufferUsages,
    CommandEncoder, ComputePassDescriptor, Device, Queue,
    util::{BufferInitDescriptor, DeviceExt},
};

use crate::{
    GpuError,
    pipelines::{Pipeline, Pipelines},
};

/// Distance of parameters in their buffer: what every device accepts as a dynamic offset.
const PARAMS_STRIDE: usize = 256;

const _: () = assert!(size_of::<Params>() <= PARAMS_STRIDE);

struct Dispatch {
    pipeline: Arc<Pipeline>,
    buffers: Vec<Buffer>,
    params: Params,
    groups: [u32; 2],
    name: &'static str,
}

/// Collects dispatches that share a light.
pub(crate) struct Recorder<'a> {
    device: &'a Device,
    queue: &'a Queue,
    pipelines: &'a mut Pipelines,
    params: Params,
    dispatches: Vec<Dispatch>,
}

impl<'a> Recorder<'a> {
    pub(crate) fn new(device: &'a Device, queue: &'a Queue, pipelines: &'a mut Pipelines, params: Params) -> Self {
        Self { device, queue, pipelines, params, dispatches: Vec::new() }
    }

    pub(crate) fn device(&self) -> &'a Device {
        self.device
    }

    pub(crate) fn queue(&self) -> &'a Queue {
        self.queue
    }

    /// A kernel for the ids `0..pass.count`, over buffers in the order of the table of kernels.
    pub(crate) fn add(&mut self, kernel: Kernel, mut pass: PassParams, buffers: &[&Buffer]) -> Result<(), GpuError> {
        if pass.count == 0 {
            return Ok(());
        }
        let most = self.device.limits().max_compute_workgroups_per_dimension;
        let groups = pass.count.div_ceil(WORKGROUP);
        let columns = groups.min(most);
        pass.row = columns * WORKGROUP;
        self.dispatches.push(Dispatch {
            pipeline: self.pipelines.get(self.device, kernel)?,
            buffers: buffers.iter().map(|&buffer| buffer.clone()).collect(),
            params: self.params.with_pass(&pass),
            groups: [columns, groups.div_ceil(columns)],
            name: kernel.info().name,
        });
        Ok(())
    }

    /// Encodes all dispatches, and forgets them.
    pub(crate) fn encode(&mut self, encoder: &mut CommandEncoder) {
        if self.dispatches.is_empty() {
            return;
        }
        let mut bytes = vec![0_u8; self.dispatches.len() * PARAMS_STRIDE];
        for (slot, dispatch) in bytes.chunks_exact_mut(PARAMS_STRIDE).zip(&self.dispatches) {
            slot[..size_of::<Params>()].copy_from_slice(bytemuck::bytes_of(&dispatch.params));
        }
        let slots = self.device.create_buffer_init(&BufferInitDescriptor {
            label: Some("umbra4 parameters"),
            contents: &bytes,
            usage: BufferUsages::STORAGE,
        });
        let params = BufferBinding { buffer: &slots, offset: 0, size: BufferSize::new(size_of::<Params>() as u64) };
        let mut pass =
            encoder.begin_compute_pass(&ComputePassDescriptor { label: Some("umbra4"), timestamp_writes: None });
        for (place, dispatch) in self.dispatches.drain(..).enumerate() {
            let buffers = dispatch.buffers.iter().map(Buffer::as_entire_binding);
            let entries: Vec<BindGroupEntry<'_>> = [BindingResource::Buffer(params.clone())]
                .into_iter()
                .chain(buffers)
                .enumerate()
                .map(|(binding, resource)| BindGroupEntry { binding: binding as u32, resource })
                .collect();
            let group = self.device.create_bind_group(&BindGroupDescriptor {
                label: Some(dispatch.name),
                layout: &dispatch.pipeline.layout,
                entries: &entries,
            });
            pass.set_pipeline(&dispatch.pipeline.pipeline);
            pass.set_bind_group(0, &group, &[(place * PARAMS_STRIDE) as u32]);
            pass.dispatch_workgroups(dispatch.groups[0], dispatch.groups[1], 1);
        }
    }
}
