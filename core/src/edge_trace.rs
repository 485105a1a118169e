//! The edges of the silhouette as lines over the light's rows, for sixteen receivers; and what they add to the depths.
//!
//! # What an edge adds
//! Let an edge run from v to u, seen at columns and rows (x, y), and let `r = ⌈y⌉` be the first row not below an end. In the
//! rows between `r(v)` and `r(u)` the columns from the edge on are deeper by its sum, or, where it descends, shallower. And
//! an end left of column 0 takes that back for all rows from r on: edges that are wholly to the left add nothing, and
//! where the silhouette comes in from the left, the rows beyond differ in all columns. Over a closed polygon this is the
//! rule of winding numbers, seen from the left. Edges that the full-coverage test has dropped are no loss: none of them
//! comes between the receiver and R, the samples' hull, so whatever they would add they add to all of R alike.
//!
//! # Certainty
//! An end is computed once for all edges that share it, with the same operations, and known to within δ
//! ([`crate::outline`]). Let all ends move from where they are to where they were computed: D is then counted for other
//! edges, and right for all samples that no edge passes on the way. A sample in a row of an edge that is nearer than
//! `(1 + |slope|)·δ` to its line is decided in integers; if it lies on the edge it is blocked, since triangles are closed.
//! Receivers are *lost* to this module, and go by all triangles, where
//! - a row passes within δ of an end, and a column within twice the doubt: the row may belong to the next edge;
//! - an end lies within δ of a border of R: its next edge may have been dropped;
//! - an edge rises by so little that it has no slope, and a row passes through it;
//! - an edge has an end that is not clearly above the receiver, or δ is large;
//! - sample (0, 0), whose depth is counted otherwise, is itself near an edge.

use glam::IVec3;

use crate::{
    depth::Depths,
    edge_plane::{LightGrid, ReceiverTile},
    exact::{self, Wide},
    jitter::{LAST_PLACE, PLACES, Samples},
    jittered_edges::{Crossing, MOST_OFF, first_place, near_sample, step, within_places},
    jittered_rows::slack,
    lanes::{Lanes, TILE},
    light::MAX_SAMPLES,
    mask_word::MaskWord,
    precision::PrecisionMode,
    row_mask::{MASK_ROWS, MaskRows},
    silhouette::SilhouetteEdge,
    statistics::Tally,
    view::{Corner, LEAST_HEIGHT, SPARE, View},
};

/// Edges that rise by less, in rows, have no usable slope.
const FLAT: f32 = 1.0 / 1024.0;
/// Largest δ, and largest doubt of a column, that is worked with.
const MOST_DOUBT: f32 = 0.125;

/// One edge as sixteen receivers see it.
#[derive(Clone, Copy, Debug)]
pub struct EdgeTrace {
    /// Columns a row.
    slope: [f32; TILE],
    /// Column at row 0.
    start: [f32; TILE],
    /// How well a column is known.
    doubt: [f32; TILE],
    /// First row not below either end; of jittered samples, first row of places.
    rows: [[i32; TILE]; 2],
    /// Bit l: in lane l the end is left of column 0.
    left: [u32; 2],
}

/// What becomes of the lanes that an edge was asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Traced {
    /// The edge adds something.
    pub(crate) crossed: u32,
    /// Nothing can be said.
    pub(crate) lost: u32,
}

impl EdgeTrace {
    /// No edge.
    pub const NONE: Self =
        Self { slope: [0.0; TILE], start: [0.0; TILE], doubt: [0.0; TILE], rows: [[0; TILE]; 2], left: [0; 2] };

    /// Traces an edge for the lanes in `wanted`.
    #[inline(always)]
    pub(crate) fn trace<L: Lanes, P: PrecisionMode, S: Samples>(
        &mut self,
        view: &View<L::Long>,
        samples: &S,
        edge: &SilhouetteEdge,
        wanted: u32,
    ) -> Traced {
        let (mut ends, lost, lost_height) = view.corners::<L, P>(&edge.relative_to(view.offsets.base));
        self.left = [0; 2];
        let mut traced = Traced { crossed: 0, lost: 0 };
        let Some(cut) = cut_behind::<L>(view, &mut ends, lost_height) else {
            return Traced { crossed: 0, lost: wanted };
        };
        let known = Known { lost, lost_height, cut };
        let mut first = 0;
        while first < TILE {
            let lanes = wanted >> first & ((1 << L::WIDTH) - 1);
            if lanes != 0 {
                let chunk = self.chunk::<L, P, S>(view, samples, &ends, &known, first, lanes);
                traced.crossed |= chunk.crossed << first;
                traced.lost |= chunk.lost << first;
            }
            first += L::WIDTH;
        }
        traced
    }

