//! Stage `resolve_punctual`: which of sixteen receivers a light without extent does not reach.

use glam::IVec3;

use crate::{
    edge_plane::ReceiverTile,
    hierarchy::{Levels, Root, Walk},
    lanes::{Lanes, TILE},
    occluder::Occluder,
    precision::PrecisionMode,
    proj4::{KeyTile, Keys, NODE, NeedTile},
    punctual::{self, Punctual},
    statistics::{Counts, Tally},
    view::Offsets,
};

/// The triangles of a scene as a light without extent sees them in one of its frames.
#[derive(Clone, Copy, Debug)]
pub struct PunctualScene<'a> {
    /// The light.
    pub light: Punctual,
    /// Layout of `nodes`.
    pub levels: &'a Levels,
    /// Keys of all levels; level 0 goes with `occluders`.
    pub nodes: &'a [KeyTile],
    /// Triangles, in the order of level 0.
    pub occluders: &'a [Occluder],
}

/// Sixteen receivers, in one of the light's frames.
#[derive(Clone, Copy, Debug)]
pub struct PunctualGroup {
    receivers: ReceiverTile,
    needs: NeedTile,
    active: u32,
    /// Bit l: the light does not reach lane l's receiver.
    pub shadowed: u32,
    /// Sums over the group.
    pub counts: Counts,
}

impl Default for PunctualGroup {
    fn default() -> Self {
        Self {
            receivers: ReceiverTile::EMPTY,
            needs: NeedTile::NOTHING,
            active: 0,
            shadowed: 0,
            counts: Counts::default(),
        }
    }
}

impl PunctualGroup {
    /// Puts a receiver into a lane; `lane < 16`.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, point: IVec3, keys: &Keys) {
        self.receivers.set(lane, point);
        self.needs.set(lane, keys);
        self.active |= 1 << (lane % TILE);
    }
}

/// Finds the receivers of a group that are in shadow.
#[inline(always)]
pub fn resolve_punctual<L: Lanes, P: PrecisionMode>(scene: &PunctualScene<'_>, group: &mut PunctualGroup) {
    let PunctualScene { light, levels, nodes, occluders } = *scene;
    resolve_among::<L, P>(light, levels, Root::top(levels), nodes, occluders, group);
}

/// The same, of the triangles under one node, its parts by themselves: kernels hold no structures of references. A receiver in
/// shadow drops out, and the walk ends with the last of them.
#[inline(always)]
pub fn resolve_among<L: Lanes, P: PrecisionMode>(
    light: Punctual,
    levels: &Levels,
    root: Root,
    nodes: &[KeyTile],
    occluders: &[Occluder],
    group: &mut PunctualGroup,
) {
    if group.active == 0 {
        return;
    }
    let need = group.needs.least::<L>(group.active);
    let mut walk = Walk::new::<L>(levels, root, nodes, &need);
    let offsets = Offsets::new(&group.receivers, group.active);
    while let Some((tile, mut bits)) = walk.next::<L>(nodes, &need) {
        while bits != 0 {
            let entry = bits.trailing_zeros() as usize;
            bits &= bits.wrapping_sub(1);
            let place = tile as usize * NODE + entry;
            if tile as usize >= nodes.len() || place >= occluders.len() {
                continue;
            }
            let (keys, occluder) = (nodes[tile as usize].entry(entry), occluders[place]);
            let kept = group.needs.dominated_by::<L>(&keys) & group.active;
            group.counts.pairs_tested += group.active.count_ones() as Tally;
            if kept == 0 {
                continue;
            }
            group.counts.pairs_kept += kept.count_ones() as Tally;
            let corners = occluder.corners();
            let rule = |p| punctual::blocks(light, p, corners);
            let (receivers, fallbacks) = (&group.receivers, &mut group.counts.fallbacks);
            let blocked = punctual::blocked::<L, P>(light, &offsets, receivers, &occluder, kept, fallbacks, rule);
            group.counts.pairs_relevant += blocked.count_ones() as Tally;
            group.shadowed |= blocked;
            group.active &= !blocked;
            if group.active == 0 {
                return;
            }
        }
    }
}
