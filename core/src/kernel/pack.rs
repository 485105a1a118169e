//! Kernel `pack`: lit counts → an image of visibility, in words of 32 bits. A pixel is a table entry, made once on the
//! host in the format of the image: the same bits everywhere.

use crate::{
    kernel::{fetch, store},
    params::{Params, PassParams},
};

/// Row and column of word `id` of an image; `None` beyond its end.
#[inline(always)]
pub(super) fn place(id: usize, pass: &PassParams) -> Option<[u32; 2]> {
    if id >= pass.count as usize || pass.pitch == 0 || pass.texels == 0 {
        return None;
    }
    Some([id as u32 / pass.pitch, id as u32 % pass.pitch])
}

/// Word `id` of the image, rows one after the other; a row takes `pitch` words.
#[inline(always)]
pub fn pack(id: usize, params: &Params, lit: &[u32], table: &[u32], image: &mut [u32]) {
    let pass = params.pass();
    let Some([y, column]) = place(id, &pass) else { return };
    let bits = 32 / pass.texels;
    let (mut word, mut k) = (0, 0);
    while k < pass.texels {
        let x = column * pass.texels + k;
        if x < pass.width {
            let count = fetch(lit, (y * pass.width + x) as usize, 0);
            word |= fetch(table, count as usize, 0) << (k * bits);
        }
        k += 1;
    }
    store(image, pass.base as usize + id, word);
}
