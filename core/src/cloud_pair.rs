//! A triangle and sixteen receivers before a cloud: from which of them it may block anything, and by which planes.
//!
//! The planes are those of [`crate::exact`]: through the receiver and each edge, and the triangle's own. A plane that has the
//! cloud's whole box on its outer side ends the pair; one that has it on its inner side cuts nothing.
//!
//! # Error bound
//! For receiver p, edge a → b and a sample s the sign sought is that of `n·(s − p)`, `n = (a − p) × (b − a)`. Over the box
//! around the samples, with middle m and half extents h, it ranges over `n·(m − p) ± |n|·h`. The first term is under
//! at most eight relative errors ε, as in [`crate::edge_plane`]: three conversions, two products, a difference, two sums. The
//! second is under four of the normal, one of h, and three of its products and sums: eight too. Adding the two takes one
//! more. All are relative to the permanent `P = (|a − p| ⊗ |b − a|)·(|m − p| + r)`, ⊗ the cross product with sums in the
//! place of differences, and r as below, no less than any of h. Twelve ε·P are allowed: three for second-order terms and the
//! bound's own arithmetic.
//!
//! Samples lie no farther than r from m, too, which says more of a sphere: n·(s − p) has the sign of `v = n·(m − p)` where
//! `|v| > |n|·r`. Of `|v| − 12ε·P`, which is no larger than the true |v| less the four ε of the normal, the square is compared with
//! that of `|n|·r`, in which another ten roundoffs are covered by a factor of `1 + 16ε`. So that no square overflows,
//! all is multiplied by 2^-60, exactly: v² stays below 2^67, and |n|², unless it is zero, above 2^-121.

use glam::IVec3;

#[cfg(not(target_arch = "spirv"))]
use crate::{cloud::CloudMask, statistics::Tally};
use crate::{
    cloud_extent::CloudExtent,
    edge_plane::{ReceiverTile, cross_magnitudes, cross_scalar, dot, dot_scalar, float, towards, turned},
    lanes::{Lanes, TILE},
    occluder::Occluder,
    precision::PrecisionMode,
    side::{Planes, Sides},
    view::Offsets,
};

/// Roundoffs allowed for, relative to P.
const ERRORS: f32 = 12.0;

/// Keeps squares of normals within the range of a float.
const SCALE: f32 = 1.0 / (1_u64 << 60) as f32;

/// The place of the triangle's own plane among those of a pair; the edges' come before.
pub(crate) const OWN_PLANE: usize = 3;

/// A receiver, and a triangle that may block some samples from it.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// The receiver, lattice.
    pub receiver: IVec3,
    /// The triangle's corners, in the order of its [`Occluder`].
    pub corners: [IVec3; 3],
    /// Whether the receiver lies on the negative side: the normal points towards it.
    pub flipped: bool,
    /// Bit k: plane k may cut the samples. Edges are 0, 1 and 2; bit 3 is the triangle's own.
    pub cuts: u32,
}

/// Which samples a triangle blocks from a receiver: what differs between the exact answer and that of a table.
#[cfg(not(target_arch = "spirv"))]
pub trait SampleTest: Sync {
    /// Adds what the pair blocks to a mask, and returns how many samples that are. `N` is 4 where the triangle's own plane
    /// may cut, else 3. Adds the signs decided in integers to `fallbacks`.
    fn mark<L: Lanes, P: PrecisionMode, const N: usize>(
        &self,
        pair: &Pair,
        mask: &mut CloudMask,
        fallbacks: &mut Tally,
    ) -> u32;
}

impl Pair {
    /// Of all four planes, two vectors along each, of which the cross product points outwards, and a point of it.
    #[inline(always)]
    pub(crate) fn spans(&self) -> [[IVec3; 4]; 3] {
        let [a, b, c] = self.corners;
        let p = self.receiver;
        let (along, across) = ([b - a, c - b, a - c, c - a], [a - p, b - p, c - p, b - a]);
        let (first, second) = if self.flipped { (across, along) } else { (along, across) };
        [first, second, [a, b, c, a]]
    }

