//! Rows of a mask from the lines of one triangle, where samples are jittered ([`crate::jitter`]).
//!
//! Sample (i, j) lies at row `i + a_j` and column `j + b_i`. A line `x(y) = β·y + α` has it on its upper side where
//! `t_j ≥ X_i`, with `t_j = j − β·a_j`, the same for all rows, and `X_i = β·i + α − b_i`, the same for all columns. Since
//! `0 ≤ a_j ≤ 31/32`, only columns within |β| of X_i have to be looked at.
//!
//! - A *shallow* line, `|β| ≤ 1`, leaves one column a row to be looked at: columns are in order, and rows are intervals as those of
//!   regular samples are. Rows are taken by vectors, and shifts of columns looked up in a table.
//! - In a *steep* one's rows, which are few, columns are taken by vectors: a comparison each.
//!
//! # Error bound
//! That of the lines ([`crate::outline`], [`crate::edge_plane`]) is for the evaluation of `β·y + α` at any real row of the light.
//! What is computed here beyond it, in units of ε, near X = t where it matters (so |X| ≤ 65 + |β|, |α| ≤ 65 + 65·|β|): 1·|α| where one
//! column is taken from it, 1·|X| for b_i, 2·|β| + 64 for t_j, 1·|X| for the limits of intervals. In all less than `320 + 80·|β|`: the
//! slack.

// On a GPU no structure holds references: what goes together is handed on one by one.
#![allow(clippy::too_many_arguments)]

use crate::{
    doubt::{Margins, PairForms, PairIntegers},
    jitter::{LAST_PLACE, Samples},
    lanes::{Lanes, TILE},
    mask_word::MaskWord,
    precision::{Exact, PrecisionMode},
    row_mask::{Filled, MASK_ROWS, MaskRows, or_rows},
};

/// Largest width of the band beyond a shallow line's limit: with it, and what a column's shift may add, less than one column.
const MOST_BEYOND: f32 = 1.0 / 64.0;

/// The lines of one triangle for one receiver, as bounds of real columns.
pub(crate) trait Limits: Margins {
    /// Slope of line k, and the column at row 0 from which on (where it is a lower bound), or up to which, samples are surely
    /// inside.
    fn limit(&self, k: usize, lane: usize) -> (f32, f32);
    /// Whether line k is a lower bound.
    fn is_lower(&self, k: usize, lane: usize) -> bool;
    /// How far beyond the limits of `planes` lines samples may still be inside; 0 where nothing is certified.
    fn beyond<P: PrecisionMode>(&self, planes: usize, lane: usize) -> f32;
}

/// The slack of the module's notes.
#[inline(always)]
pub(crate) fn slack<L: Lanes>(slope: f32) -> f32 {
    (320.0 + 80.0 * Lanes::abs(slope)) * L::ROUNDOFF
}

/// One line of a triangle for one receiver.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    slope: f32,
    limit: f32,
    lower: bool,
    /// Samples as deep inside are surely inside.
    slack: f32,
    /// Samples that lie deeper than this may be inside.
    outside: f32,
    /// What the shifts of columns add to the column of a crossing, at least and at most.
    least: f32,
    most: f32,
}

impl Line {
    const NONE: Self = Self { slope: 0.0, limit: 0.0, lower: true, slack: 0.0, outside: 0.0, least: 0.0, most: 0.0 };

    #[inline(always)]
    fn of<L: Lanes, P: PrecisionMode, M: Limits>(lines: &M, k: usize, lane: usize, beyond: f32) -> Self {
        let (slope, limit) = lines.limit(k, lane);
        let slack = if P::CERTIFIED { slack::<L>(slope) } else { 0.0 };
        Self::new(slope, limit, lines.is_lower(k, lane), slack, -(beyond + slack))
    }

    /// `column ≥ slope·row + limit`, or ≤ where it is no `lower` bound; samples deeper inside than `slack` are surely so, and others that
    /// are deeper than `outside` may be.
    #[inline(always)]
    pub(crate) fn new(slope: f32, limit: f32, lower: bool, slack: f32, outside: f32) -> Self {
        let (least, most) = (Lanes::min(slope, 0.0) * LAST_PLACE, Lanes::max(slope, 0.0) * LAST_PLACE);
        Self { slope, limit, lower, slack, outside, least, most }
    }

    #[inline(always)]
    pub(crate) fn is_shallow(&self, beyond: f32) -> bool {
        Lanes::abs(self.slope) <= 1.0 && beyond <= MOST_BEYOND
    }

    /// X of the rows from `start` on.
    #[inline(always)]
    pub(crate) fn crossings<L: Lanes, S: Samples>(&self, samples: &S, start: usize) -> L {
        let rows = L::count_from(start);
        L::splat(self.slope).mul_add(rows, L::splat(self.limit)).sub(samples.row_shifts(rows.ceil()))
    }

