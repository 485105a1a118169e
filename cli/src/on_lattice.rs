//! What is shown, on the lattice: occluders and receivers, for any number of lights.

use umbra4_core::{Bounds, Lattice, LatticeLight, Lift, glam::Vec3};
use umbra4_cpu::{Caster, Occluders, Receivers};

use crate::{
    casters,
    error::ProgramError,
    executor::Scene,
    light::Light,
    model::{Model, Parts},
    primary::GBuffer,
};

/// A model and what is seen of it, snapped once.
pub struct OnLattice {
    /// The lattice around the model and its lights.
    pub lattice: Lattice,
    /// The model.
    pub occluders: Occluders,
    /// The same as casters, where parts of it are cut out, let light through, or cast on some layers only.
    pub casters: Option<Vec<Caster>>,
    /// What is seen: the pixels that see something, lifted off their surfaces.
    pub receivers: Receivers,
}

impl OnLattice {
    /// The model and what is `seen` of it, on a lattice with room for `lights`.
    ///
    /// # Errors
    /// A world that no lattice holds; a point that cannot be snapped; parts that are no casters.
    pub fn new(model: &Model, parts: &Parts, seen: &GBuffer, lights: &[Light]) -> Result<Self, ProgramError> {
        let lattice = Lattice::covering(lights.iter().filter_map(Light::bounds).fold(model.bounds(), Bounds::union))?;
        let positions: Vec<Vec3> = seen.seen().map(|hit| hit.position).collect();
        let normals: Vec<Vec3> = seen.seen().map(|hit| hit.normal).collect();
        let occluders = Occluders::new(&lattice, &model.vertices, &model.triangles)?;
        let casters = casters::casters(model, parts, &lattice)?;
        let receivers = Receivers::on_surfaces(&lattice, &positions, &normals, Lift::F32_POSITIONS)?;
        let receivers = casters::on_layers(receivers, seen, parts)?;
        Ok(Self { lattice, occluders, casters, receivers })
    }

    /// All of it under one light.
    pub fn under<'a>(&'a self, light: &'a LatticeLight) -> Scene<'a> {
        (&self.occluders, light, &self.receivers)
    }
}
