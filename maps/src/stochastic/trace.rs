//! The nearest hit of a ray (section 7.1): what the paper leaves to a ray tracer, or to stochastic rasterisation.
//!
//! A triangle is held against a ray by its corners' places around the ray, each at its own depth: the ray is sheared onto the d axis, and what
//! remains is a point in a triangle in the plane. No corner is divided by its depth, so that nothing has to be clipped, and neighbours see
//! a shared edge with opposite signs of one product: no ray slips between them.

use glam::{IVec3, Vec3};
use umbra4_core::kernel::fetch;

use crate::stochastic::{
    float::{larger, smaller},
    params::LensParams,
    strata,
    thin_lens::Ray,
    tree::{CHILDREN, Tree},
};

/// Corners of a triangle, light frame.
pub type Corners = [[f32; 3]; 3];

/// The box around some triangles, light frame: least and largest coordinates.
pub type Node = [f32; 6];

/// The box around nothing.
pub const NOTHING: Node = [f32::MAX, f32::MAX, f32::MAX, -f32::MAX, -f32::MAX, -f32::MAX];

/// A triangle that is not there: no ray hits it.
pub const NOWHERE: Corners = [[0.0; 3]; 3];

/// The depth of a ray that hits nothing.
pub const MISS: f32 = f32::MAX;

/// The corners of triangle `id`.
#[inline(always)]
pub fn corners(id: usize, params: &LensParams, vertices: &[[i32; 3]], triangles: &[[u32; 3]]) -> Corners {
    let [i, j, k] = fetch(triangles, id, [u32::MAX; 3]);
    let vertex_count = vertices.len();
    if i as usize >= vertex_count || j as usize >= vertex_count || k as usize >= vertex_count {
        return NOWHERE;
    }
    [placed(i, params, vertices), placed(j, params, vertices), placed(k, params, vertices)]
}

#[inline(always)]
fn placed(vertex: u32, params: &LensParams, vertices: &[[i32; 3]]) -> [f32; 3] {
    let p = fetch(vertices, vertex as usize, [0; 3]);
    let p = params.place(IVec3::new(p[0], p[1], p[2]));
    [p.x, p.y, p.z]
}

/// The box around both.
#[inline(always)]
pub fn union(a: Node, b: Node) -> Node {
    [
        smaller(a[0], b[0]),
        smaller(a[1], b[1]),
        smaller(a[2], b[2]),
        larger(a[3], b[3]),
        larger(a[4], b[4]),
        larger(a[5], b[5]),
    ]
}

/// Node `id` of level 0: the box around four triangles.
#[inline(always)]
pub fn leaf(id: usize, params: &LensParams, placed: &[Corners]) -> Node {
    let mut node = NOTHING;
    let mut child = 0;
    while child < CHILDREN as usize {
        let triangle = id * CHILDREN as usize + child;
        if triangle < params.triangles as usize {
            let corners = fetch(placed, triangle, NOWHERE);
            let mut corner = 0;
            while corner < 3 {
                let p = corners[corner];
                node = union(node, [p[0], p[1], p[2], p[0], p[1], p[2]]);
                corner += 1;
            }
        }
        child += 1;
    }
    node
}

/// Node `id` of a level above: the box around its children.
#[inline(always)]
pub fn parent(id: usize, level: u32, tree: &Tree, nodes: &[Node]) -> Node {
    let (start, count) = (tree.start(level - 1), tree.count(level - 1));
    let mut node = NOTHING;
    let mut child = 0;
    while child < CHILDREN {
        let below = id as u32 * CHILDREN + child;
        if below < count {
            node = union(node, fetch(nodes, (start + below) as usize, NOTHING));
        }
        child += 1;
    }
    node
}

/// Whether a ray may meet a box at a depth in `near..best`. Never false where it does: the box is grown by more than what rounding
/// moves a point of the ray.
#[inline(always)]
pub fn meets(node: &Node, ray: &Ray, near: f32, best: f32) -> bool {
    let low = larger(node[2], near);
    let high = smaller(node[5], best);
    if low > high {
        return false;
    }
    let (a, b) = (ray.at(low), ray.at(high));
    let room = 1e-5 * (1.0 + larger(larger(a.x.abs(), b.x.abs()), larger(a.y.abs(), b.y.abs())));
    smaller(a.x, b.x) - room <= node[3]
        && larger(a.x, b.x) + room >= node[0]
        && smaller(a.y, b.y) - room <= node[4]
        && larger(a.y, b.y) + room >= node[1]
}

/// The depth at which a ray meets a triangle, or [`MISS`]. Both sides of a triangle stop rays; one that is seen edge-on stops none.
#[inline(always)]
pub fn hit(corners: &Corners, ray: &Ray) -> f32 {
    let around = |p: [f32; 3]| {
        let at = ray.at(p[2]);
        Vec3::new(p[0] - at.x, p[1] - at.y, p[2])
    };
    let (a, b, c) = (around(corners[0]), around(corners[1]), around(corners[2]));
    let (of_a, of_b, of_c) = (cross(b, c), cross(c, a), cross(a, b));
    let inside = (of_a >= 0.0 && of_b >= 0.0 && of_c >= 0.0) || (of_a <= 0.0 && of_b <= 0.0 && of_c <= 0.0);
    let sum = of_a + of_b + of_c;
    if inside && sum != 0.0 { (of_a * a.z + of_b * b.z + of_c * c.z) / sum } else { MISS }
}

#[inline(always)]
fn cross(a: Vec3, b: Vec3) -> f32 {
    a.x * b.y - a.y * b.x
}

/// The depth of the nearest hit of texel `id`, or [`MISS`]. A walk through the tree without a stack: from a node down, or to the
/// next, and up where there is none.
#[inline(always)]
pub fn nearest(id: usize, params: &LensParams, tree: &Tree, placed: &[Corners], nodes: &[Node]) -> f32 {
    let (column, row) = (id as u32 % params.size.max(1), id as u32 / params.size.max(1));
    let ray = params.lens().ray(column, row, strata::light_position(column, row, params.seed));
    let mut best = MISS;
    if tree.levels == 0 {
        return best;
    }
    let mut level = tree.levels - 1;
    let mut node = 0;
    loop {
        let found = fetch(nodes, (tree.start(level) + node) as usize, NOTHING);
        let within = meets(&found, &ray, params.near, best);
        if within && level > 0 {
            level -= 1;
            node *= CHILDREN;
            continue;
        }
        if within {
            let mut child = 0;
            while child < CHILDREN {
                let triangle = node * CHILDREN + child;
                if triangle < params.triangles {
                    let depth = hit(&fetch(placed, triangle as usize, NOWHERE), &ray);
                    if depth >= params.near && depth < best {
                        best = depth;
                    }
                }
                child += 1;
            }
        }
        node += 1;
        while level + 1 < tree.levels && (node % CHILDREN == 0 || node >= tree.count(level)) {
            // The parent's next sibling.
            node = node / CHILDREN + (node % CHILDREN != 0) as u32;
            level += 1;
        }
        if level + 1 >= tree.levels && node >= tree.count(level) {
            return best;
        }
    }
}
