//! Stage `resolve_cutout`: what alpha-tested casters add to the masks of a group, and casters whose planes are offset.
//!
//! What a triangle covers is found as for any other; of that, the samples stay that are seen through an opaque texel
//! (`texel`). Samples that are blocked already are not looked up.

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
        resolve::{Group, Meeting, Occlusion, drop_full},
    },
    surface_words::SurfaceLayout,
    texel::TexelView,
};

/// An alpha-tested caster.
#[derive(Clone, Copy, Debug)]
pub struct CutoutScene<'a> {
    /// Its triangles, numbered.
    pub occlusion: Occlusion<'a>,
    /// Its texture: a bit a texel, 1 where it is opaque.
    pub surface: &'a [u32],
    /// How it is packed.
    pub layout: SurfaceLayout,
    /// By how many lattice units the planes are moved towards the light.
    pub offset: u32,
}

/// Adds what a caster blocks to the masks of a group. `room`: a group without receivers, for the same light; so it is left.
#[inline(always)]
pub fn resolve_cutout<L: Lanes, W: MaskWord, S: Samples>(
    scene: &CutoutScene<'_>,
    samples: &S,
    group: &mut Group<W>,
    room: &mut Group<W>,
) {
    let CutoutScene { occlusion: Occlusion { grid, levels, nodes, occluders }, surface, layout, offset } = scene;
    let root = Root::top(levels);
    resolve_among::<L, W, S>(grid, samples, levels, root, nodes, occluders, surface, layout, *offset, group, room);
}

/// As [`resolve_cutout`], with the triangles below `root`. (On a GPU no structure holds slices.)
#[inline(always)]
pub fn resolve_among<L: Lanes, W: MaskWord, S: Samples>(
    grid: &LightGrid,
    samples: &S,
    levels: &Levels,
    root: Root,
    nodes: &[KeyTile],
    occluders: &[Occluder],
    surface: &[u32],
    layout: &SurfaceLayout,
    offset: u32,
    group: &mut Group<W>,
    room: &mut Group<W>,
) {
    if group.active == 0 {
        return;
    }
    let mut pairs = KeptPairs::new::<L, W>(levels, root, nodes, group);
    let mut meeting = Meeting::<L::Long>::new::<L, W, Exact>(grid, group);
    cover::start(room, group, false);
    while let Some(tile) = pairs.next_tile::<L, W>(grid.light.columns, nodes, group) {
        if tile >= nodes.len() {
            return;
        }
        let keys = &nodes[tile];
        while let Some((place, kept)) = pairs.next::<L, W>(keys, group) {
            if place >= occluders.len() {
                return;
            }
            let occluder = &occluders[place];
            let covered = cover::cover::<L, W, S>(grid, samples, &mut meeting, occluder, offset, kept, room);
            cut_out::<L, W, S>(grid, samples, surface, layout, occluder, covered, group, room);
            // A pair costs more here than to look whether masks are full.
            drop_full(grid.light.columns, group);
        }
    }
    group.counts.fallbacks += core::mem::take(&mut room.counts.fallbacks);
    group.sum_relevant();
}

/// Adds to the masks of a group what a triangle covers, as `room` has it, where its texels are opaque. `covered`: lanes of which it
/// covers anything.
#[inline(always)]
fn cut_out<L: Lanes, W: MaskWord, S: Samples>(
    grid: &LightGrid,
    samples: &S,
    surface: &[u32],
    layout: &SurfaceLayout,
    occluder: &Occluder,
    mut covered: u32,
    group: &mut Group<W>,
    room: &mut Group<W>,
) {
    let triangle = layout.triangle(surface, occluder.index());
    while covered != 0 {
        let lane = covered.trailing_zeros() as usize % TILE;
        covered &= covered - 1;
        let mut view = TexelView::<L::Long>::new::<S>(grid, &group.receivers, occluder, lane, layout.texture, triangle);
        let (mut relevant, mut row) = (false, 0);
        while row < grid.light.rows as usize && row < MASK_ROWS {
            let mut left = room.masks[lane][row].without(group.masks[lane][row]);
            room.masks[lane][row] = W::EMPTY;
            let mut found = W::EMPTY;
            if !layout.texture.is_one() {
                while left != W::EMPTY {
                    let column = left.lowest();
                    let bit = W::span(column, column + 1);
                    left = left.without(bit);
                    if layout.is_opaque(surface, view.texel(&samples.place(row, column as usize))) {
                        found = found.or(bit);
                    }
                }
            } else if layout.is_opaque(surface, 0) {
                found = left;
            }
            relevant |= found != W::EMPTY;
            group.masks[lane][row] = group.masks[lane][row].or(found);
            row += 1;
        }
        group.counts.fallbacks += view.fallbacks();
        group.tell(lane, relevant);
    }
}
