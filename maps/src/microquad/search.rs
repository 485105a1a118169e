//! Which texels a receiver has to look at.
//!
//! Seed: Schwarz, Stamminger 2008, who restrict the search area by a hierarchical shadow map. What lies between a receiver and the light,
//! and is no nearer to the light than inverse depth `κ`, is seen on the map within the light's rectangle, `κ − ι` as large, around the receiver's own place
//! (the inverse of [`crate::microquad::projection`]). The greatest inverse depth there gives a smaller rectangle, and so on.
//! Nothing that could block a sample is left out: a quad is, only where all its corners lie beyond one side of the light.

use crate::{
    arithmetic::{Arithmetic, ceil_within, floor_within},
    microquad::{
        params::{MicroquadParams, PATCHES},
        projection::Viewer,
    },
    pyramid::{self, Node, TILE},
};

/// Texels by which the rectangle is larger: more than rounding takes away.
const MARGIN: f32 = 1.0 / 16.0;
/// How often it is made smaller.
const ROUNDS: u32 = 3;

/// Micro-occluders, by their first texels: both ends are included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Area {
    /// First and last column; none where the first is greater.
    pub columns: [i32; 2],
    /// First and last row.
    pub rows: [i32; 2],
    /// The map ends within it.
    pub cut: bool,
}

impl Area {
    /// Whether it holds nothing.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.columns[0] > self.columns[1] || self.rows[0] > self.rows[1]
    }
}

/// What a receiver has to do. (On GPUs, a variant with an area in it would be copied byte by byte, which they do not do.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Found {
    /// Nothing: it sees all of the light.
    Lit,
    /// Nothing: every texel that it could see the light through occludes it.
    Dark,
    /// To look at the texels of an area.
    Some,
}

/// What may block something, where all that occludes has an inverse depth of `most` at most.
#[inline(always)]
pub fn area(a: Arithmetic, params: &MicroquadParams, viewer: &Viewer, most: f32) -> Area {
    let size = params.frame.size() as i32;
    let patches = params.counts.z == PATCHES;
    let spread = a.sub(most, viewer.inverse);
    // Quads begin up to a texel before what they cover, patches half a texel, and end so.
    let (before, after) = if patches { (0.5 + MARGIN, 0.5 + MARGIN) } else { (1.0 + MARGIN, MARGIN) };
    let last = size - if patches { 1 } else { 2 };
    let side = |place: f32, low: f32, high: f32, texels: f32| {
        let scale = a.mul(texels, spread);
        let low = a.sub(a.add(place, a.mul(low, scale)), before);
        let high = a.add(a.add(place, a.mul(high, scale)), after);
        [ceil_within(low, -2, size + 1), floor_within(high, -2, size + 1)]
    };
    let columns = side(viewer.x, params.light.x, params.light.z, params.frame.across.w);
    let rows = side(viewer.y, params.light.y, params.light.w, params.frame.down.w);
    let cut = columns[0] < 0 || rows[0] < 0 || columns[1] > last || rows[1] > last;
    let within = |[from, to]: [i32; 2]| [if from > 0 { from } else { 0 }, if to < last { to } else { last }];
    Area { columns: within(columns), rows: within(rows), cut }
}

/// What a receiver has to do, and, if anything, in which area. `dark`: whether one that only occluding texels lie around is in the dark, as it is where
/// footprints leave no gaps.
#[inline(always)]
pub fn search(a: Arithmetic, params: &MicroquadParams, nodes: &[Node], viewer: &Viewer, dark: bool) -> (Found, Area) {
    let size = params.frame.size();
    let last = pyramid::tiles(size) - 1;
    let mut node = pyramid::around(nodes, size, [0, last], [0, last]);
    let mut found = Area::default();
    let mut round = 0;
    while round < ROUNDS {
        if node.most <= viewer.threshold {
            return (Found::Lit, found);
        }
        found = area(a, params, viewer, node.most);
        if found.is_empty() {
            return (Found::Lit, found);
        }
        let tiles = |[from, to]: [i32; 2]| [from as u32 / TILE, to as u32 / TILE];
        node = pyramid::around(nodes, size, tiles(found.columns), tiles(found.rows));
        round += 1;
    }
    if node.most <= viewer.threshold {
        return (Found::Lit, found);
    }
    if dark && !found.cut && node.least > viewer.threshold {
        return (Found::Dark, found);
    }
    (Found::Some, found)
}
