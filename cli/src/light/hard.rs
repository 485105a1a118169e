//! Lights without extent: they cast hard shadows.

use umbra4_core::{Bounds, DirectionalLight, Lattice, PointLight, Punctual, PunctualLightError, glam::DVec3};

/// A light that casts hard shadows, world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HardLight {
    /// Infinitely far away; the vector towards it.
    Sun(DVec3),
    /// A point that shines to all sides.
    Lamp(DVec3),
    /// A point that shines into a cone. The cone has a say in brightness only: shadows are those of the point.
    Spot(DVec3, Cone),
}

/// The cone of a spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Where it shines to, of length 1.
    axis: DVec3,
    /// Cosine of the angle at which the light has faded.
    outer: f64,
    /// One over the difference of cosines within which it fades.
    scale: f64,
}

/// Why a cone is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ConeError {
    /// The angles are not in order.
    #[error("cone from innerConeAngle {inner} to outerConeAngle {outer}: 0 ≤ inner < outer ≤ π/2 is called for")]
    Angles {
        /// Where the light begins to fade, radians.
        inner: f64,
        /// Where it has faded, radians.
        outer: f64,
    },
    /// The axis is zero or not finite.
    #[error("the axis of the cone is {0}: it points nowhere")]
    Axis(DVec3),
}

/// Least difference of cosines within which a cone fades, that of glTF's reference.
const LEAST_FADE: f64 = 0.001;

impl Cone {
    /// The cone around `axis` in which light fades between two angles from it, radians.
    ///
    /// # Errors
    /// Angles that are not in order; an axis that points nowhere.
    pub fn new(axis: DVec3, inner: f64, outer: f64) -> Result<Self, ConeError> {
        if !(inner >= 0.0 && inner < outer && outer <= std::f64::consts::FRAC_PI_2 + 1e-6) {
            return Err(ConeError::Angles { inner, outer });
        }
        let unit = axis.try_normalize().ok_or(ConeError::Axis(axis))?;
        Ok(Self { axis: unit, outer: outer.cos(), scale: 1.0 / (inner.cos() - outer.cos()).max(LEAST_FADE) })
    }

    /// How much of the light is left in a direction of length 1, `0.0..=1.0`.
    fn factor(&self, direction: DVec3) -> f64 {
        let fade = ((self.axis.dot(direction) - self.outer) * self.scale).clamp(0.0, 1.0);
        fade * fade
    }
}

impl HardLight {
    /// What the lattice has to hold of it.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::Sun(_) => None,
            Self::Lamp(position) | Self::Spot(position, _) => Some(Bounds::of([*position])),
        }
    }

    /// On the lattice.
    ///
    /// # Errors
    /// A direction that points nowhere; a position outside the lattice.
    pub fn snap(&self, lattice: &Lattice) -> Result<Punctual, PunctualLightError> {
        match self {
            Self::Sun(towards) => DirectionalLight { towards: *towards }.snap(),
            Self::Lamp(position) | Self::Spot(position, _) => PointLight { position: *position }.snap(lattice),
        }
    }

    /// The vector from a point towards it; of a sun, of any length.
    pub fn towards(&self, position: DVec3) -> DVec3 {
        match self {
            Self::Sun(towards) => *towards,
            Self::Lamp(lamp) | Self::Spot(lamp, _) => *lamp - position,
        }
    }

    /// Irradiance at an unoccluded point, up to the light's power.
    pub fn irradiance(&self, position: DVec3, normal: DVec3) -> f64 {
        let towards = self.towards(position);
        let unit = towards.normalize_or_zero();
        let (squared, cone) = match self {
            Self::Sun(_) => (1.0, 1.0),
            Self::Lamp(lamp) => (lamp.distance_squared(position), 1.0),
            Self::Spot(lamp, cone) => (lamp.distance_squared(position), cone.factor(-unit)),
        };
        normal.dot(unit).max(0.0) / squared.max(f64::MIN_POSITIVE) * cone
    }

    /// What it is, in a few words.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Sun(_) => "a direction, without extent",
            Self::Lamp(_) => "a point, without extent",
            Self::Spot(..) => "a spot, without extent",
        }
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

    #[test]
    fn a_spot_fades_between_its_angles() {
        let cone = Cone::new(-DVec3::Y, 0.2, 0.6).unwrap();
        let spot = HardLight::Spot(DVec3::new(0.0, 1.0, 0.0), cone);
        let at = |angle: f64| spot.irradiance(DVec3::new(angle.tan(), 0.0, 0.0), DVec3::Y);
        assert_eq!(at(0.0), 1.0);
        assert!(at(0.3) > at(0.5) && at(0.5) > 0.0 && at(0.7) == 0.0);
    }

    #[test]
    fn senseless_cones_are_refused() {
        for (inner, outer) in [(0.5, 0.5), (-0.1, 0.5), (0.1, 2.0), (f64::NAN, 1.0), (0.0, f64::NAN)] {
            assert!(matches!(Cone::new(DVec3::Y, inner, outer), Err(ConeError::Angles { .. })));
        }
        assert!(matches!(Cone::new(DVec3::ZERO, 0.0, 0.5), Err(ConeError::Axis(_))));
    }
}
