//! Kernels of [`crate::microquad`]: draw the map, build its pyramid, gather.

use umbra4_core::{
    glam::IVec3,
    kernel::{fetch, point, store},
};

use crate::{
    draw,
    microquad::params::MicroquadParams,
    pyramid::{self, Node},
};

/// Rows of a map that a thread draws of one triangle.
pub const ROWS: u32 = 8;

#[inline(always)]
fn corner(vertices: &[[i32; 3]], index: u32) -> Option<IVec3> {
    point(vertices, index as usize)
}

/// The texels of one triangle that lie in one part of the map's rows. Id: triangle by triangle from the pass's first on, parts of [`ROWS`] rows
/// each; the pass's number is that of parts a triangle. `keep` makes a word of the map the greater of itself and another; many threads may
/// do so at once.
#[inline(always)]
pub fn draw_map(
    id: usize,
    params: &MicroquadParams,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    map: &mut [u32],
    keep: impl Fn(&mut u32, u32),
) {
    let (pass, size) = (params.pass(), params.frame().size());
    if id >= pass.count as usize || pass.number == 0 {
        return;
    }
    let (triangle, part) = (pass.first + id as u32 / pass.number, id as u32 % pass.number);
    let [i, j, k] = fetch(triangles, triangle as usize, [u32::MAX; 3]);
    if let (Some(p), Some(q), Some(r)) = (corner(vertices, i), corner(vertices, j), corner(vertices, k)) {
        let a = params.arithmetic();
        let drawing = draw::set_up(a, params.frame(), [p, q, r]);
        let (first, end) = (part * ROWS, part * ROWS + ROWS);
        let mut y = if drawing.rows[0] > first { drawing.rows[0] } else { first };
        let end = if drawing.rows[1] < end { drawing.rows[1] } else { end };
        while y < end {
            let mut x = drawing.columns[0];
            while x < drawing.columns[1] {
                let (word, index) = (drawing.texel(a, x, y), (y * size + x) as usize);
                if word != 0 && index < map.len() {
                    keep(&mut map[index], word);
                }
                x += 1;
            }
            y += 1;
        }
    }
}

/// Node `id` of level 0.
#[inline(always)]
pub fn build_tiles(id: usize, params: &MicroquadParams, map: &[u32], nodes: &mut [Node]) {
    if id < params.pass().count as usize {
        store(nodes, id, pyramid::tile(map, params.frame().size(), id as u32));
    }
}

/// Node `id` of the level that is the pass's number.
#[inline(always)]
pub fn build_parents(id: usize, params: &MicroquadParams, nodes: &mut [Node]) {
    let (pass, size) = (params.pass(), params.frame().size());
    if id < pass.count as usize && pass.number > 0 {
        let index = pyramid::start(size, pass.number) as usize + id;
        store(nodes, index, pyramid::parent(nodes, size, pass.number, id as u32));
    }
}
