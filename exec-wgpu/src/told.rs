//! What kernels are told of a light.

use umbra4_core::{
    LatticeLight, Punctual,
    cloud_table::TableSize,
    cloud_tiles::CloudTiles,
    edge_plane::LightGrid,
    glam::IVec3,
    hierarchy::Levels,
    jitter::Pattern,
    kernel::{ParamsKind, dispatch::Dispatch},
    order::{BoxCurve, CodeFrame},
    params::{CasterParams, CloudParams, JitteredParams, Params, PassParams, PunctualParams},
};

use crate::{
    GpuError,
    recorder::{Recorder, Resource},
};

/// The parameters of a light's kernels, but for the pass.
#[derive(Clone, Debug)]
pub(crate) enum Told {
    /// The pattern of jittered samples.
    Area {
        params: Params,
        pattern: Option<Box<Pattern>>,
    },
    Punctual(PunctualParams),
    Cloud(CloudParams),
    /// Of a caster before a light with an area.
    Caster(Box<CasterParams>),
}

impl Told {
    /// Of a light with an area. `bounds`: of all triangles and receivers, lattice. They decide the order of things, never a bit.
    pub(crate) fn area(light: &LatticeLight, bounds: [IVec3; 2], levels: &Levels) -> Self {
        let grid = LightGrid::new(*light);
        let params = Params::new(&grid, &CodeFrame::around(&grid.frame, bounds), levels);
        Self::Area { params, pattern: light.jitter.is_some().then(|| Box::new(Pattern::of(light))) }
    }

    /// Of a face of a light without extent.
    pub(crate) fn face(light: &Punctual, face: u32, bounds: [IVec3; 2], levels: &Levels) -> Self {
        let codes = CodeFrame::around(light.frame(face).light_frame(), bounds);
        Self::Punctual(PunctualParams::new(light, face, &codes, levels))
    }

    /// Of a cloud, and the size of its table. `bounds` as in [`Told::area`].
    pub(crate) fn cloud(cloud: &CloudTiles<'_>, table: Option<TableSize>, bounds: [IVec3; 2], levels: &Levels) -> Self {
        let params = CloudParams::new(cloud.extent(), cloud.len() as u32, &BoxCurve::through(bounds), levels);
        Self::Cloud(table.map_or(params, |size| params.with_table(size)))
    }

    /// What kernels are told that take nothing but a light.
    pub(crate) fn plain(&self, pass: &PassParams) -> Params {
        match self {
            Self::Area { params, .. } => params.with_pass(pass),
            Self::Punctual(params) => params.params.with_pass(pass),
            Self::Cloud(params) => params.params.with_pass(pass),
            Self::Caster(params) => params.params.with_pass(pass),
        }
    }

    /// Records a dispatch.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder,
        dispatch: &Dispatch<'_>,
        bound: &[Resource],
    ) -> Result<(), GpuError> {
        let Dispatch { kernel, pass, .. } = dispatch;
        let plain = self.plain(pass);
        match (self, kernel.info().params) {
            (Self::Punctual(params), ParamsKind::PunctualLight) => recorder.add(*kernel, params.with_pass(pass), bound),
            (Self::Cloud(params), ParamsKind::Cloud) => recorder.add(*kernel, params.with_pass(pass), bound),
            (Self::Caster(params), ParamsKind::Caster) => recorder.add(*kernel, params.with_pass(pass), bound),
            (Self::Area { pattern: Some(pattern), .. }, ParamsKind::JitteredLight) => {
                recorder.add(*kernel, JitteredParams { params: plain, pattern: **pattern }, bound)
            }
            _ => recorder.add(*kernel, plain, bound),
        }
    }
}
