//! One switch for all techniques.

use umbra4_core::{LatticeLight, MaskWord};
use umbra4_maps::Technique;

use crate::{GpuError, LatticeReceivers, LatticeScene, Statistics, WgpuExecutor};

impl WgpuExecutor {
    /// The masks of all receivers, by the technique of choice.
    ///
    /// # Errors
    /// Those of [`WgpuExecutor::masks`], or of [`WgpuExecutor::microquad_masks`]; a technique that has no masks.
    pub fn masks_by<'a, W: MaskWord>(
        &self,
        technique: &Technique,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<W>, Statistics), GpuError> {
        match technique {
            Technique::Exact => self.masks(scene, light, receivers),
            Technique::Microquads(options) => self.microquad_masks(options, scene, light, receivers),
            Technique::Stochastic(_) => Err(GpuError::NoMasks),
        }
    }

    /// The fraction of the light that every receiver sees, by the technique of choice.
    ///
    /// # Errors
    /// Those of [`WgpuExecutor::visibility`], of [`WgpuExecutor::microquad_visibility`], or of
    /// [`WgpuExecutor::stochastic_shadows`].
    pub fn visibility_by<'a>(
        &self,
        technique: &Technique,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<f32>, Statistics), GpuError> {
        match technique {
            Technique::Exact => self.visibility(scene, light, receivers),
            Technique::Microquads(options) => self.microquad_visibility(options, scene, light, receivers),
            Technique::Stochastic(options) => {
                let shadows = self.stochastic_shadows(scene, light, receivers, options)?;
                Ok((shadows.visibility, shadows.statistics))
            }
        }
    }
}
