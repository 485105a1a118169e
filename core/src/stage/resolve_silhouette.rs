//! Stage `resolve`, by the silhouette: the masks of a group of sixteen receivers from the depth at one sample and the edges
//! at which depths change. Theory and proof: [`crate::silhouette`].
//!
//! Triangles whose plane meets the light are no part of the chain, and are rasterised one by one. So are all triangles for
//! receivers that [`crate::edge_trace`] loses.

// On a GPU no structure holds references: what goes together is handed on one by one.
#![allow(clippy::too_many_arguments)]

use crate::{
    corner::blocked,
    depth::{Depths, MOST_DEPTH},
    edge_plane::LightGrid,
    edge_trace::{EdgeTrace, Seen, forget},
    frame::LightFrame,
    hierarchy::{Levels, Root, Walk},
    jitter::Samples,
    lanes::{Lanes, TILE},
    mask_word::MaskWord,
    occluder::Occluder,
    precision::PrecisionMode,
    proj4::{KeyTile, Keys, NODE, NeedTile},
    silhouette::SilhouetteEdge,
    stage::resolve::{Group, Occlusion, descend},
    statistics::Tally,
    view::View,
};

/// Things under a hierarchy.
#[derive(Clone, Copy, Debug)]
pub struct Indexed<'a, T> {
    /// Layout of `nodes`.
    pub levels: &'a Levels,
    /// Keys of all levels; level 0 goes with `things`.
    pub nodes: &'a [KeyTile],
    /// In the order of level 0.
    pub things: &'a [T],
}

/// The triangles of a scene, sorted by what they are to one light.
#[derive(Clone, Copy, Debug)]
pub struct SilhouetteScene<'a> {
    /// All triangles.
    pub all: Occlusion<'a>,
    /// Those whose plane meets the light.
    pub mixed: Indexed<'a, Occluder>,
    /// The others, by their keys for [`crate::corner::corner_light`].
    pub facing: Indexed<'a, Occluder>,
    /// Frame of that light.
    pub corner: &'a LightFrame,
    /// Where the facing ones end.
    pub edges: Indexed<'a, SilhouetteEdge>,
}

/// Room for the work on one group. All depths are zero between two groups.
#[derive(Clone, Debug)]
pub struct SilhouetteRoom<W> {
    depths: [Depths<W>; TILE],
    trace: EdgeTrace,
}

impl<W: MaskWord> Default for SilhouetteRoom<W> {
    fn default() -> Self {
        Self { depths: [Depths::FLAT; TILE], trace: EdgeTrace::NONE }
    }
}

/// Fills the masks of a group. As [`crate::stage::resolve::resolve`], with the same bits; but only triangles that were
/// rasterised count as relevant.
#[inline(always)]
pub fn resolve_silhouette<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
    scene: &SilhouetteScene<'_>,
    samples: &S,
    group: &mut Group<W>,
    room: &mut SilhouetteRoom<W>,
) {
    let grid = scene.all.grid;
    let Indexed { mut levels, mut nodes, mut things } = scene.mixed;
    let mut last = false;
    // One code for both walks over triangles: kernels of half the size.
    loop {
        if group.active != 0 {
            descend::<L, W, P, S>(grid, samples, levels, Root::top(levels), nodes, things, group);
        }
        if last || group.active == 0 {
            break;
        }
        let lost = facing::<L, W, P, S>(scene, samples, group, room);
        if lost == 0 {
            break;
        }
        group.counts.receivers_lost += Tally::from(lost.count_ones());
        group.active = lost;
        Occlusion { levels, nodes, occluders: things, .. } = scene.all;
        last = true;
    }
    group.sum_relevant();
}

