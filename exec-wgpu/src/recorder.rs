//! Steps of a run, collected first: parameters of all dispatches go into one buffer, then everything is encoded.
//!
//! What a run needed is kept: where another asks for the same kernels over the same resources, as frame after frame does,
//! no object is made on the device.

#![allow(clippy::mutable_key_type, reason = "wgpu's resources are equal, and hash, by identity")]

use std::{
    collections::{HashMap, hash_map::Entry},
    num::NonZero,
    sync::Arc,
};

use umbra4_core::{kernel::WORKGROUP, params::Dispatched, stage::Stage};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferBinding, BufferDescriptor,
    BufferSize, BufferUsages, CommandEncoder, ComputePass, ComputePassDescriptor, Device, Extent3d, Origin3d,
    TexelCopyBufferInfo, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture, TextureAspect, TextureView,
    util::StagingBelt,
};

use crate::{
    DeviceKernel, GpuError,
    error::guarded,
    pipelines::{Loading, Pipeline, Pipelines},
    timing::Timing,
};

/// Distance of parameters in their buffer: what every device accepts as a dynamic offset.
const SLOT: usize = 256;
/// Bytes of a chunk of the staging belt: the parameters of most frames.
const CHUNK: u64 = 1 << 16;

/// What a kernel is bound to.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
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
    /// The first `count` elements of a buffer, at least one: nothing empty can be bound. Beyond lies what other runs have left.
    pub(crate) fn first<T>(buffer: &Buffer, count: u64) -> Self {
        let bytes = count.max(1) * size_of::<T>() as u64;
        NonZero::new(bytes).map_or_else(|| buffer.into(), |bytes| Self::Part(buffer.clone(), 0, bytes))
    }

    /// Where it lies, unless it is a texture.
    pub(crate) fn buffer(&self) -> Option<&Buffer> {
        match self {
            Self::Buffer(buffer) | Self::Part(buffer, ..) => Some(buffer),
            Self::Texture(_) => None,
        }
    }

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

/// A kernel over resources.
type Bound = (DeviceKernel, Vec<Resource>);

/// Encodings after which a bind group that none of them used is let go, with the resources that it holds.
const AGE: u64 = 64;

/// A bind group, and the encoding that used it last.
#[derive(Debug)]
struct Group {
    group: BindGroup,
    used: u64,
}

/// A kernel to be run.
#[derive(Debug)]
struct Dispatch {
    bound: Bound,
    stage: &'static str,
    pipeline: Arc<Pipeline>,
    groups: [u32; 2],
    /// As many slots as it takes.
    params: Vec<u8>,
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
    stage: &'static str,
    steps: Vec<Step>,
    groups: HashMap<Bound, Group>,
    encodings: u64,
    slots: Option<Buffer>,
    belt: StagingBelt,
    timing: Option<Timing>,
}