    #[inline(always)]
    fn chunk<L: Lanes, P: PrecisionMode, S: Samples>(
        &mut self,
        view: &View<L::Long>,
        samples: &S,
        ends: &[[f32; 4]; 3],
        known: &Known,
        first: usize,
        wanted: u32,
    ) -> Traced {
        let at = [L::load(&view.at[0], first), L::load(&view.at[1], first), L::load(&view.at[2], first)];
        let Known { lost, lost_height, cut: lost_behind } = *known;
        let least = L::splat(if P::CERTIFIED { lost_height * LEAST_HEIGHT + 1.0e-3 } else { 1.0e-3 });
        let usable = view.usable >> first & ((1 << L::WIDTH) - 1);
        let mut above = [usable; 2];
        let mut a = view.corner::<L>(first, &at, ends, 0, least, &mut above[0]);
        let mut b = view.corner::<L>(first, &at, ends, 1, least, &mut above[1]);
        let zero = L::splat(0.0);
        // An edge that lies lower than the receiver does not come between it and the light.
        let wanted = wanted & !L::bits(zero.sub(least).ge(a.rise.max(b.rise)));
        let (last_column, last_row) = (L::splat(view.last_column), L::splat(view.last_row));

        let cut = wanted & (above[0] ^ above[1]);
        let mut drift = zero;
        if cut != 0 {
            let offsets = [view.offset_of::<L>(first, ends, 0), view.offset_of::<L>(first, ends, 1)];
            drift = cut_below::<L>(&mut a, &mut b, &offsets, L::mask(above[0]), L::mask(cut), [lost, lost_height]);
        }
        let front = wanted & ((above[0] & above[1]) | cut);
        let mut off = zero;
        if P::CERTIFIED {
            let e = a.column.abs().max(b.column.abs()).max(a.row.abs()).max(b.row.abs());
            off = view.uncertainty::<L>(at[2], e, a.inverse.max(b.inverse), lost, lost_height);
            off = off.add(drift).add(L::splat(lost_behind));
        }
        let along = [b.column.sub(a.column), b.row.sub(a.row)];
        let rise = along[1].abs();
        let inverse = rise.max(L::splat(FLAT)).recip();
        let slope = along[0].mul(L::select(along[1].ge(zero), inverse, zero.sub(inverse)));
        let mut doubt = slope.abs().mul_add(off, off);
        if S::JITTERED && P::CERTIFIED {
            doubt = doubt.add(slacks(slope));
        }
        let start = a.column.sub(slope.mul(a.row));
        slope.store(&mut self.slope, first);
        start.store(&mut self.start, first);

        // What lies on one side of R adds the same to all of it.
        let margin = off.add(L::splat(1.0e-3));
        let (high_column, high_row) = (last_column.add(margin), last_row.add(margin));
        let low = zero.sub(margin);
        let beside = L::either(low.ge(a.column.max(b.column)), a.column.min(b.column).ge(high_column));
        let beyond = L::either(low.ge(a.row.max(b.row)), a.row.min(b.row).ge(high_row));
        let wanted = wanted & !(L::bits(L::either(beside, beyond)) & front);
        // Nor need a line be known well that passes by.
        let (at_first, at_last) = (start, slope.mul_add(last_row, start));
        let passes = L::either(
            low.ge(at_first.max(at_last).add(doubt)),
            at_first.min(at_last).sub(doubt).ge(last_column.add(L::splat(1.0))),
        );
        let doubt = L::select(passes, zero, doubt);
        doubt.store(&mut self.doubt, first);

        // Rows, with half a row off the light on both sides.
        let half = L::splat(0.5);
        let (before, after) = (zero.sub(half), last_row.add(half));
        let (rows, ceils);
        if S::JITTERED {
            rows = [within_places(a.row, view.last_row), within_places(b.row, view.last_row)];
            ceils = [first_place(rows[0]), first_place(rows[1])];
        } else {
            rows = [a.row.max(before).min(after), b.row.max(before).min(after)];
            ceils = [rows[0].ceil(), rows[1].ceil()];
        }
        L::store_ints(ceils[0], &mut self.rows[0], first);
        L::store_ints(ceils[1], &mut self.rows[1], first);
        let left = [!L::bits(a.column.ge(zero)), !L::bits(b.column.ge(zero))];
        let lanes = front & wanted;
        self.left[0] |= (left[0] & lanes) << first;
        self.left[1] |= (left[1] & lanes) << first;

        let mut unsure = wanted & !front;
        // An end that was cut off is no other edge's.
        let own = [cut & !above[0], cut & !above[1]];
        if P::CERTIFIED {
            let sloped = L::bits(rise.ge(L::splat(FLAT)));
            unsure |= wanted & !L::bits(L::splat(if S::JITTERED { MOST_OFF } else { MOST_DOUBT }).ge(off));
            unsure |= wanted & sloped & !L::bits(L::splat(MOST_DOUBT).ge(doubt));
            let (low, high) = (rows[0].min(rows[1]).sub(off), rows[0].max(rows[1]).add(off));
            let places = L::splat(PLACES as f32);
            unsure |= wanted
                & !sloped
                & if S::JITTERED { meets(low.mul(places), high.mul(places)) } else { meets(low, high) };
            let mut k = 0;
            while k < 2 {
                let (column, row) = if k == 0 { (a.column, a.row) } else { (b.column, b.row) };
                let mut near = near_border(&column, zero, off);
                near |= near_border(&row, zero, off) | near_border(&row, last_row, off);
                let within = column.max(before).min(last_column.add(half));
                let wide = doubt.add(doubt).min(L::splat(MOST_DOUBT));
                if S::JITTERED {
                    let end = if k == 0 { &a } else { &b };
                    let last_column = view.last_column - LAST_PLACE;
                    near |= near_sample(end, rows[k], [off, wide], last_column, samples);
                } else {
                    near |= meets(rows[k].sub(off), rows[k].add(off)) & meets(within.sub(wide), within.add(wide));
                }
                unsure |= near & !own[k];
                k += 1;
            }
        }
        let lost = wanted & unsure;
        let spans = L::less(ceils[0], ceils[1]) | L::less(ceils[1], ceils[0]);
        let crossed = lanes & !lost & (spans | (left[0] ^ left[1]));
        Traced { crossed, lost }
    }
}

