//! A light's run: the stages in each of its frames, one after the other.

use umbra4_core::{
    AnyLight, Facing, Plan, SceneFacts, cloud_table::TableSize, cloud_tiles::CloudTiles, glam::IVec3,
    kernel::dispatch::MaskLayout,
};

use crate::{
    GpuError, LatticeReceivers,
    recorder::Recorder,
    stages::{Buffers, Ends, Stages},
    told::Told,
};

/// What shines in a run.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RunLight<'a> {
    Any(AnyLight),
    /// Samples in the order of a mask's bits, and the size of the table that they are looked up in.
    Cloud(&'a CloudTiles<'a>, Option<TableSize>),
}

/// A light, and what is asked of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightRun<'a> {
    pub(crate) light: RunLight<'a>,
    /// Faces of a light without extent that are looked through: bit f is face f. At least one.
    pub(crate) faces: u32,
    pub(crate) facts: SceneFacts,
    pub(crate) layout: MaskLayout,
    /// Of all triangles and receivers, lattice.
    pub(crate) bounds: [IVec3; 2],
}

/// All faces of a light.
pub(crate) fn all_faces(light: &AnyLight) -> u32 {
    match light {
        AnyLight::Area(_) => 1,
        AnyLight::Punctual(light) => (1 << light.faces()) - 1,
    }
}

/// The faces of a light that have receivers: none where it reaches none.
pub(crate) fn faces_with(light: &AnyLight, receivers: &[IVec3]) -> u32 {
    match light {
        AnyLight::Area(light) => u32::from(light.reaches(receivers)),
        AnyLight::Punctual(light) => {
            receivers.iter().filter_map(|p| light.face_of(*p)).fold(0, |faces, face| faces | 1 << face)
        }
    }
}

/// Whether one of the receivers sees the light where nothing lies between.
pub(crate) fn meet(light: &AnyLight, receivers: LatticeReceivers<'_>) -> bool {
    let LatticeReceivers { points, facings, .. } = receivers;
    let facing = |index: usize| facings.get(index).copied().unwrap_or(Facing::UNKNOWN);
    points.iter().enumerate().any(|(index, p)| facing(index).sees(light, *p))
}

impl LightRun<'_> {
    /// Records the stages, between the given ends.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder,
        buffers: &Buffers,
        ends: &mut impl Ends,
    ) -> Result<(), GpuError> {
        let Self { light, faces, facts, layout, bounds } = self;
        let plan = Plan::new(*facts);
        let light = match light {
            RunLight::Any(AnyLight::Area(light)) => {
                let told = Told::area(light, *bounds, plan.levels());
                return Stages::new(&plan, *layout, told, recorder, buffers, ends).run();
            }
            RunLight::Cloud(cloud, table) => {
                let told = Told::cloud(cloud, *table, *bounds, plan.levels());
                return Stages::new(&plan, *layout, told, recorder, buffers, ends).run();
            }
            RunLight::Any(AnyLight::Punctual(light)) => light,
        };
        for face in (0..light.faces()).filter(|face| faces >> face & 1 == 1) {
            // Of the faces, the first brings what all look at, and after the last all masks are there.
            let (first, last) = (faces & ((1 << face) - 1) == 0, faces >> face == 1);
            let plan = Plan::new(SceneFacts {
                new_vertices: if first { facts.new_vertices } else { 0 },
                world_receivers: first && facts.world_receivers,
                visibility: last && facts.visibility,
                ..*facts
            });
            let told = Told::face(light, face, *bounds, plan.levels());
            Stages::new(&plan, *layout, told, recorder, buffers, ends).run()?;
        }
        ends.block(recorder, buffers, 0, facts.receivers)
    }
}
