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
//! relative to the light (j_p, i_p, h_p) and to that one receiver, corners relative to it too, with [`Real`], and rounded
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
//! rounding by less than `δ·(w + h)`. So the sign of T' is that of T where twice its area is at least `6δ·(w + h)` (which
//! implies w + h ≥ 24δ, and so covers the quadratic term). It tells the receiver's side of the triangle's plane.
//!
//! *Flat sides*, of less than 1/32 row, have no usable slope. If no row lies within δ of one, it separates whole rows:
//! those on the side of the third corner, where the other two sides alone bound T', from those where there is nothing of
//! it. A line that is all but parallel to the rows stands for it.

use glam::{IVec3, Vec3};

use crate::{
    doubt::Margins,
    edge_plane::{LightGrid, Lines, Occluder, ReceiverTile, cross_magnitudes, float},
    lanes::{Lanes, TILE},
    light::{LatticeLight, MAX_SAMPLES},
    precision::PrecisionMode,
    real::{Axis, Real},
};

/// Second-order terms, and the bound's own arithmetic.
const SPARE: f32 = 1.125;
/// Heights are used where they exceed their sum over absolute values by this: relative errors stay small.
const LEAST_HEIGHT: f32 = 1.0 / 1024.0;
/// Sides that rise by less, in rows, have no usable slope.
const FLAT: f32 = 1.0 / 32.0;
/// The same where nothing is certified.
const LEAST_RISE: f32 = 1.0e-6;
/// The slope that stands for a flat side, in columns a row: over `FLAT_MARGIN` it crosses the whole grid.
const FLAT_SLOPE: f32 = (1 << 22) as f32;
/// The same for lines that planes made: their doubts differ much from plane to plane, and the largest counts for all.
const MOST_PLANE_DOUBT: f32 = 1.0 / 64.0;
/// The least slope of a triangle's own plane along the columns that is divided by, as a part of its largest value.
const LEAST_COLUMN: f32 = 1.0 / (1 << 20) as f32;
/// A column off any grid: larger doubts make no difference.
const MOST_COLUMN: f32 = (1 << 30) as f32;
/// How far from a flat side rows must lie beyond δ, in rows. (Rounding moves the cut by less than δ.)
const FLAT_MARGIN: f32 = 1.0 / (1 << 14) as f32;
/// Doubts of as many columns or more are not looked at here: half a column would hold no certain one.
const MOST_DOUBT: f32 = 0.25;

/// Sixteen receivers in the light's sheared frame.
#[derive(Clone, Copy, Debug)]
pub struct View<R> {
    /// Sheared axes: columns, rows, and minus the height.
    axes: [Axis<R>; 3],
    /// The receiver that all points are placed from.
    pub(crate) base: IVec3,
    /// Receivers from the base, lattice units, and their limits.
    pub(crate) offset: [[f32; TILE]; 3],
    pub(crate) offset_limit: Vec3,
    /// Receivers' columns, rows and heights.
    at: [[f32; TILE]; 3],
    /// Receivers along the axes, from the base.
    beside: [[f32; TILE]; 3],
    /// Lanes that are high enough above the light plane.
    usable: u32,
    last_column: f32,
    last_row: f32,
    bound: ViewBound,
}

/// What the receivers contribute to δ, in units of ε.
#[derive(Clone, Copy, Debug, Default)]
struct ViewBound {
    /// Magnitudes of the axes, for what dot products lose.
    reach: Vec3,
    height: Vec3,
    /// B and B_h.
    beside: f32,
    beside_height: f32,
    /// Terms of δ: constant, times e, times q, times e·q.
    constant: f32,
    per_e: f32,
    per_q: f32,
    per_eq: f32,
    /// Largest |j_p|, |i_p|.
    aside: f32,
}

