//! All micro-occluders of one receiver: from the map to its mask, or to the area that is occluded.
//!
//! Seed: Schwarz, Stamminger 2008, sections 2 and 3. Tiles of the map in which nothing occludes, or whose nearest texel lies outside of the light
//! as the receiver sees it, are skipped; and the search ends when nothing is left to block.

use umbra4_core::{MaskWord, exact, glam::IVec3, light::MAX_SAMPLES, wide::Wide};

use crate::{
    arithmetic::Arithmetic,
    microquad::{
        area, half_spaces,
        half_spaces::TableWord,
        hull,
        hull::Hull,
        params::{MicroquadParams, PATCHES, TRIS},
        projection::{Point, Viewer},
        rectangles, rows,
        rows::Mask,
        search::{self, Area, Found},
    },
    pyramid::{self, Node, TILE},
    shadow_map::texel,
};

/// What footprints add up to. Kernels are compiled for one each.
pub trait Gathered {
    /// Whether footprints of neighbours leave no gaps.
    const CLOSED: bool;
    /// Adds a quad, or, with its last corner equal to the first, a triangle. Corners come around it.
    fn add_quad(&mut self, a: Arithmetic, params: &MicroquadParams, table: &[u32], corners: [Point; 4], count: u32);
    /// Adds an axis-aligned rectangle, by its low and high corner.
    fn add_rectangle(&mut self, a: Arithmetic, params: &MicroquadParams, table: &[u32], corners: [Point; 2]);
    /// Whether nothing is left to block.
    fn is_full(&self, params: &MicroquadParams) -> bool;
    /// Blocks everything.
    fn fill(&mut self, params: &MicroquadParams);
}

/// A mask from exact rows.
#[derive(Clone, Copy, Debug)]
pub struct ByRows<W>(pub Mask<W>);

/// A mask from a table of half-spaces.
#[derive(Clone, Copy, Debug)]
pub struct ByTable<W>(pub Mask<W>);

/// A mask from axis-aligned rectangles.
#[derive(Clone, Copy, Debug)]
pub struct ByRectangles<W>(pub Mask<W>);

/// The area that is occluded, in cells of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ByArea(pub f32);

#[inline(always)]
fn is_full<W: MaskWord>(params: &MicroquadParams, mask: &Mask<W>) -> bool {
    let (mut all, mut row) = (W::below(params.columns()), 0);
    while row < params.rows() as usize {
        all = all.and(mask[row % MAX_SAMPLES as usize]);
        row += 1;
    }
    all == W::below(params.columns())
}

#[inline(always)]
fn fill<W: MaskWord>(params: &MicroquadParams, mask: &mut Mask<W>) {
    let mut row = 0;
    while row < params.rows() as usize {
        mask[row % MAX_SAMPLES as usize] = W::below(params.columns());
        row += 1;
    }
}

#[inline(always)]
fn hull_of(a: Arithmetic, corners: [Point; 4], count: u32) -> Hull {
    if count == 3 { hull::of_three(a, corners[0], corners[1], corners[2]) } else { hull::of_four(a, corners) }
}

/// The corners of a rectangle, counter-clockwise.
#[inline(always)]
fn around([low, high]: [Point; 2]) -> Hull {
    let corners = [low, Point { x: high.x, y: low.y }, high, Point { x: low.x, y: high.y }];
    let count = if high.x > low.x && high.y > low.y { 4 } else { 0 };
    Hull { corners, count }
}

impl<W: MaskWord> Gathered for ByRows<W> {
    const CLOSED: bool = true;

    #[inline(always)]
    fn add_quad(&mut self, a: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 4], count: u32) {
        rows::fill(a, params, &hull_of(a, corners, count), &mut self.0);
    }

    #[inline(always)]
    fn add_rectangle(&mut self, _: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 2]) {
        rectangles::fill(params, corners, &mut self.0);
    }

    #[inline(always)]
    fn is_full(&self, params: &MicroquadParams) -> bool {
        is_full(params, &self.0)
    }

    #[inline(always)]
    fn fill(&mut self, params: &MicroquadParams) {
        fill(params, &mut self.0);
    }
}

