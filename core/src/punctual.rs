//! Lights without extent: a point, or a direction. Their masks have one bit, and are exact: no texels, no bias.
//!
//! Seed: the alias-free shadow maps of Sintorn, Eisemann and Assarsson 2008, section 3: receivers stay where they lie, triangles
//! are cast onto them, and planes through the light and the edges decide. Departures: receivers and triangles meet in a
//! hierarchy, by the full-coverage test, not in texels; every sign is certified, and decided in integers where it is not; a
//! point light shines to all sides ([`crate::punctual_frame`]).
//!
//! **The rule** is that of `exact`, with the light in the place of the sample. A direction d is a point at infinity: triangle
//! (a, b, c) blocks it from p iff p lies off the triangle's plane, d points to its other side, and
//! `det(d, a − p, b − a)` and so on, oriented by p's side, are ≥ 0.
//!
//! Planes through a light without extent and an edge are the same for all receivers, so that they are made once a group.

use glam::IVec3;

use crate::{
    edge_plane::ReceiverTile,
    exact::{self, Wide, WideInt},
    lanes::Lanes,
    occluder::{Facing, Occluder},
    precision::PrecisionMode,
    side::Planes,
    snap::LIMIT,
    statistics::Tally,
    view::Offsets,
};
#[cfg(not(target_arch = "spirv"))]
use crate::{
    edge_plane::{cross_magnitudes, float},
    real::Real,
};

/// A light without extent, on the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(C)]
pub struct Punctual {
    /// Where it is; of a direction, the vector towards the light, of any length above zero.
    at: IVec3,
    is_point: bool,
}

impl Punctual {
    /// At a lattice point. `None` outside the lattice, whose coordinates lie strictly between -2^29 and 2^29.
    pub const fn point(at: IVec3) -> Option<Self> {
        let inside = is_within(at.x, LIMIT - 1) && is_within(at.y, LIMIT - 1) && is_within(at.z, LIMIT - 1);
        if inside { Some(Self::at_sample(at)) } else { None }
    }

    /// From infinitely far away: `towards` it. `None` where that is zero, or a component is beyond 2^29 in magnitude.
    pub const fn direction(towards: IVec3) -> Option<Self> {
        let somewhere = towards.x != 0 || towards.y != 0 || towards.z != 0;
        let inside = is_within(towards.x, LIMIT) && is_within(towards.y, LIMIT) && is_within(towards.z, LIMIT);
        if somewhere && inside { Some(Self::from_afar(towards)) } else { None }
    }

    /// From a direction that is known to be one.
    #[inline(always)]
    pub(crate) const fn from_afar(towards: IVec3) -> Self {
        Self { at: towards, is_point: false }
    }

    /// At a sample of a light, which is on the lattice.
    #[inline(always)]
    pub(crate) const fn at_sample(at: IVec3) -> Self {
        Self { at, is_point: true }
    }

    /// Where a point light is, lattice.
    #[inline(always)]
    pub const fn position(&self) -> Option<IVec3> {
        if self.is_point { Some(self.at) } else { None }
    }

    /// The vector towards a light that is infinitely far away.
    #[inline(always)]
    pub const fn towards(&self) -> Option<IVec3> {
        if self.is_point { None } else { Some(self.at) }
    }

    /// The light as seen from a point: a vector towards it.
    #[inline(always)]
    pub(crate) fn seen_from(&self, p: IVec3) -> IVec3 {
        if self.is_point { self.at - p } else { self.at }
    }

    /// The triangle, with its corners in such an order that the light lies on the positive side of its plane. `None` where it
    /// lies in it.
    #[inline]
    pub fn occluder(&self, corners: [IVec3; 3]) -> Option<Occluder> {
        let facing = match self.side(corners) {
            1 => Facing::Front,
            -1 => Facing::Back,
            _ => Facing::Nothing,
        };
        facing.occluder(corners)
    }

    /// The side of a triangle's plane that the light lies on.
    #[inline]
    fn side(&self, [a, b, c]: [IVec3; 3]) -> i32 {
        let (e, f, d) = (b - a, c - a, self.seen_from(a));
        #[cfg(not(target_arch = "spirv"))]
        {
            let side = <f64 as Real>::dot(&<f64 as Real>::cross(e, f), d);
            // Twice the error: for the bound's own arithmetic.
            let doubt = 2.0 * <f64 as Real>::SIDE_ERROR * cross_magnitudes(float(e), float(f)).dot(float(d).abs());
            if side.abs() > f64::from(doubt) {
                return if side > 0.0 { 1 } else { -1 };
            }
        }
        exact::dot::<Wide>(exact::cross(e, f), d).sign()
    }
}

