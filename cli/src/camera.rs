//! A pinhole camera.

use umbra4_core::glam::DVec3;

/// Why a camera is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// A coordinate is NaN or infinite.
    #[error("camera {field} is {value}, not finite")]
    NotFinite {
        /// "from" or "to".
        field: &'static str,
        /// Its value.
        value: DVec3,
    },
    /// The camera looks nowhere.
    #[error("the camera stands where it looks: from and to are both {0}")]
    NoDirection(DVec3),
    /// The field of view is no angle that a pinhole can have.
    #[error("the field of view is {0} degrees, outside 0.01..=179")]
    FieldOfView(f64),
}

/// A pinhole camera, upright: the world's up is +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    from: DVec3,
    forward: DVec3,
    /// Half the picture's height, at distance 1.
    up: DVec3,
    /// As long as `up`.
    right: DVec3,
}

impl Camera {
    /// A camera at `from` that looks at `to`; `fov` is the vertical angle of view in degrees.
    ///
    /// # Errors
    /// Points that are not finite or the same; an angle outside 0.01..=179.
    pub fn new(from: DVec3, to: DVec3, fov: f64) -> Result<Self, CameraError> {
        for (field, value) in [("from", from), ("to", to)] {
            if !value.is_finite() {
                return Err(CameraError::NotFinite { field, value });
            }
        }
        if !(0.01..=179.0).contains(&fov) {
            return Err(CameraError::FieldOfView(fov));
        }
        let forward = (to - from).try_normalize().ok_or(CameraError::NoDirection(from))?;
        let pole = if forward.y.abs() > 0.999 { DVec3::Z } else { DVec3::Y };
        let right = forward.cross(pole).normalize();
        let half = (fov.to_radians() * 0.5).tan();
        Ok(Self { from, forward, up: right.cross(forward) * half, right: right * half })
    }

    /// Where it stands, world.
    pub fn from(&self) -> DVec3 {
        self.from
    }

    /// The direction, of length 1, through the middle of pixel (`x`, `y`) of a picture; (0, 0) is its upper left.
    pub fn direction(&self, x: u32, y: u32, width: u32, height: u32) -> DVec3 {
        let (half_width, half_height) = (f64::from(width) * 0.5, f64::from(height) * 0.5);
        let across = (f64::from(x) + 0.5 - half_width) / half_height;
        let down = (f64::from(y) + 0.5 - half_height) / half_height;
        (self.forward + self.right * across - self.up * down).normalize()
    }
}

/// What a file says about the camera; what it leaves open is fitted to the model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Viewpoint {
    /// Where it stands, world.
    pub from: Option<DVec3>,
    /// What it looks at, world.
    pub to: Option<DVec3>,
    /// Vertical angle of view, degrees.
    pub fov: Option<f64>,
}

impl Viewpoint {
    /// Whether a camera can be what is said, whatever is left open.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn check(&self) -> Result<(), CameraError> {
        // Points that stand for those left open, and an angle that is always one.
        let (from, to) = self.from.zip(self.to).unwrap_or((DVec3::ZERO, DVec3::X));
        Camera::new(from, to, self.fov.unwrap_or(45.0)).map(|_| ())
    }

    /// This one, where `other` says nothing.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        // A place and a direction belong together.
        let (from, to) =
            if self.from.is_some() || self.to.is_some() { (self.from, self.to) } else { (other.from, other.to) };
        Self { from, to, fov: self.fov.or(other.fov) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_looks_forward_and_up_is_up() {
        let camera = Camera::new(DVec3::ZERO, DVec3::NEG_Z, 90.0).unwrap();
        assert!((camera.direction(1, 1, 3, 3) - DVec3::NEG_Z).length() < 1e-12);
        assert!(camera.direction(1, 0, 3, 3).y > 0.0);
        assert!(camera.direction(2, 1, 3, 3).x > 0.0);
    }

    #[test]
    fn senseless_cameras_are_refused() {
        assert!(matches!(Camera::new(DVec3::ONE, DVec3::ONE, 40.0), Err(CameraError::NoDirection(_))));
        assert!(matches!(Camera::new(DVec3::ONE, DVec3::ZERO, 180.0), Err(CameraError::FieldOfView(_))));
        assert!(matches!(Camera::new(DVec3::NAN, DVec3::ZERO, 40.0), Err(CameraError::NotFinite { .. })));
        assert!(Camera::new(DVec3::ONE, DVec3::ONE + DVec3::Y, 40.0).is_ok());
    }

    #[test]
    fn place_and_direction_come_from_one_viewpoint() {
        let file = Viewpoint { from: Some(DVec3::ONE), to: Some(DVec3::ZERO), fov: Some(30.0) };
        let wider = Viewpoint { fov: Some(60.0), ..Viewpoint::default() };
        assert_eq!(wider.or(file), Viewpoint { fov: Some(60.0), ..file });
        let elsewhere = Viewpoint { from: Some(DVec3::X), ..Viewpoint::default() };
        assert_eq!(elsewhere.or(file), Viewpoint { fov: Some(30.0), ..elsewhere });
    }
}
