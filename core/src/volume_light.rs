//! Lights that fill a volume, in the world, and how their samples are placed.
//!
//! Seed: Sintorn, Eisemann and Assarsson 2008, sections 4.1 and 4.2: spheres, ellipsoids, which are spheres of another space,
//! and samples anywhere. They do not say how samples are spread.
//!
//! **Spread.** A sphere that is equally bright from everywhere looks, from afar, like a disk of one brightness. So samples have
//! the density `1/√(1 − r²)` in the unit ball: along every line of sight, at the distance ρ from the middle,
//! `∫ dz/√(1 − ρ² − z²) = π`, whatever ρ. The part within r is `(2θ − sin 2θ)/π` where `r = sin θ`. Ellipsoids are the same
//! ball in other axes. A tube has, across, the density `1/√(1 − ρ²)` in the unit disk, which looks equally bright over its width; the
//! part within ρ is `1 − √(1 − ρ²)`. Points are of low discrepancy in all three dimensions together: one coordinate is
//! even, the two others are the additive sequence of the plastic number (Roberts 2018). None are random.

use glam::{DVec2, DVec3, IVec3};
use thiserror::Error;

use crate::{
    cloud::{Cloud, CloudError},
    lattice::{Lattice, SnapError},
};

/// The least extent of a light along some axis of the lattice, lattice units: below it samples would fall together.
pub const LEAST_EXTENT: f64 = 64.0;

/// Inverses of the plastic number and of its square.
const PLASTIC: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Why a light with a volume is refused.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum VolumeLightError {
    /// A coordinate is NaN or infinite.
    #[error("{field} is {value}: not finite")]
    NotFinite {
        /// "center", "from", "to", or one of the axes: `axes[0]` to `axes[2]`.
        field: &'static str,
        /// Its value.
        value: DVec3,
    },
    /// A radius is not a finite number above zero.
    #[error("radius is {value}, not a finite number above 0")]
    Radius {
        /// Its value.
        value: f64,
    },
    /// Both ends of a tube are in the same place: it has no axis.
    #[error("the tube begins and ends at {at}")]
    NoLength {
        /// Where both ends are.
        at: DVec3,
    },
    /// Samples would fall on too few lattice points.
    #[error(
        "the light is too small for the lattice: it is {extent:.1} lattice units across, at least {LEAST_EXTENT} are needed; \
         bounds of at most {largest_bounds:e} around the lattice origin would do"
    )]
    TooSmall {
        /// The longest side of the box around it, lattice units.
        extent: f64,
        /// Largest coordinate for which the lattice would be fine enough, world units.
        largest_bounds: f64,
    },
    /// A sample is not finite, or outside the lattice.
    #[error("sample {index}: {source}")]
    Sample {
        /// Index of the sample.
        index: usize,
        /// What is wrong with it.
        source: SnapError,
    },
    /// There is room for another number of samples than there are points.
    #[error("room for {room} samples, but there are {points} points")]
    Room {
        /// Samples there is room for.
        room: usize,
        /// Points given.
        points: usize,
    },
    /// There is room for no samples, or for too many.
    #[error(transparent)]
    Cloud(#[from] CloudError),
}

/// A ball that is equally bright from everywhere, world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereLight {
    /// Its middle.
    pub center: DVec3,
    /// Above 0.
    pub radius: f64,
}

/// An ellipsoid, world: the sphere `center + axes·x`, x in the unit ball. Axes need not be perpendicular. They may be parallel, or
/// zero, as long as one of them is long enough: with one axis zero it is an elliptic disk that shines to both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipsoidLight {
    /// Its middle.
    pub center: DVec3,
    /// From the middle to the surface.
    pub axes: [DVec3; 3],
}

/// A round tube with flat ends, world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubeLight {
    /// The middle of one end.
    pub from: DVec3,
    /// The middle of the other.
    pub to: DVec3,
    /// Above 0.
    pub radius: f64,
}

impl SphereLight {
    /// The samples on the lattice, as many as there is room for in `room`, whose contents are not looked at.
    ///
    /// # Errors
    /// A center or radius that is not finite, a radius that is not above 0; a sphere less than [`LEAST_EXTENT`] across; a sample
    /// outside the lattice; room for no samples, or for more than [`crate::cloud::MAX_CLOUD`].
    pub fn snap<S: AsRef<[IVec3]> + AsMut<[IVec3]>>(
        &self,
        lattice: &Lattice,
        room: S,
    ) -> Result<Cloud<S>, VolumeLightError> {
        check_radius(self.radius)?;
        EllipsoidLight { center: self.center, axes: DVec3::AXES.map(|axis| axis * self.radius) }.snap(lattice, room)
    }
}

impl EllipsoidLight {
    /// As [`SphereLight::snap`].
    ///
    /// # Errors
    /// As [`SphereLight::snap`]; an axis that is not finite.
    pub fn snap<S: AsRef<[IVec3]> + AsMut<[IVec3]>>(
        &self,
        lattice: &Lattice,
        room: S,
    ) -> Result<Cloud<S>, VolumeLightError> {
        let [a, b, c] = self.axes;
        check_finite([("center", self.center), ("axes[0]", a), ("axes[1]", b), ("axes[2]", c)])?;
        // Along a coordinate an ellipsoid reaches as far as its axes' coordinates are long, taken as a vector.
        let reach = |k: usize| 2.0 * DVec3::new(a[k], b[k], c[k]).length();
        check_extent(lattice, reach(0).max(reach(1)).max(reach(2)))?;
        fill(lattice, room, |even, first, second| {
            let x = in_ball(even, first, second);
            self.center + a * x.x + b * x.y + c * x.z
        })
    }
}

