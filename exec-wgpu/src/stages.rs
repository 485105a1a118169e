//! The stages as dispatches, over the buffers of a run.

use umbra4_core::{
    Executor, LatticeLight, Pass, Plan,
    edge_plane::LightGrid,
    glam::IVec3,
    hierarchy::Levels,
    kernel::{
        Kernel,
        resolve::{ReceiverCounts, stride},
    },
    order::CodeFrame,
    params::{Params, PassParams},
    precision::Precision,
    proj4::{KeyTile, NODE},
    stage::Stage,
};
use wgpu::{Buffer, Device};

use crate::{
    GpuError,
    recorder::{Recorder, Resource},
    scratch::Scratch,
    sort,
};

/// Bytes that the masks of a block take, at most.
const MASK_BYTES: u64 = 64 << 20;
/// Receivers of a block, at most.
pub(crate) const BLOCK: u32 = 1 << 20;
/// Triangles that a dispatch of a software driver looks at: lavapipe ends loops after 65,535 rounds.
const SOFTWARE_SLICE: u32 = 256;

/// How masks are computed and stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) resolve: Kernel,
    /// Words of 32 bits that a receiver's mask takes.
    pub(crate) stride: u32,
    pub(crate) counted: bool,
    /// Triangles that a dispatch looks at, at most.
    pub(crate) slice: u32,
}

impl Layout {
    /// For rows in words of `bits` bits.
    pub(crate) fn new(light: &LatticeLight, bits: u32, precision: Precision, counted: bool, software: bool) -> Self {
        Self {
            resolve: resolve_kernel(bits, precision, counted),
            stride: stride(light.rows, bits),
            counted,
            slice: if software { SOFTWARE_SLICE } else { u32::MAX },
        }
    }

    /// Receivers of a block: at most `most`, and no more than the memory for masks holds.
    pub(crate) fn block(&self, most: u32) -> u32 {
        most.min((MASK_BYTES / (4 * u64::from(self.stride))) as u32)
    }
}

/// Bits of the narrowest word that holds a row.
pub(crate) const fn narrowest(light: &LatticeLight) -> u32 {
    match light.columns {
        0..=16 => 16,
        17..=32 => 32,
        _ => 64,
    }
}

const fn resolve_kernel(bits: u32, precision: Precision, counted: bool) -> Kernel {
    match (bits, precision, counted) {
        (..=32, Precision::Exact, false) => Kernel::Resolve32Exact,
        (..=32, Precision::Exact, true) => Kernel::Resolve32ExactCounted,
        (..=32, Precision::Fast, false) => Kernel::Resolve32Fast,
        (..=32, Precision::Fast, true) => Kernel::Resolve32FastCounted,
        (_, Precision::Exact, false) => Kernel::Resolve64Exact,
        (_, Precision::Exact, true) => Kernel::Resolve64ExactCounted,
        (_, Precision::Fast, false) => Kernel::Resolve64Fast,
        (_, Precision::Fast, true) => Kernel::Resolve64FastCounted,
    }
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

/// What stages read and write.
#[derive(Clone, Debug)]
pub(crate) struct Buffers {
    pub(crate) vertices: Buffer,
    pub(crate) triangles: Buffer,
    pub(crate) receivers: Buffer,
    pub(crate) masks: Buffer,
    pub(crate) counts: Option<Buffer>,
    pub(crate) lit: Option<Buffer>,
    triangle_keys: Buffer,
    triangle_order: Buffer,
    occluders: Buffer,
    nodes: Buffer,
    receiver_keys: Buffer,
    receiver_order: Buffer,
    spare_order: Buffer,
    counters: Buffer,
}

impl Buffers {
    /// Large enough for a plan, and for `vertices` vertices.
    pub(crate) fn fit(
        scratch: &mut Scratch,
        device: &Device,
        plan: &Plan,
        layout: &Layout,
        vertices: u32,
    ) -> Result<Self, GpuError> {
        let facts = plan.facts();
        let triangles = u64::from(facts.triangles);
        let receivers = u64::from(facts.receivers);
        let block = facts.block.min(facts.receivers);
        let sorted = facts.triangles.max(block);
        let masks = u64::from(block) * u64::from(layout.stride);
        let mut fit = Fit { scratch, device };
        Ok(Self {
            vertices: fit.of::<[i32; 3]>("vertices", u64::from(vertices))?,
            triangles: fit.of::<[u32; 3]>("triangles", triangles)?,
            triangle_keys: fit.of::<[f32; 5]>("keys of triangles", triangles)?,
            triangle_order: fit.of::<[u32; 2]>("order of triangles", triangles)?,
            occluders: fit.of::<[[i32; 4]; 3]>("triangles in order", triangles)?,
            nodes: fit.of::<KeyTile>("nodes", plan.levels().tiles() as u64)?,
            receivers: fit.of::<[i32; 3]>("receivers", receivers)?,
            receiver_keys: fit.of::<[f32; 5]>("keys of receivers", u64::from(block))?,
            receiver_order: fit.of::<[u32; 2]>("order of receivers", u64::from(block))?,
            spare_order: fit.of::<[u32; 2]>("order", u64::from(sorted))?,
            counters: fit.of::<u32>("counters", sort::counters(sorted))?,
            masks: fit.of::<u32>("masks", masks)?,
            counts: if layout.counted { Some(fit.of::<ReceiverCounts>("counts", u64::from(block))?) } else { None },
            lit: if facts.visibility { Some(fit.of::<u32>("lit counts", receivers)?) } else { None },
        })
    }
}

struct Fit<'a> {
    scratch: &'a mut Scratch,
    device: &'a Device,
}