impl<W: TableWord> Gathered for ByTable<W> {
    const CLOSED: bool = true;

    #[inline(always)]
    fn add_quad(&mut self, a: Arithmetic, params: &MicroquadParams, table: &[u32], corners: [Point; 4], count: u32) {
        half_spaces::fill(a, params, table, &hull_of(a, corners, count), &mut self.0);
    }

    #[inline(always)]
    fn add_rectangle(&mut self, a: Arithmetic, params: &MicroquadParams, table: &[u32], corners: [Point; 2]) {
        half_spaces::fill(a, params, table, &around(corners), &mut self.0);
    }

    #[inline(always)]
    fn is_full(&self, params: &MicroquadParams) -> bool {
        is_full(params, &self.0)
    }

    #[inline(always)]
    fn fill(&mut self, params: &MicroquadParams) {
        fill(params, &mut self.0);
    }
}

impl<W: MaskWord> Gathered for ByRectangles<W> {
    const CLOSED: bool = false;

    #[inline(always)]
    fn add_quad(&mut self, a: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 4], _: u32) {
        rectangles::fill(params, rectangles::of_quad(a, params, corners), &mut self.0);
    }

    #[inline(always)]
    fn add_rectangle(&mut self, _: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 2]) {
        rectangles::fill(params, corners, &mut self.0);
    }

    #[inline(always)]
    fn is_full(&self, params: &MicroquadParams) -> bool {
        is_full(params, &self.0)
    }

    #[inline(always)]
    fn fill(&mut self, params: &MicroquadParams) {
        fill(params, &mut self.0);
    }
}

impl Gathered for ByArea {
    const CLOSED: bool = false;

    #[inline(always)]
    fn add_quad(&mut self, a: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 4], _: u32) {
        self.0 = a.add(self.0, area::of_quad(a, params, corners));
    }

    #[inline(always)]
    fn add_rectangle(&mut self, a: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 2]) {
        self.0 = a.add(self.0, area::of_rectangle(a, params, corners));
    }

    #[inline(always)]
    fn is_full(&self, params: &MicroquadParams) -> bool {
        self.0 >= (params.rows() * params.columns()) as f32
    }

    #[inline(always)]
    fn fill(&mut self, params: &MicroquadParams) {
        self.0 = (params.rows() * params.columns()) as f32;
    }
}

/// The share of the light that is seen, of which `occluded` cells of samples are hidden: between 0 and 1.
#[inline(always)]
pub fn visibility(a: Arithmetic, params: &MicroquadParams, occluded: f32) -> f32 {
    let samples = (params.rows() * params.columns()) as f32;
    let left = a.sub(samples, occluded);
    a.mul(if left > 0.0 { left } else { 0.0 }, a.reciprocal(samples))
}

/// A texel's centre as a corner of micro-occluders.
#[derive(Clone, Copy, Default)]
struct Corner {
    at: Point,
    /// Whether it is nearer to the light than the receiver.
    occludes: bool,
}

#[inline(always)]
fn corner(a: Arithmetic, params: &MicroquadParams, map: &[u32], viewer: &Viewer, x: i32, y: i32) -> Corner {
    let inverse = f32::from_bits(texel(map, params.frame.size(), x as u32, y as u32));
    if inverse > viewer.threshold {
        Corner { at: viewer.project(a, params, x as f32, y as f32, inverse), occludes: true }
    } else {
        Corner::default()
    }
}

/// Adds all that blocks the receiver at `p`. `nodes` is the pyramid of `map`; `table` is read by [`ByTable`] only.
#[inline(always)]
pub fn gather<G: Gathered>(
    params: &MicroquadParams,
    map: &[u32],
    nodes: &[Node],
    table: &[u32],
    p: IVec3,
    out: &mut G,
) {
    if exact::behind_light::<Wide>(&params.lattice_light(), p) {
        out.fill(params);
        return;
    }
    let a = params.arithmetic();
    let viewer = Viewer::new(a, params, p);
    let closed = G::CLOSED && params.counts.z != PATCHES;
    match search::search(a, params, nodes, &viewer, closed) {
        Found::Lit => {}
        Found::Dark => out.fill(params),
        Found::Some(area) => gather_area(params, map, nodes, table, &viewer, area, out),
    }
}

