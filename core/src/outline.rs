//! A triangle as a receiver sees it against the light: its corners projected to the light's grid, its edges as lines
//! over the rows.
//!
//! Seed: Wang et al. 2016, section 3.3, where each edge has a plane through the receiver. Departure: where all corners
//! rise from the receiver towards the light, the planes' traces on the light are the sides of one triangle, and its
//! corners cost less than its planes: a perspective division each. The corners also tell which rows can change at all.
//! What is not certified here is left to `edge_plane`, which needs no division by a height.
//!
//! # Error bound
//! Coordinates are columns j, rows i and heights h of the light's frame, *sheared* along the ray from one receiver of the
//! group to the light's middle. A shear along the plane h = 0 moves no point of it, so its rounding is no error; but
//! receivers and relevant corners then lie almost above one another, and little is cancelled. Receivers are placed
//! relative to the light (j_p, i_p, h_p) and to that one receiver, corners relative to it too, with [`crate::real::Real`], and rounded
//! to f32. With `d = corner − receiver` the corner is seen at `j = j_p + s·d_j`, `s = h_p/(−d_h)`.
//!
//! In units of ε, to first order: j_p has 1, and C from its dot product; d_j is the difference of two rounded numbers,
//! 1·|d_j| and at most B + D, twice the largest receiver and the dot product's own; d_h likewise, 1·|d_h| and B_h + D_h;
//! s has 3 for the reciprocal, 1 for the product and those of h_p (1 and C_h/h_p) and d_h; j has one for its product and
//! one for its sum. With `e ≥ |j|, |i|` of all corners and `q = e + max |j_p|, |i_p| ≥ |s·d_j|, |s·d_i|`, each coordinate is
//! known to
//! `δ = ε·(C + s·(B + D) + q·((B_h + D_h)/|d_h| + C_h/h_p + 9 + e·F_h) + e·(2 + F))`.
//! C, D, their likes and F, the rounding of the axes along the light's steps (it bends the grid, and by F_h the light
//! plane), are zero with f64.
//!
//! *Lines.* Let T be the true triangle on the grid, T' the computed one; corners differ by at most δ in each coordinate.
//! A sample in T lies in T' grown by the box of radius δ, so on the inner side of each side of T' moved outwards by
//! `δ·(1 + |β|)` columns, β the side's slope in columns a row. And a sample whose box of radius δ lies in T' lies in T: else a
//! line through the sample would have all corners of T strictly on one side, those of T' less than δ beyond it, and
//! the box reaches farther. That box lies in T' where the sample is inside each side moved inwards by the same. So
//! `doubt = (1 + max |β|)·δ` serves all three, once the evaluation of a line is counted. Only rows between the corners of
//! T' are looked at, so |i| ≤ e + 1, and i lies at most 2e + 1 from the corner where the line starts. The slope has 6: two
//! differences, the reciprocal, a product; its product with i 1; the column at row 0 2, and 1 when it is moved; the sum 1.
//! In all less than `ε·(16e + 8)·(1 + |β|)`, which δ takes over.
//!
//! *Orientation.* Moving corners by δ changes twice the area by at most `4δ·(w + h) + 16δ²`, w and h the extents of T', and
//! rounding by less than `δ·(w + h)`. So the sign of T' is that of T where twice its area is at least `6δ·(w + h)`, and not 0
//! (which implies w + h ≥ 24δ, and so covers the quadratic term). It tells the receiver's side of the triangle's plane.
//!
//! *Flat sides*, of less than 1/32 row, have no usable slope. If no row lies within δ of one, it separates whole rows:
//! those on the side of the third corner, where the other two sides alone bound T', from those where there is nothing of
//! it. A line that is all but parallel to the rows stands for it.

use crate::{
    doubt::Margins,
    edge_plane::{LightGrid, Lines},
    jitter::{LAST_PLACE, Samples},
    jittered_rows::Limits,
    lanes::{Lanes, TILE},
    light::LatticeLight,
    occluder::Occluder,
    precision::PrecisionMode,
    trace::{Crossing, MOST_PLANE_DOUBT, OwnSide, Side, flat},
    view::{LEAST_HEIGHT, View},
};

/// Doubts of as many columns or more are not looked at here: half a column would hold no certain one.
const MOST_DOUBT: f32 = 0.25;

