//! The map itself: triangles in the light frame, the tree over them, and the nearest hit of every texel.

use umbra4_core::kernel::{fetch, store};

use crate::stochastic::{
    params::LensParams,
    trace::{self, Corners, Node},
    tree::Tree,
};

/// The corners of the triangle in place `id` of the order. Any order gives the same map; along a curve, nodes are small.
#[inline(always)]
pub fn place_triangles(
    id: usize,
    params: &LensParams,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    order: &[u32],
    placed: &mut [Corners],
) {
    if id < params.count as usize {
        let triangle = fetch(order, id, u32::MAX);
        store(placed, id, trace::corners(triangle as usize, params, vertices, triangles));
    }
}

/// Node `id` of level 0.
#[inline(always)]
pub fn bound_triangles(id: usize, params: &LensParams, placed: &[Corners], nodes: &mut [Node]) {
    if id < params.count as usize {
        store(nodes, id, trace::leaf(id, params, placed));
    }
}

/// Node `id` of a level above 0, from those of the level below.
#[inline(always)]
pub fn bound_nodes(id: usize, params: &LensParams, nodes: &mut [Node]) {
    if id < params.count as usize && params.level > 0 {
        let tree = Tree::new(params.triangles);
        let node = trace::parent(id, params.level, &tree, nodes);
        store(nodes, tree.start(params.level) as usize + id, node);
    }
}

/// The depth of the nearest hit of texel `id`.
#[inline(always)]
pub fn sample_light_field(id: usize, params: &LensParams, placed: &[Corners], nodes: &[Node], depths: &mut [f32]) {
    if id < params.count as usize {
        store(depths, id, trace::nearest(id, params, &Tree::new(params.triangles), placed, nodes));
    }
}
