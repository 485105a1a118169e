//! `--sun` and `--lamp`: lights without extent.

use umbra4_core::{Bounds, DirectionalLight, Lattice, PointLight, Punctual, PunctualLightError, glam::DVec3};

/// A light that casts hard shadows, world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HardLight {
    /// Infinitely far away; the vector towards it.
    Sun(DVec3),
    /// A point that shines to all sides.
    Lamp(DVec3),
}

impl HardLight {
    /// What the lattice has to hold of it.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::Sun(_) => None,
            Self::Lamp(position) => Some(Bounds::of([*position])),
        }
    }

    /// On the lattice.
    ///
    /// # Errors
    /// A direction that points nowhere; a position outside the lattice.
    pub fn snap(&self, lattice: &Lattice) -> Result<Punctual, PunctualLightError> {
        match self {
            Self::Sun(towards) => DirectionalLight { towards: *towards }.snap(),
            Self::Lamp(position) => PointLight { position: *position }.snap(lattice),
        }
    }

    /// Irradiance at an unoccluded point, up to the light's power.
    pub fn irradiance(&self, position: DVec3, normal: DVec3) -> f64 {
        let (towards, squared) = match self {
            Self::Sun(towards) => (*towards, 1.0),
            Self::Lamp(lamp) => (*lamp - position, lamp.distance_squared(position)),
        };
        normal.dot(towards.normalize_or_zero()).max(0.0) / squared.max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn irradiance_falls_with_distance_and_angle() {
        let lamp = HardLight::Lamp(DVec3::new(0.0, 2.0, 0.0));
        assert_eq!(lamp.irradiance(DVec3::ZERO, DVec3::Y), 0.25);
        assert_eq!(lamp.irradiance(DVec3::ZERO, -DVec3::Y), 0.0);
        let sun = HardLight::Sun(DVec3::new(0.0, 3.0, 4.0));
        assert!((sun.irradiance(DVec3::splat(9.0), DVec3::Y) - 0.6).abs() < 1e-12);
    }
}