impl Fit<'_> {
    fn of<T>(&mut self, what: &'static str, count: u64) -> Result<Buffer, GpuError> {
        self.scratch.fit::<T>(self.device, what, count)
    }
}

/// Where a run's input comes from and its output goes to: the host, or an engine's own resources.
pub(crate) trait Ends {
    /// Records how vertices and triangles come to [`Buffers`].
    fn snap_vertices(&mut self, recorder: &mut Recorder, buffers: &Buffers) -> Result<(), GpuError>;
    /// Records how the `count` receivers from `first` on come to [`Buffers`].
    fn snap_receivers(
        &mut self,
        recorder: &mut Recorder,
        buffers: &Buffers,
        first: u32,
        count: u32,
    ) -> Result<(), GpuError>;
    /// Takes the masks of the `count` receivers from `first` on, before those of the next block replace them.
    fn block(&mut self, recorder: &mut Recorder, buffers: &Buffers, first: u32, count: u32) -> Result<(), GpuError>;
}

/// An executor for one light and one set of receivers.
pub(crate) struct Stages<'a, E> {
    plan: &'a Plan,
    layout: Layout,
    params: Params,
    recorder: &'a mut Recorder,
    buffers: &'a Buffers,
    ends: E,
}

impl<'a, E: Ends> Stages<'a, E> {
    /// `bounds`: of all triangles and receivers, lattice. They decide the order of things, never a bit.
    pub(crate) fn new(
        plan: &'a Plan,
        layout: Layout,
        light: &LatticeLight,
        bounds: [IVec3; 2],
        recorder: &'a mut Recorder,
        buffers: &'a Buffers,
        ends: E,
    ) -> Self {
        let grid = LightGrid::new(*light);
        let params = Params::new(&grid, &CodeFrame::around(&grid.frame, bounds), plan.levels());
        Self { plan, layout, params, recorder, buffers, ends }
    }

    /// Records all stages of the plan.
    pub(crate) fn run(mut self) -> Result<E, GpuError> {
        let plan = self.plan;
        plan.run(&mut self)?;
        Ok(self.ends)
    }

    fn add(&mut self, kernel: Kernel, pass: PassParams, bound: &[&Buffer]) -> Result<(), GpuError> {
        add(self.recorder, kernel, self.params.with_pass(&pass), bound)
    }

    fn sort(&mut self, count: u32, order: &Buffer) -> Result<(), GpuError> {
        let b = self.buffers;
        let params = self.params;
        let mut record =
            |kernel, pass: PassParams, bound: &[&Buffer]| add(self.recorder, kernel, params.with_pass(&pass), bound);
        sort::sort(&mut record, count, order, &b.spare_order, &b.counters)
    }

