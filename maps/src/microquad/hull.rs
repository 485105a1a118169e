//! The convex hull of a microquad's corners on the light.
//!
//! Seed: Schwarz, Stamminger 2008, section 3.1 and figure 5: a triangle of three corners is turned counter-clockwise, and the
//! signs of the fourth's barycentric coordinates tell which of seven cases holds. Departure: where the first three lie on one line, another three are
//! taken, so that only hulls without area are left out.

use crate::{arithmetic::Arithmetic, microquad::projection::Point};

/// A convex polygon, counter-clockwise (from columns to rows): none, three or four corners.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hull {
    /// Its corners; of fewer than four, the last is the first.
    pub corners: [Point; 4],
    /// How many.
    pub count: u32,
}

/// Twice the area of a triangle; positive where it is counter-clockwise. With two corners exchanged it is the same but for its
/// sign, or a rounding.
#[inline(always)]
pub fn doubled_area(a: Arithmetic, p: Point, q: Point, r: Point) -> f32 {
    a.difference_of_products(a.sub(q.x, p.x), a.sub(r.y, p.y), a.sub(q.y, p.y), a.sub(r.x, p.x))
}

/// The hull of three corners.
#[inline(always)]
pub fn of_three(a: Arithmetic, p: Point, q: Point, r: Point) -> Hull {
    let area = doubled_area(a, p, q, r);
    if area > 0.0 {
        Hull { corners: [p, q, r, p], count: 3 }
    } else if area < 0.0 {
        Hull { corners: [p, r, q, p], count: 3 }
    } else {
        Hull::default()
    }
}

/// The hull of four corners, in any order.
#[inline(always)]
pub fn of_four(a: Arithmetic, corners: [Point; 4]) -> Hull {
    let mut v = corners;
    // Three that are not on one line come first.
    let mut turn = 0;
    let mut area = doubled_area(a, v[0], v[1], v[2]);
    while turn < 3 && area == 0.0 {
        v = [v[1], v[2], v[3], v[0]];
        area = doubled_area(a, v[0], v[1], v[2]);
        turn += 1;
    }
    // NaN is no area either.
    if area == 0.0 || area.is_nan() {
        return Hull::default();
    }
    let [p, q, r, d] = if area > 0.0 { v } else { [v[0], v[2], v[1], v[3]] };
    // Barycentric coordinates of d, but for their scale: negative beyond the edge before each corner.
    let beyond_qr = doubled_area(a, q, r, d) < 0.0;
    let beyond_rp = doubled_area(a, r, p, d) < 0.0;
    let beyond_pq = doubled_area(a, p, q, d) < 0.0;
    let (corners, count) = match (beyond_qr, beyond_rp, beyond_pq) {
        (false, false, false) => ([p, q, r, p], 3),
        (true, false, false) => ([p, q, d, r], 4),
        (false, true, false) => ([p, q, r, d], 4),
        (false, false, true) => ([p, d, q, r], 4),
        // Beyond two edges: their common corner lies inside.
        (true, true, false) => ([p, q, d, p], 3),
        (false, true, true) => ([d, q, r, d], 3),
        (true, false, true) => ([p, d, r, p], 3),
        // Beyond all three is nothing, but for rounding.
        (true, true, true) => ([p, q, r, p], 3),
    };
    Hull { corners, count }
}
