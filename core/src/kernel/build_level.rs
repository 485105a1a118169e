//! Kernel `build_level`: one entry of a node above the lowest level.

use crate::{
    params::Params,
    proj4::{KeyTile, NODE, NOTHING},
};

/// Entry `id` of a level (sixteen a node), from the node below that it stands for.
#[inline(always)]
pub fn build_level(id: usize, params: &Params, nodes: &mut [KeyTile]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    // `first` is where the level starts, `base` where the one below does, `elements` how many nodes that one has.
    let (node, below) = (pass.first as usize + id / NODE, pass.base as usize + id);
    let mut own = NOTHING;
    if id < pass.elements as usize && below < nodes.len() {
        own = nodes[below].largest();
    }
    if node < nodes.len() {
        nodes[node].set(id, &own);
    }
}