    /// From X on: beyond which column no sample is inside.
    #[inline(always)]
    pub(crate) fn outer<L: Lanes>(&self, x: L) -> L {
        x.add(L::splat(if self.lower { self.least + self.outside } else { self.most - self.outside }))
    }

    /// From X on: from which column on, or up to which, all samples are inside.
    #[inline(always)]
    pub(crate) fn inner<L: Lanes>(&self, x: L) -> L {
        x.add(L::splat(if self.lower { self.most + self.slack } else { self.least - self.slack }))
    }

    /// How deep samples lie inside: t from X.
    #[inline(always)]
    pub(crate) fn depth<L: Lanes>(&self, t: L, x: L) -> L {
        if self.lower { t.sub(x) } else { x.sub(t) }
    }

    #[inline(always)]
    pub(crate) fn t<L: Lanes>(&self, columns: L, shifts: L) -> L {
        shifts.mul_add(L::splat(-self.slope), columns)
    }
}

/// The columns `from..to` of the rows of a vector, as lines bound them; and the rows in which a sample is in doubt.
struct Spans<L> {
    from: L,
    to: L,
    unsure: u32,
}

impl<L: Lanes> Spans<L> {
    /// Bounds them by a shallow line.
    #[inline(always)]
    fn bound<P: PrecisionMode, S: Samples>(&mut self, line: &Line, x: L, last_column: f32, samples: &S) {
        let at = line.outer(x).max(L::splat(0.0)).min(L::splat(last_column));
        // The only column of which it is not clear on which side it lies.
        let places = if line.lower { at.ceil() } else { at.floor() };
        let column = L::difference(places, L::splat_int(0));
        let depth = line.depth(line.t(column, samples.column_shifts(places)), x);
        let sure = depth.ge(L::splat(line.slack));
        let next = column.add(L::splat(1.0));
        if line.lower {
            self.from = self.from.max(L::select(sure, column, next));
        } else {
            self.to = self.to.min(L::select(sure, next, column));
        }
        if P::CERTIFIED {
            self.unsure |= L::bits(depth.ge(L::splat(line.outside))) & !L::bits(sure);
        }
    }

    /// Bounds them by line k, in the rows from `start` on.
    #[inline(always)]
    fn bound_by<P: PrecisionMode, S: Samples, const E: usize>(
        &mut self,
        k: usize,
        own: &[Line; E],
        steep: &mut Steep<L, E>,
        start: usize,
        last_column: f32,
        samples: &S,
    ) {
        let line = &own[k % E];
        let x = line.crossings(samples, start);
        if steep.lines >> k & 1 == 0 {
            self.bound::<P, S>(line, x, last_column, samples);
        } else {
            self.bound_outside(line, x);
            steep.add(k, line, x);
        }
    }

    /// Bounds them by what a steep line leaves at most.
    #[inline(always)]
    fn bound_outside(&mut self, line: &Line, x: L) {
        if line.lower {
            self.from = self.from.max(line.outer(x));
        } else {
            self.to = self.to.min(line.outer(x).add(L::splat(1.0)));
        }
    }
}

/// Where, in the rows of a vector, steep lines pass through columns.
struct Steep<L, const E: usize> {
    /// Bit k: line k is one.
    lines: u32,
    /// X of their rows.
    crossings: [[f32; TILE]; E],
    /// Columns from here on are inside all lower bounds.
    lowest: L,
    /// Columns up to here are inside all upper bounds.
    highest: L,
}

impl<L: Lanes, const E: usize> Steep<L, E> {
    #[inline(always)]
    fn add(&mut self, k: usize, line: &Line, x: L) {
        x.store(&mut self.crossings[k % E], 0);
        if line.lower {
            self.lowest = self.lowest.max(line.inner(x));
        } else {
            self.highest = self.highest.min(line.inner(x));
        }
    }

