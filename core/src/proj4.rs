//! The generalised projection of points and triangles, and the full-coverage test.
//!
//! Seed: Wang et al. 2016, section 3.1 (Proj4), 3.2 (full coverage), appendix (proof). Proj4(A) is the rectangle on a
//! plane P that A's projections fill as the centre of projection moves over the light. With A at (a, b, w) in the light's
//! frame and P at height W it spans, along the columns, `[last + W·(a − last)/w, W·a/w]`: the ends seen from the last
//! and the first column. Whether one such rectangle lies inside another depends on the two *slopes* `a/w` and
//! `(a − last)/w` alone, not on W. So no plane is needed for the test, and a point is described by its slopes.
//!
//! **Full coverage.** If triangle t blocks any sample of the light from receiver s, then Proj4(s) lies inside the box of
//! t's vertices' Proj4, and t has a point nearer to the light plane than s. In slopes, along the columns:
//! `max over t of a/w ≥ s.a/s.w` and `min over t of (a − last)/w ≤ (s.a − last)/s.w`; along the rows the same.
//! *Proof.* The segment from s to the sample meets t in a point A with `0 < A.w < s.w` (strictly: neither end lies in
//! t's plane). A lies in the pyramid from s over the samples' hull, whose side through column 0 is `x/w = s.a/s.w`; so
//! `A.a/A.w ≥ s.a/s.w`, and the part of t above the light plane has a vertex, or a limit at the plane, with as large a
//! slope. The other sides are alike. ∎
//!
//! Five comparisons with nothing computed at test time: the condition is that the triangle's [`Keys`] *dominate* the
//! receiver's. Maxima of triangles' keys and minima of receivers' keys keep the property, so the same test serves
//! nodes of a hierarchy and groups of receivers. Rounding is taken care of when keys are made: a triangle's are rounded
//! up, a receiver's down, so that no relevant pair is ever dropped.

use glam::IVec3;

use crate::{
    frame::{FramePoint, LightFrame, dot},
    lanes::{Lanes, TILE},
};

#[cfg(not(target_arch = "spirv"))]
use crate::edge_plane::ReceiverTile;

/// Number of comparisons that make the full-coverage test.
pub const KEYS: usize = 5;

/// Stands for an infinite slope.
pub const UNBOUNDED: f32 = 1.0e30;

/// Key of an entry that does not exist: dominates no receiver, not even one that asks for nothing.
pub const NOTHING: [f32; KEYS] = [f32::MIN; KEYS];

/// Heights below this many lattice units count as touching the light plane: their slopes would overflow.
pub(crate) const TOUCHING: f32 = 1.0e-3;

/// What a triangle offers, or a receiver asks for: slopes seen from the first column, from the last column (negated),
/// from the first row, from the last row (negated), and the height above the light plane (negated).
pub type Keys = [f32; KEYS];

/// Entries of a node.
pub const NODE: usize = 16;

/// Keys of the entries of a node: key-major, so that lanes compare all entries at once.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[cfg_attr(not(target_arch = "spirv"), repr(C, align(64)))]
#[cfg_attr(target_arch = "spirv", repr(C))]
pub struct KeyTile {
    /// `keys[k][entry]`.
    pub keys: [[f32; NODE]; KEYS],
}

impl KeyTile {
    /// Sixteen entries that do not exist.
    pub const NOTHING: Self = Self { keys: [[f32::MIN; NODE]; KEYS] };

    /// The keys of one entry; `entry < NODE`.
    #[inline(always)]
    pub fn entry(&self, entry: usize) -> Keys {
        let e = entry % NODE;
        [self.keys[0][e], self.keys[1][e], self.keys[2][e], self.keys[3][e], self.keys[4][e]]
    }

    /// Sets one entry; `entry < NODE`.
    #[inline(always)]
    pub fn set(&mut self, entry: usize, keys: &Keys) {
        let mut k = 0;
        while k < KEYS {
            self.keys[k][entry % NODE] = keys[k];
            k += 1;
        }
    }

    /// Which of the sixteen entries (triangles, or nodes) may block something from a receiver, or group, with `need`.
    #[inline(always)]
    pub fn dominating<L: Lanes>(&self, need: &Keys) -> u32 {
        let mut bits = 0;
        let mut first = 0;
        while first < NODE {
            let mut covered = L::load(&self.keys[0], first).ge(L::splat(need[0]));
            let mut k = 1;
            while k < KEYS {
                covered = L::both(covered, L::load(&self.keys[k], first).ge(L::splat(need[k])));
                k += 1;
            }
            bits |= L::bits(covered) << first;
            first += L::WIDTH;
        }
        bits
    }