impl Recorder {
    pub(crate) fn new(device: &Device, loading: Loading, timing: Option<Timing>) -> Self {
        Self {
            device: device.clone(),
            pipelines: Pipelines::new(loading),
            stage: Stage::SnapVertices.info().name,
            steps: Vec::new(),
            groups: HashMap::new(),
            encodings: 0,
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

    /// The stage, by its name, that what follows belongs to.
    pub(crate) fn set_stage(&mut self, stage: &'static str) {
        self.stage = stage;
    }

    /// Forgets the steps of a run that was not encoded; what it needed is kept.
    pub(crate) fn restart(&mut self) {
        self.steps.clear();
    }

    /// A kernel for the ids `0..params.count()`, over resources in the order of its table.
    pub(crate) fn add<P: Dispatched + bytemuck::Pod>(
        &mut self,
        kernel: impl Into<DeviceKernel>,
        params: P,
        bound: &[Resource],
    ) -> Result<(), GpuError> {
        let (kernel, count) = (kernel.into(), params.count());
        if count == 0 {
            return Ok(());
        }
        let most = self.device.limits().max_compute_workgroups_per_dimension;
        let columns = count.div_ceil(WORKGROUP).min(most);
        let rows = count.div_ceil(columns * WORKGROUP);
        let mut bytes = bytemuck::bytes_of(&params.with_row(columns * WORKGROUP)).to_vec();
        bytes.resize(bytes.len().next_multiple_of(SLOT), 0);
        let pipeline = self.pipelines.get(&self.device, kernel)?;
        self.steps.push(Step::Dispatch(Box::new(Dispatch {
            bound: (kernel, bound.to_vec()),
            stage: self.stage,
            pipeline,
            groups: [columns, rows],
            params: bytes,
        })));
        Ok(())
    }

    /// Zeros in a buffer, from byte `from` on.
    pub(crate) fn clear(&mut self, buffer: &Buffer, from: u64) {
        self.steps.push(Step::Clear { buffer: buffer.clone(), from });
    }

    /// Bytes of a buffer, from a byte on, go to another.
    pub(crate) fn copy(&mut self, from: (&Buffer, u64), to: (&Buffer, u64), bytes: u64) {
        self.steps.push(Step::Copy { from: (from.0.clone(), from.1), to: (to.0.clone(), to.1), bytes });
    }

    /// Rows of `pitch` bytes go to a layer of a texture.
    pub(crate) fn copy_image(&mut self, from: &Buffer, pitch: u32, to: &Texture, layer: u32) {
        self.steps.push(Step::Image { from: from.clone(), pitch, to: to.clone(), layer });
    }

    /// Makes what encoding needs, and forgets the steps.
    pub(crate) fn prepare(&mut self) -> Result<(), GpuError> {
        let made = self.make();
        self.steps.clear();
        made
    }

    /// Encodes all steps, or nothing where an error is returned. They must be submitted in the order in which they were encoded.
    pub(crate) fn encode(&mut self, encoder: &mut CommandEncoder) -> Result<(), GpuError> {
        let encoded = self.make().and_then(|()| self.write_params(encoder));
        if encoded.is_ok() {
            self.put(encoder);
        }
        self.steps.clear();
        encoded
    }

    fn dispatches(&self) -> impl Iterator<Item = &Dispatch> {
        self.steps.iter().filter_map(|step| match step {
            Step::Dispatch(dispatch) => Some(&**dispatch),
            _ => None,
        })
    }

    /// The buffer of the parameters, and the bind groups of all dispatches.
    fn make(&mut self) -> Result<(), GpuError> {
        self.encodings += 1;
        let bytes = self.dispatches().map(|dispatch| dispatch.params.len() as u64).sum::<u64>();
        if self.slots.as_ref().is_none_or(|slots| slots.size() < bytes) {
            let slots = guarded(&self.device, "allocates parameters", || {
                self.device.create_buffer(&BufferDescriptor {
                    label: Some("umbra4 parameters"),
                    size: bytes.max(CHUNK).next_power_of_two(),
                    usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            })?;
            self.groups.clear();
            self.slots = Some(slots);
        }
        let Self { device, steps, groups, encodings, slots, .. } = self;
        let Some(slots) = slots else { return Ok(()) };
        groups.retain(|_, group| group.used + AGE > *encodings);
        for step in steps {
            let Step::Dispatch(dispatch) = step else { continue };
            match groups.entry(dispatch.bound.clone()) {
                Entry::Occupied(mut known) => known.get_mut().used = *encodings,
                Entry::Vacant(place) => {
                    place.insert(Group { group: bind(device, slots, dispatch)?, used: *encodings });
                }
            }
        }
        Ok(())
    }

    /// Brings the parameters of all dispatches to the device, in the order of the encoder.
    fn write_params(&mut self, encoder: &mut CommandEncoder) -> Result<(), GpuError> {
        let all: Vec<u8> = self.dispatches().flat_map(|dispatch| &dispatch.params).copied().collect();
        let bytes = all.len();
        let (Some(slots), Some(size)) = (&self.slots, BufferSize::new(bytes as u64)) else { return Ok(()) };
        // Powers of two: frames that grow little by little take the same chunks.
        let room = size.checked_next_power_of_two().unwrap_or(size);
        let part = guarded(&self.device, "allocates a staging buffer", || {
            let part = self.belt.allocate(room, const { NonZero::new(wgpu::COPY_BUFFER_ALIGNMENT).unwrap() });
            let view = part.get_mapped_range_mut();
            view.map(|mut view| {
                view.slice(..bytes).copy_from_slice(&all);
                (part.buffer().clone(), part.offset())
            })
        });
        let lost = |reason: String| GpuError::Lost { doing: "maps a staging buffer", reason };
        match part.and_then(|part| part.map_err(|error| lost(error.to_string()))) {
            Ok((buffer, offset)) => {
                encoder.copy_buffer_to_buffer(&buffer, offset, slots, 0, size.get());
                self.belt.finish_and_recall_on_submit(encoder);
                Ok(())
            }
            Err(error) => {
                // What it holds may not be usable.
                self.belt = StagingBelt::new(self.device.clone(), CHUNK);
                Err(error)
            }
        }
    }

    /// Puts all steps into the encoder.
    fn put(&mut self, encoder: &mut CommandEncoder) {
        let Self { steps, groups, timing, .. } = self;
        if let Some(timing) = timing {
            timing.begin();
        }
        let mut steps = steps.iter().peekable();
        let mut place = 0;
        while let Some(step) = steps.next() {
            match step {
                Step::Clear { buffer, from } => encoder.clear_buffer(buffer, *from, None),
                Step::Copy { from, to, bytes } => {
                    encoder.copy_buffer_to_buffer(&from.0, from.1, &to.0, to.1, *bytes);
                }
                Step::Image { from, pitch, to, layer } => copy_image(encoder, from, *pitch, to, *layer),
                Step::Dispatch(first) => {
                    let stage = first.stage;
                    let timestamp_writes = timing.as_mut().and_then(|timing| timing.writes(stage));
                    let timed = timestamp_writes.is_some();
                    let label = if timed { stage } else { "umbra4" };
                    let mut pass =
                        encoder.begin_compute_pass(&ComputePassDescriptor { label: Some(label), timestamp_writes });
                    dispatch(&mut pass, groups, first, &mut place);
                    while let Some(Step::Dispatch(next)) = steps.next_if(|step| match step {
                        Step::Dispatch(next) => !timed || next.stage == stage,
                        _ => false,
                    }) {
                        dispatch(&mut pass, groups, next, &mut place);
                    }
                }
            }
        }
        if let Some(timing) = timing {
            timing.end(encoder);
        }
    }
}

fn bind(device: &Device, slots: &Buffer, Dispatch { bound, pipeline, .. }: &Dispatch) -> Result<BindGroup, GpuError> {
    let (kernel, resources) = bound;
    let params = BindingResource::Buffer(BufferBinding {
        buffer: slots,
        offset: 0,
        size: BufferSize::new(kernel.params_size() as u64),
    });
    let entries: Vec<BindGroupEntry<'_>> = [params]
        .into_iter()
        .chain(resources.iter().map(Resource::binding))
        .enumerate()
        .map(|(binding, resource)| BindGroupEntry { binding: binding as u32, resource })
        .collect();
    guarded(device, kernel.name(), || {
        device.create_bind_group(&BindGroupDescriptor {
            label: Some(kernel.name()),
            layout: &pipeline.layout,
            entries: &entries,
        })
    })
}

fn dispatch(pass: &mut ComputePass<'_>, groups: &HashMap<Bound, Group>, own: &Dispatch, place: &mut u32) {
    // All are made before anything is encoded.
    let Some(Group { group, .. }) = groups.get(&own.bound) else { return };
    pass.set_pipeline(&own.pipeline.pipeline);
    pass.set_bind_group(0, group, &[*place]);
    pass.dispatch_workgroups(own.groups[0], own.groups[1], 1);
    *place += own.params.len() as u32;
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