/// The sides of one triangle for sixteen receivers, as lines over the rows: column `slope·i + start` at row i.
#[derive(Clone, Copy, Debug)]
pub struct Outlines<const E: usize> {
    /// Columns a row, of each side.
    pub(crate) slope: [[f32; TILE]; E],
    /// Of a side with its bit in `lower`, the least column that is surely inside, at row 0; of another, one more than the
    /// largest.
    pub(crate) start: [[f32; TILE]; E],
    /// Width of the band before `start` in which a column may be inside. Written only where signs are certified.
    pub(crate) band: [f32; TILE],
    /// First row that may change.
    pub(crate) first: [i32; TILE],
    /// Number of rows that may.
    pub(crate) count: [i32; TILE],
    /// Bit l: for lane l the side bounds the columns from below.
    pub(crate) lower: [u32; E],
    /// Bit l: lane l's side of the triangle's plane is the negative one.
    pub(crate) flipped: u32,
}

impl<const E: usize> Margins for Outlines<E> {
    /// Twice the doubt counts as unsure: `start` was rounded when it was moved inwards.
    #[inline(always)]
    fn margin(&self, k: usize, lane: usize, row: f32, column: f32) -> (f32, f32) {
        let k = k % E;
        let (band, x) = (self.band[lane], self.slope[k][lane] * row + self.start[k][lane]);
        let inside = if self.lower[k] >> lane & 1 == 1 { column - x } else { x - 1.0 - column };
        (inside + 0.5 * band, band)
    }

    #[inline(always)]
    fn flipped(&self, lane: usize) -> bool {
        self.flipped >> lane & 1 == 1
    }
}

impl<const E: usize> Limits for Outlines<E> {
    #[inline(always)]
    fn limit(&self, k: usize, lane: usize) -> (f32, f32) {
        let (slope, start) = (self.slope[k % E][lane], self.start[k % E][lane]);
        (slope, if self.is_lower(k, lane) { start } else { start - 1.0 })
    }

    #[inline(always)]
    fn is_lower(&self, k: usize, lane: usize) -> bool {
        self.lower[k % E] >> lane & 1 == 1
    }

    #[inline(always)]
    fn beyond<P: PrecisionMode>(&self, _: usize, lane: usize) -> f32 {
        if P::CERTIFIED { self.band[lane] } else { 0.0 }
    }
}

/// Lanes that an outline leaves.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Their lines are written, and their rows are few.
    pub outlined: u32,
    /// Nothing is known of these: their planes must be looked at.
    pub unknown: u32,
}

impl<const E: usize> Outlines<E> {
    /// Lines of nothing, to be written by [`Outlines::outline`] or [`Outlines::take_over`].
    pub const EMPTY: Self = Self {
        slope: [[0.0; TILE]; E],
        start: [[0.0; TILE]; E],
        band: [0.0; TILE],
        first: [0; TILE],
        count: [0; TILE],
        lower: [0; E],
        flipped: 0,
    };

    /// Takes over the lines that planes made for regular samples, for the lanes in `alive` of which one band serves all, on all rows of
    /// the light. Returns those lanes.
    #[inline(always)]
    pub fn take_over<L: Lanes, P: PrecisionMode>(
        &mut self,
        lines: &Lines<E>,
        light: &LatticeLight,
        planes: usize,
        alive: u32,
    ) -> u32 {
        self.lower = lines.lower;
        self.flipped = lines.flipped;
        let mut taken = 0;
        let mut first = 0;
        while first < TILE {
            let wanted = alive >> first & ((1 << L::WIDTH) - 1);
            if wanted != 0 {
                taken |= self.take_chunk::<L, P>(lines, light, planes, first, wanted) << first;
            }
            first += L::WIDTH;
        }
        taken
    }

    #[inline(always)]
    fn take_chunk<L: Lanes, P: PrecisionMode>(
        &mut self,
        lines: &Lines<E>,
        light: &LatticeLight,
        planes: usize,
        first: usize,
        wanted: u32,
    ) -> u32 {
        let (mut taken, mut doubt) = (wanted, L::splat(0.0));
        let mut start = [L::splat(0.0); E];
        let mut k = 0;
        while k < planes {
            let mut slope = L::load(&lines.slope[k], first);
            start[k] = L::load(&lines.start[k], first);
            if P::CERTIFIED {
                let mut own = L::load(&lines.doubt[k], first);
                let steep = own.ge(L::splat(MOST_PLANE_DOUBT));
                if L::bits(steep) & wanted != 0 {
                    let crossing = Crossing::of(slope, start[k], own, light.columns);
                    taken &= !(crossing.stuck & L::bits(steep));
                    slope = L::select(steep, crossing.slope, slope);
                    start[k] = L::select(steep, crossing.start, start[k]);
                    own = L::select(steep, L::splat(0.0), own);
                }
                doubt = doubt.max(own);
            }
            slope.store(&mut self.slope[k], first);
            k += 1;
        }
        let (below, above) = (doubt, L::splat(1.0).sub(doubt));
        let mut k = 0;
        while k < planes {
            let lower = L::mask(lines.lower[k] >> first);
            start[k].add(L::select(lower, below, above)).store(&mut self.start[k], first);
            k += 1;
        }
        if P::CERTIFIED {
            doubt.add(doubt).store(&mut self.band, first);
        }
        L::store_ints(L::splat_int(0), &mut self.first, first);
        L::store_ints(L::splat_int(light.rows as i32), &mut self.count, first);
        taken
    }

