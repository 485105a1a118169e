//! Pairs of receivers and triangles that pass the full-coverage test: a walk over the hierarchy for a whole group.

use crate::{
    hierarchy::{Levels, Root, Walk},
    lanes::Lanes,
    mask_word::MaskWord,
    proj4::{KeyTile, Keys, NODE},
    stage::resolve::{Group, drop_full},
    statistics::Tally,
};

/// Walks the triangles below a node, and tells of each for which receivers of a group it is kept.
pub(crate) struct KeptPairs {
    walk: Walk,
    need: Keys,
    tile: u32,
    /// Of the tile, the triangles that are left.
    bits: u32,
}

impl KeptPairs {
    /// Of the receivers that are active now.
    #[inline(always)]
    pub(crate) fn new<L: Lanes, W: MaskWord>(levels: &Levels, root: Root, nodes: &[KeyTile], group: &Group<W>) -> Self {
        let need = group.needs.least::<L>(group.active);
        Self { walk: Walk::new::<L>(levels, root, nodes, &need), need, tile: 0, bits: 0 }
    }

    /// Whether there is anything to walk.
    #[inline(always)]
    pub(crate) fn is_open(&self) -> bool {
        self.walk.is_open()
    }

    /// The next tile of triangles, by its place in `nodes`. Before that, receivers whose masks are full drop out; where none is left,
    /// the walk ends. `columns`: the light's.
    #[inline(always)]
    pub(crate) fn next_tile<L: Lanes, W: MaskWord>(
        &mut self,
        columns: u32,
        nodes: &[KeyTile],
        group: &mut Group<W>,
    ) -> Option<usize> {
        drop_full(columns, group);
        if group.active == 0 {
            return None;
        }
        (self.tile, self.bits) = self.walk.next::<L>(nodes, &self.need)?;
        Some(self.tile as usize)
    }

    /// The next triangle of the tile, by its place among all, and the receivers that keep it. `keys`: the tile's.
    #[inline(always)]
    pub(crate) fn next<L: Lanes, W: MaskWord>(&mut self, keys: &KeyTile, group: &mut Group<W>) -> Option<(usize, u32)> {
        while self.bits != 0 {
            let entry = self.bits.trailing_zeros() as usize;
            self.bits &= self.bits - 1;
            group.counts.pairs_tested += Tally::from(group.active.count_ones());
            let kept = group.needs.dominated_by::<L>(&keys.entry(entry)) & group.active;
            if kept != 0 {
                group.counts.pairs_kept += Tally::from(kept.count_ones());
                return Some((self.tile as usize * NODE + entry, kept));
            }
        }
        None
    }
}
