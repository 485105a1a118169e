//! All micro-occluders of one receiver: from the map to its mask, or to the area that is occluded.
//!
//! Seed: Schwarz, Stamminger 2008, sections 2 and 3. Tiles of the map in which nothing occludes, or whose nearest texel lies outside of the light
//! as the receiver sees it, are skipped; and the search ends when nothing is left to block.

use core::marker::PhantomData;

use umbra4_core::{MaskWord, exact, facing::Facing, glam::IVec3, light::MAX_SAMPLES, wide::Wide};

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

/// How the footprint of one micro-occluder becomes bits of a mask.
pub trait InMask<W> {
    /// See [`Gathered::CLOSED`].
    const CLOSED: bool;
    /// See [`Gathered::add_quad`].
    fn add_quad(
        mask: &mut Mask<W>,
        a: Arithmetic,
        params: &MicroquadParams,
        table: &[u32],
        corners: [Point; 4],
        count: u32,
    );
    /// See [`Gathered::add_rectangle`].
    fn add_rectangle(mask: &mut Mask<W>, a: Arithmetic, params: &MicroquadParams, table: &[u32], corners: [Point; 2]);
}

/// By exact rows.
#[derive(Clone, Copy, Debug)]
pub struct Rows;

/// By a table of half-spaces.
#[derive(Clone, Copy, Debug)]
pub struct Table;

/// By axis-aligned rectangles.
#[derive(Clone, Copy, Debug)]
pub struct Rectangles;

/// A mask, and how footprints come into it.
#[derive(Clone, Copy, Debug)]
pub struct ByMask<W, F> {
    /// Rows of samples that are blocked.
    pub mask: Mask<W>,
    footprints: PhantomData<F>,
}

/// A mask from exact rows.
pub type ByRows<W> = ByMask<W, Rows>;

/// A mask from a table of half-spaces.
pub type ByTable<W> = ByMask<W, Table>;

/// A mask from axis-aligned rectangles.
pub type ByRectangles<W> = ByMask<W, Rectangles>;

/// The area that is occluded, in cells of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ByArea(pub f32);

impl<W: MaskWord, F> ByMask<W, F> {
    /// Adds to what is blocked already.
    #[inline(always)]
    pub const fn of(mask: Mask<W>) -> Self {
        Self { mask, footprints: PhantomData }
    }
}

impl<W: MaskWord, F: InMask<W>> Gathered for ByMask<W, F> {
    const CLOSED: bool = F::CLOSED;

    #[inline(always)]
    fn add_quad(&mut self, a: Arithmetic, params: &MicroquadParams, table: &[u32], corners: [Point; 4], count: u32) {
        F::add_quad(&mut self.mask, a, params, table, corners, count);
    }

    #[inline(always)]
    fn add_rectangle(&mut self, a: Arithmetic, params: &MicroquadParams, table: &[u32], corners: [Point; 2]) {
        F::add_rectangle(&mut self.mask, a, params, table, corners);
    }

    #[inline(always)]
    fn is_full(&self, params: &MicroquadParams) -> bool {
        let (mut all, mut row) = (W::below(params.columns()), 0);
        while row < params.rows() as usize {
            all = all.and(self.mask[row % MAX_SAMPLES as usize]);
            row += 1;
        }
        all == W::below(params.columns())
    }

    #[inline(always)]
    fn fill(&mut self, params: &MicroquadParams) {
        let mut row = 0;
        while row < params.rows() as usize {
            self.mask[row % MAX_SAMPLES as usize] = W::below(params.columns());
            row += 1;
        }
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

impl<W: MaskWord> InMask<W> for Rows {
    const CLOSED: bool = true;

    #[inline(always)]
    fn add_quad(
        mask: &mut Mask<W>,
        a: Arithmetic,
        params: &MicroquadParams,
        _: &[u32],
        corners: [Point; 4],
        count: u32,
    ) {
        rows::fill(a, params, &hull_of(a, corners, count), mask);
    }

    #[inline(always)]
    fn add_rectangle(mask: &mut Mask<W>, _: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 2]) {
        rectangles::fill(params, corners, mask);
    }
}

impl<W: TableWord> InMask<W> for Table {
    const CLOSED: bool = true;

    #[inline(always)]
    fn add_quad(
        mask: &mut Mask<W>,
        a: Arithmetic,
        params: &MicroquadParams,
        table: &[u32],
        corners: [Point; 4],
        count: u32,
    ) {
        half_spaces::fill(a, params, table, &hull_of(a, corners, count), mask);
    }

    #[inline(always)]
    fn add_rectangle(mask: &mut Mask<W>, a: Arithmetic, params: &MicroquadParams, table: &[u32], corners: [Point; 2]) {
        half_spaces::fill(a, params, table, &around(corners), mask);
    }
}

impl<W: MaskWord> InMask<W> for Rectangles {
    const CLOSED: bool = false;

    #[inline(always)]
    fn add_quad(mask: &mut Mask<W>, a: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 4], _: u32) {
        rectangles::fill(params, rectangles::of_quad(a, params, corners), mask);
    }

    #[inline(always)]
    fn add_rectangle(mask: &mut Mask<W>, _: Arithmetic, params: &MicroquadParams, _: &[u32], corners: [Point; 2]) {
        rectangles::fill(params, corners, mask);
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

/// As [`gather`], of a receiver whose surface may be known to face away: as in the exact system, the light gives it nothing.
#[inline(always)]
pub fn gather_facing<G: Gathered>(
    params: &MicroquadParams,
    map: &[u32],
    nodes: &[Node],
    table: &[u32],
    p: IVec3,
    facing: Facing,
    out: &mut G,
) {
    if facing.is_away_from(&params.lattice_light(), p) {
        out.fill(params);
    } else {
        gather(params, map, nodes, table, p, out);
    }
}

/// Adds all that blocks the receiver at `p`, in those tiles of its search area that the pass is of. `nodes` is the pyramid of `map`; `table` is
/// read by [`ByTable`] only.
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
    let (found, area) = search::search(a, params, nodes, &viewer, closed);
    match found {
        Found::Lit => {}
        Found::Dark => out.fill(params),
        Found::Some => gather_area(params, map, nodes, table, &viewer, area, out),
    }
}

/// Adds what lies in an area of the map: tile by tile, row by row, those of the pass.
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
    let (a, pass, size) = (params.arithmetic(), params.pass(), params.frame.size());
    let (left, below) = (whole.columns[0] as u32 / TILE, whole.rows[0] as u32 / TILE);
    let across = (whole.columns[1] as u32 / TILE - left + 1).max(1);
    let all = across * (whole.rows[1] as u32 / TILE - below + 1);
    let mut index = pass.tile;
    let end = if index < all && pass.tiles < all - index { index + pass.tiles } else { all };
    while index < end {
        let (x, y) = (left + index % across, below + index / across);
        let node = pyramid::of_tile(nodes, size, x, y);
        if node.most > viewer.threshold {
            // Its own nearest texel may make the area smaller still.
            let own = search::area(a, params, viewer, node.most);
            let part = Area { columns: in_tile(own.columns, x), rows: in_tile(own.rows, y), cut: false };
            if !part.is_empty() {
                gather_part(params, map, table, viewer, part, out);
                if out.is_full(params) {
                    index = end;
                }
            }
        }
        index += 1;
    }
}

/// What of a range lies in a tile's own.
#[inline(always)]
fn in_tile([from, to]: [i32; 2], tile: u32) -> [i32; 2] {
    let first = (tile * TILE) as i32;
    let last = first + TILE as i32 - 1;
    [if from > first { from } else { first }, if to < last { to } else { last }]
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
