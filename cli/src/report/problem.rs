//! What every method is given: the same scene, receivers and light.

use umbra4_core::{AreaLight, Bounds, Jitter, Lattice, LatticeLight, Lift, LightError, glam::DVec3, glam::Vec3};
use umbra4_cpu::{Occluders, Receivers};

use crate::{
    error::ProgramError,
    light_file::LightShape,
    model::Parts,
    primary::{self, GBuffer},
    scene::Scene,
};

/// A scene, seen.
pub struct Problem {
    /// What is shown.
    pub scene: Scene,
    /// What the pixels see.
    pub seen: GBuffer,
    /// The lattice around the scene and its light.
    pub lattice: Lattice,
    /// Where the receivers lie, world: the pixels that see something, row by row.
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// Everything on the lattice.
pub struct Snapped {
    /// The occluders.
    pub occluders: Occluders,
    /// The light.
    pub light: LatticeLight,
    /// The receivers, lifted off their surfaces.
    pub receivers: Receivers,
}

impl Problem {
    /// The scene as a picture of `width` × `height` pixels sees it.
    ///
    /// # Errors
    /// A light without area; a world that no lattice holds.
    pub fn new(scene: Scene, width: u32, height: u32) -> Result<Self, ProgramError> {
        let corners = scene.light.sampled(1)?.corners();
        let lattice = Lattice::covering(scene.model.bounds().union(Bounds::of(corners)))?;
        // Every method knows opaque triangles, and no others.
        let seen = primary::visible_surfaces(&scene.model, &Parts::default(), &scene.camera, width, height);
        let positions = seen.seen().map(|hit| hit.position).collect();
        let normals = seen.seen().map(|hit| hit.normal).collect();
        Ok(Self { scene, seen, lattice, positions, normals })
    }

    /// Whether the finest lights that will be asked for can be snapped: a quarter with the most samples, and the whole with as
    /// many, jittered.
    ///
    /// # Errors
    /// It is too fine for the lattice.
    pub fn check_light(&self, samples: u32) -> Result<(), LightError> {
        let fits = |light: AreaLight| light.snap(&self.lattice, Lift::F32_POSITIONS).map(|_| ());
        quarters(&self.scene.light).iter().try_for_each(|quarter| fits(quarter.sampled(samples)?))?;
        fits(self.light(samples)?.with_jitter(Jitter::pattern(0)))
    }

    /// Number of receivers.
    pub fn receivers(&self) -> usize {
        self.positions.len()
    }

    /// The light with `samples` × `samples` samples.
    ///
    /// # Errors
    /// As [`AreaLight::new`].
    pub fn light(&self, samples: u32) -> Result<AreaLight, LightError> {
        self.scene.light.sampled(samples)
    }

    /// Occluders and receivers on the lattice, with `light`.
    ///
    /// # Errors
    /// A light too fine for the lattice; a point that cannot be snapped.
    pub fn snapped(&self, light: &AreaLight) -> Result<Snapped, ProgramError> {
        Ok(Snapped {
            light: light.snap(&self.lattice, Lift::F32_POSITIONS)?,
            occluders: self.occluders()?,
            receivers: self.on_lattice()?,
        })
    }

    /// The occluders on the lattice.
    ///
    /// # Errors
    /// A vertex that cannot be snapped.
    pub fn occluders(&self) -> Result<Occluders, ProgramError> {
        Ok(Occluders::new(&self.lattice, &self.scene.model.vertices, &self.scene.model.triangles)?)
    }

    /// The receivers on the lattice, lifted off their surfaces.
    ///
    /// # Errors
    /// A point that cannot be snapped.
    pub fn on_lattice(&self) -> Result<Receivers, ProgramError> {
        Ok(Receivers::on_surfaces(&self.lattice, &self.positions, &self.normals, Lift::F32_POSITIONS)?)
    }

    /// The same receivers, which face where their surfaces do.
    ///
    /// # Errors
    /// A normal that points nowhere.
    pub fn facing(&self, receivers: Receivers) -> Result<Receivers, ProgramError> {
        Ok(receivers.facing(&self.normals)?)
    }
}

/// The four quarters of a light. With `n` × `n` samples each, they have the samples of the whole with `2n` × `2n`.
pub fn quarters(light: &LightShape) -> [LightShape; 4] {
    let [corner, u, v] = [light.corner, light.edge_u, light.edge_v].map(DVec3::from_array);
    let (u, v) = (u * 0.5, v * 0.5);
    [corner, corner + u, corner + v, corner + u + v].map(|corner| LightShape {
        corner: corner.to_array(),
        edge_u: u.to_array(),
        edge_v: v.to_array(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_have_the_samples_of_the_whole() {
        let whole = LightShape { corner: [1.0, 2.0, 3.0], edge_u: [4.0, 0.0, 1.0], edge_v: [0.0, 8.0, 2.0] };
        let samples = |shape: &LightShape, n: u32| -> Vec<DVec3> {
            let [corner, u, v] = [shape.corner, shape.edge_u, shape.edge_v].map(DVec3::from_array);
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
            (0..n * n).map(|k| corner + u * at(k % n) + v * at(k / n)).collect()
        };
        let all = samples(&whole, 8);
        let parts: Vec<DVec3> = quarters(&whole).iter().flat_map(|quarter| samples(quarter, 4)).collect();
        assert_eq!(parts.len(), all.len());
        assert!(all.iter().all(|a| parts.iter().filter(|b| a.distance(**b) < 1e-12).count() == 1));
    }
}
