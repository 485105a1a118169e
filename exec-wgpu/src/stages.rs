//! The stages as dispatches, over the buffers of a run.

use umbra4_core::{
    AnyLight, Executor, IndexKind, Pass, Plan,
    cloud::MAX_CLOUD,
    kernel::{
        Kernel,
        dispatch::{self, MaskLayout, Reduction, Role, dispatches},
        resolve::{ReceiverCounts, stride},
        resolve_cloud::SampleTile,
    },
    precision::Precision,
    proj4::{KeyTile, NODE},
    shaft::BoxTile,
    stage::Stage,
};
use wgpu::{Buffer, Device};

use crate::{
    GpuError,
    recorder::{Recorder, Resource},
    scratch::Scratch,
    told::Told,
};

/// Bytes that the masks of a block take, at most.
const MASK_BYTES: u64 = 64 << 20;
/// Tiles of a cloud, at most.
const SAMPLE_TILES: u64 = (MAX_CLOUD / NODE) as u64;
/// Receivers of a block, at most.
pub(crate) const BLOCK: u32 = 1 << 20;
/// Triangles that a dispatch looks at, at first: lavapipe ends loops after 65,535 rounds.
pub(crate) const fn slice(software: bool) -> u32 {
    if software { 16 * SMALLEST_SLICE } else { u32::MAX }
}

/// Those of one node: a dispatch cannot look at fewer.
pub(crate) const SMALLEST_SLICE: u32 = NODE as u32;

/// The buffer of facings.
pub(crate) const FACINGS: &str = "facings";

/// How masks with rows in words of `bits` bits are computed and stored.
pub(crate) fn mask_layout(light: &AnyLight, bits: u32, precision: Precision, counted: bool, slice: u32) -> MaskLayout {
    let (resolve, stride) = match light {
        AnyLight::Area(light) => {
            (resolve_kernel(bits, precision, light.jitter.is_some(), counted), stride(light.rows, bits))
        }
        AnyLight::Punctual(_) => (punctual_kernel(precision, counted), 1),
    };
    MaskLayout { resolve, stride, counted, slice, reduction: Reduction::LitCounts }
}

/// The same of the masks of a cloud, in `words` words of 32 bits.
pub(crate) fn cloud_layout(words: u32, precision: Precision, counted: bool, slice: u32) -> MaskLayout {
    let resolve = match (precision, counted) {
        (Precision::Exact, false) => Kernel::ResolveCloudExact,
        (Precision::Exact, true) => Kernel::ResolveCloudExactCounted,
        (Precision::Fast, false) => Kernel::ResolveCloudFast,
        (Precision::Fast, true) => Kernel::ResolveCloudFastCounted,
    };
    MaskLayout { resolve, stride: words, counted, slice, reduction: Reduction::LitCounts }
}

/// The same by a table of planes.
pub(crate) fn table_layout(words: u32, counted: bool, slice: u32) -> MaskLayout {
    let resolve = if counted { Kernel::ResolveCloudByTableCounted } else { Kernel::ResolveCloudByTable };
    MaskLayout { resolve, stride: words, counted, slice, reduction: Reduction::LitCounts }
}

/// Receivers of a block: at most `most`, and no more than the memory for masks holds.
pub(crate) fn block(layout: &MaskLayout, most: u32) -> u32 {
    receivers_of(layout.stride, most)
}

/// The same of masks of `stride` words of 32 bits.
pub(crate) fn receivers_of(stride: u32, most: u32) -> u32 {
    most.min((MASK_BYTES / (4 * u64::from(stride))) as u32)
}

/// Bits of the narrowest word that holds a row.
pub(crate) const fn narrowest(light: &AnyLight) -> u32 {
    match light {
        AnyLight::Area(light) if light.columns <= 16 => 16,
        AnyLight::Area(light) if light.columns > 32 => 64,
        _ => 32,
    }
}

const fn punctual_kernel(precision: Precision, counted: bool) -> Kernel {
    match (precision, counted) {
        (Precision::Exact, false) => Kernel::ResolvePunctualExact,
        (Precision::Exact, true) => Kernel::ResolvePunctualExactCounted,
        (Precision::Fast, false) => Kernel::ResolvePunctualFast,
        (Precision::Fast, true) => Kernel::ResolvePunctualFastCounted,
    }
}

