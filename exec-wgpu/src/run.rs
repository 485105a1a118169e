//! One run: the stages as dispatches, over the buffers of this run.

use umbra4_core::{
    Executor, LatticeLight, Pass, Plan,
    glam::IVec3,
    hierarchy::Levels,
    kernel::{Kernel, resolve::ReceiverCounts},
    params::PassParams,
    proj4::{KeyTile, NODE},
    stage::{Stage, reduce},
};
use wgpu::{Buffer, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, Device, util::DeviceExt};

use crate::{
    GpuError, LatticeScene,
    error::guarded,
    readback::{copy, read},
    recorder::Recorder,
    sort,
};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Wanted {
    pub(crate) resolve: Kernel,
    /// Words of 32 bits that a receiver's mask takes.
    pub(crate) stride: u32,
    pub(crate) masks: bool,
    pub(crate) counts: bool,
    /// Triangles that a dispatch looks at, at most.
    pub(crate) slice: u32,
}

/// The highest level whose nodes stand for no more than `slice` triangles.
fn slice_level(levels: &Levels, slice: u32) -> usize {
    let (mut level, mut triangles) = (0, NODE as u64);
    while level + 1 < levels.count() && triangles * NODE as u64 <= u64::from(slice) {
        level += 1;
        triangles *= NODE as u64;
    }
    level
}

/// What came out.
#[derive(Clone, Debug, Default)]
pub(crate) struct Results {
    pub(crate) masks: Vec<u32>,
    pub(crate) visibility: Vec<f32>,
    pub(crate) counts: Vec<ReceiverCounts>,
}

struct Buffers {
    vertices: Buffer,
    triangles: Buffer,
    triangle_keys: Buffer,
    triangle_order: Buffer,
    occluders: Buffer,
    nodes: Buffer,
    receivers: Buffer,
    receiver_keys: Buffer,
    receiver_order: Buffer,
    spare_order: Buffer,
    counters: Buffer,
    masks: Buffer,
    counts: Option<Buffer>,
    table: Buffer,
    visibility: Buffer,
}

/// An executor for one light and one set of receivers.
pub(crate) struct Run<'a> {
    plan: &'a Plan,
    wanted: Wanted,
    recorder: Recorder<'a>,
    buffers: Buffers,
    results: Results,
}

/// A storage buffer of `count` elements; an empty one still has one, since nothing empty can be bound.
fn storage<T>(device: &Device, what: &'static str, count: u64) -> Result<Buffer, GpuError> {
    let bytes = count.max(1) * size_of::<T>() as u64;
    check_size(device, what, bytes)?;
    let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
    guarded(device, "allocates a buffer", || {
        device.create_buffer(&BufferDescriptor { label: Some(what), size: bytes, usage, mapped_at_creation: false })
    })
}

/// A storage buffer with the given elements; where there are none, one of zeros.
fn uploaded<T: bytemuck::Pod>(device: &Device, what: &'static str, elements: &[T]) -> Result<Buffer, GpuError> {
    let none = [T::zeroed()];
    let elements = if elements.is_empty() { &none[..] } else { elements };
    let contents = bytemuck::cast_slice(elements);
    check_size(device, what, contents.len() as u64)?;
    guarded(device, "uploads a buffer", || {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(what),
            contents,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
        })
    })
}

fn check_size(device: &Device, what: &'static str, bytes: u64) -> Result<(), GpuError> {
    let limits = device.limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    if bytes > limit { Err(GpuError::TooLarge { what, bytes, limit }) } else { Ok(()) }
}

impl<'a> Run<'a> {
    pub(crate) fn new(
        plan: &'a Plan,
        wanted: Wanted,
        recorder: Recorder<'a>,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: &[IVec3],
    ) -> Result<Self, GpuError> {
        let device = recorder.device();
        let facts = plan.facts();
        let triangles = u64::from(facts.triangles);
        let block = facts.block.min(facts.receivers);
        let sorted = facts.triangles.max(block);
        let samples = light.sample_count();
        let table: Vec<f32> = (0..=samples).map(|lit| reduce::visibility(lit, samples)).collect();
        let visible = if facts.visibility { u64::from(facts.receivers) } else { 0 };
        let buffers = Buffers {
            vertices: uploaded(device, "vertices", scene.vertices)?,
            triangles: uploaded(device, "triangles", scene.triangles)?,
            triangle_keys: storage::<[f32; 5]>(device, "keys of triangles", triangles)?,
            triangle_order: storage::<[u32; 2]>(device, "order of triangles", triangles)?,
            occluders: storage::<[[i32; 4]; 3]>(device, "triangles in order", triangles)?,
            nodes: storage::<KeyTile>(device, "nodes", plan.levels().tiles() as u64)?,
            receivers: uploaded(device, "receivers", receivers)?,
            receiver_keys: storage::<[f32; 5]>(device, "keys of receivers", u64::from(block))?,
            receiver_order: storage::<[u32; 2]>(device, "order of receivers", u64::from(block))?,
            spare_order: storage::<[u32; 2]>(device, "order", u64::from(sorted))?,
            counters: storage::<u32>(device, "counters", sort::counters(sorted))?,
            masks: storage::<u32>(device, "masks", u64::from(block) * u64::from(wanted.stride))?,
            counts: match wanted.counts {
                true => Some(storage::<ReceiverCounts>(device, "counts", u64::from(block))?),
                false => None,
            },
            table: uploaded(device, "visibility table", &table)?,
            visibility: storage::<f32>(device, "visibility", visible)?,
        };
        Ok(Self { plan, wanted, recorder, buffers, results: Results::default() })
    }