    /// The least keys that dominate whatever any entry dominates: a node's keys from its children's.
    #[inline]
    pub fn largest(&self) -> Keys {
        let mut out = NOTHING;
        let mut k = 0;
        while k < KEYS {
            let mut e = 0;
            while e < NODE {
                out[k] = Lanes::max(out[k], self.keys[k][e]);
                e += 1;
            }
            k += 1;
        }
        out
    }
}

/// What the receivers of a group ask for: key-major too.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(target_arch = "spirv"), repr(align(64)))]
pub struct NeedTile([[f32; TILE]; KEYS]);

impl NeedTile {
    /// Receivers that ask for nothing.
    pub const NOTHING: Self = Self([[f32::MIN; TILE]; KEYS]);

    /// Sets one receiver; `lane < TILE`.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, keys: &Keys) {
        let mut k = 0;
        while k < KEYS {
            self.0[k][lane % TILE] = keys[k];
            k += 1;
        }
    }

    /// What the receivers of a tile ask of the light that `frame` belongs to.
    #[cfg(not(target_arch = "spirv"))]
    #[inline(always)]
    pub(crate) fn of<L: Lanes>(frame: &LightFrame, receivers: &ReceiverTile) -> Self {
        let mut needs = Self::NOTHING;
        let origin = frame.origin.to_array();
        let mut first = 0;
        while first < TILE {
            let p = receivers.load::<L>(first);
            let d = [
                L::difference(p[0], L::splat_int(origin[0])),
                L::difference(p[1], L::splat_int(origin[1])),
                L::difference(p[2], L::splat_int(origin[2])),
            ];
            let keys = keys_of_receivers(frame, &d);
            let mut k = 0;
            while k < KEYS {
                keys[k].store(&mut needs.0[k], first);
                k += 1;
            }
            first += L::WIDTH;
        }
        needs
    }

    /// The least that any receiver in `active` asks for.
    #[inline(always)]
    pub(crate) fn least<L: Lanes>(&self, active: u32) -> Keys {
        let mut need = [f32::MAX; KEYS];
        let mut first = 0;
        while first < TILE {
            let there = L::mask(active >> first);
            let mut k = 0;
            while k < KEYS {
                let negated = L::splat(0.0).sub(L::load(&self.0[k], first));
                need[k] = Lanes::min(need[k], -L::select(there, negated, L::splat(f32::MIN)).largest());
                k += 1;
            }
            first += L::WIDTH;
        }
        need
    }

    /// Which of the receivers a triangle with the keys `reach` may block something from.
    #[inline(always)]
    pub fn dominated_by<L: Lanes>(&self, reach: &Keys) -> u32 {
        let mut bits = 0;
        let mut first = 0;
        while first < TILE {
            let mut covered = L::splat(reach[0]).ge(L::load(&self.0[0], first));
            let mut k = 1;
            while k < KEYS {
                covered = L::both(covered, L::splat(reach[k]).ge(L::load(&self.0[k], first)));
                k += 1;
            }
            bits |= L::bits(covered) << first;
            first += L::WIDTH;
        }
        bits
    }
}

/// The full-coverage test of one pair: whether the triangle may block something from the receiver.
#[inline(always)]
pub fn covers(triangle: &Keys, receiver: &Keys) -> bool {
    let mut covered = true;
    let mut k = 0;
    while k < KEYS {
        covered &= triangle[k] >= receiver[k];
        k += 1;
    }
    covered
}

/// A reciprocal and a product may be off by 4 ulp; 2^-20 also covers the sum that made the dividend.
const SLACK: f32 = 8.0 * f32::EPSILON;

/// An upper bound of `x/w` for x ≤ `x_high` and w, above zero, between two bounds of which the reciprocals are given.
#[inline(always)]
pub(crate) fn quotient_above<L: Lanes>(x_high: L, inverse_low: L, inverse_high: L) -> L {
    let q = x_high.mul(L::select(x_high.ge(L::splat(0.0)), inverse_low, inverse_high));
    q.abs().mul_add(L::splat(SLACK), q)
}

