//! Kernels `settle_receivers`: receivers that face away from the light are taken out of the order, their masks are full.

use crate::{
    facing::Facing,
    kernel::{fetch, light_params::LightParams, point, resolve_punctual::BLOCKED, store},
    order::Entry,
    params::PunctualParams,
};

/// Receiver `first + id` of a block, after its key was made: where it faces away it comes last in the order, as those do that are
/// behind the light. `facings` holds a [`Facing`]'s word for each receiver of all blocks. Returns whether it does.
#[inline(always)]
pub fn settle_receivers<T: LightParams>(
    id: usize,
    params: &T,
    receivers: &[[i32; 3]],
    facings: &[u32],
    order: &mut [Entry],
) -> bool {
    let pass = params.pass();
    if id >= pass.count as usize {
        return false;
    }
    let place = pass.first as usize + id;
    let Some(p) = point(receivers, place) else { return false };
    let is_away = params.is_behind(Facing::from_word(fetch(facings, place, Facing::UNKNOWN.word())), p);
    if is_away {
        store(order, id, Entry { code: Entry::ABSENT, index: id as u32 });
    }
    is_away
}

/// The same before a light without extent, whose masks hold a word for each receiver of all blocks: nothing else writes that of a
/// receiver that faces away.
#[inline(always)]
pub fn settle_punctual_receivers(
    id: usize,
    params: &PunctualParams,
    receivers: &[[i32; 3]],
    facings: &[u32],
    order: &mut [Entry],
    masks: &mut [u32],
) {
    if settle_receivers(id, params, receivers, facings, order) {
        store(masks, params.params.pass().first as usize + id, BLOCKED);
    }
}