/// Adds what facing triangles block. Returns the lanes of which nothing is known.
#[inline(always)]
fn facing<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
    scene: &SilhouetteScene<'_>,
    samples: &S,
    group: &mut Group<W>,
    room: &mut SilhouetteRoom<W>,
) -> u32 {
    let grid = scene.all.grid;
    let needs = NeedTile::of::<L>(scene.corner, &group.receivers);
    let need = needs.least::<L>(group.active);
    let mut triangles = Walk::new::<L>(scene.facing.levels, Root::top(scene.facing.levels), scene.facing.nodes, &need);
    let edge_need = group.needs.least::<L>(group.active);
    let mut edges = Walk::new::<L>(scene.edges.levels, Root::top(scene.edges.levels), scene.edges.nodes, &edge_need);
    if !triangles.is_open() && !edges.is_open() {
        return 0;
    }
    let view = View::new::<L, P>(grid, &group.receivers, group.active);
    let mut lanes = Known { crossed: 0, lost: 0, most: [0; TILE] };
    add_edges::<L, W, P, S>(scene, samples, &view, &mut edges, &edge_need, &mut lanes, group, room);

    // Whoever sees no edge needs to know only whether anything is before the sample.
    let mut counts = [0_u32; TILE];
    let mut wanted = group.active & !lanes.lost;
    while let Some((tile, mut bits)) = triangles.next::<L>(scene.facing.nodes, &need) {
        let Some(keys) = scene.facing.nodes.get(tile as usize) else { break };
        while bits != 0 {
            let entry = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let kept = needs.dominated_by::<L>(&keys.entry(entry)) & wanted;
            let Some(occluder) = scene.facing.things.get(tile as usize * NODE + entry) else { break };
            if kept == 0 {
                continue;
            }
            let fallbacks = &mut group.counts.fallbacks;
            let mut found = blocked::<L, P>(grid, &view, &group.receivers, occluder, kept, fallbacks);
            wanted &= !(found & !lanes.crossed);
            while found != 0 {
                let lane = found.trailing_zeros() as usize % TILE;
                found &= found - 1;
                counts[lane] += 1;
            }
        }
        if wanted == 0 {
            break;
        }
    }

    let mut lane = 0;
    while lane < TILE {
        if lanes.crossed >> lane & 1 == 1 && counts[lane] + lanes.most[lane] > MOST_DEPTH {
            lanes.lost |= 1 << lane;
        }
        if (group.active & !lanes.lost) >> lane & 1 == 1 {
            if lanes.crossed >> lane & 1 == 1 {
                let light = &grid.light;
                room.depths[lane].flush::<S>(counts[lane], light.rows, light.columns, &mut group.masks[lane]);
            } else if counts[lane] > 0 {
                group.set_behind(lane, &grid.light);
            }
        }
        lane += 1;
    }
    forget(&mut room.depths, lanes.lost & lanes.crossed, grid.light.rows);
    lanes.lost
}

/// What is known of the lanes of a group.
struct Known {
    /// Some edge adds to its depths.
    crossed: u32,
    lost: u32,
    /// How far depths can differ from that at the first sample.
    most: [u32; TILE],
}

/// Adds all edges of the silhouette to the depths.
#[inline(always)]
fn add_edges<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
    scene: &SilhouetteScene<'_>,
    samples: &S,
    view: &View<L::Long>,
    edges: &mut Walk,
    need: &Keys,
    lanes: &mut Known,
    group: &mut Group<W>,
    room: &mut SilhouetteRoom<W>,
) {
    let grid: &LightGrid = scene.all.grid;
    while let Some((tile, mut bits)) = edges.next::<L>(scene.edges.nodes, need) {
        let Some(keys) = scene.edges.nodes.get(tile as usize) else { return };
        while bits != 0 {
            let entry = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let wanted = group.active & !lanes.lost;
            group.counts.edges_tested += Tally::from(wanted.count_ones());
            let kept = group.needs.dominated_by::<L>(&keys.entry(entry)) & wanted;
            let Some(edge) = scene.edges.things.get(tile as usize * NODE + entry) else { return };
            if kept == 0 {
                continue;
            }
            group.counts.edges_kept += Tally::from(kept.count_ones());
            let traced = room.trace.trace::<L, P, S>(view, samples, edge, kept);
            lanes.lost |= traced.lost;
            let mut crossed = traced.crossed & !lanes.lost;
            lanes.crossed |= crossed;
            group.shadowed |= crossed;
            while crossed != 0 {
                let lane = crossed.trailing_zeros() as usize % TILE;
                crossed &= crossed - 1;
                lanes.most[lane] += edge.right().unsigned_abs();
                let mut seen = Seen {
                    depths: &mut room.depths[lane],
                    mask: &mut group.masks[lane],
                    fallbacks: &mut group.counts.fallbacks,
                };
                if !room.trace.add::<L, W, P, S>(grid, samples, &group.receivers, edge, lane, &mut seen) {
                    lanes.lost |= 1 << lane;
                }
            }
        }
        if group.active & !lanes.lost == 0 {
            return;
        }
    }
}
