//! What every contender is given: the same occluders, light and receivers, on the lattice and in the world.

use thiserror::Error;
use umbra4::model::Model;
use umbra4_core::{
    Bounds, Lattice, LatticeError, LatticeLight, Lift, LightError, MaskWord,
    glam::{DVec3, Vec3},
};
use umbra4_cpu::{Receivers, SceneError};

use crate::{primary::Hit, scene::Scene};

/// Why a problem cannot be posed.
#[derive(Debug, Error)]
pub enum ProblemError {
    /// The scene does not fit a lattice.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The light does not fit the lattice.
    #[error(transparent)]
    Light(#[from] LightError),
    /// A receiver is refused.
    #[error(transparent)]
    Receivers(#[from] SceneError),
}

/// One set of receivers in one scene.
#[derive(Debug)]
pub struct Problem<'a> {
    /// The occluders, world.
    pub model: &'a Model,
    /// The lattice around the whole scene.
    pub lattice: Lattice,
    /// The light on the lattice.
    pub light: LatticeLight,
    /// The receivers on the lattice, lifted off their surfaces.
    pub receivers: Receivers,
    /// Normals of their surfaces, towards the eye.
    pub normals: Vec<Vec3>,
    /// The same receivers as a ray tracer takes them: the lifted lattice points, rounded to f32.
    pub origins: Vec<Vec3>,
    /// The same light samples as a ray tracer takes them, row by row.
    pub samples: Vec<Vec3>,
    /// `step_u × step_v`, of length one.
    pub light_normal: Vec3,
}

impl<'a> Problem<'a> {
    /// Poses the problem of shading `hits`. The lattice is fitted to `scene` and `all`, so that every subset has the same.
    ///
    /// # Errors
    /// A scene that no lattice holds; a light too fine for it.
    pub fn new(scene: &'a Scene, all: &[Hit], hits: &[Hit]) -> Result<Self, ProblemError> {
        let points = scene.model.vertices.iter().copied().chain(all.iter().map(|hit| hit.position));
        let bounds = Bounds::of(points.map(|p| p.as_dvec3()).chain(scene.light.corners()));
        let lattice = Lattice::covering(bounds)?;
        let light = scene.light.snap(&lattice, Lift::NONE)?;
        let positions: Vec<Vec3> = hits.iter().map(|hit| hit.position).collect();
        let normals: Vec<Vec3> = hits.iter().map(|hit| hit.normal).collect();
        let receivers = Receivers::on_surfaces(&lattice, &positions, &normals, Lift::F32_POSITIONS)?;
        let origins = receivers.points().iter().map(|&p| lattice.to_world(p).as_vec3()).collect();
        let samples = (0..light.rows)
            .flat_map(|row| (0..light.columns).map(move |column| (row, column)))
            .map(|(row, column)| lattice.to_world(light.sample(row, column)).as_vec3())
            .collect();
        let normal: DVec3 = light.step_u.as_dvec3().cross(light.step_v.as_dvec3());
        let light_normal = normal.normalize().as_vec3();
        Ok(Self { model: &scene.model, lattice, light, receivers, normals, origins, samples, light_normal })
    }

    /// Rows of a mask.
    pub fn rows(&self) -> usize {
        self.light.rows as usize
    }

    /// Whether a ray origin lies behind the light, where every sample counts as blocked and no ray is shot.
    #[inline]
    pub fn behind_light(&self, origin: Vec3) -> bool {
        self.light_normal.dot(origin - self.samples[0]) <= 0.0
    }

    /// Receivers behind the light.
    pub fn count_behind_light(&self) -> usize {
        self.origins.iter().filter(|&&origin| self.behind_light(origin)).count()
    }

    /// Calls `masks(origins, rows)` on blocks of receivers, on `threads` threads; `out` holds all masks' rows.
    pub fn for_blocks<W: MaskWord>(&self, threads: usize, out: &mut [W], masks: impl Fn(&[Vec3], &mut [W]) + Sync) {
        if threads <= 1 {
            return masks(&self.origins, out);
        }
        const BLOCK: usize = 256;
        let blocks = self.origins.chunks(BLOCK).zip(out.chunks_mut(BLOCK * self.rows()));
        let blocks = std::sync::Mutex::new(blocks);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    // The lock is held while a block is taken, not while it is worked on.
                    while let Some((origins, rows)) = blocks.lock().ok().and_then(|mut blocks| blocks.next()) {
                        masks(origins, rows);
                    }
                });
            }
        });
    }
}
