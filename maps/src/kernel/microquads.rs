//! Kernels of [`crate::microquad`]: draw the map, build its pyramid, gather.

use umbra4_core::{
    facing::Facing,
    glam::IVec3,
    kernel::{
        fetch, point,
        resolve::{DeviceWord, tell_if_stopped},
        store,
    },
    light::MAX_SAMPLES,
};

use crate::{
    draw,
    microquad::{
        gather::{ByArea, ByMask, Gathered, InMask, gather_facing},
        params::MicroquadParams,
    },
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

/// Number of a pass of [`gather_masks`] or [`gather_areas`] that starts from what is there; others start from nothing.
pub const ADD: u32 = 1;

/// Adds what blocks receiver `index`: all of it where there is no such receiver, or it faces away.
#[inline(always)]
fn gather_receiver<G: Gathered>(
    index: usize,
    params: &MicroquadParams,
    receivers: &[[i32; 3]],
    facings: &[u32],
    map: &[u32],
    nodes: &[Node],
    table: &[u32],
    out: &mut G,
) {
    match point(receivers, index) {
        Some(p) => {
            let facing = Facing::from_word(fetch(facings, index, Facing::UNKNOWN.word()));
            gather_facing(params, map, nodes, table, p, facing, out);
        }
        None => out.fill(params),
    }
}

/// The mask of receiver `first + id`, as far as the tiles of the pass go: starts from nothing, or, where the pass's number is
/// [`ADD`], from the words that are there. They lie as [`umbra4_core::kernel::resolve`] has them; the last of `masks` belongs to none.
/// `table` is read by [`crate::microquad::gather::Table`] only.
#[inline(always)]
pub fn gather_masks<W: DeviceWord, F: InMask<W>>(
    id: usize,
    params: &MicroquadParams,
    receivers: &[[i32; 3]],
    facings: &[u32],
    map: &[u32],
    nodes: &[Node],
    table: &[u32],
    masks: &mut [u32],
) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let (rows, stride) = (params.rows() as usize, pass.stride as usize);
    let (halves, own) = (pass.stride < params.rows(), id * stride);
    let (mut out, mut k) = (ByMask::<W, F>::of([W::EMPTY; MAX_SAMPLES as usize]), 0);
    while pass.number == ADD && k < stride {
        W::load(&mut out.mask, k, halves, fetch(masks, own + k, 0));
        k += 1;
    }
    if k == 0 || !out.is_full(params) {
        gather_receiver(pass.first as usize + id, params, receivers, facings, map, nodes, table, &mut out);
        k = 0;
        while k < stride {
            store(masks, own + k, W::stored(&out.mask, rows, k, halves));
            k += 1;
        }
    }
    tell_if_stopped(params.rounds(), k == stride, masks);
}

/// The same of the area that is occluded, in cells of samples: the bits of a float each.
#[inline(always)]
pub fn gather_areas(
    id: usize,
    params: &MicroquadParams,
    receivers: &[[i32; 3]],
    facings: &[u32],
    map: &[u32],
    nodes: &[Node],
    areas: &mut [u32],
) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut out = ByArea(f32::from_bits(if pass.number == ADD { fetch(areas, id, 0) } else { 0 }));
    if !out.is_full(params) {
        gather_receiver(pass.first as usize + id, params, receivers, facings, map, nodes, map, &mut out);
    }
    store(areas, id, out.0.to_bits());
    tell_if_stopped(params.rounds(), true, areas);
}
