//! Kernel `reduce`: lit samples of one receiver.

use crate::{
    kernel::{fetch, store},
    params::Params,
};

/// Receiver `id` of a block.
#[inline(always)]
pub fn reduce(id: usize, params: &Params, masks: &[u32], lit: &mut [u32]) {
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
    store(lit, pass.first as usize + id, params.light().sample_count() - blocked);
}