const fn is_within(x: i32, most: i32) -> bool {
    -most <= x && x <= most
}

/// Whether the triangle blocks the light from p: the rule as it stands above.
pub fn blocks(light: Punctual, p: IVec3, triangle: [IVec3; 3]) -> bool {
    // Not in a loop: some drivers end loops after so many rounds.
    let ([a, b, c], side, toward) = (triangle, exact::far_side::<Wide>(p, triangle), light.seen_from(p));
    side != 0
        && light.side(triangle) == side
        && edge_side(p, a, b, toward) * side >= 0
        && edge_side(p, b, c, toward) * side >= 0
        && edge_side(p, c, a, toward) * side >= 0
}

/// The side of the plane through p and an edge on which the light lies, `toward` which p looks.
#[cfg_attr(not(target_arch = "spirv"), inline)]
#[cfg_attr(target_arch = "spirv", inline(never))]
fn edge_side(p: IVec3, from: IVec3, to: IVec3, toward: IVec3) -> i32 {
    exact::dot::<Wide>(exact::cross(from - p, to - from), toward).sign()
}

/// The planes through the light and the edges of a triangle that faces it, and the triangle's own: positive before what is in
/// the light's shadow.
#[inline(always)]
pub(crate) fn planes<L: Lanes, P: PrecisionMode>(light: Punctual, offsets: &Offsets, corners: [IVec3; 3]) -> Planes<4> {
    let (mut e, mut f, mut d) = ([[0; 4]; 3], [[0; 4]; 3], [[0; 4]; 3]);
    let [a, b, c] = [corners[0] - offsets.base, corners[1] - offsets.base, corners[2] - offsets.base];
    let to = light.seen_from(offsets.base);
    let (e_columns, f_columns, d_columns) = if light.is_point {
        ([a - to, b - to, c - to, b - a], [b - to, c - to, a - to, c - a], [to, to, to, a])
    } else {
        ([b - a, c - b, a - c, b - a], [to, to, to, c - a], [a, b, c, a])
    };
    let mut k = 0;
    while k < 4 {
        (e[0][k], e[1][k], e[2][k]) = (e_columns[k].x, e_columns[k].y, e_columns[k].z);
        (f[0][k], f[1][k], f[2][k]) = (f_columns[k].x, f_columns[k].y, f_columns[k].z);
        (d[0][k], d[1][k], d[2][k]) = (d_columns[k].x, d_columns[k].y, d_columns[k].z);
        k += 1;
    }
    Planes::spanned::<L, P>(offsets, &e, &f, &d)
}

/// Lanes of `kept` from which the triangle, which faces the light, blocks it. Where a float cannot tell, `blocks` does, of one
/// receiver.
#[inline(always)]
pub(crate) fn blocked<L: Lanes, P: PrecisionMode>(
    light: Punctual,
    offsets: &Offsets,
    receivers: &ReceiverTile,
    occluder: &Occluder,
    kept: u32,
    fallbacks: &mut Tally,
    blocks: impl Fn(IVec3) -> bool,
) -> u32 {
    let planes = planes::<L, P>(light, offsets, occluder.corners());
    let (mut inside, mut unsure) = (kept, 0);
    let mut k = 0;
    while k < 4 {
        let (positive, near) = planes.signs::<L, P>(offsets, k);
        inside &= positive | near;
        unsure |= near;
        k += 1;
    }
    unsure &= inside;
    if unsure == 0 { inside } else { settle(receivers, inside, unsure, fallbacks, blocks) }
}

/// Decides the lanes in `unsure`. Out of line: few come here.
#[inline(never)]
fn settle(
    receivers: &ReceiverTile,
    mut inside: u32,
    mut unsure: u32,
    fallbacks: &mut Tally,
    blocks: impl Fn(IVec3) -> bool,
) -> u32 {
    while unsure != 0 {
        let lane = unsure.trailing_zeros() as usize;
        unsure &= unsure - 1;
        *fallbacks += 1;
        if !blocks(receivers.point(lane)) {
            inside &= !(1 << lane);
        }
    }
    inside
}
