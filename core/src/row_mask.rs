//! Rows of a mask from the lines of one triangle: half-open column intervals, then words.
//!
//! Seed: Wang et al. 2016, section 3.3 and Algorithm 3, lines 11 to 17. Departures: the partial masks of the planes are
//! not built and ANDed; the largest lower and the smallest upper bound give the interval, and one word a row is made from
//! it.
//!
//! Lines come in two kinds. Those of an outline (`outline`), by far the most, are moved inwards by one doubt for all, so
//! that one interval a row is sure; a bound with a column in the band before it is in doubt. Those of planes
//! (`edge_plane`) have a doubt each, and give two intervals: columns that are surely blocked (inner), and those that may be
//! (outer). Either way rows in doubt are only noted while rows are filled. Afterwards they are *settled*: their doubtful
//! columns are decided in integers (`doubt`), out of line and on one lane. Without certification, none is in doubt.

use crate::{
    doubt::{PairForms, PairIntegers},
    edge_plane::Lines,
    jitter::Regular,
    lanes::{Lanes, TILE},
    light::{LatticeLight, MAX_SAMPLES},
    mask_word::MaskWord,
    outline::Outlines,
    precision::PrecisionMode,
};

/// Rows of one receiver's mask, and room for one tile more, so that a tile of rows may start at any of the light's.
pub const MASK_ROWS: usize = MAX_SAMPLES as usize + if TILE > 1 { TILE } else { 0 };

/// Rows of one receiver. Those at and beyond the light's hold full words.
pub type MaskRows<W> = [W; MASK_ROWS];

/// The column intervals of a vector of rows, as the planes of one receiver bound them.
#[derive(Clone, Copy)]
struct Bounds<L> {
    /// First and last column that are surely blocked: every plane is moved by its doubt towards the blocked side.
    inner: (L, L),
    /// First and last column that may be blocked: every plane is moved the other way.
    outer: (L, L),
}

/// The bounds of `rows` for one receiver (`lane`); without certification, inner and outer are the same. They end half a
/// column outside the grid: that rounds to 0 or to `columns`, whichever way it is rounded.
#[inline(always)]
fn bounds<L: Lanes, const E: usize>(
    lines: &Lines<E>,
    planes: usize,
    lane: usize,
    rows: L,
    columns: u32,
    certified: bool,
) -> Bounds<L> {
    let (lowest, highest) = (L::splat(-0.5), L::splat(columns as f32 - 0.5));
    let (mut from_in, mut to_in, mut from_out, mut to_out) = (lowest, highest, lowest, highest);
    let mut k = 0;
    while k < planes {
        let along = L::splat(lines.slope[k][lane]).mul(rows);
        let (start, doubt) = (lines.start[k][lane], if certified { lines.doubt[k][lane] } else { 0.0 });
        let (above, below) = (along.add(L::splat(start + doubt)), along.add(L::splat(start - doubt)));
        if lines.lower[k] >> lane & 1 == 1 {
            from_in = from_in.max(above);
            from_out = from_out.max(below);
        } else {
            to_in = to_in.min(below);
            to_out = to_out.min(above);
        }
        k += 1;
    }
    Bounds { inner: (from_in.min(highest), to_in.max(lowest)), outer: (from_out.min(highest), to_out.max(lowest)) }
}

/// The half-open columns of an interval, in `0..=columns`. Both its ends are included.
#[inline(always)]
fn columns_of<L: Lanes>((from, to): (L, L)) -> (L::Ints, L::Ints) {
    (from.ceil(), to.add(L::splat(1.0)).floor())
}

/// Whether all samples of a mask with `columns` columns are blocked.
#[inline(always)]
pub fn is_full<W: MaskWord>(mask: &MaskRows<W>, columns: u32) -> bool {
    let (mut all, mut row) = (W::below(columns), 0);
    while row < mask.len() {
        all = all.and(mask[row]);
        row += 1;
    }
    all == W::below(columns)
}

/// ORs the rows of one triangle into one receiver's mask. `lane` is the receiver's in `lines`. Rows in doubt are to be
/// settled by [`settle_rows`].
#[inline(always)]
pub fn fill<L: Lanes, W: MaskWord, P: PrecisionMode, const E: usize>(
    lines: &Lines<E>,
    planes: usize,
    lane: usize,
    light: &LatticeLight,
    mask: &mut MaskRows<W>,
) -> Filled {
    let lane = lane % TILE;
    let (rows, columns) = (light.rows as usize, light.columns);
    let mut filled = Filled { relevant: false, unsure: [0; 2] };
    let mut row = 0;
    while row < rows {
        let Bounds { inner, outer } = bounds::<L, E>(lines, planes, lane, L::count_from(row), columns, P::CERTIFIED);
        let (from, to) = columns_of(inner);
        or_spans::<L, W>(from, to, mask, row);
        // Rows beyond the light's hold full words, and are no rows of this triangle.
        let present = if rows - row < 32 { (1 << (rows - row)) - 1 } else { u32::MAX };
        filled.relevant |= L::less(from, to) & present != 0;
        if P::CERTIFIED {
            // A row is in doubt where a column lies between its inner and its outer bound.
            let near = inner.0.integer_below(inner.0.sub(outer.0)) | inner.1.integer_above(outer.1.sub(inner.1));
            let possible = L::bits(outer.1.ge(outer.0));
            filled.unsure[row / 32 % 2] |= (near & possible & present) << (row % 32);
        }
        row += L::WIDTH;
    }
    filled
}

