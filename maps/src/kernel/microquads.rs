//! Kernels of [`crate::microquad`]: draw the map, build its pyramid, gather.

use umbra4_core::glam::IVec3;

use crate::{
    draw,
    microquad::params::MicroquadParams,
    pyramid::{self, Node},
};

/// Rows of a map that a thread draws of one triangle.
pub const ROWS: u32 = 16;

#[inline(always)]
fn corner(vertices: &[[i32; 3]], index: u32) -> Option<IVec3> {
    let index = index as usize;
    if index < vertices.len() { Some(IVec3::from_array(vertices[index])) } else { None }
}

/// The texels of one triangle that lie in one part of the map's rows. Id: triangle by triangle, parts of [`ROWS`] rows each;
/// the parameters' number is that of parts a triangle. `draw(index, word)` keeps the greater of both words.
#[inline(always)]
pub fn draw_map(
    id: u32,
    params: &MicroquadParams,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    mut draw: impl FnMut(usize, u32),
) {
    let parts = params.number();
    if id >= params.count() || parts == 0 {
        return;
    }
    let (triangle, part) = ((id / parts) as usize, id % parts);
    if triangle >= triangles.len() {
        return;
    }
    let [i, j, k] = triangles[triangle];
    if let (Some(p), Some(q), Some(r)) = (corner(vertices, i), corner(vertices, j), corner(vertices, k)) {
        let a = params.arithmetic();
        let drawing = draw::set_up(a, params.frame(), [p, q, r]);
        let (first, end) = (part * ROWS, part * ROWS + ROWS);
        let mut y = if drawing.rows[0] > first { drawing.rows[0] } else { first };
        let end = if drawing.rows[1] < end { drawing.rows[1] } else { end };
        while y < end {
            let mut x = drawing.columns[0];
            while x < drawing.columns[1] {
                let word = drawing.texel(a, x, y);
                if word != 0 {
                    draw((y * params.frame().size() + x) as usize, word);
                }
                x += 1;
            }
            y += 1;
        }
    }
}

/// Node `id` of level 0.
#[inline(always)]
pub fn build_tiles(id: u32, params: &MicroquadParams, map: &[u32], nodes: &mut [Node]) {
    if id < params.count() && (id as usize) < nodes.len() {
        nodes[id as usize] = pyramid::tile(map, params.frame().size(), id);
    }
}

/// Node `id` of the level that is the parameters' number.
#[inline(always)]
pub fn build_parents(id: u32, params: &MicroquadParams, nodes: &mut [Node]) {
    let (size, level) = (params.frame().size(), params.number());
    let index = (pyramid::start(size, level) + id) as usize;
    if id < params.count() && level > 0 && index < nodes.len() {
        nodes[index] = pyramid::parent(nodes, size, level, id);
    }
}