/// Adds what lies in an area of the map.
#[inline(always)]
pub fn gather_area<G: Gathered>(
    params: &MicroquadParams,
    map: &[u32],
    nodes: &[Node],
    table: &[u32],
    viewer: &Viewer,
    whole: Area,
    out: &mut G,
) {
    let a = params.arithmetic();
    let size = params.frame.size();
    let tile = TILE as i32;
    let mut y = whole.rows[0] / tile;
    while y <= whole.rows[1] / tile {
        let mut x = whole.columns[0] / tile;
        while x <= whole.columns[1] / tile {
            let node = pyramid::of_tile(nodes, size, x as u32, y as u32);
            if node.most > viewer.threshold {
                // Its own nearest texel may make the area smaller still.
                let own = search::area(a, params, viewer, node.most);
                let within = |own: [i32; 2], at: i32| {
                    let (first, last) = (at * tile, at * tile + tile - 1);
                    [if own[0] > first { own[0] } else { first }, if own[1] < last { own[1] } else { last }]
                };
                let part = Area { columns: within(own.columns, x), rows: within(own.rows, y), cut: false };
                if !part.is_empty() {
                    gather_part(params, map, table, viewer, part, out);
                    if out.is_full(params) {
                        return;
                    }
                }
            }
            x += 1;
        }
        y += 1;
    }
}

#[inline(always)]
fn gather_part<G: Gathered>(
    params: &MicroquadParams,
    map: &[u32],
    table: &[u32],
    viewer: &Viewer,
    part: Area,
    out: &mut G,
) {
    let a = params.arithmetic();
    let kind = params.counts.z;
    let mut y = part.rows[0];
    while y <= part.rows[1] {
        let mut x = part.columns[0];
        if kind == PATCHES {
            while x <= part.columns[1] {
                patch(params, map, table, viewer, x, y, out);
                x += 1;
            }
        } else {
            let mut below = corner(a, params, map, viewer, x, y);
            let mut above = corner(a, params, map, viewer, x, y + 1);
            while x <= part.columns[1] {
                let next_below = corner(a, params, map, viewer, x + 1, y);
                let next_above = corner(a, params, map, viewer, x + 1, y + 1);
                quad(params, table, [below, next_below, next_above, above], kind == TRIS, out);
                below = next_below;
                above = next_above;
                x += 1;
            }
        }
        y += 1;
    }
}

/// A microquad, or a microtri, if its corners make one.
#[inline(always)]
fn quad<G: Gathered>(params: &MicroquadParams, table: &[u32], v: [Corner; 4], tris: bool, out: &mut G) {
    let count = v[0].occludes as u32 + v[1].occludes as u32 + v[2].occludes as u32 + v[3].occludes as u32;
    let a = params.arithmetic();
    if count == 4 {
        out.add_quad(a, params, table, [v[0].at, v[1].at, v[2].at, v[3].at], 4);
    } else if tris && count == 3 {
        // The one that is missing is passed over.
        let p = if v[0].occludes { v[0].at } else { v[1].at };
        let q = if v[0].occludes && v[1].occludes { v[1].at } else { v[2].at };
        let r = if v[3].occludes { v[3].at } else { v[2].at };
        out.add_quad(a, params, table, [p, q, r, p], 3);
    }
}

/// A micropatch, if its texel occludes.
#[inline(always)]
fn patch<G: Gathered>(
    params: &MicroquadParams,
    map: &[u32],
    table: &[u32],
    viewer: &Viewer,
    x: i32,
    y: i32,
    out: &mut G,
) {
    let a = params.arithmetic();
    let inverse = f32::from_bits(texel(map, params.frame.size(), x as u32, y as u32));
    if inverse > viewer.threshold {
        let low = viewer.project(a, params, a.sub(x as f32, 0.5), a.sub(y as f32, 0.5), inverse);
        let high = viewer.project(a, params, a.add(x as f32, 0.5), a.add(y as f32, 0.5), inverse);
        out.add_rectangle(a, params, table, [low, high]);
    }
}
