//! On which side of a triangle's plane receivers lie.
//!
//! The sign is that of `n·(a − p)`, n the triangle's normal. With the group's base b it is `n·(a − b) − n·(p − b)`: the
//! first term is taken once, in [`Real`]; the second is small, since receivers of a group lie close together.
//!
//! # Error bound
//! The first term has six roundoffs of its own type at most (conversion, product and difference of the normal; product
//! and two sums), relative to the sum over absolute values, and one when it is rounded to f32; the second a conversion,
//! a rounding of the normal, a product and two sums; their difference one more. The constants hold one to spare. The
//! normal's own error counts in both terms: it is relative to its magnitudes, which a sliver's normal is far below. So
//! those are multiplied with `|a − b| + |p − b|`.

use glam::Vec3;

use crate::{
    edge_plane::{Occluder, ReceiverTile, cross_magnitudes, float},
    exact::{self, Wide},
    lanes::{Lanes, TILE},
    precision::PrecisionMode,
    real::Real,
    statistics::Tally,
    view::View,
};

/// Lanes on either side of a triangle's plane; those in it are in neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// Lanes from which the normal points away: what lies on the normal's side of the plane is seen through it.
    pub positive: u32,
    /// The others.
    pub negative: u32,
}

/// A triangle's plane from a group's base.
struct Plane {
    normal: Vec3,
    at_base: f32,
    doubt: f32,
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
        let plane = Plane::of::<L, P>(view, occluder);
        let (mut positive, mut unsure) = (0, 0);
        let mut first = 0;
        while first < TILE {
            let side = L::load(&view.offset[0], first).mul_add(L::splat(-plane.normal.x), L::splat(plane.at_base));
            let side = L::load(&view.offset[1], first).mul_add(L::splat(-plane.normal.y), side);
            let side = L::load(&view.offset[2], first).mul_add(L::splat(-plane.normal.z), side);
            positive |= L::bits(side.ge(L::splat(Lanes::max(plane.doubt, f32::MIN_POSITIVE)))) << first;
            if P::CERTIFIED {
                let doubt = L::splat(plane.doubt);
                unsure |= L::bits(L::both(doubt.ge(side), side.ge(L::splat(0.0).sub(doubt)))) << first;
            }
            first += L::WIDTH;
        }
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

impl Plane {
    #[inline(always)]
    fn of<L: Lanes, P: PrecisionMode>(view: &View<L::Long>, occluder: &Occluder) -> Self {
        let [a, b, c] = occluder.corners();
        let (e, f, d) = (b - a, c - a, a - view.base);
        let normal = L::Long::cross(e, f);
        let at_base = L::Long::dot(&normal, d).to_f32();
        let normal = Vec3::new(normal[0].to_f32(), normal[1].to_f32(), normal[2].to_f32());
        let mut doubt = 0.0;
        if P::CERTIFIED {
            let lost =
                L::Long::SIDE_ERROR * cross_magnitudes(float(e), float(f)).dot(float(d).abs() + view.offset_limit);
            let near = 7.0 * normal.abs().dot(view.offset_limit) + 3.0 * Lanes::abs(at_base);
            doubt = lost + near * L::ROUNDOFF;
        }
        Self { normal, at_base, doubt }
    }
}
