//! Stage `reduce`: mask → lit count → visibility. The count is an integer and the visibility a table entry, so both are
//! the same bits everywhere.

use crate::mask_word::MaskWord;

/// Lit samples of a mask of `columns` columns.
#[inline]
pub fn lit_count<W: MaskWord>(rows: &[W], columns: u32) -> u32 {
    let (mut blocked, mut row) = (0, 0);
    while row < rows.len() {
        blocked += rows[row].count();
        row += 1;
    }
    rows.len() as u32 * columns - blocked
}

/// Entry `lit` of the visibility table of a light with `samples` samples: made once, on the host.
pub fn visibility(lit: u32, samples: u32) -> f32 {
    lit as f32 / samples as f32
}