const fn resolve_kernel(bits: u32, precision: Precision, jittered: bool, counted: bool) -> Kernel {
    match (bits, precision, jittered, counted) {
        (..=32, Precision::Exact, false, false) => Kernel::Resolve32Exact,
        (..=32, Precision::Exact, false, true) => Kernel::Resolve32ExactCounted,
        (..=32, Precision::Exact, true, false) => Kernel::Resolve32ExactJittered,
        (..=32, Precision::Exact, true, true) => Kernel::Resolve32ExactJitteredCounted,
        (..=32, Precision::Fast, false, false) => Kernel::Resolve32Fast,
        (..=32, Precision::Fast, false, true) => Kernel::Resolve32FastCounted,
        (..=32, Precision::Fast, true, false) => Kernel::Resolve32FastJittered,
        (..=32, Precision::Fast, true, true) => Kernel::Resolve32FastJitteredCounted,
        (_, Precision::Exact, false, false) => Kernel::Resolve64Exact,
        (_, Precision::Exact, false, true) => Kernel::Resolve64ExactCounted,
        (_, Precision::Exact, true, false) => Kernel::Resolve64ExactJittered,
        (_, Precision::Exact, true, true) => Kernel::Resolve64ExactJitteredCounted,
        (_, Precision::Fast, false, false) => Kernel::Resolve64Fast,
        (_, Precision::Fast, false, true) => Kernel::Resolve64FastCounted,
        (_, Precision::Fast, true, false) => Kernel::Resolve64FastJittered,
        (_, Precision::Fast, true, true) => Kernel::Resolve64FastJitteredCounted,
    }
}

/// What stages read and write.
#[derive(Clone, Debug)]
pub(crate) struct Buffers {
    pub(crate) vertices: Buffer,
    /// How many there are: a triangle may name others, and blocks nothing then.
    vertex_count: u32,
    pub(crate) triangles: Buffer,
    pub(crate) receivers: Buffer,
    pub(crate) masks: Buffer,
    pub(crate) counts: Option<Buffer>,
    pub(crate) lit: Option<Buffer>,
    /// Of an emission: the weights, and where their sums go. Whoever asks for sums brings them.
    pub(crate) emission: Option<[Resource; 2]>,
    /// Unit normals, the light's samples, and where irradiance goes. Whoever asks for it brings them.
    pub(crate) irradiance: Option<[Buffer; 3]>,
    pub(crate) samples: Option<Buffer>,
    /// A table of planes. Whoever has one brings it.
    pub(crate) planes: Option<Buffer>,
    triangle_keys: Buffer,
    triangle_order: Buffer,
    pub(crate) occluders: Buffer,
    pub(crate) nodes: Buffer,
    pub(crate) facings: Option<Buffer>,
    pub(crate) receiver_keys: Buffer,
    pub(crate) receiver_order: Buffer,
    spare_order: Buffer,
    counters: Buffer,
}

impl Buffers {
    /// Large enough for a plan, and for `vertices` vertices.
    pub(crate) fn fit(
        scratch: &mut Scratch,
        device: &Device,
        plan: &Plan,
        layout: &MaskLayout,
        vertices: u32,
    ) -> Result<Self, GpuError> {
        let facts = plan.facts();
        let triangles = u64::from(facts.triangles);
        let receivers = u64::from(facts.receivers);
        let block = facts.block.min(facts.receivers);
        let sorted = facts.triangles.max(block);
        // Masks of one bit are kept for all receivers: a light without extent may have several frames.
        let masked = if facts.punctual { receivers } else { u64::from(block) };
        // One more word says whether a thread was stopped.
        let masks = masked * u64::from(layout.stride) + 1;
        let (cloud, tiles) = (facts.index == IndexKind::Shafts, plan.levels().tiles() as u64);
        // Before a cloud nothing has keys.
        let keyed = |count: u64| if cloud { 0 } else { count };
        let mut fit = Fit { scratch, device };
        Ok(Self {
            vertices: fit.of::<[i32; 3]>("vertices", u64::from(vertices))?,
            vertex_count: vertices,
            triangles: fit.of::<[u32; 3]>("triangles", triangles)?,
            triangle_keys: fit.of::<[f32; 5]>("keys of triangles", keyed(triangles))?,
            triangle_order: fit.of::<[u32; 2]>("order of triangles", triangles)?,
            occluders: fit.of::<[[i32; 4]; 3]>("triangles in order", triangles)?,
            nodes: if cloud { fit.of::<BoxTile>("boxes", tiles)? } else { fit.of::<KeyTile>("nodes", tiles)? },
            samples: if cloud && !facts.table { Some(fit.of::<SampleTile>("samples", SAMPLE_TILES)?) } else { None },
            receivers: fit.of::<[i32; 3]>("receivers", receivers)?,
            facings: if facts.facing { Some(fit.of::<u32>(FACINGS, receivers)?) } else { None },
            receiver_keys: fit.of::<[f32; 5]>("keys of receivers", keyed(u64::from(block)))?,
            receiver_order: fit.of::<[u32; 2]>("order of receivers", u64::from(block))?,
            spare_order: fit.of::<[u32; 2]>("order", u64::from(sorted))?,
            counters: fit.of::<u32>("counters", dispatch::counters(sorted))?,
            masks: fit.of::<u32>("masks", masks)?,
            counts: if layout.counted { Some(fit.of::<ReceiverCounts>("counts", masked)?) } else { None },
            lit: match facts.visibility && layout.reduction.counts() {
                true => Some(fit.of::<u32>("lit counts", receivers)?),
                false => None,
            },
            emission: None,
            irradiance: None,
            planes: None,
        })
    }
}