impl<R: Real> View<R> {
    /// The receivers of `active` lanes (not none) as the light sees them.
    #[inline(always)]
    pub fn new<L: Lanes, P: PrecisionMode>(grid: &LightGrid, receivers: &ReceiverTile, active: u32) -> Self {
        let [u, v, down] = R::axes(grid);
        let base = receivers.point(active.trailing_zeros() as usize);
        let middle = base - grid.light.origin;
        let frame = &grid.frame;
        let depth = R::from_f32(Lanes::min(R::dot(&down, middle).to_f32(), -1.0));
        let shear_u = R::dot(&u, middle).minus(R::from_f32(0.5), R::from_f32(frame.last_column)).over(depth);
        let shear_v = R::dot(&v, middle).minus(R::from_f32(0.5), R::from_f32(frame.last_row)).over(depth);
        let mut view = Self {
            axes: [sheared(&u, shear_u, &down), sheared(&v, shear_v, &down), down],
            base,
            offset: [[0.0; TILE]; 3],
            offset_limit: receivers.farthest(base, base),
            at: [[0.0; TILE]; 3],
            beside: [[0.0; TILE]; 3],
            usable: active,
            last_column: frame.last_column,
            last_row: frame.last_row,
            bound: ViewBound::default(),
        };
        let mut lane = 0;
        while lane < TILE {
            // Lanes without a receiver repeat one that is there, and so widen no bound.
            let p = if active >> lane & 1 == 1 { receivers.point(lane) } else { base };
            view.at[0][lane] = R::dot(&view.axes[0], p - grid.light.origin).to_f32();
            view.at[1][lane] = R::dot(&view.axes[1], p - grid.light.origin).to_f32();
            view.at[2][lane] = R::dot(&view.axes[2], grid.light.origin - p).to_f32();
            let offset = float(p - base);
            let mut k = 0;
            while k < 3 {
                view.beside[k][lane] = R::dot(&view.axes[k], p - base).to_f32();
                view.offset[k][lane] = offset[k];
                k += 1;
            }
            lane += 1;
        }
        if P::CERTIFIED {
            let normal = frame.normal.abs();
            let reach_u = frame.along_u.abs() + normal * Lanes::abs(shear_u.to_f32());
            let reach_v = frame.along_v.abs() + normal * Lanes::abs(shear_v.to_f32());
            view.certify::<L>(grid, receivers, reach_u.max(reach_v), normal);
        }
        view
    }

    #[inline(always)]
    fn certify<L: Lanes>(&mut self, grid: &LightGrid, receivers: &ReceiverTile, reach: Vec3, height: Vec3) {
        let farthest = receivers.farthest(grid.light.origin, grid.light.origin);
        let steps = float(grid.light.step_u).abs() + float(grid.light.step_v).abs();
        let heights = R::DOT_ERRORS * height.dot(farthest);
        let least = Lanes::max(heights * LEAST_HEIGHT, 1.0);
        let zero = L::splat(0.0);
        let (mut negative_lowest, mut aside, mut beside, mut beside_height) = (L::splat(f32::MIN), zero, zero, zero);
        let mut first = 0;
        while first < TILE {
            let high = L::load(&self.at[2], first);
            let all = (1 << L::WIDTH) - 1;
            self.usable &= !((L::bits(high.ge(L::splat(least))) ^ all) << first);
            negative_lowest = negative_lowest.max(zero.sub(high.max(L::splat(least))));
            aside = aside.max(L::load(&self.at[0], first).abs()).max(L::load(&self.at[1], first).abs());
            beside = beside.max(L::load(&self.beside[0], first).abs()).max(L::load(&self.beside[1], first).abs());
            beside_height = beside_height.max(L::load(&self.beside[2], first).abs());
            first += L::WIDTH;
        }
        let (lowest, aside) = (-negative_lowest.largest(), aside.largest());
        let axis = R::AXIS_ERRORS * reach.dot(steps);
        self.bound = ViewBound {
            reach: reach * R::DOT_ERRORS,
            height: height * R::DOT_ERRORS,
            beside: 2.0 * beside.largest(),
            beside_height: 2.0 * beside_height.largest(),
            constant: aside + R::DOT_ERRORS * reach.dot(farthest) + 8.0 + grid.skew / f32::EPSILON * 2.0,
            per_e: 18.0 + axis,
            per_q: heights / lowest + 9.0,
            per_eq: R::AXIS_ERRORS * height.dot(steps) / lowest,
            aside,
        };
    }

