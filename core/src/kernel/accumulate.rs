//! Kernel `accumulate`: lit counts are added to those of earlier frames, and the sums become an image of visibility.

use crate::{
    kernel::{fetch, pack, store},
    params::Params,
    ratio,
};

/// Word `id` of the image, as of [`super::pack`]. A receiver's sum is of `elements` samples; `first` is 0 where it starts
/// with this frame.
#[inline(always)]
pub fn accumulate(id: usize, params: &Params, lit: &[u32], sums: &mut [u32], image: &mut [u32]) {
    let pass = params.pass();
    let Some([y, column]) = pack::place(id, &pass) else { return };
    let bits = 32 / pass.texels;
    let (mut word, mut k) = (0, 0);
    while k < pass.texels {
        let x = column * pass.texels + k;
        if x < pass.width {
            let pixel = (y * pass.width + x) as usize;
            let before = if pass.first == 0 { 0 } else { fetch(sums, pixel, 0) };
            let sum = before + fetch(lit, pixel, 0);
            store(sums, pixel, sum);
            word |= pixel_bits(sum, pass.elements, pass.texels) << (k * bits);
        }
        k += 1;
    }
    store(image, pass.base as usize + id, word);
}

/// A pixel of an image with so many pixels a word.
#[inline(always)]
fn pixel_bits(part: u32, whole: u32, texels: u32) -> u32 {
    match texels {
        1 => ratio::float32(part, whole),
        2 => ratio::float16(part, whole),
        _ => ratio::unorm8(part, whole),
    }
}
