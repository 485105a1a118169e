//! Casters, indexed on the device for one light: each by itself.

use umbra4_core::{
    CasterWork, Executor, LatticeLight, Layers, PackedCaster, Pass, Plan, Precision, SceneFacts, Work,
    edge_plane::LightGrid,
    glam::IVec3,
    kernel::dispatch::{MaskLayout, dispatches},
    order::CodeFrame,
    params::{CasterParams, Params},
};
use wgpu::Buffer;

use crate::{
    Gpu, GpuError, checks,
    error::guarded,
    executor::bounds,
    recorder::{Recorder, Resource},
    scratch::Scratch,
    stages::{Buffers, mask_layout},
    submit::submit,
    told::Told,
};

/// Casters as one light sees them, on a device: made by [`crate::WgpuExecutor::index_casters`], good for any receivers, for as long as
/// neither light nor casters change. Where one caster changes, [`crate::WgpuExecutor::index_caster`] makes its part anew, and that
/// alone.
#[derive(Debug)]
pub struct CasterIndex {
    pub(crate) light: LatticeLight,
    pub(crate) casters: Vec<IndexedCaster>,
}

impl CasterIndex {
    /// The light it is made for.
    pub fn light(&self) -> &LatticeLight {
        &self.light
    }

    /// Casters.
    pub fn len(&self) -> usize {
        self.casters.len()
    }

    /// Whether there is no caster.
    pub fn is_empty(&self) -> bool {
        self.casters.is_empty()
    }
}

/// One caster's part.
#[derive(Debug)]
pub(crate) struct IndexedCaster {
    pub(crate) work: CasterWork,
    pub(crate) layers: Layers,
    /// But for the pass.
    pub(crate) params: CasterParams,
    pub(crate) occluders: Buffer,
    pub(crate) nodes: Buffer,
    pub(crate) surface: Buffer,
    /// Of all its vertices.
    pub(crate) bounds: [IVec3; 2],
    /// What the buffers are kept in.
    scratch: Scratch,
}

impl IndexedCaster {
    /// Indexes a caster, over what `scratch` holds.
    pub(crate) fn new(
        gpu: &Gpu,
        recorder: &mut Recorder,
        light: &LatticeLight,
        caster: &PackedCaster<'_>,
        mut scratch: Scratch,
        stages: &mut Vec<(&'static str, f64)>,
    ) -> Result<Self, GpuError> {
        checks::caster(caster)?;
        // A caster that does nothing to light has no triangle that matters.
        let triangles = if caster.work() == CasterWork::Nothing { &[] } else { caster.triangles };
        let facts = SceneFacts { triangles: triangles.len() as u32, work: Work::Index, ..SceneFacts::default() };
        let plan = Plan::new(facts);
        let (device, queue) = (&gpu.device, &gpu.queue);
        // No mask is made.
        let layout = mask_layout(&(*light).into(), u32::BITS, Precision::Exact, false, u32::MAX);
        let buffers = Buffers::fit(&mut scratch, device, &plan, &layout, caster.vertices.len() as u32)?;
        let surface = scratch.fit::<u32>(device, "surface", caster.surface.len() as u64)?;
        guarded(device, "uploads a caster", || {
            queue.write_buffer(&buffers.vertices, 0, bytemuck::cast_slice(caster.vertices));
            queue.write_buffer(&buffers.triangles, 0, bytemuck::cast_slice(triangles));
            queue.write_buffer(&surface, 0, bytemuck::cast_slice(caster.surface));
        })?;
        let (grid, bounds) = (LightGrid::new(*light), bounds(caster.vertices.iter()));
        let params = Params::new(&grid, &CodeFrame::around(&grid.frame, bounds), plan.levels());
        let params = CasterParams::new(params, caster);
        recorder.restart();
        let told = Told::Caster(Box::new(params));
        plan.run(&mut IndexStages { plan: &plan, layout, told, recorder, buffers: &buffers })?;
        submit(gpu, recorder, &[], stages)?;
        Ok(Self {
            work: caster.work(),
            layers: caster.layers,
            params,
            occluders: buffers.occluders,
            nodes: buffers.nodes,
            surface,
            bounds,
            scratch,
        })
    }

    /// What its buffers are kept in, for the next that takes its place.
    pub(crate) fn take_scratch(&mut self) -> Scratch {
        std::mem::take(&mut self.scratch)
    }
}

/// The stages that index a caster.
struct IndexStages<'a> {
    plan: &'a Plan,
    layout: MaskLayout,
    told: Told,
    recorder: &'a mut Recorder,
    buffers: &'a Buffers,
}

impl Executor for IndexStages<'_> {
    type Error = GpuError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), GpuError> {
        let Self { plan, layout, told, recorder, buffers } = self;
        recorder.set_stage(pass.stage.info().name);
        dispatches(plan, layout, pass, &mut |dispatch| {
            let bound: Vec<Resource> = dispatch.roles.iter().map(|role| buffers.of(*role)).collect();
            told.record(recorder, dispatch, &bound)
        })
    }
}