impl TubeLight {
    /// As [`SphereLight::snap`].
    ///
    /// # Errors
    /// Ends or a radius that are not finite, a radius that is not above 0; ends in the same place; a tube less than
    /// [`LEAST_EXTENT`] across and long; a sample outside the lattice; room for no samples, or for more than
    /// [`crate::cloud::MAX_CLOUD`].
    pub fn snap<S: AsRef<[IVec3]> + AsMut<[IVec3]>>(
        &self,
        lattice: &Lattice,
        room: S,
    ) -> Result<Cloud<S>, VolumeLightError> {
        check_radius(self.radius)?;
        check_finite([("from", self.from), ("to", self.to)])?;
        let along = self.to - self.from;
        let longest = along.abs().max_element();
        if longest == 0.0 {
            return Err(VolumeLightError::NoLength { at: self.from });
        }
        check_extent(lattice, longest.max(2.0 * self.radius))?;
        let [across, up] = perpendicular(along / longest).map(|axis| axis * self.radius);
        fill(lattice, room, |even, first, second| {
            let x = in_disk(first, second);
            self.from + along * even + across * x.x + up * x.y
        })
    }
}

/// Free points, world, as the samples of a light. `room` is as long as `points`; its contents are not looked at.
///
/// # Errors
/// Room for another number of samples; the first point that is not finite or outside the lattice; no points, or more than
/// [`crate::cloud::MAX_CLOUD`].
pub fn snap_points<S: AsRef<[IVec3]> + AsMut<[IVec3]>>(
    lattice: &Lattice,
    points: &[DVec3],
    mut room: S,
) -> Result<Cloud<S>, VolumeLightError> {
    if room.as_ref().len() != points.len() {
        return Err(VolumeLightError::Room { room: room.as_ref().len(), points: points.len() });
    }
    for (index, (place, point)) in room.as_mut().iter_mut().zip(points).enumerate() {
        *place = lattice.snap_f64(*point).map_err(|source| VolumeLightError::Sample { index, source })?;
    }
    Ok(Cloud::new(room)?)
}

fn check_radius(value: f64) -> Result<(), VolumeLightError> {
    if value.is_finite() && value > 0.0 { Ok(()) } else { Err(VolumeLightError::Radius { value }) }
}

fn check_finite<const N: usize>(fields: [(&'static str, DVec3); N]) -> Result<(), VolumeLightError> {
    match fields.into_iter().find(|(_, value)| !value.is_finite()) {
        Some((field, value)) => Err(VolumeLightError::NotFinite { field, value }),
        None => Ok(()),
    }
}

fn check_extent(lattice: &Lattice, extent: f64) -> Result<(), VolumeLightError> {
    let extent = extent / lattice.step();
    if extent < LEAST_EXTENT {
        let largest_bounds = lattice.reach_of_finer(LEAST_EXTENT / extent);
        return Err(VolumeLightError::TooSmall { extent, largest_bounds });
    }
    Ok(())
}

/// Fills the room with what `place` makes of an even coordinate and two of low discrepancy, all in `0.0..1.0`.
fn fill<S: AsRef<[IVec3]> + AsMut<[IVec3]>>(
    lattice: &Lattice,
    mut room: S,
    place: impl Fn(f64, f64, f64) -> DVec3,
) -> Result<Cloud<S>, VolumeLightError> {
    let count = room.as_ref().len();
    for (index, sample) in room.as_mut().iter_mut().enumerate() {
        let k = index as f64 + 0.5;
        let [first, second] = PLASTIC.map(|step| k * step - (k * step) as u32 as f64);
        let point = place(k / count as f64, first, second);
        *sample = lattice.snap_f64(point).map_err(|source| VolumeLightError::Sample { index, source })?;
    }
    Ok(Cloud::new(room)?)
}

/// A point of the unit ball: its height on the sphere, its turn, and which part of all points lie further in.
fn in_ball(height: f64, turn: f64, part: f64) -> DVec3 {
    let (mut low, mut high) = (0.0, core::f64::consts::FRAC_PI_2);
    // Halving the interval 53 times leaves nothing of it.
    for _ in 0..53 {
        let angle = 0.5 * (low + high);
        if 2.0 * angle - DVec2::from_angle(2.0 * angle).y < part * core::f64::consts::PI {
            low = angle;
        } else {
            high = angle;
        }
    }
    let (z, around) = (1.0 - 2.0 * height, DVec2::from_angle(core::f64::consts::TAU * turn));
    let aside = around * root(1.0 - z * z);
    DVec3::new(aside.x, aside.y, z) * DVec2::from_angle(low).y
}

/// A point of the unit disk: its turn, and which part of all points lie further in.
fn in_disk(turn: f64, part: f64) -> DVec2 {
    DVec2::from_angle(core::f64::consts::TAU * turn) * root(part * (2.0 - part))
}

fn root(x: f64) -> f64 {
    DVec2::splat(x).powf(0.5).x
}

/// Two axes of length 1, perpendicular to a direction of any length above 0 and to each other: the first lies in a plane of two
/// coordinates, so that no roundoff decides it.
fn perpendicular(direction: DVec3) -> [DVec3; 2] {
    let size = direction.abs();
    let least = if size.x <= size.y && size.x <= size.z {
        DVec3::X
    } else if size.y <= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let across = direction.cross(least).normalize_or_zero();
    [across, direction.cross(across).normalize_or_zero()]
}
