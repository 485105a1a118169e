//! Stage `add_tint`: the optical depths that tinted casters put before the light samples of a group's receivers.
//!
//! What a pane covers is found as for any other triangle, but for its edges: a sample seen exactly through an edge that two triangles share
//! belongs to one of them ([`crate::exact::GridForm::sign_beside`]), so that a pane of many triangles is one pane. Depths are added,
//! in any order: [`crate::tint`].

// On a GPU no structure holds references: what goes together is handed on one by one.
#![allow(clippy::too_many_arguments)]

use crate::{
    edge_plane::LightGrid,
    hierarchy::{Levels, Root},
    jitter::Samples,
    lanes::{Lanes, TILE},
    mask_word::MaskWord,
    occluder::Occluder,
    precision::Exact,
    proj4::KeyTile,
    row_mask::MASK_ROWS,
    stage::{
        cover,
        kept_pairs::KeptPairs,
        resolve::{Group, Meeting, Occlusion},
    },
    surface_words::SurfaceLayout,
    texel::TexelView,
    tint::Depth,
};

/// A tinted caster.
#[derive(Clone, Copy, Debug)]
pub struct TintScene<'a> {
    /// Its triangles, numbered.
    pub occlusion: Occlusion<'a>,
    /// Its texture: a depth a texel.
    pub surface: &'a [u32],
    /// How it is packed.
    pub layout: SurfaceLayout,
}

/// Adds what a caster's panes take to the depths of a group's receivers. Lane l's are `depths[l·samples..]`, a depth a sample, row
/// by row. Returns the lanes of which any has changed. `room`: a group without receivers, for the same light; so it is left.
#[inline(always)]
pub fn add_tint<L: Lanes, W: MaskWord, S: Samples>(
    scene: &TintScene<'_>,
    samples: &S,
    group: &mut Group<W>,
    room: &mut Group<W>,
    depths: &mut [Depth],
    tinted: &mut u32,
) {
    let TintScene { occlusion: Occlusion { grid, levels, nodes, occluders }, surface, layout } = scene;
    let root = Root::top(levels);
    *tinted |=
        add_among::<L, W, S>(grid, samples, levels, root, nodes, occluders, surface, layout, group, room, depths, 0);
}

/// As [`add_tint`], with the triangles below `root` and depths from `first` on. (On a GPU no structure holds slices.)
#[inline(always)]
pub fn add_among<L: Lanes, W: MaskWord, S: Samples>(
    grid: &LightGrid,
    samples: &S,
    levels: &Levels,
    root: Root,
    nodes: &[KeyTile],
    occluders: &[Occluder],
    surface: &[u32],
    layout: &SurfaceLayout,
    group: &mut Group<W>,
    room: &mut Group<W>,
    depths: &mut [Depth],
    first: usize,
) -> u32 {
    let mut tinted = 0;
    if group.active == 0 {
        return tinted;
    }
    let mut pairs = KeptPairs::new::<L, W>(levels, root, nodes, group);
    let mut meeting = Meeting::<L::Long>::new::<L, W, Exact>(grid, group);
    cover::start(room, group, true);
    let light = &grid.light;
    while let Some(tile) = pairs.next_tile::<L, W>(light.columns, nodes, group) {
        if tile >= nodes.len() {
            return tinted;
        }
        let keys = &nodes[tile];
        while let Some((place, kept)) = pairs.next::<L, W>(keys, group) {
            if place >= occluders.len() {
                return tinted;
            }
            let occluder = &occluders[place];
            let covered = cover::cover::<L, W, S>(grid, samples, &mut meeting, occluder, 0, kept, room);
            put_before::<L, W, S>(grid, samples, surface, layout, occluder, covered, group, room, depths, first);
            tinted |= covered;
        }
    }
    group.counts.fallbacks += core::mem::take(&mut room.counts.fallbacks);
    tinted
}

/// Adds the depths of a triangle's texels where it covers light samples, as `room` has it. `covered`: lanes of which it covers anything.
#[inline(always)]
fn put_before<L: Lanes, W: MaskWord, S: Samples>(
    grid: &LightGrid,
    samples: &S,
    surface: &[u32],
    layout: &SurfaceLayout,
    occluder: &Occluder,
    mut covered: u32,
    group: &mut Group<W>,
    room: &mut Group<W>,
    depths: &mut [Depth],
    first: usize,
) {
    let (light, triangle) = (&grid.light, layout.triangle(surface, occluder.index()));
    while covered != 0 {
        let lane = covered.trailing_zeros() as usize % TILE;
        covered &= covered - 1;
        let mut view = TexelView::<L::Long>::new::<S>(grid, &group.receivers, occluder, lane, layout.texture, triangle);
        let mut row = 0;
        while row < light.rows as usize && row < MASK_ROWS {
            // What is blocked already matters to nobody.
            let mut left = room.masks[lane][row].without(group.masks[lane][row]);
            room.masks[lane][row] = W::EMPTY;
            while left != W::EMPTY {
                let column = left.lowest();
                left = left.without(W::span(column, column + 1));
                let texel = view.texel(&samples.place(row, column as usize));
                let sample = row * light.columns as usize + column as usize;
                let at = first + lane * light.sample_count() as usize + sample;
                if at < depths.len() {
                    depths[at] = depths[at].and(layout.depth(surface, texel));
                }
            }
            row += 1;
        }
        group.counts.fallbacks += view.fallbacks();
    }
}
