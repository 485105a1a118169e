//! One switch for all techniques.

use umbra4_core::LatticeLight;
use umbra4_maps::{Technique, microquad::half_spaces::TableWord};

use crate::{CpuExecutor, CpuWord, ExecutorError, Masks, Occluders, Receivers, Statistics};

impl CpuExecutor {
    /// The masks of all receivers, by the technique of choice.
    ///
    /// # Errors
    /// Those of [`CpuExecutor::masks`], or of [`CpuExecutor::microquad_masks`]; a technique that has no masks.
    pub fn masks_by<W: CpuWord + TableWord>(
        &self,
        technique: &Technique,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Masks<W>, Statistics), ExecutorError> {
        match technique {
            Technique::Exact => self.masks(occluders, light, receivers),
            Technique::Microquads(options) => self.microquad_masks(options, occluders, light, receivers),
            Technique::Stochastic(_) => Err(ExecutorError::NoMasks),
        }
    }

    /// The fraction of the light that every receiver sees, by the technique of choice.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers, maps::{Technique, microquad::MicroquadOptions}};
    /// # use umbra4_core::{glam::{DVec3, Vec3}, AreaLight, Bounds, Lattice, Lift};
    /// # let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// # let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?;
    /// # let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// # let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// # let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
    /// # let light = light.snap(&lattice, Lift::NONE)?;
    /// for technique in [Technique::Exact, Technique::Microquads(MicroquadOptions::default())] {
    ///     let (visibility, _) = CpuExecutor::new().visibility_by(&technique, &occluders, &light, &receivers)?;
    ///     assert!(visibility[0] < 0.5 && visibility[1] == 1.0);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`CpuExecutor::visibility`], of [`CpuExecutor::microquad_visibility`], or of
    /// [`CpuExecutor::stochastic_shadows`].
    pub fn visibility_by(
        &self,
        technique: &Technique,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Statistics), ExecutorError> {
        match technique {
            Technique::Exact => self.visibility(occluders, light, receivers),
            Technique::Microquads(options) => self.microquad_visibility(options, occluders, light, receivers),
            Technique::Stochastic(options) => {
                let shadows = self.stochastic_shadows(occluders, light, receivers, options)?;
                Ok((shadows.visibility, shadows.statistics))
            }
        }
    }
}