    /// The first `N` planes, placed from the base of `offsets`: positive where samples are blocked.
    #[inline(always)]
    pub(crate) fn planes<L: Lanes, P: PrecisionMode, const N: usize>(&self, offsets: &Offsets) -> Planes<N> {
        let [first, second, through] = self.spans();
        let (mut e, mut f, mut d) = ([[0; N]; 3], [[0; N]; 3], [[0; N]; 3]);
        let mut k = 0;
        while k < N {
            let (first, second, from) = (first[k], second[k], through[k] - offsets.base);
            (e[0][k], e[1][k], e[2][k]) = (first.x, first.y, first.z);
            (f[0][k], f[1][k], f[2][k]) = (second.x, second.y, second.z);
            (d[0][k], d[1][k], d[2][k]) = (from.x, from.y, from.z);
            k += 1;
        }
        Planes::spanned::<L, P>(offsets, &e, &f, &d)
    }
}

/// What a triangle may do to sixteen receivers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Reach {
    /// Receivers from which it may block something.
    pub(crate) alive: u32,
    /// Of each edge's plane, the receivers from which it may cut the samples.
    pub(crate) cuts: [u32; 3],
}

impl Reach {
    /// Of the lanes on either side of the triangle's plane that may see samples through it.
    #[inline(always)]
    pub(crate) fn of<L: Lanes, P: PrecisionMode>(
        cloud: &CloudExtent,
        receivers: &ReceiverTile,
        occluder: &Occluder,
        sides: Sides,
    ) -> Self {
        let wanted = if occluder.is_mixed() { sides.positive | sides.negative } else { sides.positive };
        let corners = occluder.corners();
        let [a, b, c] = corners;
        let edges = [float(b - a) * SCALE, float(c - b) * SCALE, float(a - c) * SCALE];
        let (middle, half, radius) = (cloud.middle(), cloud.half(), cloud.radius());
        // One bound for all edges and lanes: the longest edge on each axis, from the farthest receiver.
        let longest = edges[0].abs().max(edges[1].abs()).max(edges[2].abs());
        let farthest = receivers.farthest(a.min(b).min(c), a.max(b).max(c));
        let permanent = cross_magnitudes(farthest, longest).dot(receivers.farthest(middle, middle) + radius);
        let bound = if P::CERTIFIED { permanent * (ERRORS * L::ROUNDOFF) } else { 0.0 };
        let (least, bound) = (L::splat(-bound), L::splat(bound));
        let square = L::splat(radius * radius * (1.0 + 16.0 * L::ROUNDOFF));
        let zero = L::splat(f32::MIN_POSITIVE);
        let mut reach = Self { alive: wanted, cuts: [wanted; 3] };
        let mut first = 0;
        while first < TILE {
            let p = receivers.load::<L>(first);
            let toward = towards::<L>(middle, &p);
            let turn = turned::<L>(sides.negative, first);
            let mut k = 0;
            while k < 3 {
                let n = cross_scalar(&towards::<L>(corners[k], &p), edges[k]);
                let value = dot(&n, &toward).mul(turn);
                let spread = dot_scalar(half, &[n[0].abs(), n[1].abs(), n[2].abs()]);
                let farthest = dot(&n, &n).mul(square);
                let (outer, inner) = (least.sub(value), value.sub(bound));
                let beyond = L::both(outer.ge(zero), outer.mul(outer).ge(farthest));
                let beyond = L::either(beyond, L::not(value.add(spread).ge(least)));
                let within = L::both(inner.ge(zero), inner.mul(inner).ge(farthest));
                let within = L::either(within, value.sub(spread).ge(bound));
                reach.alive &= !(L::bits(beyond) << first);
                reach.cuts[k] &= !(L::bits(within) << first);
                k += 1;
            }
            first += L::WIDTH;
        }
        reach
    }

    /// The planes that may cut the samples of lane `lane < 16`.
    #[inline(always)]
    pub(crate) fn cuts_of(&self, lane: usize, mixed: bool) -> u32 {
        let mut cuts = (mixed as u32) << OWN_PLANE;
        let mut k = 0;
        while k < 3 {
            cuts |= (self.cuts[k] >> lane & 1) << k;
            k += 1;
        }
        cuts
    }
}
