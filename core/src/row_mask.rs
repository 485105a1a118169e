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
    lane: usize,
    rows: L,
    columns: u32,
    certified: bool,
) -> Bounds<L> {
    let (lowest, highest) = (L::splat(-0.5), L::splat(columns as f32 - 0.5));
    let (mut from_in, mut to_in, mut from_out, mut to_out) = (lowest, highest, lowest, highest);
    let mut k = 0;
    while k < E {
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
    let (rows, columns) = (pair.light.rows as usize, pair.light.columns);
    let (mut relevant, mut unsure) = (false, [0_u32; 2]);
    let mut row = 0;
    while row < rows {
        let Bounds { inner, outer } = bounds::<L, E>(lines, lane, L::count_from(row), columns, P::CERTIFIED);
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
        if P::CERTIFIED {
            // A row is in doubt where a column lies between its inner and its outer bound.
            let near = inner.0.integer_below(inner.0.sub(outer.0)) | inner.1.integer_above(outer.1.sub(inner.1));
            let possible = L::bits(outer.1.ge(outer.0));
            unsure[row / 32 % 2] |= (near & possible & present) << (row % 32);
        }
        row += L::WIDTH;
    }
    // After the loop, so that nothing in it has to outlive a call.
    let settled = P::CERTIFIED && unsure[0] | unsure[1] != 0 && settle_rows(lines, lane, pair, unsure, mask);
    relevant | settled
}

/// Decides the columns between inner and outer bounds of the rows in `unsure` (bit k of word w: row `32w + k`). Returns
/// whether any is blocked.
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
    let mut forms = PairForms([None; 4]);
    let mut relevant = false;
    while unsure[0] | unsure[1] != 0 {
        let word = (unsure[0] == 0) as usize;
        let row = word * 32 + unsure[word].trailing_zeros() as usize;
        unsure[word] &= unsure[word] - 1;
        let Some(word) = mask.get_mut(row) else { break };
        let outer = columns_of(bounds::<f32, E>(lines, lane, row as f32, pair.light.columns, true).outer);
        let mut left = W::span(outer.0 as u32, outer.1 as u32).without(*word);
        while left != W::EMPTY {
            let column = left.lowest();
            let bit = W::span(column, column + 1);
            left = left.without(bit);
            if forms.blocks(lines, lane, pair, row, column) {
                *word = word.or(bit);
                relevant = true;
            }
        }
    }
    relevant
}

/// The integer forms of one pair, each made when it is first needed.
struct PairForms([Option<GridForm<Wide>>; 4]);

impl PairForms {
    /// Whether the triangle blocks one sample. Only planes that are themselves in doubt there are asked in integers.
    #[inline(always)]
    fn blocks<const E: usize>(
        &mut self,
        lines: &Lines<E>,
        lane: usize,
        pair: &mut PairIntegers<'_>,
        row: usize,
        column: u32,
    ) -> bool {
        let side = if lines.flipped >> lane & 1 == 1 { -1 } else { 1 };
        let mut k = 0;
        while k < E {
            let x = lines.slope[k][lane] * row as f32 + lines.start[k][lane];
            let beyond = if lines.lower[k] >> lane & 1 == 1 { column as f32 - x } else { x - column as f32 };
            let doubt = lines.doubt[k][lane];
            if beyond < -doubt {
                return false;
            }
            if beyond <= doubt {
                *pair.fallbacks += 1;
                let sign = self.form(k, pair).sign_at(row as i32, column as i32) * side;
                // Edges are closed; the triangle's own plane blocks strictly.
                if sign < 0 || (k == 3 && sign == 0) {
                    return false;
                }
            }
            k += 1;
        }
        true
    }

    #[inline(always)]
    fn form(&mut self, k: usize, pair: &PairIntegers<'_>) -> GridForm<Wide> {
        let k = k % 4;
        if let Some(form) = self.0[k] {
            return form;
        }
        let [a, b, c] = pair.corners;
        let form = match k {
            0 => exact::edge_form(pair.light, pair.receiver, a, b),
            1 => exact::edge_form(pair.light, pair.receiver, b, c),
            2 => exact::edge_form(pair.light, pair.receiver, c, a),
            _ => exact::triangle_form(pair.light, pair.corners),
        };
        self.0[k] = Some(form);
        form
    }
}