/// A lower bound, of x known to within `error`.
#[inline(always)]
fn quotient_below<L: Lanes>(x: L, error: L, inverse_low: L, inverse_high: L) -> L {
    L::splat(0.0).sub(quotient_above(error.sub(x), inverse_low, inverse_high))
}

/// How far a vertex may reach, seen from the first column, from the last, from the first row, from the last.
#[inline(always)]
pub(crate) fn reaches(frame: &LightFrame, q: &FramePoint) -> [f32; 4] {
    [
        q.a + q.error_a,
        (frame.last_column - q.a) + (q.error_a + frame.last_column * f32::EPSILON),
        q.b + q.error_b,
        (frame.last_row - q.b) + (q.error_b + frame.last_row * f32::EPSILON),
    ]
}

/// The keys of receivers, given by their differences from the light's first sample: rounded down. The receivers are in
/// front of the light (that is decided in integers before).
#[inline(always)]
pub(crate) fn keys_of_receivers<L: Lanes>(frame: &LightFrame, d: &[L; 3]) -> [L; KEYS] {
    let (zero, touching) = (L::splat(0.0), L::splat(TOUCHING));
    let ((a, error_a), (b, error_b)) = (dot(frame.along_u, d), dot(frame.along_v, d));
    let (w, error_w) = dot(frame.normal, d);
    let (low, high) = (w.sub(error_w), w.add(error_w));
    let clear = low.ge(touching);
    let (inverse_low, inverse_high) = (low.max(touching).recip(), high.max(touching).recip());
    let (column, row) = (L::splat(frame.last_column), L::splat(frame.last_row));
    let far_a = error_a.add(L::splat(frame.last_column * f32::EPSILON));
    let far_b = error_b.add(L::splat(frame.last_row * f32::EPSILON));
    let bound = L::splat(-UNBOUNDED);
    [
        L::select(clear, quotient_below(a, error_a, inverse_low, inverse_high), bound),
        L::select(clear, quotient_below(column.sub(a), far_a, inverse_low, inverse_high), bound),
        L::select(clear, quotient_below(b, error_b, inverse_low, inverse_high), bound),
        L::select(clear, quotient_below(row.sub(b), far_b, inverse_low, inverse_high), bound),
        zero.sub(high),
    ]
}

/// The keys of a receiver.
#[inline]
pub fn receiver_keys(frame: &LightFrame, p: IVec3) -> Keys {
    let d = p - frame.origin;
    keys_of_receivers(frame, &[d.x as f32, d.y as f32, d.z as f32])
}

/// The keys of a triangle: rounded up. `None` where no point of it lies in front of the light: it blocks nothing.
///
/// Where a triangle reaches or crosses the light plane its slopes have no bound, but only on the sides on which it has
/// a vertex inside: a wall beside the light still offers nothing to receivers on the other side.
#[inline]
pub fn triangle_keys(frame: &LightFrame, corners: &[IVec3; 3]) -> Option<Keys> {
    let points = [frame.place(corners[0]), frame.place(corners[1]), frame.place(corners[2])];
    let high = |q: &FramePoint| q.w + q.error_w;
    let low = |q: &FramePoint| q.w - q.error_w;
    let highest = Lanes::max(high(&points[0]), Lanes::max(high(&points[1]), high(&points[2])));
    if highest <= 0.0 {
        return None;
    }
    let lowest = Lanes::min(low(&points[0]), Lanes::min(low(&points[1]), low(&points[2])));
    let touches = lowest < TOUCHING;
    let mut out = NOTHING;
    let mut v = 0;
    while v < 3 {
        let q = points[v];
        let x = reaches(frame, &q);
        let (inverse_low, inverse_high) = (Lanes::recip(Lanes::max(low(&q), TOUCHING)), Lanes::recip(high(&q)));
        let mut k = 0;
        while k < 4 {
            let slope = if touches && x[k] >= 0.0 {
                UNBOUNDED
            } else if high(&q) <= 0.0 {
                // Behind, and outside on this side: towards the light plane the slopes fall without end.
                f32::MIN
            } else {
                quotient_above(x[k], inverse_low, inverse_high)
            };
            out[k] = Lanes::max(out[k], slope);
            k += 1;
        }
        v += 1;
    }
    out[4] = -lowest;
    Some(out)
}