    /// Runs the plan.
    pub(crate) fn finish(mut self) -> Result<Results, GpuError> {
        let plan = self.plan;
        plan.run(&mut self)?;
        Ok(self.results)
    }

    fn order_triangles(&mut self, count: u32) -> Result<(), GpuError> {
        let b = &self.buffers;
        sort::sort(&mut self.recorder, count, &b.triangle_order, &b.spare_order, &b.counters)?;
        // Places beyond the last triangle are written too, up to the end of its node.
        let places = count.div_ceil(NODE as u32) * NODE as u32;
        let pass = PassParams { count: places, elements: count, ..PassParams::default() };
        let bound = [&b.vertices, &b.triangles, &b.triangle_keys, &b.triangle_order, &b.occluders, &b.nodes];
        self.recorder.add(Kernel::OrderTriangles, pass, &bound)
    }

    fn build_level(&mut self, level: usize) -> Result<(), GpuError> {
        let levels = self.plan.levels();
        let (own, below) = (levels.range(level), levels.range(level.saturating_sub(1)));
        let pass = PassParams {
            count: (own.len() * NODE) as u32,
            first: own.start as u32,
            base: below.start as u32,
            elements: below.len() as u32,
            ..PassParams::default()
        };
        self.recorder.add(Kernel::BuildLevel, pass, &[&self.buffers.nodes])
    }

    fn resolve(&mut self, first: u32) -> Result<(), GpuError> {
        let b = &self.buffers;
        let facts = self.plan.facts();
        let count = facts.block.min(facts.receivers - first);
        let pass = PassParams { count, first, stride: self.wanted.stride, ..PassParams::default() };
        let mut bound = vec![&b.receivers, &b.receiver_keys, &b.receiver_order, &b.occluders, &b.nodes, &b.masks];
        bound.extend(&b.counts);
        // A slice of the triangles after the other: those under each node of one level.
        let levels = self.plan.levels();
        let level = slice_level(levels, self.wanted.slice);
        for base in 0..levels.range(level).len().max(1) as u32 {
            self.recorder.add(self.wanted.resolve, PassParams { level: level as u32, base, ..pass }, &bound)?;
        }
        if facts.visibility {
            self.recorder.add(Kernel::Reduce, pass, &[&b.masks, &b.table, &b.visibility])?;
        }
        self.submit(first, count)
    }

    /// Ends a block: its dispatches go to the device, and what was asked for comes back.
    fn submit(&mut self, first: u32, count: u32) -> Result<(), GpuError> {
        let Self { recorder, buffers: b, wanted, results, plan } = self;
        let (device, queue) = (recorder.device(), recorder.queue());
        let facts = plan.facts();
        let last = first + count == facts.receivers;
        let [masks, counts, visibility] = guarded(device, "records passes", || {
            let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor { label: Some("umbra4") });
            recorder.encode(&mut encoder);
            let words = u64::from(count) * u64::from(wanted.stride);
            let masks = wanted.masks.then(|| copy(device, &mut encoder, &b.masks, words * 4));
            let size = u64::from(count) * size_of::<ReceiverCounts>() as u64;
            let counts = b.counts.as_ref().map(|counts| copy(device, &mut encoder, counts, size));
            let size = u64::from(facts.receivers) * 4;
            let visibility = (facts.visibility && last).then(|| copy(device, &mut encoder, &b.visibility, size));
            queue.submit([encoder.finish()]);
            [masks, counts, visibility]
        })?;
        if let Some(masks) = masks {
            results.masks.extend(read::<u32>(device, &masks)?);
        }
        if let Some(counts) = counts {
            results.counts.extend(read::<ReceiverCounts>(device, &counts)?);
        }
        if let Some(visibility) = visibility {
            results.visibility = read(device, &visibility)?;
        }
        Ok(())
    }
}

impl Executor for Run<'_> {
    type Error = GpuError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), GpuError> {
        let b = &self.buffers;
        let by_id = PassParams { count: pass.count, first: pass.first, ..PassParams::default() };
        match pass.stage {
            Stage::KeyTriangles => {
                let bound = [&b.vertices, &b.triangles, &b.triangle_keys, &b.triangle_order];
                self.recorder.add(Kernel::KeyTriangles, by_id, &bound)
            }
            Stage::OrderTriangles => self.order_triangles(pass.count),
            Stage::BuildLevel => self.build_level(pass.first as usize),
            Stage::KeyReceivers => {
                self.recorder.add(Kernel::KeyReceivers, by_id, &[&b.receivers, &b.receiver_keys, &b.receiver_order])
            }
            Stage::OrderReceivers => {
                sort::sort(&mut self.recorder, pass.count, &b.receiver_order, &b.spare_order, &b.counters)
            }
            Stage::Resolve => self.resolve(pass.first),
            // The scene and the receivers come snapped, the hierarchy is the index, and blocks are reduced when resolved.
            Stage::SnapVertices
            | Stage::SnapReceivers
            | Stage::DefineFrame
            | Stage::BinReceivers
            | Stage::BinTriangles
            | Stage::ResolveCells
            | Stage::Reduce => Ok(()),
        }
    }
}