/// [`slack`], lane by lane.
#[inline(always)]
fn slacks<L: Lanes>(slope: L) -> L {
    let none = slack::<L>(0.0);
    slope.abs().mul_add(L::splat(slack::<L>(1.0) - none), L::splat(none))
}

/// How well the ends of an edge are known, in units of ε; and what a cut at the light adds to δ.
#[derive(Clone, Copy)]
struct Known {
    lost: f32,
    lost_height: f32,
    cut: f32,
}

/// Cuts an edge where it passes the light plane: what lies behind it stands between nothing and the light, though it may
/// be seen beyond. (Where it passes, it is outside R: the planes of facing triangles do not meet R.) Returns what that adds to
/// δ: the error of the height, over the edge's slope, and the roundings of the interpolation. `None` where no end is surely in
/// front.
#[inline(always)]
fn cut_behind<L: Lanes>(view: &View<L::Long>, ends: &mut [[f32; 4]; 3], lost_height: f32) -> Option<f32> {
    let (at, beside) = (view.at[2][0], view.beside_height(0));
    let heights = [at - (ends[2][0] - beside), at - (ends[2][1] - beside)];
    let largest = Lanes::max(Lanes::abs(ends[2][0]), Lanes::abs(ends[2][1]));
    let error =
        L::ROUNDOFF * (8.0 * (Lanes::abs(at) + largest + Lanes::abs(beside)) + 2.0 * lost_height + view.bound.heights);
    let low = (heights[1] < heights[0]) as usize;
    if heights[low] >= error {
        return Some(0.0);
    }
    if heights[1 - low] < error {
        return None;
    }
    let span = heights[1 - low] - heights[low];
    let t = Lanes::min(heights[1 - low] / span, 1.0);
    let mut size = 0.0;
    let mut axis = 0;
    while axis < 3 {
        let (from, to) = (ends[axis][1 - low], ends[axis][low]);
        if axis < 2 {
            size = Lanes::max(size, Lanes::abs(from) + Lanes::abs(to));
        }
        ends[axis][low] = from + t * (to - from);
        axis += 1;
    }
    Some(2.0 * size * (2.0 * error / span + 16.0 * L::ROUNDOFF))
}

