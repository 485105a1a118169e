//! Lights on the lattice, each named where it is refused.

use umbra4_core::{
    AreaLight, Lattice, LatticeLight, Lift, LightError, Punctual, PunctualLightError, VolumeLightError, cloud::Cloud,
    glam::IVec3,
};

use super::{HardLight, InLight, Light, VolumeSource};

/// Why a light cannot be put on the lattice.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(transparent)]
pub enum SnapLightError {
    /// A light with an area.
    Area(#[from] LightError),
    /// One without.
    Hard(#[from] PunctualLightError),
    /// One with a volume.
    Volume(#[from] VolumeLightError),
}

impl Light {
    /// One of its sides on the lattice.
    ///
    /// # Errors
    /// Samples too close to each other for the lattice, or outside it.
    pub fn snap_side(&self, side: &AreaLight, lattice: &Lattice) -> Result<LatticeLight, InLight<SnapLightError>> {
        side.snap(lattice, Lift::F32_POSITIONS).map_err(|e| InLight::at(&self.label)(e.into()))
    }

    /// Its point or direction on the lattice.
    ///
    /// # Errors
    /// A direction that points nowhere; a position outside the lattice.
    pub fn snap_hard(&self, hard: &HardLight, lattice: &Lattice) -> Result<Punctual, InLight<SnapLightError>> {
        hard.snap(lattice).map_err(|e| InLight::at(&self.label)(e.into()))
    }

    /// The samples of its volume on the lattice.
    ///
    /// # Errors
    /// A size that is no size; a light too small for the lattice; samples outside it.
    pub fn snap_volume(
        &self,
        volume: &VolumeSource,
        lattice: &Lattice,
    ) -> Result<Cloud<Vec<IVec3>>, InLight<SnapLightError>> {
        volume.snap(lattice).map_err(|e| InLight::at(&self.label)(e.into()))
    }
}
