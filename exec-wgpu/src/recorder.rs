//! Steps of a run, collected first: parameters of all dispatches go into one buffer, then everything is encoded.
//!
//! What a run needed is kept: where the next one asks for the same kernels over the same resources, as frame after frame
//! does, nothing is allocated and no bind group is made.

use std::{num::NonZero, sync::Arc};

use umbra4_core::{
    kernel::{Kernel, WORKGROUP},
    params::Dispatched,
    stage::Stage,
};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferBinding, BufferDescriptor,
    BufferSize, BufferUsages, CommandEncoder, ComputePass, ComputePassDescriptor, Device, Extent3d, Origin3d,
    TexelCopyBufferInfo, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture, TextureAspect, TextureView,
    util::StagingBelt,
};

use crate::{
    GpuError,
    pipelines::{Loading, Pipeline, Pipelines},
    timing::Timing,
};

/// Distance of parameters in their buffer: what every device accepts as a dynamic offset.
const SLOT: usize = 256;
/// Bytes of a chunk of the staging belt: the parameters of most frames.
const CHUNK: u64 = 1 << 16;

/// What a kernel is bound to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Resource {
    /// A whole buffer.
    Buffer(Buffer),
    /// A part of it: first byte and length.
    Part(Buffer, u64, NonZero<u64>),
    Texture(TextureView),
}

impl From<&Buffer> for Resource {
    fn from(buffer: &Buffer) -> Self {
        Self::Buffer(buffer.clone())
    }
}

impl Resource {
    fn binding(&self) -> BindingResource<'_> {
        match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::Part(buffer, offset, size) => {
                BindingResource::Buffer(BufferBinding { buffer, offset: *offset, size: Some(*size) })
            }
            Self::Texture(view) => BindingResource::TextureView(view),
        }
    }
}

/// A kernel over resources; its parameters may be others every time.
#[derive(Debug)]
struct Dispatch {
    kernel: Kernel,
    bound: Vec<Resource>,
    stage: Stage,
    pipeline: Arc<Pipeline>,
    groups: [u32; 2],
    params: [u8; SLOT],
    group: Option<BindGroup>,
}

#[derive(Debug)]
enum Step {
    Dispatch(Box<Dispatch>),
    Clear { buffer: Buffer, from: u64 },
    Copy { from: (Buffer, u64), to: (Buffer, u64), bytes: u64 },
    Image { from: Buffer, pitch: u32, to: Texture, layer: u32 },
}

/// Collects the steps of a run.
#[derive(Debug)]
pub(crate) struct Recorder {
    device: Device,
    pipelines: Pipelines,
    stage: Stage,
    steps: Vec<Step>,
    used: usize,
    slots: Option<Buffer>,
    belt: StagingBelt,
    timing: Option<Timing>,
}

impl Recorder {
    pub(crate) fn new(device: &Device, loading: Loading, timing: Option<Timing>) -> Self {
        Self {
            device: device.clone(),
            pipelines: Pipelines::new(loading),
            stage: Stage::SnapVertices,
            steps: Vec::new(),
            used: 0,
            slots: None,
            belt: StagingBelt::new(device.clone(), CHUNK),
            timing,
        }
    }

    pub(crate) fn pipelines(&self) -> &Pipelines {
        &self.pipelines
    }

    pub(crate) fn timing(&self) -> Option<&Timing> {
        self.timing.as_ref()
    }

    pub(crate) fn set_timing(&mut self, timing: Option<Timing>) {
        self.timing = timing;
    }

    /// The stage that what follows belongs to.
    pub(crate) fn set_stage(&mut self, stage: Stage) {
        self.stage = stage;
    }

    /// Forgets the steps of a run that was not encoded; what it needed is kept.
    pub(crate) fn restart(&mut self) {
        self.used = 0;
    }

    /// A kernel for the ids `0..params.count()`, over resources in the order of the table of kernels.
    pub(crate) fn add<P: Dispatched + bytemuck::Pod>(
        &mut self,
        kernel: Kernel,
        params: P,
        bound: &[Resource],
    ) -> Result<(), GpuError> {
        const { assert!(size_of::<P>() <= SLOT) }
        let count = params.count();
        if count == 0 {
            return Ok(());
        }
        let most = self.device.limits().max_compute_workgroups_per_dimension;
        let columns = count.div_ceil(WORKGROUP).min(most);
        let rows = count.div_ceil(columns * WORKGROUP);
        let mut bytes = [0; SLOT];
        bytes[..size_of::<P>()].copy_from_slice(bytemuck::bytes_of(&params.with_row(columns * WORKGROUP)));
        let (stage, groups) = (self.stage, [columns, rows]);
        if let Some(Step::Dispatch(known)) = self.steps.get_mut(self.used)
            && known.kernel == kernel
            && known.bound == bound
        {
            (known.stage, known.groups, known.params) = (stage, groups, bytes);
            self.used += 1;
            return Ok(());
        }
        let pipeline = self.pipelines.get(&self.device, kernel)?;
        let bound = bound.to_vec();
        let dispatch = Dispatch { kernel, bound, stage, pipeline, groups, params: bytes, group: None };
        self.put(Step::Dispatch(Box::new(dispatch)));
        Ok(())
    }

    /// Zeros in a buffer, from byte `from` on.
    pub(crate) fn clear(&mut self, buffer: &Buffer, from: u64) {
        self.put(Step::Clear { buffer: buffer.clone(), from });
    }

    /// Bytes of a buffer, from a byte on, go to another.
    pub(crate) fn copy(&mut self, from: (&Buffer, u64), to: (&Buffer, u64), bytes: u64) {
        self.put(Step::Copy { from: (from.0.clone(), from.1), to: (to.0.clone(), to.1), bytes });
    }

