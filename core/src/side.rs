//! On which side of a triangle's plane receivers lie.
//!
//! The sign is that of `n·(a − p)`, n the triangle's normal. With the group's base b it is `n·(a − b) − n·(p − b)`: the
//! first term is taken once, in [`Real`]; the second is small, since receivers of a group lie close together.
//!
//! # Error bound
//! The first term has six roundoffs of its own type at most (conversion, product and difference of the normal; product
//! and two sums), relative to the sum over absolute values, and one when it is rounded to f32; the second a conversion,
//! a rounding of the normal, a product and two sums; their difference one more. (The first term enters the first of three sums. Where the sign is in doubt the partial
//! sums are no larger than what is still to come, so that its roundoffs are those of the second.) The constants hold one to
//! spare. The
//! normal's own error counts in both terms: it is relative to its magnitudes, which a sliver's normal is far below. So
//! those are multiplied with `|a − b| + |p − b|`.

use glam::{IVec3, Vec3};

use crate::{
    edge_plane::{ReceiverTile, cross_magnitudes, float},
    exact::{self, Wide},
    lanes::{Lanes, TILE},
    occluder::Occluder,
    precision::PrecisionMode,
    real::Real,
    statistics::Tally,
    view::{Offsets, View},
};

/// Lanes on either side of a triangle's plane; those in it are in neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// Lanes from which the normal points away: what lies on the normal's side of the plane is seen through it.
    pub positive: u32,
    /// The others.
    pub negative: u32,
}

/// Planes from a group's base: `n·(a − p)` for a point a of each. Axis-major.
pub(crate) struct Planes<const N: usize> {
    pub(crate) normals: [[f32; N]; 3],
    pub(crate) at_base: [f32; N],
    pub(crate) doubt: [f32; N],
}

impl Sides {
    /// Of the lanes in `wanted`. Adds the signs decided in integers to `fallbacks`.
    #[inline(always)]
    pub fn of<L: Lanes, P: PrecisionMode>(
        view: &View<L::Long>,
        receivers: &ReceiverTile,
        occluder: &Occluder,
        wanted: u32,
        fallbacks: &mut Tally,
    ) -> Self {
        Self::seen_from::<L, P>(&view.offsets, receivers, occluder, wanted, fallbacks)
    }

    /// The same, of receivers that lie at `offsets`.
    #[inline(always)]
    pub(crate) fn seen_from<L: Lanes, P: PrecisionMode>(
        offsets: &Offsets,
        receivers: &ReceiverTile,
        occluder: &Occluder,
        wanted: u32,
        fallbacks: &mut Tally,
    ) -> Self {
        let [a, b, c] = occluder.corners();
        let planes = Planes::spanned::<L, P>(offsets, &single(b - a), &single(c - a), &single(a - offsets.base));
        let (positive, unsure) = planes.signs::<L, P>(offsets, 0);
        let unsure = unsure & wanted;
        let mut sides = Self { positive: positive & wanted & !unsure, negative: wanted & !positive & !unsure };
        if P::CERTIFIED && unsure != 0 {
            sides.settle(occluder, receivers, unsure, fallbacks);
        }
        sides
    }

    /// Decides the lanes in `unsure`. Out of line: few come here.
    #[inline(never)]
    fn settle(&mut self, occluder: &Occluder, receivers: &ReceiverTile, mut unsure: u32, fallbacks: &mut Tally) {
        while unsure != 0 {
            let lane = unsure.trailing_zeros() as usize;
            unsure &= unsure - 1;
            *fallbacks += 1;
            let sign = exact::far_side::<Wide>(receivers.point(lane), occluder.corners());
            self.positive |= ((sign > 0) as u32) << lane;
            self.negative |= ((sign < 0) as u32) << lane;
        }
    }
}

impl<const N: usize> Planes<N> {
    /// The planes along `e` and `f` that pass `d` from the base.
    #[inline(always)]
    pub(crate) fn spanned<L: Lanes, P: PrecisionMode>(
        offsets: &Offsets,
        e: &[[i32; N]; 3],
        f: &[[i32; N]; 3],
        d: &[[i32; N]; 3],
    ) -> Self {
        let (mut normals, mut at_base, mut doubt) = ([[0.0; N]; 3], [0.0; N], [0.0; N]);
        let mut k = 0;
        while k < N {
            let (e, f, d) = (vector(e, k), vector(f, k), vector(d, k));
            let normal = L::Long::cross(e, f);
            at_base[k] = L::Long::dot(&normal, d).to_f32();
            let normal = Vec3::new(normal[0].to_f32(), normal[1].to_f32(), normal[2].to_f32());
            (normals[0][k], normals[1][k], normals[2][k]) = (normal.x, normal.y, normal.z);
            if P::CERTIFIED {
                let (e, f, d) = (float(e), float(f), float(d).abs() + offsets.limit);
                let lost = if L::Long::DOT_ERRORS > 0.0 {
                    cross_magnitudes(e, f).dot(d)
                } else {
                    // Six products of the largest: of little consequence in a long float.
                    6.0 * e.abs().max_element() * f.abs().max_element() * d.max_element()
                };
                let near = 7.0 * normal.abs().dot(offsets.limit) + 3.0 * Lanes::abs(at_base[k]);
                doubt[k] = L::Long::SIDE_ERROR * lost + near * L::ROUNDOFF;
            }
            k += 1;
        }
        Self { normals, at_base, doubt }
    }

