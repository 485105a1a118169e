//! Rows of a mask from the planes of one triangle: half-open column intervals, then words.
//!
//! Seed: Wang et al. 2016, section 3.3 and Algorithm 3, lines 11 to 17. Departures: the partial masks of the planes are
//! not built and ANDed; the largest lower and the smallest upper bound give the interval, and one word a row is made from
//! it. With certified precision two intervals are carried, of columns that are surely blocked (inner) and of columns
//! that may be (outer). Where they agree the row is certified; the few columns between them are decided in integers.

use crate::{
    edge_plane::Lines,
    exact::{self, GridForm, Wide},
    lanes::{Lanes, TILE},
    light::{LatticeLight, MAX_SAMPLES},
    mask_word::MaskWord,
    precision::PrecisionMode,
};
use glam::IVec3;

/// Rows of one receiver, padded to whole tiles: rows at and beyond the light's hold full words.
pub type MaskRows<W> = [W; MAX_SAMPLES as usize];

/// A row's half-open column intervals, in `0..=columns`.
#[derive(Clone, Copy)]
struct Intervals<L: Lanes> {
    inner: (L::Ints, L::Ints),
    outer: (L::Ints, L::Ints),
}

/// What one pair did to a mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filled {
    /// At least one sample is blocked by this triangle.
    pub relevant: bool,
    /// All samples of the mask are blocked now.
    pub full: bool,
}

/// A pair whose doubtful columns are decided in integers.
pub struct PairIntegers<'a> {
    /// The light.
    pub light: &'a LatticeLight,
    /// The receiver.
    pub receiver: IVec3,
    /// The triangle, in the order in which its lines were made.
    pub corners: [IVec3; 3],
    /// Signs decided, added up over all pairs.
    pub fallbacks: &'a mut u64,
}

/// The intervals of rows `first_row..first_row + WIDTH` for one receiver (`lane`).
#[inline(always)]
fn intervals<L: Lanes, P: PrecisionMode, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    rows: L,
    columns: u32,
) -> Intervals<L> {
    // Half a column outside the grid on either side: rounds to 0 and to `columns`, whichever way it is rounded.
    let (lowest, highest) = (L::splat(-0.5), L::splat(columns as f32 - 0.5));
    let (mut from_in, mut to_in, mut from_out, mut to_out) = (lowest, highest, lowest, highest);
    let mut k = 0;
    while k < E {
        let along = L::splat(lines.slope[k][lane]).mul(rows);
        let inner = along.add(L::splat(lines.inner[k][lane]));
        let outer = if P::CERTIFIED { along.add(L::splat(lines.outer[k][lane])) } else { inner };
        if lines.lower[k] >> lane & 1 == 1 {
            from_in = from_in.max(inner);
            from_out = if P::CERTIFIED { from_out.max(outer) } else { from_out };
        } else {
            to_in = to_in.min(inner);
            to_out = if P::CERTIFIED { to_out.min(outer) } else { to_out };
        }
        k += 1;
    }
    let inner = (from_in.min(highest).ceil(), past(to_in.max(lowest)));
    let outer = if P::CERTIFIED { (from_out.min(highest).ceil(), past(to_out.max(lowest))) } else { inner };
    Intervals { inner, outer }
}

/// The half-open end of an interval whose last column is `⌊x⌋`.
#[inline(always)]
fn past<L: Lanes>(x: L) -> L::Ints {
    x.add(L::splat(1.0)).floor()
}

