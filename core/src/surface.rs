//! Self-shadowing, settled at the door: a receiver that lies on a surface is moved a few integer steps off it, along the
//! dominant axis of the surface's normal. No slider: the number of steps follows from how the position was rounded.

use glam::{IVec3, Vec3};

use crate::{exact::WideInt, snap::is_finite};

/// A number of lattice steps by which a receiver, or a light, is lifted off the surface that it lies on.
///
/// Derivation. Let q be the true surface point and p the one that was stored. Along the dominant axis of the normal n
/// the distance of p from the plane is at most `Σ|n_i|/|n_dom| ≤ 3` times the largest error of a coordinate. On the
/// lattice a coordinate below 2^29 comes from an f32 with a half-ulp of at most 2^4 lattice units, so a correctly
/// rounded f32 position is at most `3·16` steps off. Snapping adds ½ step per coordinate to the receiver, and as much
/// to the vertices (whose error inside the triangle is a convex combination of theirs): `3·½ + 3·½`. One more step
/// makes the side strict. A coplanar neighbour obeys the same bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lift(i32);

impl Lift {
    /// Nothing is moved: raw receivers, taken as they are.
    pub const NONE: Self = Self(0);

    /// Positions that are exact before the snap, as f64 input is for any practical purpose.
    pub const EXACT_POSITIONS: Self = Self(3 + 1);

    /// Positions rounded once to f32.
    pub const F32_POSITIONS: Self = Self(3 * 16 + 3 + 1);

    /// Positions whose coordinates are off by up to `ulps` units in the last place of f32 (in `1..=8`), as those that a
    /// G-buffer pass interpolates or unprojects. `None` outside that range.
    pub const fn f32_positions_off_by(ulps: u32) -> Option<Self> {
        if ulps >= 1 && ulps <= 8 { Some(Self(3 * 32 * ulps as i32 + 3 + 1)) } else { None }
    }

    /// Positions whose coordinates are off by up to `error` lattice units, in `0.0..2^26`. (The error's own bound has more to
    /// spare than the product rounds away.)
    #[inline]
    pub(crate) fn off_by(error: f32) -> Self {
        Self((3.0 * error) as i32 + 1 + 3 + 1)
    }

    /// A lift that also makes up for `error` lattice units a coordinate, from other roundings; none stays none.
    #[cfg(not(target_arch = "spirv"))]
    pub(crate) fn with_error(self, error: f64) -> Self {
        if self == Self::NONE { self } else { Self(self.0 + 3 * (error as i32 + 1)) }
    }

    /// Lattice steps.
    pub const fn steps(self) -> i32 {
        self.0
    }
}

/// The axis (0, 1, 2) of the largest component of an exact normal, and the sign of that component.
pub fn dominant_axis<W: WideInt>(normal: &[W; 3]) -> (usize, i32) {
    let magnitude = |n: W| if n.sign() < 0 { W::ZERO.minus(n) } else { n };
    let exceeds = |a: W, b: W| magnitude(a).minus(magnitude(b)).sign() > 0;
    let [x, y, z] = *normal;
    let (axis, value) = if exceeds(y, x) { (1, y) } else { (0, x) };
    let (axis, value) = if exceeds(z, value) { (2, z) } else { (axis, value) };
    (axis, value.sign())
}

/// As [`dominant_axis`], for a float normal that need not be normalised; the sign is 0 for a zero or NaN normal.
#[inline]
pub fn dominant_axis_f32(normal: Vec3) -> (usize, i32) {
    let (axis, value) = if normal.y.abs() > normal.x.abs() { (1, normal.y) } else { (0, normal.x) };
    let (axis, value) = if normal.z.abs() > value.abs() { (2, normal.z) } else { (axis, value) };
    (axis, (value > 0.0) as i32 - (value < 0.0) as i32)
}

/// Which way a receiver is lifted: an axis, and a sign; 0 where that is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Upwards {
    /// 0, 1 or 2.
    pub axis: usize,
    /// −1, 0 or 1.
    pub sign: i32,
}

/// By a float normal, which need not be normalised; unknown where that is zero or not finite.
#[inline]
pub fn by_normal(normal: Vec3) -> Upwards {
    let (axis, sign) = dominant_axis_f32(normal);
    let finite = is_finite(normal.x) && is_finite(normal.y) && is_finite(normal.z);
    Upwards { axis, sign: if finite { sign } else { 0 } }
}

/// Moves `point` by `steps` along `axis`.
#[inline]
pub fn lift(point: IVec3, axis: usize, steps: i32) -> IVec3 {
    match axis {
        0 => point + IVec3::new(steps, 0, 0),
        1 => point + IVec3::new(0, steps, 0),
        _ => point + IVec3::new(0, 0, steps),
    }
}