    /// Lanes in which the value of plane `k < N` is surely positive, and those in which its sign is not known.
    #[inline(always)]
    pub(crate) fn signs<L: Lanes, P: PrecisionMode>(&self, offsets: &Offsets, k: usize) -> (u32, u32) {
        let normal = [-self.normals[0][k], -self.normals[1][k], -self.normals[2][k]];
        let (at_base, doubt) = (L::splat(self.at_base[k]), self.doubt[k]);
        let (mut positive, mut unsure) = (0, 0);
        let mut first = 0;
        while first < TILE {
            let side = L::load(&offsets.at[0], first).mul_add(L::splat(normal[0]), at_base);
            let side = L::load(&offsets.at[1], first).mul_add(L::splat(normal[1]), side);
            let side = L::load(&offsets.at[2], first).mul_add(L::splat(normal[2]), side);
            positive |= L::bits(side.ge(L::splat(Lanes::max(doubt, f32::MIN_POSITIVE)))) << first;
            if P::CERTIFIED {
                let doubt = L::splat(doubt);
                unsure |= L::bits(L::both(doubt.ge(side), side.ge(L::splat(0.0).sub(doubt)))) << first;
            }
            first += L::WIDTH;
        }
        (positive & !unsure, unsure)
    }
}

impl<const N: usize> Planes<N> {
    /// Whether points, from the base, surely lie on the inner side of all planes in `cuts`, and whether they may; `3 ≤ N ≤ 4`. A sum
    /// of two floats has the sign of the exact sum, so that it tells which is larger.
    #[inline(always)]
    pub(crate) fn hold<L: Lanes>(&self, cuts: u32, at: &[L; 3]) -> (L::Mask, L::Mask) {
        let mut range = (L::splat(f32::MAX), L::splat(f32::MAX));
        range = self.of_point(0, cuts, at, range);
        range = self.of_point(1, cuts, at, range);
        range = self.of_point(2, cuts, at, range);
        if N > 3 {
            range = self.of_point(3, cuts, at, range);
        }
        (range.0.ge(L::splat(f32::MIN_POSITIVE)), range.1.ge(L::splat(0.0)))
    }

    /// The same of all points of boxes, and of any of them.
    ///
    /// # Error bound
    /// At a box' middle, a float, the value is known to within `doubt`, as that of any point. Over the box it changes by `|n|·h`,
    /// of which five roundoffs are lost, and the sum of both loses one more: less than `doubt` each, as long as h is no larger than
    /// the limit of all points. So `3·doubt` is enough.
    #[inline(always)]
    pub(crate) fn hold_box<L: Lanes>(&self, cuts: u32, middle: &[L; 3], half: &[L; 3]) -> (L::Mask, L::Mask) {
        let mut range = (L::splat(f32::MAX), L::splat(f32::MAX));
        range = self.of_box(0, cuts, middle, half, range);
        range = self.of_box(1, cuts, middle, half, range);
        range = self.of_box(2, cuts, middle, half, range);
        if N > 3 {
            range = self.of_box(3, cuts, middle, half, range);
        }
        (range.0.ge(L::splat(f32::MIN_POSITIVE)), range.1.ge(L::splat(0.0)))
    }

    /// The least and the most that a plane's value may be, and those of others.
    #[inline(always)]
    fn of_point<L: Lanes>(&self, k: usize, cuts: u32, at: &[L; 3], (least, most): (L, L)) -> (L, L) {
        if cuts >> k & 1 == 0 {
            return (least, most);
        }
        let value = at[0].mul_add(L::splat(-self.normals[0][k]), L::splat(self.at_base[k]));
        let value = at[1].mul_add(L::splat(-self.normals[1][k]), value);
        let value = at[2].mul_add(L::splat(-self.normals[2][k]), value);
        let doubt = L::splat(self.doubt[k]);
        (least.min(value.sub(doubt)), most.min(value.add(doubt)))
    }

    #[inline(always)]
    fn of_box<L: Lanes>(&self, k: usize, cuts: u32, middle: &[L; 3], half: &[L; 3], (least, most): (L, L)) -> (L, L) {
        if cuts >> k & 1 == 0 {
            return (least, most);
        }
        let n = [self.normals[0][k], self.normals[1][k], self.normals[2][k]];
        let value = middle[0].mul_add(L::splat(-n[0]), L::splat(self.at_base[k]));
        let value = middle[1].mul_add(L::splat(-n[1]), value);
        let value = middle[2].mul_add(L::splat(-n[2]), value);
        let spread = half[0].mul(L::splat(Lanes::abs(n[0])));
        let spread = half[1].mul_add(L::splat(Lanes::abs(n[1])), spread);
        let spread = half[2].mul_add(L::splat(Lanes::abs(n[2])), spread);
        let doubt = L::splat(BOX_DOUBT * self.doubt[k]);
        (least.min(value.sub(spread).sub(doubt)), most.min(value.add(spread).add(doubt)))
    }
}

/// Bounds of a box' values, in units of a point's.
const BOX_DOUBT: f32 = 3.0;

#[inline(always)]
fn single(v: IVec3) -> [[i32; 1]; 3] {
    [[v.x], [v.y], [v.z]]
}

#[inline(always)]
fn vector<const N: usize>(axes: &[[i32; N]; 3], k: usize) -> IVec3 {
    IVec3::new(axes[0][k], axes[1][k], axes[2][k])
}