    /// Rows of `pitch` bytes go to a layer of a texture.
    pub(crate) fn copy_image(&mut self, from: &Buffer, pitch: u32, to: &Texture, layer: u32) {
        self.put(Step::Image { from: from.clone(), pitch, to: to.clone(), layer });
    }

    fn put(&mut self, step: Step) {
        match self.steps.get_mut(self.used) {
            Some(place) => *place = step,
            None => self.steps.push(step),
        }
        self.used += 1;
    }

    /// Encodes all steps. They must be submitted in the order in which they were encoded.
    pub(crate) fn encode(&mut self, encoder: &mut CommandEncoder) -> Result<(), GpuError> {
        // What the last run had beyond this one is let go, with the resources that it holds.
        self.steps.truncate(self.used);
        self.used = 0;
        let dispatches = self.steps.iter().filter(|step| matches!(step, Step::Dispatch(_))).count();
        self.write_params(encoder, dispatches * SLOT)?;
        if let Some(timing) = &mut self.timing {
            timing.begin();
        }
        let mut steps = self.steps.iter_mut().peekable();
        let mut place = 0;
        while let Some(step) = steps.next() {
            match step {
                Step::Clear { buffer, from } => encoder.clear_buffer(buffer, *from, None),
                Step::Copy { from, to, bytes } => {
                    encoder.copy_buffer_to_buffer(&from.0, from.1, &to.0, to.1, *bytes);
                }
                Step::Image { from, pitch, to, layer } => copy_image(encoder, from, *pitch, to, *layer),
                Step::Dispatch(first) => {
                    let Some(slots) = &self.slots else { continue };
                    let stage = first.stage;
                    let timestamp_writes = self.timing.as_mut().and_then(|timing| timing.writes(stage));
                    let timed = timestamp_writes.is_some();
                    let label = if timed { stage.info().name } else { "umbra4" };
                    let mut pass =
                        encoder.begin_compute_pass(&ComputePassDescriptor { label: Some(label), timestamp_writes });
                    dispatch(&mut pass, &self.device, slots, first, &mut place);
                    while let Some(Step::Dispatch(next)) = steps.next_if(|step| match step {
                        Step::Dispatch(next) => !timed || next.stage == stage,
                        _ => false,
                    }) {
                        dispatch(&mut pass, &self.device, slots, next, &mut place);
                    }
                }
            }
        }
        if let Some(timing) = &self.timing {
            timing.end(encoder);
        }
        Ok(())
    }

    /// Brings the parameters of all dispatches to the device, in the order of the encoder.
    fn write_params(&mut self, encoder: &mut CommandEncoder, bytes: usize) -> Result<(), GpuError> {
        let Some(size) = BufferSize::new(bytes as u64) else { return Ok(()) };
        let large_enough = self.slots.as_ref().is_some_and(|slots| slots.size() >= size.get());
        if !large_enough {
            self.slots = Some(self.device.create_buffer(&BufferDescriptor {
                label: Some("umbra4 parameters"),
                size: size.get().next_power_of_two(),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
            for step in &mut self.steps {
                if let Step::Dispatch(dispatch) = step {
                    dispatch.group = None;
                }
            }
        }
        let Some(slots) = &self.slots else { return Ok(()) };
        let part = self.belt.allocate(size, const { NonZero::new(wgpu::COPY_BUFFER_ALIGNMENT).unwrap() });
        encoder.copy_buffer_to_buffer(part.buffer(), part.offset(), slots, 0, size.get());
        let lost = |reason: String| GpuError::Lost { doing: "maps a staging buffer", reason };
        let mut view = part.get_mapped_range_mut().map_err(|error| lost(error.to_string()))?;
        let mut place = 0;
        for step in &self.steps {
            if let Step::Dispatch(dispatch) = step {
                view.slice(place..place + SLOT).copy_from_slice(&dispatch.params);
                place += SLOT;
            }
        }
        drop(view);
        self.belt.finish_and_recall_on_submit(encoder);
        Ok(())
    }
}

fn dispatch(pass: &mut ComputePass<'_>, device: &Device, slots: &Buffer, own: &mut Dispatch, place: &mut usize) {
    let Dispatch { kernel, bound, pipeline, groups, group, .. } = own;
    let group = group.get_or_insert_with(|| {
        let size = BufferSize::new(kernel.info().params.size() as u64);
        let params = BindingResource::Buffer(BufferBinding { buffer: slots, offset: 0, size });
        let entries: Vec<BindGroupEntry<'_>> = [params]
            .into_iter()
            .chain(bound.iter().map(Resource::binding))
            .enumerate()
            .map(|(binding, resource)| BindGroupEntry { binding: binding as u32, resource })
            .collect();
        device.create_bind_group(&BindGroupDescriptor {
            label: Some(kernel.info().name),
            layout: &pipeline.layout,
            entries: &entries,
        })
    });
    pass.set_pipeline(&pipeline.pipeline);
    pass.set_bind_group(0, &*group, &[(*place * SLOT) as u32]);
    pass.dispatch_workgroups(groups[0], groups[1], 1);
    *place += 1;
}

fn copy_image(encoder: &mut CommandEncoder, from: &Buffer, pitch: u32, to: &Texture, layer: u32) {
    let (width, height) = (to.width(), to.height());
    encoder.copy_buffer_to_texture(
        TexelCopyBufferInfo {
            buffer: from,
            layout: TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None },
        },
        TexelCopyTextureInfo {
            texture: to,
            mip_level: 0,
            origin: Origin3d { x: 0, y: 0, z: layer },
            aspect: TextureAspect::All,
        },
        Extent3d { width, height, depth_or_array_layers: 1 },
    );
}