    /// Corners along the axes, from the base, and what is lost in the worst of them, beside and in height.
    #[inline(always)]
    fn corners<L: Lanes<Long = R>, P: PrecisionMode>(&self, occluder: &Occluder) -> ([[f32; 4]; 3], f32, f32) {
        let d = occluder.from(self.base);
        let out = L::dots(&self.axes, &d);
        let (mut lost, mut lost_height) = (self.bound.beside, self.bound.beside_height);
        if P::CERTIFIED && R::DOT_ERRORS > 0.0 {
            let mut c = 0;
            while c < 3 {
                let far = float(IVec3::new(d[0][c], d[1][c], d[2][c])).abs();
                lost = Lanes::max(lost, self.bound.beside + self.bound.reach.dot(far));
                lost_height = Lanes::max(lost_height, self.bound.beside_height + self.bound.height.dot(far));
                c += 1;
            }
        }
        (out, lost, lost_height)
    }
}

/// `axis − shear·down`
#[inline(always)]
fn sheared<R: Real>(axis: &Axis<R>, shear: R, down: &Axis<R>) -> Axis<R> {
    [axis[0].minus(shear, down[0]), axis[1].minus(shear, down[1]), axis[2].minus(shear, down[2])]
}

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
    const PLANES: usize = E;

    /// Twice the doubt counts as unsure: `start` was rounded when it was moved inwards.
    #[inline(always)]
    fn margin(&self, k: usize, lane: usize, row: f32, column: f32) -> (f32, f32) {
        let (band, x) = (self.band[lane], self.slope[k][lane] * row + self.start[k][lane]);
        let inside = if self.lower[k] >> lane & 1 == 1 { column - x } else { x - 1.0 - column };
        (inside + 0.5 * band, band)
    }

    #[inline(always)]
    fn flipped(&self, lane: usize) -> bool {
        self.flipped >> lane & 1 == 1
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

/// A corner as sixteen receivers see it.
#[derive(Clone, Copy)]
struct Corner<L> {
    column: L,
    row: L,
    /// −d_h
    rise: L,
    /// Its reciprocal.
    inverse: L,
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

    /// Takes over the lines that planes made, for the lanes in `alive` of which one band serves all, on all rows of
    /// the light. Returns those lanes.
    #[inline(always)]
    pub fn take_over<L: Lanes, P: PrecisionMode>(&mut self, lines: &Lines<E>, light: &LatticeLight, alive: u32) -> u32 {
        self.lower = lines.lower;
        self.flipped = lines.flipped;
        let mut taken = 0;
        let mut first = 0;
        while first < TILE {
            let wanted = alive >> first & ((1 << L::WIDTH) - 1);
            if wanted != 0 {
                taken |= self.take_chunk::<L, P>(lines, light, first, wanted) << first;
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
        first: usize,
        wanted: u32,
    ) -> u32 {
        let (mut taken, mut doubt) = (wanted, L::splat(0.0));
        let mut start = [L::splat(0.0); E];
        let mut k = 0;
        while k < E {
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
        while k < E {
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
    /// Writes the outlines of a triangle for the lanes in `wanted`. `E` is 3, or 4 for a mixed triangle, whose own plane is
    /// the fourth side.
    #[inline(always)]
    pub fn outline<L: Lanes, P: PrecisionMode>(
        &mut self,
        grid: &LightGrid,
        view: &View<L::Long>,
        occluder: &Occluder,
        wanted: u32,
    ) -> Seen {
        let (corners, lost, lost_height) = view.corners::<L, P>(occluder);
        let mut own = OwnSide::NONE;
        if E == 4 {
            own = OwnSide::of::<L, P>(grid, occluder);
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
                let chunk = self.chunk::<L, P>(view, &triangle, first, lanes);
                seen.outlined |= chunk.outlined << first;
                seen.unknown |= chunk.unknown << first;
            }
            first += L::WIDTH;
        }
        seen
    }

    #[inline(always)]
    fn chunk<L: Lanes, P: PrecisionMode>(
        &mut self,
        view: &View<L::Long>,
        triangle: &Triangle,
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
            let unit = SPARE * L::ROUNDOFF;
            let v = &view.bound;
            let e = right.max(zero.sub(left)).max(high.max(zero.sub(low)));
            let inverse = a.inverse.max(b.inverse).max(c.inverse);
            // δ as in the notes, sorted by what it is multiplied with.
            let lost_height = triangle.lost_height * unit;
            let of_e = (v.per_e + v.per_q) * unit;
            let constant = (v.constant + v.aside * v.per_q) * unit;
            off = e.mul_add(L::splat(of_e), L::splat(constant));
            let per_inverse = at[2].mul_add(L::splat(triangle.lost * unit), L::splat(v.aside * lost_height));
            off = inverse.mul_add(e.mul_add(L::splat(lost_height), per_inverse), off);
            if L::Long::AXIS_ERRORS > 0.0 {
                off = e.mul(e.add(L::splat(v.aside))).mul_add(L::splat(v.per_eq * unit), off);
            }
        }

        // Twice the area, positive where the receiver is on the triangle's far side.
        let (ab, ac) = ([b.column.sub(a.column), b.row.sub(a.row)], [c.column.sub(a.column), c.row.sub(a.row)]);
        let area = ac[0].mul(ab[1]).sub(ab[0].mul(ac[1]));
        let mut unknown = wanted & !front;
        let (positive, negative);
        if P::CERTIFIED {
            let least_area = right.sub(left).add(high.sub(low)).mul(off).mul(L::splat(6.0));
            positive = L::bits(area.ge(least_area));
            negative = L::bits(zero.sub(least_area).ge(area));
            unknown |= !positive & !negative;
        } else {
            positive = L::bits(area.ge(L::splat(f32::MIN_POSITIVE)));
            negative = !positive;
        }
        // A triangle that faces the light is seen from its far side only.
        let mut dropped = if E == 3 { negative } else { 0 };

        // Rows that may change, and whether any sample may.
        let half = L::splat(0.5);
        let from = low.sub(off).max(zero.sub(half)).min(last_row.add(half)).ceil();
        let end = high.add(off).min(last_row.add(half)).max(zero.sub(half)).add(L::splat(1.0)).floor();
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
        let mut sides = if E == 3 {
            [Side::new::<P>(&a, &b, &c, ab), Side::new::<P>(&b, &c, &a, bc), Side::new::<P>(&c, &a, &b, ca)]
        } else {
            // From the other side the corners go round the other way.
            let turned = L::mask(negative);
            [
                Side::new::<P>(&a, &b, &c, turn(ab, turned)),
                Side::new::<P>(&b, &c, &a, turn(bc, turned)),
                Side::new::<P>(&c, &a, &b, turn(ca, turned)),
            ]
        };
        let mut doubt = zero;
        if P::CERTIFIED {
            let shallowest = sides[0].rise.min(sides[1].rise).min(sides[2].rise);
            if candidates & !L::bits(shallowest.ge(L::splat(FLAT))) != 0 {
                let mut k = 0;
                while k < 3 {
                    unknown |= candidates & sides[k].cut_flat(off);
                    k += 1;
                }
            }
            doubt = sides[0].steep.max(sides[1].steep).max(sides[2].steep).mul_add(off, off);
            if E == 4 {
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
        if E == 4 {
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

/// One side of sixteen outlines.
#[derive(Clone, Copy)]
struct Side<L: Lanes> {
    /// Columns a row.
    slope: L,
    /// Column at row 0, not yet moved inwards.
    start: L,
    /// Whether it bounds the columns from below.
    lower: L::Mask,
    /// |slope|, 0 where a cut stands for the side.
    steep: L,
    /// Rows from one end to the other, either way.
    rise: L,
    /// Rows of both ends.
    ends: [L; 2],
    /// Row of the corner that is not on it.
    opposite: L,
}

impl<L: Lanes> Side<L> {
    /// Between two corners, `along` columns and rows from one to the other, whichever goes clockwise.
    #[inline(always)]
    fn new<P: PrecisionMode>(corner: &Corner<L>, other: &Corner<L>, opposite: &Corner<L>, along: [L; 2]) -> Self {
        let zero = L::splat(0.0);
        let rise = along[1].abs();
        let lower = along[1].ge(zero);
        let inverse = rise.max(L::splat(if P::CERTIFIED { FLAT } else { LEAST_RISE })).recip();
        let slope = along[0].mul(L::select(lower, inverse, zero.sub(inverse)));
        let start = corner.column.sub(slope.mul(corner.row));
        let ends = [corner.row, other.row];
        Self { slope, start, lower, steep: slope.abs(), rise, ends, opposite: opposite.row }
    }

    /// In flat lanes, puts a line along the rows in the place of the side. Returns the lanes in which a row lies within
    /// `off` of the side: nothing can stand for it there.
    #[inline(always)]
    fn cut_flat(&mut self, off: L) -> u32 {
        let (zero, off) = (L::splat(0.0), off.add(L::splat(FLAT_MARGIN)));
        let sloped = self.rise.ge(L::splat(FLAT));
        let [one, other] = self.ends;
        let top = one.max(other).add(off);
        let stuck = top.integer_below(top.sub(one.min(other).sub(off)));
        // The third corner tells which rows are inside: a side so short may well run along the columns. (Where that corner is
        // as near, no row lies within the triangle.)
        let middle = one.add(other).mul(L::splat(0.5));
        let cut = L::select(middle.ge(self.opposite), L::splat(FLAT_SLOPE), L::splat(-FLAT_SLOPE));
        self.slope = L::select(sloped, self.slope, cut);
        self.start = L::select(sloped, self.start, zero.sub(cut.mul(middle)));
        self.steep = L::select(sloped, self.steep, zero);
        self.lower = L::either(self.lower, L::not(sloped));
        stuck & !L::bits(sloped)
    }
}

/// A line so steep that it crosses the whole grid between two rows, as a cut along them.
struct Crossing<L> {
    slope: L,
    start: L,
    /// Lanes in which it crosses a row on its way: nothing can stand for it there.
    stuck: u32,
}

impl<L: Lanes> Crossing<L> {
    /// Of the line `slope·i + start`, known to within `doubt` columns.
    #[inline(always)]
    fn of(slope: L, start: L, doubt: L, columns: u32) -> Self {
        let zero = L::splat(0.0);
        let upwards = slope.ge(zero);
        let inverse = slope.abs().max(L::splat(1.0e-6)).recip();
        let inverse = L::select(upwards, inverse, zero.sub(inverse));
        // Rows at which the column is one off the grid, and the doubt more. Beyond the light's rows it does not matter
        // where: the clamps lie between rows.
        let one = L::splat(-1.0).sub(doubt).sub(start).mul(inverse);
        let other = L::splat(columns as f32).add(doubt).sub(start).mul(inverse);
        let (lowest, highest) = (L::splat(-8.5), L::splat(MAX_SAMPLES as f32 + 8.5));
        let bottom = one.min(other).sub(L::splat(FLAT_MARGIN)).max(lowest).min(highest);
        let top = one.max(other).add(L::splat(FLAT_MARGIN)).max(lowest).min(highest);
        let cut = L::select(upwards, L::splat(FLAT_SLOPE), L::splat(-FLAT_SLOPE));
        let middle = bottom.add(top).mul(L::splat(0.5));
        Self { slope: cut, start: zero.sub(cut.mul(middle)), stuck: top.integer_below(top.sub(bottom)) }
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

/// The line in which a mixed triangle's plane meets the light, the same for all receivers; as seen from its positive side.
#[derive(Clone, Copy)]
struct OwnSide {
    slope: f32,
    start: f32,
    doubt: f32,
    lower: bool,
    /// No line stands for it.
    stuck: bool,
}

impl OwnSide {
    const NONE: Self = Self { slope: 0.0, start: 0.0, doubt: 0.0, lower: true, stuck: false };

    /// The form `n·(L − a)` over the light, n the triangle's normal: its error is that of three products of three factors
    /// (see [`Real::SIDE_ERROR`]); its line has the roundoffs of a reciprocal, a product, the evaluation and the move.
    #[inline(always)]
    fn of<L: Lanes, P: PrecisionMode>(grid: &LightGrid, occluder: &Occluder) -> Self {
        let light = &grid.light;
        let [a, b, c] = occluder.corners();
        let (e, f, d) = (b - a, c - a, light.origin - a);
        let normal = L::Long::cross(e, f);
        let (at_origin, per_row) = (L::Long::dot(&normal, d).to_f32(), L::Long::dot(&normal, light.step_v).to_f32());
        let per_column = L::Long::dot(&normal, light.step_u).to_f32();
        let lower = per_column >= 0.0;
        // A smaller slope would make quotients that overflow. With this one the line crosses the same rows, less steeply.
        let samples = MAX_SAMPLES as f32;
        let whole = Lanes::abs(at_origin) + samples * Lanes::abs(per_row);
        let magnitude = Lanes::max(Lanes::max(Lanes::abs(per_column), whole * LEAST_COLUMN), 1.0e-20);
        let signed = if lower { -magnitude } else { magnitude };
        let (slope, start) = (per_row / signed, at_origin / signed);
        let mut own = Self { slope, start, doubt: 0.0, lower, stuck: false };
        if P::CERTIFIED {
            let steps = (float(light.step_u).abs() + float(light.step_v).abs()) * samples;
            let lost = L::Long::SIDE_ERROR * cross_magnitudes(float(e), float(f)).dot(float(d).abs() + steps);
            let rounding = 8.0 * L::ROUNDOFF * (Lanes::abs(start) + samples * Lanes::abs(slope) + samples);
            own.doubt = Lanes::min(lost / magnitude, MOST_COLUMN) + rounding;
            if own.doubt >= MOST_PLANE_DOUBT {
                let crossing = Crossing::of(slope, start, own.doubt, light.columns);
                own = Self {
                    slope: crossing.slope,
                    start: crossing.start,
                    doubt: 0.0,
                    lower,
                    stuck: crossing.stuck != 0,
                };
            }
        }
        own
    }
}

impl<R: Real> View<R> {
    /// Projects a corner. Lanes of which it is not clearly above the receiver leave `front`; their corner is finite.
    #[inline(always)]
    fn corner<L: Lanes>(
        &self,
        first: usize,
        at: &[L; 3],
        corners: &[[f32; 4]; 3],
        c: usize,
        least: L,
        front: &mut u32,
    ) -> Corner<L> {
        let rise = L::splat(corners[2][c]).sub(L::load(&self.beside[2], first));
        *front &= L::bits(rise.ge(least));
        let inverse = rise.max(least).recip();
        let s = at[2].mul(inverse);
        Corner {
            column: L::splat(corners[0][c]).sub(L::load(&self.beside[0], first)).mul_add(s, at[0]),
            row: L::splat(corners[1][c]).sub(L::load(&self.beside[1], first)).mul_add(s, at[1]),
            rise,
            inverse,
        }
    }
}