/// Cuts edges of which one end is not clearly above the receiver, in the lanes of `cut`; `first` tells where that is not the
/// first. Seen from the receiver such an edge runs on from its upper end and never ends, in the direction d in which it passes the
/// receiver's height. The lower end is put so far along it that all of the light is passed, on whichever side. Returns what
/// that adds to δ.
///
/// With offsets f and g of the upper and the lower end, and heights f_h ≥ 2·g_h, `d = f + t·(g − f)`, `t = f_h/(f_h − g_h)`, each
/// component has the errors of f and g, those of t (8ε, and the heights' own over their difference) and three roundings;
/// and the distance magnifies them.
#[inline(always)]
fn cut_below<L: Lanes>(
    a: &mut Corner<L>,
    b: &mut Corner<L>,
    offsets: &[[L; 3]; 2],
    first: L::Mask,
    cut: L::Mask,
    [lost, lost_height]: [f32; 2],
) -> L {
    let (upper, lower) = (select(first, &offsets[0], &offsets[1]), select(first, &offsets[1], &offsets[0]));
    let seen = [L::select(first, a.column, b.column), L::select(first, a.row, b.row)];
    let inverse = upper[2].sub(lower[2]).max(upper[2].mul(L::splat(0.5))).max(L::splat(1.0e-3)).recip();
    let t = upper[2].mul(inverse);
    let along = [lower[0].sub(upper[0]).mul_add(t, upper[0]), lower[1].sub(upper[1]).mul_add(t, upper[1])];
    let farthest = seen[0].abs().max(seen[1].abs()).add(L::splat(MAX_SAMPLES as f32));
    let longest = along[0].abs().max(along[1].abs()).max(L::splat(1.0e-6));
    let steps = farthest.add(farthest).mul(longest.recip());
    let end = [along[0].mul_add(steps, seen[0]), along[1].mul_add(steps, seen[1])];
    let sizes = upper[0].abs().max(upper[1].abs()).add(lower[0].abs().max(lower[1].abs()));
    let of_height = inverse.mul_add(L::splat(2.0 * lost_height), L::splat(12.0));
    let errors = sizes.mul_add(of_height, L::splat(2.0 * lost)).mul(L::splat(SPARE * L::ROUNDOFF));
    let kept_inverse = L::select(first, a.inverse, b.inverse);
    replace(a, L::both(cut, L::not(first)), end, kept_inverse);
    replace(b, L::both(cut, first), end, kept_inverse);
    // Heights that are all but alike have no quotient.
    let steady = upper[2].ge(lower[2].add(lower[2]));
    L::select(cut, L::select(steady, errors.mul(steps), L::splat(1.0)), L::splat(0.0))
}

#[inline(always)]
fn select<L: Lanes>(mask: L::Mask, one: &[L; 3], other: &[L; 3]) -> [L; 3] {
    [L::select(mask, one[0], other[0]), L::select(mask, one[1], other[1]), L::select(mask, one[2], other[2])]
}

#[inline(always)]
fn replace<L: Lanes>(corner: &mut Corner<L>, mask: L::Mask, end: [L; 2], inverse: L) {
    corner.column = L::select(mask, end[0], corner.column);
    corner.row = L::select(mask, end[1], corner.row);
    corner.inverse = L::select(mask, inverse, corner.inverse);
}

/// Lanes in which an integer lies in `low..=high`; both within 2^20.
#[inline(always)]
fn meets<L: Lanes>(low: L, high: L) -> u32 {
    high.integer_below(high.sub(low))
}

/// Lanes in which `x` lies within `off` of a border.
#[inline(always)]
fn near_border<L: Lanes>(x: &L, border: L, off: L) -> u32 {
    L::bits(off.ge(x.sub(border).abs()))
}

/// A receiver with its mask and its depths.
pub(crate) struct Seen<'a, W> {
    pub(crate) depths: &'a mut Depths<W>,
    pub(crate) mask: &'a mut MaskRows<W>,
    pub(crate) fallbacks: &'a mut Tally,
}

