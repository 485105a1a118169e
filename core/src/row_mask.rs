//! Rows of a mask from the planes of one triangle: half-open column intervals, then words.
//!
//! Seed: Wang et al. 2016, section 3.3 and Algorithm 3, lines 11 to 17. Departures: the partial masks of the planes are
//! not built and ANDed; the largest lower and the smallest upper bound give the interval, and one word a row is made from
//! it. With certified precision, rows whose bounds come within the planes' doubt of a column are redone: between the
//! columns that are surely blocked (inner interval) and those that may be (outer), each is decided in integers.

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

/// A vector of rows' column intervals, as the planes of one receiver (`lane`) bound them, each plane moved towards the
/// blocked side by its entry of `inward`. Half a column outside the grid at most: that rounds to 0 or to `columns`,
/// whichever way it is rounded.
#[inline(always)]
fn interval<L: Lanes, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    rows: L,
    columns: u32,
    inward: &[f32; E],
) -> (L, L) {
    let (lowest, highest) = (L::splat(-0.5), L::splat(columns as f32 - 0.5));
    let (mut from, mut to) = (lowest, highest);
    let mut k = 0;
    while k < E {
        let along = L::splat(lines.slope[k][lane]).mul(rows);
        if lines.lower[k] >> lane & 1 == 1 {
            from = from.max(along.add(L::splat(lines.start[k][lane] + inward[k])));
        } else {
            to = to.min(along.add(L::splat(lines.start[k][lane] - inward[k])));
        }
        k += 1;
    }
    (from.min(highest), to.max(lowest))
}

/// The planes' own doubts, times `sign`.
#[inline(always)]
fn doubts<const E: usize>(lines: &Lines<E>, lane: usize, sign: f32) -> [f32; E] {
    let mut out = [0.0; E];
    let mut k = 0;
    while k < E {
        out[k] = sign * lines.doubt[k][lane];
        k += 1;
    }
    out
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

/// ORs the rows of one triangle into one receiver's mask. `lane` is the receiver's in `lines`. Returns whether the
/// triangle blocks at least one sample.
#[inline(always)]
pub fn fill<L: Lanes, W: MaskWord, P: PrecisionMode, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    pair: &mut PairIntegers<'_>,
    mask: &mut MaskRows<W>,
) -> bool {
    let lane = lane % TILE;
    let wide = P::CERTIFIED && lines.wide >> lane & 1 == 1;
    let mut unsure = [0_u32; 2];
    let relevant = if wide {
        fill_rows::<L, W, E>(lines, lane, pair.light, mask, &mut unsure, Doubt::OfEachPlane)
    } else if P::CERTIFIED {
        fill_rows::<L, W, E>(lines, lane, pair.light, mask, &mut unsure, Doubt::OfAllPlanes)
    } else {
        fill_rows::<L, W, E>(lines, lane, pair.light, mask, &mut unsure, Doubt::None)
    };
    // After the loop, so that nothing in it has to outlive a call.
    let settled = P::CERTIFIED && unsure[0] | unsure[1] != 0 && settle_rows(lines, lane, pair, unsure, mask);
    relevant | settled
}

/// How the rows in doubt are found. Always a constant where it is used.
#[derive(Clone, Copy, PartialEq)]
enum Doubt {
    /// Not at all.
    None,
    /// All planes are moved by the largest doubt of the pair, and a bound is held against the same: a few operations.
    OfAllPlanes,
    /// The interval is made twice, with every plane moved by its own doubt either way.
    OfEachPlane,
}

/// ORs what is certain into `mask`, and sets the bits of the rows that are not.
#[inline(always)]
fn fill_rows<L: Lanes, W: MaskWord, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    light: &LatticeLight,
    mask: &mut MaskRows<W>,
    unsure: &mut [u32; 2],
    doubt: Doubt,
) -> bool {
    let (rows, columns) = (light.rows as usize, light.columns);
    let inward = match doubt {
        Doubt::None => [0.0; E],
        Doubt::OfAllPlanes => [lines.most_doubt[lane]; E],
        Doubt::OfEachPlane => doubts(lines, lane, 1.0),
    };
    let mut relevant = false;
    let mut row = 0;
    while row < rows {
        let at = L::count_from(row);
        let inner = interval::<L, E>(lines, lane, at, columns, &inward);
        let (from, to) = columns_of(inner);
        let (mut starts, mut ends) = ([0_i32; TILE], [0_i32; TILE]);
        L::store_ints(from, &mut starts, 0);
        L::store_ints(to, &mut ends, 0);
        let Some(words) = mask.get_mut(row..row + L::WIDTH) else { break };
        let mut k = 0;
        while k < L::WIDTH && k < words.len() {
            words[k] = words[k].or(W::span(starts[k] as u32, ends[k] as u32));
            k += 1;
        }
        // Rows beyond the light's hold full words, and are no rows of this triangle.
        let present = if rows - row < 32 { (1 << (rows - row)) - 1 } else { u32::MAX };
        relevant |= L::less(from, to) & present != 0;
        let bits = match doubt {
            Doubt::None => 0,
            Doubt::OfAllPlanes => {
                let most = L::splat(lines.most_doubt[lane]);
                let (from, to) = (inner.0.sub(most), inner.1.add(most));
                let near = from.near_integer(most) | to.near_integer(most);
                near & L::bits(to.add(most).ge(from.sub(most)))
            }
            Doubt::OfEachPlane => {
                let outer = columns_of(interval::<L, E>(lines, lane, at, columns, &doubts(lines, lane, -1.0)));
                (L::differ(from, outer.0) | L::differ(to, outer.1)) & L::less(outer.0, outer.1)
            }
        };
        unsure[row / 32 % 2] |= (bits & present) << (row % 32);
        row += L::WIDTH;
    }
    relevant
}