/// Decides the columns between inner and outer bounds of the rows in `unsure` (bit k of word w: row `32w + k`). Returns
/// whether any is blocked.
///
/// A function of its own, on one lane: few rows come here, and the path of the others stays short.
#[inline(never)]
pub fn settle_rows<W: MaskWord, const E: usize>(
    lines: &Lines<E>,
    planes: usize,
    lane: usize,
    pair: &mut PairIntegers,
    mut unsure: [u32; 2],
    mask: &mut MaskRows<W>,
) -> bool {
    let mut forms = PairForms::NONE;
    let mut relevant = false;
    while unsure[0] | unsure[1] != 0 {
        let word = (unsure[0] == 0) as usize;
        let row = word * 32 + unsure[word].trailing_zeros() as usize;
        unsure[word] &= unsure[word] - 1;
        if row >= MASK_ROWS {
            break;
        }
        let outer = columns_of(bounds::<f32, E>(lines, planes, lane, row as f32, pair.light.columns, true).outer);
        let doubtful = W::span(outer.0 as u32, outer.1 as u32).without(mask[row]);
        let found = forms.settle(lines, &Regular, planes, lane, pair, row, doubtful);
        relevant |= found != W::EMPTY;
        mask[row] = mask[row].or(found);
    }
    relevant
}

/// What the rows of one triangle did to a mask.
#[derive(Clone, Copy, Debug)]
pub struct Filled {
    /// Whether a sample is surely blocked.
    pub relevant: bool,
    /// Rows with a doubtful column: bit k of word w is the `32w + k`-th from the first that was looked at.
    pub unsure: [u32; 2],
}

impl Filled {
    /// Whether a row is in doubt.
    #[inline(always)]
    pub fn is_unsure(&self) -> bool {
        self.unsure[0] | self.unsure[1] != 0
    }
}

/// Where columns end: half a column off the grid, so that no column is near, and ends round to 0 or to `columns`.
#[derive(Clone, Copy, Debug)]
pub struct Ends<L> {
    first: L,
    before_first: L,
    last: L,
    after_last: L,
}

impl<L: Lanes> Ends<L> {
    /// Of a light with `columns` columns.
    #[inline(always)]
    pub fn new(columns: u32) -> Self {
        let columns = columns as f32;
        Self {
            first: L::splat(0.5),
            before_first: L::splat(-0.5),
            last: L::splat(columns - 0.5),
            after_last: L::splat(columns + 0.5),
        }
    }
}

/// The columns inside all sides of an outline, in `rows` of one lane: from `from` on and before `to`, neither rounded.
#[inline(always)]
fn between<L: Lanes, const E: usize>(
    outlines: &Outlines<E>,
    planes: usize,
    lane: usize,
    rows: L,
    ends: &Ends<L>,
) -> (L, L) {
    let (mut from, mut to) = (ends.before_first, ends.after_last);
    let mut k = 0;
    while k < planes {
        let x = L::splat(outlines.slope[k][lane]).mul_add(rows, L::splat(outlines.start[k][lane]));
        if outlines.lower[k] >> lane & 1 == 1 {
            from = from.max(x);
        } else {
            to = to.min(x);
        }
        k += 1;
    }
    (from.min(ends.last), to.max(ends.first))
}

/// ORs the rows of one outlined triangle into one receiver's mask. `lane` is the receiver's in `outlines`.
#[inline(always)]
pub fn fill_outline<L: Lanes, W: MaskWord, P: PrecisionMode, const E: usize>(
    outlines: &Outlines<E>,
    planes: usize,
    lane: usize,
    ends: &Ends<L>,
    mask: &mut MaskRows<W>,
) -> Filled {
    let lane = lane % TILE;
    let band = L::splat(if P::CERTIFIED { outlines.band[lane] } else { 0.0 });
    let mut row = outlines.first[lane] as usize;
    let mut left = outlines.count[lane] as u32;
    let mut done = 0;
    let mut filled = Filled { relevant: false, unsure: [0; 2] };
    while left != 0 {
        let (from, to) = between(outlines, planes, lane, L::count_from(row), ends);
        let (starts, stops) = (from.ceil(), to.floor());
        or_spans::<L, W>(starts, stops, mask, row);
        // Rows of the tile that are beyond the triangle's may be beyond the light's.
        let here = if left < L::WIDTH as u32 { left } else { L::WIDTH as u32 };
        let present = (1 << here) - 1;
        filled.relevant |= L::less(starts, stops) & present != 0;
        if P::CERTIFIED {
            let near = L::integer_beside(from, to, band) & present;
            if done < 32 {
                filled.unsure[0] |= near << done;
            } else {
                filled.unsure[1] |= near << (done - 32);
            }
        }
        row += L::WIDTH;
        done += here;
        left -= here;
    }
    filled
}

