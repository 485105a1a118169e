//! Hierarchies in memory: things packed under nodes, and the levels above them.

use rayon::prelude::*;
use umbra4_core::{
    hierarchy::Levels,
    proj4::{KeyTile, Keys, NODE},
    stage::{build_level::build_level, resolve_silhouette::Indexed},
};

/// Things under a hierarchy.
#[derive(Debug)]
pub(crate) struct Hierarchy<T> {
    levels: Levels,
    nodes: Vec<KeyTile>,
    things: Vec<T>,
}

impl<T> Hierarchy<T> {
    /// Of things in the order in which they are packed, with their keys.
    pub(crate) fn new(packed: impl Iterator<Item = (T, Keys)>) -> Self {
        let mut hierarchy = Self::lowest(packed);
        build_levels(&hierarchy.levels, &mut hierarchy.nodes);
        hierarchy
    }

    /// The same, with the levels above the lowest yet to be built.
    pub(crate) fn lowest(packed: impl Iterator<Item = (T, Keys)>) -> Self {
        let (mut things, mut nodes) = (Vec::new(), Vec::new());
        for (thing, keys) in packed {
            if things.len() % NODE == 0 {
                nodes.push(KeyTile::NOTHING);
            }
            if let Some(tile) = nodes.last_mut() {
                tile.set(things.len() % NODE, &keys);
            }
            things.push(thing);
        }
        let levels = Levels::of(things.len() as u32);
        nodes.resize(levels.tiles(), KeyTile::NOTHING);
        Self { levels, nodes, things }
    }

    /// Builds one level from the one below it; there may be no such level.
    pub(crate) fn build_level(&mut self, level: usize) {
        if level < self.levels.count() {
            build_level_of(&self.levels, &mut self.nodes, level);
        }
    }

    /// Whether nothing is packed.
    pub(crate) fn is_empty(&self) -> bool {
        self.things.is_empty()
    }

    pub(crate) fn indexed(&self) -> Indexed<'_, T> {
        Indexed { levels: &self.levels, nodes: &self.nodes, things: &self.things }
    }
}

/// Nodes that are worth a job.
const NODES_A_JOB: usize = 64;

/// One level, from the one below it.
pub(crate) fn build_level_of(levels: &Levels, nodes: &mut [KeyTile], level: usize) {
    let (below, above) = nodes.split_at_mut(levels.range(level).start);
    let below = &below[levels.range(level - 1)];
    let above = &mut above[..levels.range(level).len()];
    above.par_iter_mut().with_min_len(NODES_A_JOB).enumerate().for_each(|(id, tile)| *tile = build_level(id, below));
}

/// All levels above the lowest.
pub(crate) fn build_levels(levels: &Levels, nodes: &mut [KeyTile]) {
    for level in 1..levels.count() {
        build_level_of(levels, nodes, level);
    }
}
