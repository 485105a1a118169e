//! Kernel `reduce`: lit samples and visibility of one receiver.

use crate::{
    kernel::{fetch, store},
    params::Params,
};

/// Receiver `id` of a block. `table` has the visibility of each lit count.
#[inline(always)]
pub fn reduce(id: usize, params: &Params, masks: &[u32], table: &[f32], visibility: &mut [f32]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    // Bits beyond the light's columns, and rows beyond its rows, are 0.
    let (mut blocked, mut k) = (0, 0);
    while k < pass.stride as usize {
        blocked += fetch(masks, id * pass.stride as usize + k, 0).count_ones();
        k += 1;
    }
    let lit = params.light().sample_count() - blocked;
    store(visibility, pass.first as usize + id, fetch(table, lit as usize, 0.0));
}
