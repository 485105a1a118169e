//! Kernel `weigh`: the weights of the lit samples of one receiver, added up ([`crate::emission`]).

use crate::{
    kernel::{fetch, store},
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
    let (rows, columns) = (params.light().rows, params.light().columns);
    // Columns that a word of 32 bits holds, and rows.
    let (width, across) = if columns <= 16 { (16, 2) } else { (32, 1) };
    let (mut sum, mut k) = ([0_u32; 3], 0);
    while k < pass.stride {
        let mut lit = !fetch(masks, id * pass.stride as usize + k as usize, 0);
        while lit != 0 {
            let bit = lit.trailing_zeros();
            lit &= lit.wrapping_sub(1);
            let (row, column) =
                if columns > 32 { (k / 2, k % 2 * 32 + bit) } else { (k * across + bit / width, bit % width) };
            if row < rows && column < columns {
                let weight = unpacked(fetch(weights, (row * columns + column) as usize, [0; 2]));
                sum[0] += weight[0];
                sum[1] += weight[1];
                sum[2] += weight[2];
            }
        }
        k += 1;
    }
    store(light, pass.first as usize + id, sum);
}
