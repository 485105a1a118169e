//! Irradiance from masks: each is summed over as soon as it is done ([`umbra4_core::irradiance`]).

use rayon::prelude::*;
use umbra4_core::{
    LatticeLight, MaskWord,
    emission::{Emission, Weight},
    glam::{IVec3, Vec3},
    irradiance::{Lambertian, PackedSample, of_rows, samples, unit, unshadowed},
};

use crate::{
    CpuExecutor, ExecutorError, Occluders, Receivers, SceneError, Statistics, executor::Answer, reduction::Reduction,
};

/// What irradiance is summed up of.
struct Irradiance<'a> {
    light: LatticeLight,
    samples: Vec<PackedSample>,
    points: &'a [IVec3],
    /// Of length 1.
    normals: Vec<Vec3>,
}

impl<'a> Irradiance<'a> {
    fn new<S: AsRef<[Weight]> + Sync>(
        light: &LatticeLight,
        receivers: &'a Receivers,
        normals: &[Vec3],
        emission: &Emission<S>,
    ) -> Result<Self, ExecutorError> {
        CpuExecutor::check_emission(light, emission)?;
        if normals.len() != receivers.len() {
            return Err(SceneError::NormalCount { count: normals.len(), receivers: receivers.len() }.into());
        }
        let units: Vec<Option<Vec3>> = normals.par_iter().map(|normal| unit(*normal)).collect();
        if let Some((index, normal)) = normals.iter().enumerate().find(|(index, _)| units[*index].is_none()) {
            return Err(SceneError::Normal { index, normal: *normal }.into());
        }
        let normals = units.into_iter().flatten().collect();
        let samples = samples(light, emission).collect();
        Ok(Self { light: *light, samples, points: receivers.points(), normals })
    }

    fn receiver(&self, index: usize) -> Lambertian {
        Lambertian::new(&self.light, self.points[index], self.normals[index])
    }
}

impl Reduction for Irradiance<'_> {
    type Value = [f32; 3];

    fn of<W: MaskWord>(&self, answer: &Answer<'_, W>) -> [f32; 3] {
        of_rows(&self.receiver(answer.receiver), &self.samples, self.light.columns, answer.rows)
    }
}

impl CpuExecutor {
    /// The irradiance of every receiver, red, green and blue: of a Lambertian surface with the given normal (of any length), from
    /// the samples that it sees, each with its own cosines and distance. The unit is that of a radiance which is 1 where a sample's
    /// weight is [`WHOLE`](umbra4_core::emission::WHOLE); see [`umbra4_core::irradiance`] for the formula and its error. Masks are
    /// never stored.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
    /// use umbra4_core::{AreaLight, Bounds, Lattice, Lift, emission::{Emission, WHOLE}, glam::{DVec3, Vec3}};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-64.0), max: DVec3::splat(64.0) })?;
    /// let sky = AreaLight::new(DVec3::new(-50.0, 0.0, -50.0), DVec3::X * 100.0, DVec3::Z * 100.0, 64, 64)?;
    /// let sky = sky.snap(&lattice, Lift::NONE)?;
    /// let emission = Emission::new(64, 64, vec![[WHOLE, WHOLE / 2, 0]; 64 * 64])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::new(0.0, -50.0, 0.0)])?;
    ///
    /// let executor = CpuExecutor::new();
    /// let (lit, _) = executor.irradiance(&Occluders::default(), &sky, &receivers, &[Vec3::Y], &emission)?;
    /// let [red, green, blue] = lit[0];
    /// // A square twice as wide as it is high above: its form factor is known.
    /// assert!((red / std::f32::consts::PI - 0.5541).abs() < 0.001 && blue == 0.0, "{red}");
    /// assert!((green / red - 0.5).abs() < 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// An emission of another number of rows or columns than the light's; another number of normals than receivers; the first normal
    /// that is zero or not finite.
    pub fn irradiance<S: AsRef<[Weight]> + Sync>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        normals: &[Vec3],
        emission: &Emission<S>,
    ) -> Result<(Vec<[f32; 3]>, Statistics), ExecutorError> {
        let irradiance = Irradiance::new(light, receivers, normals, emission)?;
        self.per_receiver(occluders, light, receivers, irradiance)
    }

    /// The same where nothing lies between. Times the fraction of a receiver's samples that is lit, it is the usual
    /// approximation of [`CpuExecutor::irradiance`].
    ///
    /// # Errors
    /// As [`CpuExecutor::irradiance`].
    pub fn unshadowed_irradiance<S: AsRef<[Weight]> + Sync>(
        &self,
        light: &LatticeLight,
        receivers: &Receivers,
        normals: &[Vec3],
        emission: &Emission<S>,
    ) -> Result<Vec<[f32; 3]>, ExecutorError> {
        let irradiance = Irradiance::new(light, receivers, normals, emission)?;
        let of = |index| unshadowed(&irradiance.receiver(index), &irradiance.samples, light.columns);
        Ok(self.install(|| (0..receivers.len()).into_par_iter().map(of).collect()))
    }
}