    /// Writes the outlines of a triangle for the lanes in `wanted`. `E` is at least 3, or 4 for a mixed
    /// triangle, whose own plane is the fourth side.
    #[inline(always)]
    pub fn outline<L: Lanes, P: PrecisionMode, S: Samples>(
        &mut self,
        grid: &LightGrid,
        view: &View<L::Long>,
        occluder: &Occluder,
        mixed: bool,
        wanted: u32,
    ) -> Seen {
        let (corners, lost, lost_height) = view.corners::<L, P>(&occluder.from(view.offsets.base));
        let mut own = OwnSide::NONE;
        if mixed {
            own = OwnSide::of::<L, P, S>(grid, occluder);
            if own.stuck {
                return Seen { outlined: 0, unknown: wanted };
            }
        }
        let triangle = Triangle { corners, lost, lost_height, own };
        self.lower = [0; E];
        self.flipped = 0;
        let mut seen = Seen { outlined: 0, unknown: 0 };
        let mut first = 0;
        while first < TILE {
            let lanes = wanted >> first & ((1 << L::WIDTH) - 1);
            if lanes != 0 {
                let chunk = self.chunk::<L, P, S>(view, &triangle, mixed, first, lanes);
                seen.outlined |= chunk.outlined << first;
                seen.unknown |= chunk.unknown << first;
            }
            first += L::WIDTH;
        }
        seen
    }

