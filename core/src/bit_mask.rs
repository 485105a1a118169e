//! Masks one light sample at a time: what rows at once are measured against.
//!
//! Seed: Wang et al. 2016, Algorithm 1, lines 22 to 24, and the last column of table 2.

use crate::{
    doubt::{PairForms, PairIntegers},
    edge_plane::Lines,
    jitter::Regular,
    lanes::{Lanes, TILE},
    mask_word::MaskWord,
    precision::PrecisionMode,
    row_mask::{MASK_ROWS, MaskRows},
};

/// As [`crate::row_mask::fill`], one light sample at a time (Wang et al. 2016, Algorithm 1, lines 22 to 24), a sample a lane: what rows are
/// measured against. The same planes and the same certification give the same bits.
#[inline(always)]
pub fn fill_bits<L: Lanes, W: MaskWord, P: PrecisionMode, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    pair: &mut PairIntegers,
    mask: &mut MaskRows<W>,
) -> bool {
    let lane = lane % TILE;
    let (rows, columns) = (pair.light.rows as usize, pair.light.columns);
    let mut doubtful = [W::EMPTY; MASK_ROWS];
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
                let doubt = L::splat(if P::CERTIFIED { lines.doubt[k][lane] } else { 0.0 });
                let (before, behind) = (x.sub(doubt), x.add(doubt));
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
        let r = (row + which.trailing_zeros() as usize) % MASK_ROWS;
        which &= which - 1;
        mask[r] = mask[r].or(W::span(column, column + 1));
    }
}

/// Decides the samples in `doubtful`. Returns whether any is blocked. Out of line, so that the loop above stays short.
#[inline(never)]
fn settle_bits<W: MaskWord, const E: usize>(
    lines: &Lines<E>,
    lane: usize,
    pair: &mut PairIntegers,
    doubtful: &MaskRows<W>,
    mask: &mut MaskRows<W>,
) -> bool {
    let mut forms = PairForms::NONE;
    let mut relevant = false;
    let mut row = 0;
    while row < pair.light.rows as usize {
        let found = forms.settle(lines, &Regular, E, lane, pair, row, doubtful[row].without(mask[row]));
        relevant |= found != W::EMPTY;
        mask[row] = mask[row].or(found);
        row += 1;
    }
    relevant
}