/// ORs the rows of one triangle into one receiver's mask. `lane` is the receiver's in `lines`.
#[inline(always)]
pub fn fill<L: Lanes, W: MaskWord, P: PrecisionMode, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    pair: &mut PairIntegers<'_>,
    mask: &mut MaskRows<W>,
) -> Filled {
    let lane = lane % TILE;
    let (rows, columns) = (pair.light.rows as usize, pair.light.columns);
    let (mut any, mut all) = (W::EMPTY, W::below(W::BITS));
    let mut row = 0;
    while row < rows {
        let found = intervals::<L, P, E>(lines, lane, L::count_from(row), columns);
        let (mut starts, mut ends) = ([0_i32; TILE], [0_i32; TILE]);
        L::store_ints(found.inner.0, &mut starts, 0);
        L::store_ints(found.inner.1, &mut ends, 0);
        let Some(words) = mask.get_mut(row..row + L::WIDTH) else { break };
        let mut k = 0;
        while k < L::WIDTH && k < words.len() {
            let word = W::span(starts[k] as u32, ends[k] as u32);
            any = any.or(if row + k < rows { word } else { W::EMPTY });
            words[k] = words[k].or(word);
            all = all.and(words[k]);
            k += 1;
        }
        if P::CERTIFIED {
            let mut unsure = L::differ(found.inner.0, found.outer.0) | L::differ(found.inner.1, found.outer.1);
            if unsure != 0 {
                let (mut from, mut to) = ([0_i32; TILE], [0_i32; TILE]);
                L::store_ints(found.outer.0, &mut from, 0);
                L::store_ints(found.outer.1, &mut to, 0);
                let mut forms = PairForms::new();
                while unsure != 0 {
                    let k = unsure.trailing_zeros() as usize % TILE;
                    unsure &= unsure - 1;
                    if row + k < rows {
                        let known = W::span(starts[k] as u32, ends[k] as u32);
                        let doubtful = W::span(from[k] as u32, to[k] as u32);
                        let Some(word) = words.get_mut(k) else { break };
                        let found = forms.settle(lines, lane, pair, row + k, doubtful.without(known.or(*word)));
                        any = any.or(found);
                        *word = word.or(found);
                    }
                }
                // Rounded down, so that a mask that has just become full is noticed with its next triangle.
                all = W::EMPTY;
            }
        }
        row += L::WIDTH;
    }
    Filled { relevant: any != W::EMPTY, full: all.and(W::below(columns)) == W::below(columns) }
}

/// The integer forms of one pair, each made when it is first needed.
struct PairForms {
    forms: [GridForm<Wide>; 4],
    ready: u32,
}

impl PairForms {
    #[inline(always)]
    fn new() -> Self {
        use crate::exact::WideInt;
        let zero = GridForm { at_origin: Wide::ZERO, per_row: Wide::ZERO, per_column: Wide::ZERO };
        Self { forms: [zero; 4], ready: 0 }
    }

    /// Which of the doubtful columns of a row are blocked. Only planes that are themselves in doubt there are asked.
    #[inline(never)]
    fn settle<W: MaskWord, const E: usize>(
        &mut self,
        lines: &Lines<E>,
        lane: usize,
        pair: &mut PairIntegers<'_>,
        row: usize,
        doubtful: W,
    ) -> W {
        let (mut found, mut left) = (W::EMPTY, doubtful);
        let side = if lines.flipped >> lane & 1 == 1 { -1 } else { 1 };
        while left != W::EMPTY {
            let column = left.lowest();
            let bit = W::span(column, column + 1);
            left = left.without(bit);
            let mut blocked = true;
            let mut k = 0;
            while k < E {
                let x = lines.slope[k][lane] * row as f32 + lines.inner[k][lane];
                let certain = if lines.lower[k] >> lane & 1 == 1 { column as f32 > x } else { (column as f32) < x };
                if !certain {
                    *pair.fallbacks += 1;
                    let sign = self.form(k, pair).sign_at(row as i32, column as i32) * side;
                    // Edges are closed; the triangle's own plane blocks strictly.
                    if sign < 0 || (k == 3 && sign == 0) {
                        blocked = false;
                        break;
                    }
                }
                k += 1;
            }
            if blocked {
                found = found.or(bit);
            }
        }
        found
    }

    #[inline(always)]
    fn form(&mut self, k: usize, pair: &PairIntegers<'_>) -> GridForm<Wide> {
        let k = k % 4;
        if self.ready >> k & 1 == 0 {
            let [a, b, c] = pair.corners;
            self.forms[k] = match k {
                0 => exact::edge_form(pair.light, pair.receiver, a, b),
                1 => exact::edge_form(pair.light, pair.receiver, b, c),
                2 => exact::edge_form(pair.light, pair.receiver, c, a),
                _ => exact::triangle_form(pair.light, pair.corners),
            };
            self.ready |= 1 << k;
        }
        self.forms[k]
    }
}