    /// Takes the samples outside these lines away from the words that the spans made.
    #[inline(always)]
    fn cut<W: MaskWord, P: PrecisionMode, S: Samples>(
        &self,
        own: &[Line; E],
        spans: &mut Spans<L>,
        samples: &S,
        words: &mut [W; TILE],
    ) {
        // Columns to be looked at, at the lower end of a row's span and at the upper.
        let low = [spans.from, spans.to.min(self.lowest)];
        let high = [spans.from.max(self.highest), spans.to];
        let (mut at_low, mut at_high) = (!L::bits(low[0].ge(low[1])), !L::bits(high[0].ge(high[1])));
        // Of short spans all is looked at.
        let short = L::bits(L::splat(L::WIDTH as f32).ge(spans.to.sub(spans.from)));
        let either = (at_low | at_high) & short;
        (at_low, at_high) = (at_low & !short | either, at_high & !short);
        let zero = L::splat(0.0);
        let (low_end, high_start) =
            (L::select(L::mask(short), spans.to, low[1]).max(zero).ceil(), high[0].max(zero).floor());
        let (mut starts, mut ends, mut middles, mut stops) = ([0; TILE], [0; TILE], [0; TILE], [0; TILE]);
        L::store_ints(low[0].floor(), &mut starts, 0);
        L::store_ints(low_end, &mut middles, 0);
        L::store_ints(high_start, &mut stops, 0);
        L::store_ints(high[1].ceil(), &mut ends, 0);
        let all = (1 << L::WIDTH) - 1;
        let mut rows = [at_low & all, at_high & all];
        while rows[0] | rows[1] != 0 {
            let end = (rows[0] == 0) as usize;
            let row = rows[end].trailing_zeros() as usize % TILE;
            rows[end] &= rows[end] - 1;
            let columns = if end == 0 { [starts[row], middles[row]] } else { [stops[row], ends[row]] };
            self.cut_row::<W, P, S>(own, row, columns, spans, samples, words);
        }
    }

    /// The same for some columns of one row.
    #[inline(always)]
    fn cut_row<W: MaskWord, P: PrecisionMode, S: Samples>(
        &self,
        own: &[Line; E],
        row: usize,
        [mut first, end]: [i32; 2],
        spans: &mut Spans<L>,
        samples: &S,
        words: &mut [W; TILE],
    ) {
        while first < end {
            let columns = L::count_from(first as usize);
            let shifts = samples.column_shifts::<L>(columns.ceil());
            let mut inside = (L::mask(u32::MAX), L::mask(u32::MAX));
            // No loop: some drivers count rounds (`kernel::resolve`).
            self.test::<P>(0, own, row, columns, shifts, &mut inside);
            self.test::<P>(1, own, row, columns, shifts, &mut inside);
            self.test::<P>(2, own, row, columns, shifts, &mut inside);
            if E > 3 {
                self.test::<P>(3, own, row, columns, shifts, &mut inside);
            }
            let (sure, near) = inside;
            let open = !L::bits(sure) & ((1 << L::WIDTH) - 1);
            let before = words[row];
            words[row] = before.without(W::columns(first as u32, open));
            if P::CERTIFIED {
                let near = W::columns(first as u32, L::bits(near) & open);
                spans.unsure |= ((before.and(near) != W::EMPTY) as u32) << row;
            }
            first += L::WIDTH as i32;
        }
    }

    /// Leaves in `inside` what is surely, and what may be, inside line k too.
    #[inline(always)]
    fn test<P: PrecisionMode>(
        &self,
        k: usize,
        own: &[Line; E],
        row: usize,
        columns: L,
        shifts: L,
        inside: &mut (L::Mask, L::Mask),
    ) {
        let k = k % E;
        if self.lines >> k & 1 == 1 {
            let depth = own[k].depth(own[k].t(columns, shifts), L::splat(self.crossings[k][row]));
            inside.0 = L::both(inside.0, depth.ge(L::splat(own[k].slack)));
            if P::CERTIFIED {
                inside.1 = L::both(inside.1, depth.ge(L::splat(own[k].outside)));
            }
        }
    }
}