/// Decides the doubtful columns of the rows in `unsure` (bit k of word w: row `32w + k`). Returns whether any is blocked.
///
/// A function of its own, on one lane: few rows come here, and the path of the others stays short.
#[inline(never)]
fn settle_rows<W: MaskWord, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    pair: &mut PairIntegers<'_>,
    mut unsure: [u32; 2],
    mask: &mut MaskRows<W>,
) -> bool {
    let columns = pair.light.columns;
    let mut forms = PairForms::new();
    let mut relevant = false;
    while unsure[0] | unsure[1] != 0 {
        let word = (unsure[0] == 0) as usize;
        let row = word * 32 + unsure[word].trailing_zeros() as usize;
        unsure[word] &= unsure[word] - 1;
        let inner = columns_of(interval::<f32, E>(lines, lane, row as f32, columns, &doubts(lines, lane, 1.0)));
        let outer = columns_of(interval::<f32, E>(lines, lane, row as f32, columns, &doubts(lines, lane, -1.0)));
        let known = W::span(inner.0 as u32, inner.1 as u32);
        let doubtful = W::span(outer.0 as u32, outer.1 as u32);
        let Some(word) = mask.get_mut(row) else { break };
        let found = forms.settle(lines, lane, pair, row, doubtful.without(known.or(*word)));
        let found = known.or(found);
        relevant |= found != W::EMPTY;
        *word = word.or(found);
    }
    relevant
}

/// As [`fill`], one light sample at a time (Wang et al. 2016, Algorithm 1, lines 22 to 24), a sample a lane: what rows are
/// measured against. The same planes and the same certification give the same bits.
#[inline(always)]
pub fn fill_bits<L: Lanes, W: MaskWord, P: PrecisionMode, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    pair: &mut PairIntegers<'_>,
    mask: &mut MaskRows<W>,
) -> bool {
    let lane = lane % TILE;
    let (rows, columns) = (pair.light.rows as usize, pair.light.columns);
    let doubt = if P::CERTIFIED { doubts(lines, lane, 1.0) } else { [0.0; E] };
    let mut doubtful = [W::EMPTY; MAX_SAMPLES as usize];
    let (mut relevant, mut unsure) = (false, false);
    let mut row = 0;
    while row < rows {
        let at = L::count_from(row);
        let present = if rows - row < 32 { (1 << (rows - row)) - 1 } else { u32::MAX };
        let mut column = 0;
        while column < columns {
            let (mut sure, mut possible) = (present, present);
            let j = L::splat(column as f32);
            let mut k = 0;
            while k < E {
                let x = L::splat(lines.slope[k][lane]).mul(at).add(L::splat(lines.start[k][lane]));
                let (before, behind) = (x.sub(L::splat(doubt[k])), x.add(L::splat(doubt[k])));
                if lines.lower[k] >> lane & 1 == 1 {
                    sure &= L::bits(j.ge(behind));
                    possible &= L::bits(j.ge(before));
                } else {
                    sure &= L::bits(before.ge(j));
                    possible &= L::bits(behind.ge(j));
                }
                k += 1;
            }
            relevant |= sure != 0;
            unsure |= possible != sure;
            set_column(mask, row, column, sure);
            set_column(&mut doubtful, row, column, possible & !sure);
            column += 1;
        }
        row += L::WIDTH;
    }
    let settled = P::CERTIFIED && unsure && settle_bits(lines, lane, pair, &doubtful, mask);
    relevant | settled
}

/// Sets one column in the rows `row + k` for the bits k that are set in `which`.
#[inline(always)]
fn set_column<W: MaskWord>(mask: &mut MaskRows<W>, row: usize, column: u32, mut which: u32) {
    while which != 0 {
        let r = (row + which.trailing_zeros() as usize) % MAX_SAMPLES as usize;
        which &= which - 1;
        mask[r] = mask[r].or(W::span(column, column + 1));
    }
}

/// Decides the samples in `doubtful`. Returns whether any is blocked. Out of line for the reason of [`settle_rows`].
#[inline(never)]
fn settle_bits<W: MaskWord, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    pair: &mut PairIntegers<'_>,
    doubtful: &MaskRows<W>,
    mask: &mut MaskRows<W>,
) -> bool {
    let mut forms = PairForms::new();
    let mut relevant = false;
    let mut row = 0;
    while row < pair.light.rows as usize {
        let found = forms.settle(lines, lane, pair, row, doubtful[row].without(mask[row]));
        relevant |= found != W::EMPTY;
        mask[row] = mask[row].or(found);
        row += 1;
    }
    relevant
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
    #[inline(always)]
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
                let x = lines.slope[k][lane] * row as f32 + lines.start[k][lane];
                let (j, doubt) = (column as f32, lines.doubt[k][lane]);
                let certain = if lines.lower[k] >> lane & 1 == 1 { j > x + doubt } else { j < x - doubt };
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
