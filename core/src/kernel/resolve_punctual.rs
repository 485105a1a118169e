//! Kernel `resolve_punctual`: whether a light without extent reaches one receiver.

use crate::{
    hierarchy::Root,
    kernel::{
        fetch,
        resolve::{Ordered, ReceiverCounts, add_counts, ordered, tell_if_stopped},
        store,
    },
    occluder::Occluder,
    order::Entry,
    params::PunctualParams,
    precision::PrecisionMode,
    proj4::{KeyTile, Keys, NOTHING},
    stage::resolve_punctual::{PunctualGroup, resolve_among},
};

/// What a receiver's word holds where the light does not reach it.
pub const BLOCKED: u32 = 1;

/// The `id`-th receiver in the order of a block, in the frame of a face: whether a triangle under one node of the hierarchy
/// blocks the light. Those under the first of them start anew. `masks` holds a word for each receiver of all blocks, which only its
/// own face writes, and one more, as in [`super::resolve::resolve`]. Receivers that are not there are blocked, those at the
/// light itself are not. Returns the receiver's index, none of it in another face, and what was done for it.
#[inline(always)]
pub fn resolve_punctual<P: PrecisionMode>(
    id: usize,
    params: &PunctualParams,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    masks: &mut [u32],
) -> (usize, ReceiverCounts) {
    let pass = params.params.pass();
    if id >= pass.count as usize {
        return (usize::MAX, [0; 4]);
    }
    let Ordered { index, is_settled, point } = ordered(id, &pass, order, receivers);
    let place = pass.first as usize + index;
    let light = params.light();
    let Some(p) = point else {
        store(masks, place, BLOCKED);
        return (place, [0; 4]);
    };
    if is_settled {
        if light.face_of(p).is_some() {
            return (usize::MAX, [0; 4]);
        }
        store(masks, place, 0);
        return (place, [0; 4]);
    }
    if pass.base > 0 && fetch(masks, place, 0) == BLOCKED {
        return (place, [0; 4]);
    }
    let levels = params.params.levels();
    let mut group = PunctualGroup::default();
    group.set(0, p, &fetch(keys, index, NOTHING));
    let root = Root { level: pass.level as usize, tile: pass.base };
    resolve_among::<f32, P>(light, &levels, root, nodes, occluders, &mut group);
    store(masks, place, group.shadowed & BLOCKED);
    tell_if_stopped(pass.rounds, true, masks);
    let c = group.counts;
    (place, [c.pairs_tested as u32, c.pairs_kept as u32, c.pairs_relevant as u32, c.fallbacks as u32])
}

/// As [`resolve_punctual`], and writes the counts.
#[inline(always)]
pub fn resolve_punctual_counted<P: PrecisionMode>(
    id: usize,
    params: &PunctualParams,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    masks: &mut [u32],
    counts: &mut [ReceiverCounts],
) {
    let (place, own) = resolve_punctual::<P>(id, params, receivers, keys, order, occluders, nodes, masks);
    add_counts(params.params.pass().base, place, own, counts);
}
