//! World → lattice: the only rounding in the program.
//!
//! World coordinates are multiplied by a power of two, `2^k`, and rounded once to integers below `2^29`. Everything
//! that decides a bit is computed from those integers, so that it has one true answer on every processor.
//! Kernels round as [`crate::snap`] does; [`Lattice`] rounds alike, from f64, and says what it refuses.

use glam::{DVec3, IVec3, Vec3};
use thiserror::Error;

use crate::snap::{LIMIT, SnapParams};

/// Room left between the given bounds and [`LIMIT`] for the surface lift and the rounding of lights, in lattice units.
const MARGIN: f64 = 1024.0;

/// Exponents of the lattice step for which the snap is exact on every processor.
const EXPONENTS: core::ops::RangeInclusive<i32> = -98..=100;

/// An axis-aligned box in world space. Both ends are included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The box that holds nothing; the neutral element of [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box around the finite ones of `points`; the others are reported, by index, when they are snapped.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut bounds = Self::EMPTY;
        for p in points {
            if p.is_finite() {
                bounds = bounds.union(Self { min: p, max: p });
            }
        }
        bounds
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The middle of the box.
    pub fn center(self) -> DVec3 {
        (self.min + self.max) * 0.5
    }
}

/// Why a lattice cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LatticeError {
    /// The bounds hold nothing (`min > max`), as those of an empty model do.
    #[error("the bounds are empty on the {axis} axis: min {min}, max {max}")]
    Empty {
        /// The axis: 'x', 'y' or 'z'.
        axis: char,
        /// Lower end given.
        min: f64,
        /// Upper end given.
        max: f64,
    },
    /// A coordinate of the bounds, or of the origin, is NaN or infinite.
    #[error("{field} is {value}, not a finite number")]
    NotFinite {
        /// Which coordinate.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// The largest coordinate is beyond what a lattice with a normal step can hold.
    #[error("the largest coordinate, {value:e}, is beyond what the lattice can hold (about 1.7e38)")]
    TooLarge {
        /// Largest distance from the lattice origin along one axis.
        value: f64,
    },
}

/// Why a point cannot be snapped.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SnapError {
    /// A coordinate is NaN or infinite.
    #[error("coordinate {axis} is {value}, not a finite number")]
    NotFinite {
        /// The axis: 'x', 'y' or 'z'.
        axis: char,
        /// Its value.
        value: f64,
    },
    /// A coordinate lies outside the bounds that the lattice covers.
    #[error("coordinate {axis} is {value}, outside the lattice, which reaches from {min} to {max}")]
    OutOfRange {
        /// The axis: 'x', 'y' or 'z'.
        axis: char,
        /// Its value.
        value: f64,
        /// Lower end of the lattice on that axis.
        min: f64,
        /// Upper end of the lattice on that axis.
        max: f64,
    },
}

const AXES: [char; 3] = ['x', 'y', 'z'];

/// The grid of step `2^-k` that the whole world is rounded to.
///
/// ```
/// use umbra4_core::{glam::{DVec3, Vec3}, Bounds, Lattice};
/// let bounds = Bounds { min: DVec3::splat(-10.0), max: DVec3::splat(10.0) };
/// let lattice = Lattice::covering(bounds).unwrap();
/// assert_eq!(lattice.exponent(), 25); // 10 · 2^25 is the largest below 2^29
/// let p = lattice.snap(Vec3::new(1.0, 2.5, -3.0)).unwrap();
/// assert_eq!(lattice.to_world(p), DVec3::new(1.0, 2.5, -3.0)); // short fractions are kept as they are
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    origin: DVec3,
    exponent: i32,
}

impl Lattice {
    /// The finest lattice around the world's origin that holds `bounds`: of the scene, the lights and their motion.
    ///
    /// # Errors
    /// Empty or non-finite bounds; a coordinate of about 1.7e38 or more.
    pub fn covering(bounds: Bounds) -> Result<Self, LatticeError> {
        Self::covering_about(bounds, DVec3::ZERO)
    }

