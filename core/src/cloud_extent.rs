//! Where the samples of a cloud lie, all together: what a triangle and a receiver ask first.

use glam::{IVec3, Vec3};

use crate::{
    edge_plane::{cross_magnitudes, float},
    exact::{self, Wide, WideInt},
    occluder::{Facing, Occluder},
    real::Real,
    view::Offsets,
};
#[cfg(not(target_arch = "spirv"))]
use crate::{lanes::Lanes, shaft::around};

/// The float in which triangles are oriented.
#[cfg(not(target_arch = "spirv"))]
pub type Long = f64;
/// The float in which triangles are oriented.
#[cfg(target_arch = "spirv")]
pub type Long = f32;

/// The box around the samples of a cloud, and a ball around its middle that holds them too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudExtent {
    low: IVec3,
    high: IVec3,
    middle: IVec3,
    /// Half extents of the box, rounded to the nearest float: whoever compares with them has to count that.
    half: Vec3,
    radius: f32,
}

impl CloudExtent {
    /// Of a box on the lattice that holds all samples, none of which lies farther than `radius` from its middle
    /// ([`middle_of`]).
    #[inline(always)]
    pub fn new([low, high]: [IVec3; 2], radius: f32) -> Self {
        let middle = middle_of([low, high]);
        Self { low, high, middle, half: float(half_extents([low, high])), radius }
    }

    /// Of samples on the lattice.
    #[cfg(not(target_arch = "spirv"))]
    pub fn of(samples: &[IVec3]) -> Self {
        let bounds = around(samples);
        let middle = middle_of(bounds);
        let away = |sample: &IVec3| ((sample - middle).as_dvec3().length() as f32).next_up();
        Self::new(bounds, samples.iter().map(away).fold(0.0, Lanes::max))
    }

    /// Smallest and largest coordinates of the samples, lattice.
    #[inline(always)]
    pub fn bounds(&self) -> [IVec3; 2] {
        [self.low, self.high]
    }

    /// The middle of the box, from which samples are placed.
    #[inline(always)]
    pub fn middle(&self) -> IVec3 {
        self.middle
    }

    /// How far samples may lie from the middle, lattice units.
    #[inline(always)]
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// The half extents of the box.
    #[inline(always)]
    pub(crate) fn half(&self) -> Vec3 {
        self.half
    }

    /// The same, as they are.
    #[inline(always)]
    pub(crate) fn half_extents(&self) -> IVec3 {
        half_extents([self.low, self.high])
    }

    /// What planes are placed by: the middle, and how far samples may lie from it.
    #[inline(always)]
    pub(crate) fn offsets(&self) -> Offsets {
        Offsets::at_base(self.middle, self.half)
    }

    /// The triangle, with its corners in such an order that the samples lie on the positive side of its plane, unless that
    /// meets their box, or so nearly that `R` cannot tell. `None` where it blocks nothing.
    ///
    /// The plane's value `n·(x − a)` is least, and greatest, at two corners of the box, those where n says so. If a component of n
    /// has the wrong sign, its true value is no larger than the error that [`Real::SIDE_ERROR`] counts.
    #[inline(always)]
    pub fn occluder<R: Real>(&self, corners: [IVec3; 3]) -> Option<Occluder> {
        let [a, b, c] = corners;
        let (e, f, d) = (b - a, c - a, self.middle - a);
        let half = self.half_extents();
        let normal = R::cross(e, f);
        let spread = IVec3::new(along(normal[0], half.x), along(normal[1], half.y), along(normal[2], half.z));
        let (lowest, highest) = (R::dot(&normal, d - spread).to_f32(), R::dot(&normal, d + spread).to_f32());
        // Twice the error of the terms: for the bound's own arithmetic, and for rounding to f32.
        let size = cross_magnitudes(float(e), float(f)).dot(float(d).abs() + self.half);
        let doubt = 2.0 * R::SIDE_ERROR * size;
        let facing = if lowest > doubt {
            Facing::Front
        } else if highest < -doubt {
            Facing::Back
        } else if is_degenerate(e, f) {
            Facing::Nothing
        } else {
            Facing::Mixed
        };
        facing.occluder(corners)
    }
}

/// The middle of a box on the lattice, between its lowest and highest corners.
#[inline(always)]
pub fn middle_of([low, high]: [IVec3; 2]) -> IVec3 {
    let size = high - low;
    low + IVec3::new(size.x >> 1, size.y >> 1, size.z >> 1)
}

/// The half extents of a box around its middle.
#[inline(always)]
fn half_extents([low, high]: [IVec3; 2]) -> IVec3 {
    let middle = middle_of([low, high]);
    (high - middle).max(middle - low)
}

/// An extent in the direction of a component.
#[inline(always)]
fn along<R: Real>(component: R, extent: i32) -> i32 {
    if component.to_f32() < 0.0 { -extent } else { extent }
}

/// Whether two edges are parallel.
#[cfg_attr(not(target_arch = "spirv"), inline)]
#[cfg_attr(target_arch = "spirv", inline(never))]
fn is_degenerate(e: IVec3, f: IVec3) -> bool {
    let [x, y, z] = exact::cross::<Wide>(e, f).components();
    x.sign() == 0 && y.sign() == 0 && z.sign() == 0
}