    #[inline(always)]
    fn chunk<L: Lanes, P: PrecisionMode, S: Samples>(
        &mut self,
        view: &View<L::Long>,
        triangle: &Triangle,
        mixed: bool,
        first: usize,
        wanted: u32,
    ) -> Seen {
        let at = [L::load(&view.at[0], first), L::load(&view.at[1], first), L::load(&view.at[2], first)];
        let mut front = wanted & view.usable >> first;
        // Heights must exceed what is lost in them.
        let least = L::splat(if P::CERTIFIED { triangle.lost_height * LEAST_HEIGHT + 1.0e-3 } else { 1.0e-3 });
        let a = view.corner::<L>(first, &at, &triangle.corners, 0, least, &mut front);
        let b = view.corner::<L>(first, &at, &triangle.corners, 1, least, &mut front);
        let c = view.corner::<L>(first, &at, &triangle.corners, 2, least, &mut front);
        // A triangle that lies lower than the receiver does not come between it and the light.
        let wanted = wanted & !L::bits(L::splat(0.0).sub(least).ge(a.rise.max(b.rise).max(c.rise)));
        let front = front & wanted;
        if front == 0 {
            return Seen { outlined: 0, unknown: wanted };
        }

        let (zero, last_column, last_row) = (L::splat(0.0), L::splat(view.last_column), L::splat(view.last_row));
        let (left, right) = (a.column.min(b.column).min(c.column), a.column.max(b.column).max(c.column));
        let (low, high) = (a.row.min(b.row).min(c.row), a.row.max(b.row).max(c.row));
        // δ of the module's notes.
        let mut off = zero;
        if P::CERTIFIED {
            let e = right.max(zero.sub(left)).max(high.max(zero.sub(low)));
            let inverse = a.inverse.max(b.inverse).max(c.inverse);
            off = view.uncertainty::<L>(at[2], e, inverse, triangle.lost, triangle.lost_height);
        }

        // Twice the area, positive where the receiver is on the triangle's far side.
        let (ab, ac) = ([b.column.sub(a.column), b.row.sub(a.row)], [c.column.sub(a.column), c.row.sub(a.row)]);
        let area = ac[0].mul(ab[1]).sub(ab[0].mul(ac[1]));
        let mut unknown = wanted & !front;
        let (positive, negative);
        if P::CERTIFIED {
            // Corners that fall on one point have no orientation.
            let least_area = right.sub(left).add(high.sub(low)).mul(off).mul(L::splat(6.0));
            let least_area = least_area.max(L::splat(f32::MIN_POSITIVE));
            positive = L::bits(area.ge(least_area));
            negative = L::bits(zero.sub(least_area).ge(area));
            unknown |= !positive & !negative;
        } else {
            positive = L::bits(area.ge(L::splat(f32::MIN_POSITIVE)));
            negative = !positive;
        }
        // A triangle that faces the light is seen from its far side only.
        let mut dropped = if mixed { 0 } else { negative };

        // Rows that may change, and whether any sample may.
        let half = L::splat(0.5);
        // Samples of a row lie on it, or up to so much beyond.
        let spread = L::splat(if S::JITTERED { LAST_PLACE } else { 0.0 });
        let (lowest, after) =
            if S::JITTERED { (low.sub(spread), last_row.sub(spread).add(half)) } else { (low, last_row.add(half)) };
        let from = lowest.sub(off).max(zero.sub(half)).min(after).ceil();
        let end = high.add(off).min(after).max(zero.sub(half)).add(L::splat(1.0)).floor();
        dropped |= !L::less(from, end);
        dropped |= !L::bits(L::both(right.add(off).ge(zero), last_column.ge(left.sub(off))));
        dropped &= front;
        unknown = wanted & unknown & !dropped;
        let candidates = wanted & front & !dropped;
        if candidates == 0 {
            return Seen { outlined: 0, unknown };
        }
        L::store_ints(from, &mut self.first, first);
        L::store_ints(L::sub_ints(end, from), &mut self.count, first);

        let bc = [c.column.sub(b.column), c.row.sub(b.row)];
        let ca = [zero.sub(ac[0]), zero.sub(ac[1])];
        // From the other side the corners go round the other way.
        let (ab, bc, ca) = if mixed {
            let turned = L::mask(negative);
            (turn(ab, turned), turn(bc, turned), turn(ca, turned))
        } else {
            (ab, bc, ca)
        };
        let mut sides =
            [Side::new::<P, S>(&a, &b, &c, ab), Side::new::<P, S>(&b, &c, &a, bc), Side::new::<P, S>(&c, &a, &b, ca)];
        let mut doubt = zero;
        if P::CERTIFIED {
            let shallowest = sides[0].rise.min(sides[1].rise).min(sides[2].rise);
            if candidates & !L::bits(shallowest.ge(L::splat(flat::<S>()))) != 0 {
                let mut k = 0;
                while k < 3 {
                    unknown |= candidates & sides[k].cut_flat::<S>(off);
                    k += 1;
                }
            }
            doubt = sides[0].steep.max(sides[1].steep).max(sides[2].steep).mul_add(off, off);
            if mixed {
                doubt = doubt.max(L::splat(triangle.own.doubt));
            }
            doubt.add(doubt).store(&mut self.band, first);
            unknown |= candidates & L::bits(doubt.ge(L::splat(MOST_DOUBT)));
        }
        let (below, above) = (doubt, L::splat(1.0).sub(doubt));
        let mut k = 0;
        while k < 3 {
            let side = &sides[k];
            side.slope.store(&mut self.slope[k], first);
            side.start.add(L::select(side.lower, below, above)).store(&mut self.start[k], first);
            self.lower[k] |= L::bits(side.lower) << first;
            k += 1;
        }
        if mixed {
            let all = (1 << L::WIDTH) - 1;
            let lower = if triangle.own.lower { negative ^ all } else { negative } & all;
            let start = L::splat(triangle.own.start).add(L::select(L::mask(lower), below, above));
            L::splat(triangle.own.slope).store(&mut self.slope[3 % E], first);
            start.store(&mut self.start[3 % E], first);
            self.lower[3 % E] |= lower << first;
            self.flipped |= (negative & all) << first;
        }
        Seen { outlined: candidates & !unknown, unknown }
    }
}

/// `−along` in the lanes of `turned`.
#[inline(always)]
fn turn<L: Lanes>(along: [L; 2], turned: L::Mask) -> [L; 2] {
    let zero = L::splat(0.0);
    [L::select(turned, zero.sub(along[0]), along[0]), L::select(turned, zero.sub(along[1]), along[1])]
}

/// A triangle from a group's base.
struct Triangle {
    /// Its corners along the view's axes.
    corners: [[f32; 4]; 3],
    /// What it contributes to δ, in units of ε: B + D and B_h + D_h.
    lost: f32,
    lost_height: f32,
    own: OwnSide,
}