    /// The finest lattice around `origin` that holds `bounds`: for worlds far from zero, given as f64 (or relative to
    /// the camera). A point `p` is snapped as `p − origin`, a difference that f64 holds to 2^-53 of its size.
    ///
    /// # Errors
    /// As [`Lattice::covering`], and a non-finite origin.
    pub fn covering_about(bounds: Bounds, origin: DVec3) -> Result<Self, LatticeError> {
        const FIELDS: [[&str; 3]; 3] = [
            ["bounds.min.x", "bounds.min.y", "bounds.min.z"],
            ["bounds.max.x", "bounds.max.y", "bounds.max.z"],
            ["origin.x", "origin.y", "origin.z"],
        ];
        let (min, max, origins) = (bounds.min.to_array(), bounds.max.to_array(), origin.to_array());
        let mut largest = 0.0_f64;
        for (axis, name) in AXES.iter().enumerate() {
            if min[axis] > max[axis] {
                return Err(LatticeError::Empty { axis: *name, min: min[axis], max: max[axis] });
            }
            for (fields, value) in FIELDS.iter().zip([min[axis], max[axis], origins[axis]]) {
                if !value.is_finite() {
                    return Err(LatticeError::NotFinite { field: fields[axis], value });
                }
            }
            largest = largest.max((min[axis] - origins[axis]).abs()).max((max[axis] - origins[axis]).abs());
        }
        let room = f64::from(LIMIT) - MARGIN;
        let mut exponent = *EXPONENTS.end();
        while largest * power_of_two(exponent) > room {
            exponent -= 1;
            if exponent < *EXPONENTS.start() {
                return Err(LatticeError::TooLarge { value: largest });
            }
        }
        Ok(Self { origin, exponent })
    }

    /// `k`: the step of the lattice is `2^-k` world units.
    pub fn exponent(&self) -> i32 {
        self.exponent
    }

    /// The largest distance from the origin that a lattice with steps at least `factor` times finer can cover, world units.
    pub(crate) fn reach_of_finer(&self, factor: f64) -> f64 {
        let mut reach = (f64::from(LIMIT) - MARGIN) * self.step();
        let mut finer = 1.0;
        while finer < factor && reach > 0.0 {
            finer *= 2.0;
            reach *= 0.5;
        }
        reach
    }

    /// World units per lattice unit.
    pub fn step(&self) -> f64 {
        power_of_two(-self.exponent)
    }

    /// The world point that has lattice coordinates zero.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The parameters of the snap stage, for executors that snap on their own device.
    ///
    /// None when the lattice has an origin other than zero: such worlds are snapped from f64, on the host.
    pub fn snap_params(&self) -> Option<SnapParams> {
        (self.origin == DVec3::ZERO).then(|| SnapParams { scale: power_of_two(self.exponent) as f32 })
    }

    /// Rounds a world point to the lattice, halves away from zero.
    ///
    /// # Errors
    /// A coordinate that is not finite, or outside the lattice. Nothing is clamped.
    pub fn snap(&self, point: Vec3) -> Result<IVec3, SnapError> {
        self.snap_f64(point.as_dvec3())
    }

    /// Rounds a world point given in f64 to the lattice. Equal to [`Lattice::snap`] on values that f32 holds.
    ///
    /// # Errors
    /// As [`Lattice::snap`].
    pub fn snap_f64(&self, point: DVec3) -> Result<IVec3, SnapError> {
        let mut out = [0_i32; 3];
        for (axis, name) in AXES.iter().enumerate() {
            let (value, origin) = (point.to_array()[axis], self.origin.to_array()[axis]);
            if !value.is_finite() {
                return Err(SnapError::NotFinite { axis: *name, value });
            }
            let scaled = (value - origin) * power_of_two(self.exponent);
            if scaled.abs() >= f64::from(LIMIT) - 0.5 {
                let reach = f64::from(LIMIT) * self.step();
                let (min, max) = (origin - reach, origin + reach);
                return Err(SnapError::OutOfRange { axis: *name, value, min, max });
            }
            out[axis] = round_f64(scaled);
        }
        Ok(IVec3::from_array(out))
    }

    /// The world point of a lattice point, exactly (up to the rounding of the origin's sum).
    pub fn to_world(&self, point: IVec3) -> DVec3 {
        self.origin + point.as_dvec3() * self.step()
    }
}

/// Rounds to the nearest integer, halves away from zero. `|x| < 2^31 − 1`.
pub(crate) fn round_f64(x: f64) -> i32 {
    let t = x as i32;
    let rest = x - f64::from(t);
    if rest >= 0.5 {
        t + 1
    } else if rest <= -0.5 {
        t - 1
    } else {
        t
    }
}

/// `2^k` for k in −1022..=1023.
pub(crate) fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((1023 + k) as u64) << 52)
}
