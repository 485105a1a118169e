//! The receivers of a block: their keys, those that face away from the light, and the groups in which they are shadowed.

use rayon::prelude::*;
use umbra4_core::{
    LatticeLight, MaskWord,
    edge_plane::LightGrid,
    glam::IVec3,
    proj4::Keys,
    stage::{key_receivers::key_receivers, resolve::Group},
};

use crate::Receivers;

/// Keys of the receivers at `points`; none of those behind the light.
pub(crate) fn key(grid: &LightGrid, points: &[IVec3], keys: &mut Vec<Option<Keys>>) {
    (0..points.len())
        .into_par_iter()
        .map(|id| key_receivers(id, &grid.frame, &grid.light, points))
        .collect_into_vec(keys);
}

/// Receivers that face away are as good as behind the light. `first`: the block's first.
pub(crate) fn settle(light: &LatticeLight, receivers: &Receivers, first: usize, keys: &mut [Option<Keys>]) {
    keys.par_iter_mut().enumerate().for_each(|(id, keys)| {
        let index = first + id;
        if receivers.facing_of(index).is_away_from(light, receivers.points()[index]) {
            *keys = None;
        }
    });
}

/// Puts receivers into an empty group. `indices`: theirs in the block, a lane each.
pub(crate) fn gather<W: MaskWord>(
    group: &mut Group<W>,
    light: &LatticeLight,
    points: &[IVec3],
    keys: &[Option<Keys>],
    indices: impl Iterator<Item = u32>,
) {
    for (lane, index) in indices.enumerate() {
        match &keys[index as usize] {
            Some(keys) => group.set(lane, points[index as usize], keys),
            None => group.set_behind(lane, light),
        }
    }
}