impl Buffers {
    /// Byte of the mask buffer at which a word says whether a thread was stopped.
    pub(crate) fn stopped(&self) -> u64 {
        self.masks.size() - size_of::<u32>() as u64
    }

    pub(crate) fn of(&self, role: Role) -> Resource {
        let buffer = match role {
            Role::Vertices => return Resource::first::<[i32; 3]>(&self.vertices, self.vertex_count.into()),
            Role::Triangles => &self.triangles,
            Role::TriangleKeys => &self.triangle_keys,
            Role::TriangleOrder => &self.triangle_order,
            Role::SpareOrder => &self.spare_order,
            Role::Counters => &self.counters,
            Role::Occluders => &self.occluders,
            Role::Nodes => &self.nodes,
            Role::Receivers => &self.receivers,
            Role::ReceiverKeys => &self.receiver_keys,
            Role::ReceiverOrder => &self.receiver_order,
            Role::Masks => &self.masks,
            // Dispatches name these only where they are asked for.
            Role::Counts => self.counts.as_ref().unwrap_or(&self.masks),
            Role::LitCounts => self.lit.as_ref().unwrap_or(&self.masks),
            Role::Facings => self.facings.as_ref().unwrap_or(&self.masks),
            Role::Planes => self.planes.as_ref().unwrap_or(&self.masks),
            Role::Samples => self.samples.as_ref().unwrap_or(&self.masks),
            Role::UnitNormals => self.irradiance.as_ref().map_or(&self.masks, |[normals, _, _]| normals),
            Role::Emitters => self.irradiance.as_ref().map_or(&self.masks, |[_, samples, _]| samples),
            Role::Irradiance => self.irradiance.as_ref().map_or(&self.masks, |[_, _, sums]| sums),
            Role::Weights | Role::WeighedLight => match &self.emission {
                Some([weights, _]) if role == Role::Weights => return weights.clone(),
                Some([_, sums]) => return sums.clone(),
                None => &self.masks,
            },
        };
        buffer.into()
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
    /// Takes the masks of the `count` receivers from `first` on, before those of the next block replace them. Those of a light
    /// without extent are all of one block.
    fn block(&mut self, recorder: &mut Recorder, buffers: &Buffers, first: u32, count: u32) -> Result<(), GpuError>;
}

/// An executor for one light, in one of its frames, and one set of receivers.
pub(crate) struct Stages<'a, E> {
    plan: &'a Plan,
    layout: MaskLayout,
    told: Told,
    recorder: &'a mut Recorder,
    buffers: &'a Buffers,
    ends: &'a mut E,
}

impl<'a, E: Ends> Stages<'a, E> {
    pub(crate) fn new(
        plan: &'a Plan,
        layout: MaskLayout,
        told: Told,
        recorder: &'a mut Recorder,
        buffers: &'a Buffers,
        ends: &'a mut E,
    ) -> Self {
        Self { plan, layout, told, recorder, buffers, ends }
    }

    /// Records all stages of the plan.
    pub(crate) fn run(mut self) -> Result<(), GpuError> {
        self.plan.run(&mut self)
    }

    /// The block whose first receiver is `first` has all its masks, and what they are reduced to where that is asked for.
    fn end_block(&mut self, first: u32) -> Result<(), GpuError> {
        let facts = self.plan.facts();
        let count = facts.block.min(facts.receivers - first);
        self.ends.block(self.recorder, self.buffers, first, count)
    }
}

impl<E: Ends> Executor for Stages<'_, E> {
    type Error = GpuError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), GpuError> {
        let Self { plan, layout, told, recorder, buffers, ends } = self;
        recorder.set_stage(pass.stage.info().name);
        match pass.stage {
            Stage::SnapVertices => ends.snap_vertices(recorder, buffers)?,
            Stage::SnapReceivers => ends.snap_receivers(recorder, buffers, pass.first, pass.count)?,
            _ => dispatches(plan, layout, pass, &mut |dispatch| {
                let bound: Vec<Resource> = dispatch.roles.iter().map(|role| buffers.of(*role)).collect();
                told.record(recorder, dispatch, &bound)
            })?,
        }
        // No plan of a light without extent has the stage resolve, and none of it ends a block.
        let facts = plan.facts();
        let last = match facts.index {
            _ if facts.irradiance => Stage::Illuminate,
            _ if facts.visibility => Stage::Reduce,
            IndexKind::Shafts => Stage::ResolveCloud,
            _ => Stage::Resolve,
        };
        if pass.stage == last && !facts.punctual { self.end_block(pass.first) } else { Ok(()) }
    }
}
