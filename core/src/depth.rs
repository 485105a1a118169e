//! Depths of the light's samples as one receiver sees them: how many triangles lie before each. They are added up for
//! sixteen rows at once, with a bit plane for every digit.
//!
//! Digits are those of two's complement: what is counted is right modulo [`MOST_DEPTH`]` + 1`, and callers keep true depths
//! below that.

use crate::{
    jitter::Samples,
    lanes::TILE,
    light::MAX_SAMPLES,
    mask_word::MaskWord,
    row_mask::{MASK_ROWS, MaskRows},
};

/// Binary digits of a depth.
const DIGITS: usize = 10;
/// Digits that are always looked at: depths are rarely larger.
const FEW_DIGITS: usize = 3;
/// Where counts start: at half of what few digits hold.
const START: i32 = 1 << (FEW_DIGITS - 1);
/// Most triangles before one sample.
pub const MOST_DEPTH: u32 = (1 << DIGITS) - 1;

/// The depths of one receiver's samples; all zero between two uses.
#[derive(Clone, Copy, Debug)]
pub struct Depths<W> {
    /// Bit j of `digits[d][i]` is digit d of what was counted for sample (i, j). Counts start at half of what few digits
    /// hold, so that those that go down are not carried on either.
    digits: [MaskRows<W>; DIGITS],
    /// What is added from one row to the next, in all columns.
    steps: [i16; MAX_SAMPLES as usize + 1],
    /// Whether more than a few digits were counted in.
    deep: bool,
    /// What was counted for the light's first place, where no sample need lie.
    at_origin: i32,
}

impl<W: MaskWord> Depths<W> {
    /// Nothing before any sample.
    pub const FLAT: Self = {
        let mut digits = [[W::EMPTY; MASK_ROWS]; DIGITS];
        digits[FEW_DIGITS - 1] = [W::ALL; MASK_ROWS];
        Self { digits, steps: [0; MAX_SAMPLES as usize + 1], deep: false, at_origin: 0 }
    };

    /// All rows from `row` on, `row <= 64`, are deeper by `by`.
    #[inline(always)]
    pub(crate) fn step(&mut self, row: usize, by: i32) {
        if let Some(step) = self.steps.get_mut(row) {
            *step = step.wrapping_add(by as i16);
        }
    }

    /// The light's first place is deeper by `by`.
    #[inline(always)]
    pub(crate) fn step_origin(&mut self, by: i32) {
        self.at_origin += by;
    }

    /// In the `count` rows from `row` on, all columns from `columns[k]` on are deeper by `by`.
    #[inline(always)]
    pub(crate) fn add(&mut self, row: usize, columns: &[i32; TILE], count: usize, by: i32) {
        let mut words = [W::EMPTY; TILE];
        let mut k = 0;
        while k < TILE {
            let word = W::span(columns[k] as u32, W::BITS);
            words[k] = if k < count { word } else { W::EMPTY };
            k += 1;
        }
        self.add_words(row, words, by);
    }

    /// In the rows from `row` on, the samples in `words` are deeper by `by`.
    #[inline(always)]
    pub(crate) fn add_words(&mut self, row: usize, words: [W; TILE], by: i32) {
        let mut left = by.unsigned_abs();
        while left != 0 {
            self.count(row, words, by < 0);
            left -= 1;
        }
    }

    /// Adds 1 to the samples in `words`, or takes it away.
    #[inline(always)]
    fn count(&mut self, row: usize, words: [W; TILE], down: bool) {
        let carry = self.carry(0, FEW_DIGITS, row, words, down);
        let (mut any, mut k) = (W::EMPTY, 0);
        while k < TILE {
            any = any.or(carry[k]);
            k += 1;
        }
        if any != W::EMPTY {
            self.deep = true;
            self.carry(FEW_DIGITS, DIGITS, row, carry, down);
        }
    }

    /// Adds to the digits `digit..end`, and returns what is carried on.
    #[inline(always)]
    fn carry(&mut self, mut digit: usize, end: usize, row: usize, mut words: [W; TILE], down: bool) -> [W; TILE] {
        let flip = if down { W::ALL } else { W::EMPTY };
        while digit < end && digit < DIGITS {
            let Some(plane) = self.digits[digit].get_mut(row..row + TILE) else { return words };
            let mut k = 0;
            while k < TILE && k < plane.len() {
                let (old, carry) = (plane[k], words[k]);
                plane[k] = old.xor(carry);
                words[k] = carry.and(old.xor(flip));
                k += 1;
            }
            digit += 1;
        }
        words
    }

    /// ORs the samples that have something before them into a mask; `origin` is the depth of the light's first place, which is
    /// sample (0, 0) where samples are not jittered. All depths are zero again.
    #[inline(always)]
    pub(crate) fn flush<S: Samples>(&mut self, origin: u32, rows: u32, columns: u32, mask: &mut MaskRows<W>) {
        let used = self.used();
        let mut at_origin = if S::JITTERED { self.at_origin + START } else { self.steps[0] as i32 };
        let mut digit = 0;
        while digit < used && !S::JITTERED {
            at_origin += (self.digits[digit][0].bit(0) as i32) << digit;
            digit += 1;
        }
        // A sample has nothing before it where its digits are those of what would have to be added.
        let mut missing = at_origin - origin as i32;
        let all = W::below(columns);
        let mut first = 0;
        while first < rows as usize && first < MAX_SAMPLES as usize {
            let (mut wanted, mut found) = ([0_i32; TILE], [W::EMPTY; TILE]);
            let mut k = 0;
            while k < TILE {
                missing -= self.steps[first + k] as i32;
                wanted[k] = missing;
                let never = !self.deep && missing as u32 >> FEW_DIGITS != 0;
                found[k] = if never { all } else { W::EMPTY };
                k += 1;
            }
            let mut digit = 0;
            while digit < used {
                let mut k = 0;
                while k < TILE {
                    let flip = if wanted[k] >> digit & 1 == 1 { W::ALL } else { W::EMPTY };
                    found[k] = found[k].or(self.digits[digit][first + k].xor(flip));
                    k += 1;
                }
                digit += 1;
            }
            let mut k = 0;
            while k < TILE {
                mask[first + k] = mask[first + k].or(found[k].and(all));
                k += 1;
            }
            first += TILE;
        }
        self.clear(rows);
    }

    /// All depths are zero again, if only `rows` rows were counted in.
    #[inline(always)]
    pub(crate) fn clear(&mut self, rows: u32) {
        let used = self.used();
        let mut digit = 0;
        while digit < used {
            let mut row = 0;
            while row < rows as usize && row < MASK_ROWS {
                self.digits[digit][row] = Self::FLAT.digits[digit][row];
                row += 1;
            }
            digit += 1;
        }
        self.steps = [0; MAX_SAMPLES as usize + 1];
        self.deep = false;
        self.at_origin = 0;
    }

    #[inline(always)]
    fn used(&self) -> usize {
        if self.deep { DIGITS } else { FEW_DIGITS }
    }
}
