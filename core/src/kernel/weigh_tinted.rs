//! Kernel `weigh_tinted`: the weights of the lit samples of one receiver, each seen through what panes put before it, added up
//! ([`crate::tint`]).

use crate::{
    kernel::{
        fetch, store,
        weigh::{PackedWeight, lit_samples, unpacked},
    },
    params::Params,
    tint::{Depth, tinted},
};

/// Receiver `id` of a block. Masks are as [`super::weigh::weigh`] has them; `depths` holds a depth a sample, receiver by receiver of the
/// block; `table` the transmittances below a stop.
#[inline(always)]
pub fn weigh_tinted(
    id: usize,
    params: &Params,
    masks: &[u32],
    weights: &[PackedWeight],
    depths: &[Depth],
    table: &[u32],
    light: &mut [[u32; 3]],
) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let own = params.light();
    let first = id * own.sample_count() as usize;
    let mut lit = lit_samples(&own, pass.stride);
    let mut sum = [0_u32; 3];
    while let Some(sample) = lit.next(masks, id) {
        let weight = unpacked(fetch(weights, sample as usize, [0; 2]));
        let depth = fetch(depths, first + sample as usize, Depth::CLEAR);
        let part = tinted(table, weight, depth);
        sum[0] += part[0];
        sum[1] += part[1];
        sum[2] += part[2];
    }
    store(light, pass.first as usize + id, sum);
}