    fn order_triangles(&mut self, count: u32) -> Result<(), GpuError> {
        let b = self.buffers;
        self.sort(count, &b.triangle_order)?;
        // Places beyond the last triangle are written too, up to the end of its node.
        let places = count.div_ceil(NODE as u32) * NODE as u32;
        let pass = PassParams { count: places, elements: count, ..PassParams::default() };
        let bound = [&b.vertices, &b.triangles, &b.triangle_keys, &b.triangle_order, &b.occluders, &b.nodes];
        self.add(Kernel::OrderTriangles, pass, &bound)
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
        self.add(Kernel::BuildLevel, pass, &[&self.buffers.nodes])
    }

    /// Receivers of the block that begins at `first`.
    fn block(&self, first: u32) -> u32 {
        let facts = self.plan.facts();
        facts.block.min(facts.receivers - first)
    }

    fn resolve(&mut self, first: u32) -> Result<(), GpuError> {
        let b = self.buffers;
        let count = self.block(first);
        let pass = PassParams { count, first, stride: self.layout.stride, ..PassParams::default() };
        let all = [&b.receivers, &b.receiver_keys, &b.receiver_order, &b.occluders, &b.nodes, &b.masks];
        let mut counted = [&b.masks; 7];
        let bound = match &b.counts {
            Some(counts) => {
                counted[..6].copy_from_slice(&all);
                counted[6] = counts;
                &counted[..]
            }
            None => &all[..],
        };
        // A slice of the triangles after the other: those under each node of one level.
        let levels = self.plan.levels();
        let level = slice_level(levels, self.layout.slice);
        for base in 0..levels.range(level).len().max(1) as u32 {
            self.add(self.layout.resolve, PassParams { level: level as u32, base, ..pass }, bound)?;
        }
        if self.plan.facts().visibility { Ok(()) } else { self.end_block(first) }
    }

    fn reduce(&mut self, first: u32) -> Result<(), GpuError> {
        let b = self.buffers;
        let pass = PassParams { count: self.block(first), first, stride: self.layout.stride, ..PassParams::default() };
        if let Some(lit) = &b.lit {
            self.add(Kernel::Reduce, pass, &[&b.masks, lit])?;
        }
        self.end_block(first)
    }

    fn end_block(&mut self, first: u32) -> Result<(), GpuError> {
        self.ends.block(self.recorder, self.buffers, first, self.block(first))
    }
}

pub(crate) fn add(recorder: &mut Recorder, kernel: Kernel, params: Params, bound: &[&Buffer]) -> Result<(), GpuError> {
    let resources: Vec<Resource> = bound.iter().map(|&buffer| buffer.into()).collect();
    recorder.add(kernel, params, &resources)
}

impl<E: Ends> Executor for Stages<'_, E> {
    type Error = GpuError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), GpuError> {
        let b = self.buffers;
        self.recorder.set_stage(pass.stage);
        let by_id = PassParams { count: pass.count, first: pass.first, ..PassParams::default() };
        match pass.stage {
            Stage::SnapVertices => self.ends.snap_vertices(self.recorder, b),
            Stage::SnapReceivers => self.ends.snap_receivers(self.recorder, b, pass.first, pass.count),
            Stage::KeyTriangles => {
                let bound = [&b.vertices, &b.triangles, &b.triangle_keys, &b.triangle_order];
                self.add(Kernel::KeyTriangles, by_id, &bound)
            }
            Stage::OrderTriangles => self.order_triangles(pass.count),
            Stage::BuildLevel => self.build_level(pass.first as usize),
            Stage::KeyReceivers => {
                self.add(Kernel::KeyReceivers, by_id, &[&b.receivers, &b.receiver_keys, &b.receiver_order])
            }
            Stage::OrderReceivers => self.sort(pass.count, &b.receiver_order),
            Stage::Resolve => self.resolve(pass.first),
            Stage::Reduce => self.reduce(pass.first),
            // The hierarchy is the index.
            Stage::DefineFrame | Stage::BinReceivers | Stage::BinTriangles | Stage::ResolveCells => Ok(()),
        }
    }
}