/// ORs half-open column intervals into the rows from `row` on.
#[inline(always)]
fn or_spans<L: Lanes, W: MaskWord>(starts: L::Ints, ends: L::Ints, mask: &mut MaskRows<W>, row: usize) {
    let (mut from, mut to) = ([0_i32; TILE], [0_i32; TILE]);
    L::store_ints(starts, &mut from, 0);
    L::store_ints(ends, &mut to, 0);
    or_words(&from, &to, L::WIDTH, mask, row);
}

/// The same, for `count` rows: as a slice, so that one instruction does them all.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
fn or_words<W: MaskWord>(from: &[i32; TILE], to: &[i32; TILE], count: usize, mask: &mut MaskRows<W>, row: usize) {
    let Some(words) = mask.get_mut(row..row + count) else { return };
    let mut k = 0;
    while k < count && k < words.len() {
        words[k] = words[k].or(W::span(from[k] as u32, to[k] as u32));
        k += 1;
    }
}

/// The same, for the one row of a GPU thread, where slices of arrays do not exist.
#[cfg(target_arch = "spirv")]
#[inline(always)]
fn or_words<W: MaskWord>(from: &[i32; TILE], to: &[i32; TILE], _: usize, mask: &mut MaskRows<W>, row: usize) {
    mask[row % MASK_ROWS] = mask[row % MASK_ROWS].or(W::span(from[0] as u32, to[0] as u32));
}

/// ORs `count` words into the rows from `row` on. Returns whether any has a bit.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
pub(crate) fn or_rows<W: MaskWord>(from: &[W; TILE], count: usize, mask: &mut MaskRows<W>, row: usize) -> bool {
    let Some(words) = mask.get_mut(row..row + count) else { return false };
    let (mut any, mut k) = (W::EMPTY, 0);
    while k < count && k < words.len() {
        words[k] = words[k].or(from[k]);
        any = any.or(from[k]);
        k += 1;
    }
    any != W::EMPTY
}

/// The same, for the one row of a GPU thread.
#[cfg(target_arch = "spirv")]
#[inline(always)]
pub(crate) fn or_rows<W: MaskWord>(from: &[W; TILE], _: usize, mask: &mut MaskRows<W>, row: usize) -> bool {
    mask[row % MASK_ROWS] = mask[row % MASK_ROWS].or(from[0]);
    from[0] != W::EMPTY
}

/// Decides the columns of the rows in `unsure` (see [`Filled`]) that lie within the band of a bound. Returns whether any is blocked.
///
/// The lines are evaluated again, on one lane, and may round differently: so one band more is looked at on each side.
#[inline(never)]
pub fn settle_outline<W: MaskWord, const E: usize>(
    outlines: &Outlines<E>,
    planes: usize,
    lane: usize,
    pair: &mut PairIntegers,
    mut unsure: [u32; 2],
    mask: &mut MaskRows<W>,
) -> bool {
    let lane = lane % TILE;
    let (ends, band) = (Ends::new(pair.light.columns), outlines.band[lane]);
    let mut forms = PairForms::NONE;
    let mut relevant = false;
    while unsure[0] | unsure[1] != 0 {
        let word = (unsure[0] == 0) as usize;
        let row = outlines.first[lane] as usize + word * 32 + unsure[word].trailing_zeros() as usize;
        unsure[word] &= unsure[word] - 1;
        if row >= MASK_ROWS {
            break;
        }
        let (from, to) = between(outlines, planes, lane, row as f32, &ends);
        let at_from = (Lanes::ceil(from - 2.0 * band), Lanes::floor(from + band) + 1);
        let at_to = (Lanes::ceil(to - band) - 1, Lanes::floor(to + 2.0 * band));
        let doubtful = span_within::<W>(at_from, pair.light.columns).or(span_within(at_to, pair.light.columns));
        let found = forms.settle(outlines, &Regular, planes, lane, pair, row, doubtful.without(mask[row]));
        relevant |= found != W::EMPTY;
        mask[row] = mask[row].or(found);
    }
    relevant
}

/// The columns of a half-open interval that the light has.
#[inline(always)]
fn span_within<W: MaskWord>((from, to): (i32, i32), columns: u32) -> W {
    let from = if from > 0 { from as u32 } else { 0 };
    let to = if to > 0 { to as u32 } else { 0 };
    W::span(if from < columns { from } else { columns }, if to < columns { to } else { columns })
}