/// ORs rows `first..first + count` of one triangle into a mask. `lane` is the receiver's in `lines`. Rows in doubt are to be
/// settled by [`settle`].
#[inline(always)]
pub(crate) fn fill<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples, M: Limits, const E: usize>(
    lines: &M,
    planes: usize,
    lane: usize,
    [first, count]: [usize; 2],
    columns: u32,
    samples: &S,
    mask: &mut MaskRows<W>,
) -> Filled {
    let lane = lane % TILE;
    let mut filled = Filled { relevant: false, unsure: [0; 2] };
    let beyond = lines.beyond::<P>(planes, lane);
    let (mut own, mut steep_lines, mut k) = ([Line::NONE; E], 0, 0);
    while k < planes {
        own[k] = Line::of::<L, P, M>(lines, k, lane, beyond);
        steep_lines |= (!own[k].is_shallow(beyond) as u32) << k;
        k += 1;
    }
    let (zero, all) = (L::splat(0.0), L::splat(columns as f32));
    let mut done = 0;
    while done < count {
        let start = first + done;
        let mut spans = Spans { from: zero, to: all, unsure: 0 };
        let mut steep = Steep { lines: steep_lines, crossings: [[0.0; TILE]; E], lowest: zero, highest: all };
        let last_column = (columns - 1) as f32;
        spans.bound_by::<P, S, E>(0, &own, &mut steep, start, last_column, samples);
        spans.bound_by::<P, S, E>(1, &own, &mut steep, start, last_column, samples);
        spans.bound_by::<P, S, E>(2, &own, &mut steep, start, last_column, samples);
        if planes > 3 {
            spans.bound_by::<P, S, E>(3, &own, &mut steep, start, last_column, samples);
        }
        let here = if count - done < L::WIDTH { count - done } else { L::WIDTH };
        let present = (1 << here) - 1;
        // A column more or less than there is would not fit a word's span.
        spans.from = spans.from.min(all);
        spans.to = L::select(L::mask(present), spans.to.max(zero), zero);
        let (mut starts, mut ends, mut words) = ([0; TILE], [0; TILE], [W::EMPTY; TILE]);
        L::store_ints(spans.from.ceil(), &mut starts, 0);
        L::store_ints(spans.to.floor(), &mut ends, 0);
        let mut k = 0;
        while k < TILE {
            words[k] = W::span(starts[k] as u32, ends[k] as u32);
            k += 1;
        }
        if steep_lines != 0 {
            steep.cut::<W, P, S>(&own, &mut spans, samples, &mut words);
        }
        filled.relevant |= or_rows(&words, L::WIDTH, mask, start);
        if P::CERTIFIED {
            // Vectors are no wider than half a word, and begin at multiples of their width.
            filled.unsure[done / 32 % 2] |= (spans.unsure & present) << (done % 32);
        }
        done += L::WIDTH;
    }
    filled
}

/// Decides the samples of the rows in `unsure`, counted from `first`, that floats cannot tell. Returns whether any is blocked.
#[cfg_attr(not(target_arch = "spirv"), inline(never))]
#[cfg_attr(target_arch = "spirv", inline(always))]
pub(crate) fn settle<W: MaskWord, S: Samples, M: Limits>(
    lines: &M,
    planes: usize,
    lane: usize,
    first: usize,
    mut unsure: [u32; 2],
    columns: u32,
    samples: &S,
    pair: &mut PairIntegers,
    mask: &mut MaskRows<W>,
) -> bool {
    let lane = lane % TILE;
    let beyond = lines.beyond::<Exact>(planes, lane);
    let mut forms = PairForms::NONE;
    let mut relevant = false;
    while unsure[0] | unsure[1] != 0 {
        let word = (unsure[0] == 0) as usize;
        let row = first + word * 32 + unsure[word].trailing_zeros() as usize;
        unsure[word] &= unsure[word] - 1;
        if row >= MASK_ROWS {
            break;
        }
        let mut doubt = Doubt { possible: W::below(columns), near: W::EMPTY };
        doubt.add(lines, 0, lane, beyond, row, columns, samples);
        doubt.add(lines, 1, lane, beyond, row, columns, samples);
        doubt.add(lines, 2, lane, beyond, row, columns, samples);
        if planes > 3 {
            doubt.add(lines, 3, lane, beyond, row, columns, samples);
        }
        let open = doubt.possible.and(doubt.near).without(mask[row]);
        let found = forms.settle(lines, samples, planes, lane, pair, row, open);
        relevant |= found != W::EMPTY;
        mask[row] = mask[row].or(found);
    }
    relevant
}

/// The columns of one row in which floats may not tell.
struct Doubt<W> {
    /// Not surely outside a line.
    possible: W,
    /// Not surely inside all of them.
    near: W,
}

impl<W: MaskWord> Doubt<W> {
    /// What line k makes of it. On one lane, which may round differently: its bounds are wider.
    #[inline(always)]
    fn add<S: Samples, M: Limits>(
        &mut self,
        lines: &M,
        k: usize,
        lane: usize,
        beyond: f32,
        row: usize,
        columns: u32,
        samples: &S,
    ) {
        let line = Line::of::<f32, Exact, M>(lines, k, lane, beyond);
        let x = line.crossings::<f32, S>(samples, row);
        let (outer, inner) = (within(line.outer(x), columns), within(line.inner(x), columns));
        let (possible, sure) = if line.lower {
            (
                W::below(columns).without(W::below(Lanes::ceil(outer) as u32)),
                W::below(columns).without(W::below(Lanes::ceil(inner) as u32)),
            )
        } else {
            (W::below(Lanes::floor(outer + 1.0) as u32), W::below(Lanes::floor(inner + 1.0) as u32))
        };
        self.possible = self.possible.and(possible);
        self.near = self.near.or(possible.without(sure));
    }
}

/// A column, or the nearest that has none of the light's beyond it.
#[inline(always)]
fn within(x: f32, columns: u32) -> f32 {
    Lanes::min(Lanes::max(x, -0.5), columns as f32 - 0.5)
}
