//! Kernels before `resolve_cloud`: triangles and receivers along a curve through the scene, and boxes around the triangles
//! ([`crate::shaft`]).

use crate::{
    cloud_extent::{Long, middle_of},
    facing::Facing,
    kernel::{fetch, key_triangles::corners, point, store},
    occluder::Occluder,
    order::Entry,
    params::{CloudParams, Params},
    proj4::NODE,
    shaft::{BoxTile, box_of},
};

/// Place of triangle `id` on the curve; those that are not there come last.
#[inline(always)]
pub fn key_cloud_triangles(
    id: usize,
    params: &CloudParams,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    order: &mut [Entry],
) {
    if id >= params.params.pass().count as usize {
        return;
    }
    let mut entry = Entry { code: Entry::ABSENT, index: id as u32 };
    if let Some(corners) = corners(id, vertices, triangles) {
        entry.code = params.curve().code(middle_of(box_of(corners)).to_array());
    }
    store(order, id, entry);
}

/// Place of receiver `first + id` of a block on the curve; those that are not there come last.
#[inline(always)]
pub fn key_cloud_receivers(id: usize, params: &CloudParams, receivers: &[[i32; 3]], order: &mut [Entry]) {
    let pass = params.params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut entry = Entry { code: Entry::ABSENT, index: id as u32 };
    if let Some(p) = point(receivers, pass.first as usize + id) {
        entry.code = params.curve().code(p.to_array());
    }
    store(order, id, entry);
}

/// Receiver `first + id` of a block, after its key was made: where it faces away it comes last in the order. `facings` holds a
/// [`Facing`]'s word for each receiver of all blocks.
#[inline(always)]
pub fn settle_cloud_receivers(
    id: usize,
    params: &CloudParams,
    receivers: &[[i32; 3]],
    facings: &[u32],
    order: &mut [Entry],
) {
    let pass = params.params.pass();
    if id >= pass.count as usize {
        return;
    }
    let place = pass.first as usize + id;
    let Some(p) = point(receivers, place) else { return };
    let facing = Facing::from_word(fetch(facings, place, Facing::UNKNOWN.word()));
    if facing.is_away_from_box(params.extent().bounds(), p) {
        store(order, id, Entry { code: Entry::ABSENT, index: id as u32 });
    }
}

/// Place `id` of the lowest level: an oriented triangle, and its box. Places beyond the last triangle, and those of triangles that
/// block nothing, hold nothing.
#[inline(always)]
pub fn order_cloud_triangles(
    id: usize,
    params: &CloudParams,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    order: &[Entry],
    occluders: &mut [Occluder],
    nodes: &mut [BoxTile],
) {
    let pass = params.params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut own = BoxTile::NO_ENTRY;
    if id < pass.elements as usize {
        let index = fetch(order, id, Entry::default()).index as usize;
        let mut occluder = Occluder::NONE;
        if let Some(corners) = corners(index, vertices, triangles)
            && let Some(found) = params.extent().occluder::<Long>(corners)
        {
            (own, occluder) = (box_of(corners), found);
        }
        store(occluders, id, occluder);
    }
    let node = id / NODE;
    if node < nodes.len() {
        nodes[node].set(id, own[0], own[1]);
    }
}

/// Entry `id` of a level (sixteen a node), from the node below that it stands for; as [`super::build_level`].
#[inline(always)]
pub fn build_box_level(id: usize, params: &Params, nodes: &mut [BoxTile]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let (node, below) = (pass.first as usize + id / NODE, pass.base as usize + id);
    let mut own = BoxTile::NO_ENTRY;
    if id < pass.elements as usize && below < nodes.len() {
        own = nodes[below].around();
    }
    if node < nodes.len() {
        nodes[node].set(id, own[0], own[1]);
    }
}
