//! Kernel `order_triangles`: what the hierarchy's lowest level and the resolve stage read, in order.

use crate::{
    kernel::{fetch, key_triangles::triangle, light_params::LightParams, store},
    occluder::Occluder,
    order::Entry,
    proj4::{KeyTile, Keys, NODE, NOTHING},
};

/// Place `id` of the lowest level; places beyond the last triangle hold nothing.
#[inline(always)]
pub fn order_triangles<T: LightParams>(
    id: usize,
    params: &T,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &mut [Occluder],
    nodes: &mut [KeyTile],
) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut own = NOTHING;
    if id < pass.elements as usize {
        let entry = fetch(order, id, Entry::default());
        own = fetch(keys, entry.index as usize, NOTHING);
        let found = triangle(entry.index as usize, params, vertices, triangles);
        let mut occluder = Occluder::NONE;
        if let Some((_, facing)) = found {
            occluder = facing.numbered(entry.index);
        }
        store(occluders, id, occluder);
    }
    let node = id / NODE;
    if node < nodes.len() {
        nodes[node].set(id, &own);
    }
}
