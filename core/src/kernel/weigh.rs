//! Kernel `weigh`: the weights of the lit samples of one receiver, added up ([`crate::emission`]).

use crate::{
    kernel::{fetch, store},
    light::LatticeLight,
    params::Params,
};

/// A weight: red in the low half of the first word, green in the high one, blue in the second.
pub type PackedWeight = [u32; 2];

/// A weight as the kernel reads it.
pub const fn packed([red, green, blue]: [u16; 3]) -> PackedWeight {
    [red as u32 | (green as u32) << 16, blue as u32]
}

/// The weight that a packed one stands for.
#[inline(always)]
pub const fn unpacked([low, high]: PackedWeight) -> [u32; 3] {
    [low & 0xffff, low >> 16, high & 0xffff]
}

/// Receiver `id` of a block. Rows are in words of 16 bits, two in a word of 32, where the light has at most 16 columns; in words
/// of 32 bits where it has at most 32; else in two. `weights` holds a weight a sample, row by row.
#[inline(always)]
pub fn weigh(id: usize, params: &Params, masks: &[u32], weights: &[PackedWeight], light: &mut [[u32; 3]]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut lit = lit_samples(&params.light(), pass.stride);
    let mut sum = [0_u32; 3];
    while let Some(sample) = lit.next(masks, id) {
        let weight = unpacked(fetch(weights, sample as usize, [0; 2]));
        sum[0] += weight[0];
        sum[1] += weight[1];
        sum[2] += weight[2];
    }
    store(light, pass.first as usize + id, sum);
}

/// The lit samples of a receiver, by their number, row by row.
pub(super) struct LitSamples {
    rows: u32,
    columns: u32,
    stride: u32,
    /// The word that is looked at, and what is left of it.
    word: u32,
    left: u32,
}

/// Those of a light, from masks of `stride` words.
#[inline(always)]
pub(super) fn lit_samples(light: &LatticeLight, stride: u32) -> LitSamples {
    LitSamples { rows: light.rows, columns: light.columns, stride, word: u32::MAX, left: 0 }
}

impl LitSamples {
    /// The next of receiver `id` of a block.
    #[inline(always)]
    pub(super) fn next(&mut self, masks: &[u32], id: usize) -> Option<u32> {
        // Columns that a word of 32 bits holds, and rows.
        let (width, across) = if self.columns <= 16 { (16, 2) } else { (32, 1) };
        loop {
            while self.left != 0 {
                let bit = self.left.trailing_zeros();
                self.left &= self.left.wrapping_sub(1);
                let (row, column) = if self.columns > 32 {
                    (self.word / 2, self.word % 2 * 32 + bit)
                } else {
                    (self.word * across + bit / width, bit % width)
                };
                if row < self.rows && column < self.columns {
                    return Some(row * self.columns + column);
                }
            }
            self.word = self.word.wrapping_add(1);
            if self.word >= self.stride {
                return None;
            }
            self.left = !fetch(masks, id * self.stride as usize + self.word as usize, 0);
        }
    }
}