impl EdgeTrace {
    /// Adds the edge to the depths of one lane, for which it was traced and found crossing. Samples on the edge are blocked
    /// at once. Returns false where the lane is lost.
    #[inline(always)]
    pub(crate) fn add<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
        &self,
        grid: &LightGrid,
        samples: &S,
        receivers: &ReceiverTile,
        edge: &SilhouetteEdge,
        lane: usize,
        seen: &mut Seen<'_, W>,
    ) -> bool {
        let right = edge.right();
        let (one, other) = (self.rows[0][lane] as usize, self.rows[1][lane] as usize);
        if S::JITTERED {
            let columns = grid.light.columns;
            if self.left[0] >> lane & 1 == 1 {
                step::<L, W, S>(seen.depths, one, -right, columns, samples);
            }
            if self.left[1] >> lane & 1 == 1 {
                step::<L, W, S>(seen.depths, other, right, columns, samples);
            }
            let rises = one < other;
            let crossing = Crossing {
                grid,
                point: receivers.point(lane),
                edge,
                slope: self.slope[lane],
                start: self.start[lane],
                doubt: self.doubt[lane],
                places: if rises { [one, other] } else { [other, one] },
                rises,
            };
            return crossing.add::<L, W, P, S>(if rises { right } else { -right }, samples, seen);
        }
        if self.left[0] >> lane & 1 == 1 {
            seen.depths.step(one, -right);
        }
        if self.left[1] >> lane & 1 == 1 {
            seen.depths.step(other, right);
        }
        let rises = one < other;
        let (mut row, end, by) = if rises { (one, other, right) } else { (other, one, -right) };
        let (slope, start) = (L::splat(self.slope[lane]), L::splat(self.start[lane]));
        let (before, after) = (L::splat(-0.5), L::splat(grid.light.columns as f32 - 0.5));
        let doubt = L::splat(self.doubt[lane]);
        while row < end {
            let x = slope.mul_add(L::count_from(row), start).max(before).min(after);
            let mut columns = [0; TILE];
            L::store_ints(x.ceil(), &mut columns, 0);
            let here = if end - row < L::WIDTH { end - row } else { L::WIDTH };
            if P::CERTIFIED {
                let near = x.add(doubt).integer_below(doubt.add(doubt)) & ((1 << here) - 1);
                if near != 0 {
                    let at = Near { grid, point: receivers.point(lane), edge, rises, row };
                    let mut nearest = [0; TILE];
                    L::store_ints(x.add(L::splat(0.5)).floor(), &mut nearest, 0);
                    if !at.settle(near, &nearest, &mut columns, seen) {
                        return false;
                    }
                }
            }
            seen.depths.add(row, &columns, here, by);
            row += L::WIDTH;
        }
        true
    }
}

/// Rows of one receiver in which a column lies near an edge.
struct Near<'a> {
    grid: &'a LightGrid,
    point: IVec3,
    edge: &'a SilhouetteEdge,
    rises: bool,
    /// The first of sixteen.
    row: usize,
}

impl Near<'_> {
    /// Decides the columns in integers: in the rows of `near`, on which side of the edge the sample in column `nearest` lies.
    /// Returns false where that is sample (0, 0). Out of line: few come here.
    #[inline(never)]
    fn settle<W: MaskWord>(
        &self,
        mut near: u32,
        nearest: &[i32; TILE],
        columns: &mut [i32; TILE],
        seen: &mut Seen<'_, W>,
    ) -> bool {
        let form = exact::edge_form::<Wide>(self.grid.light, self.point, self.edge.from(), self.edge.to());
        while near != 0 {
            let k = near.trailing_zeros() as usize % TILE;
            near &= near - 1;
            let (row, column) = (self.row + k, nearest[k]);
            if (row, column) == (0, 0) {
                return false;
            }
            *seen.fallbacks += 1;
            // Positive on the right of the edge.
            let sign = form.sign_at(row as i32, column);
            columns[k] = column + if self.rises { sign < 0 } else { sign > 0 } as i32;
            if sign == 0 {
                let word = &mut seen.mask[row % MASK_ROWS];
                *word = word.or(W::span(column as u32, column as u32 + 1));
            }
        }
        true
    }
}

/// Clears what edges added to the lanes in `lost`.
#[inline(always)]
pub(crate) fn forget<W: MaskWord>(depths: &mut [Depths<W>; TILE], mut lost: u32, rows: u32) {
    while lost != 0 {
        let lane = lost.trailing_zeros() as usize % TILE;
        lost &= lost - 1;
        depths[lane].clear(rows);
    }
}
