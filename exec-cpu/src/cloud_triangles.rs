//! Triangles under a hierarchy of boxes, as a cloud sees them.

use bytemuck::allocation::zeroed_vec;
use rayon::prelude::*;
use umbra4_core::{
    cloud_tiles::CloudTiles,
    glam::IVec3,
    hierarchy::Levels,
    occluder::Occluder,
    proj4::NODE,
    shaft::{BoxTile, box_of, build_box_level, meet},
};

use crate::{
    Occluders,
    morton::{along, curve_through},
};

/// Leaves, or nodes, that are worth a job.
const NODES_A_JOB: usize = 64;

/// The order of triangles along a curve through the scene, by their middles.
pub(crate) fn order(scene: &Occluders) -> Vec<u32> {
    let curve = curve_through(scene.vertices(), 3);
    along(scene.triangles().len(), |id| scene.corners(id).map_or(0, |corners| curve.place(corners)))
}

/// Triangles in order, with the boxes of all levels.
#[derive(Default)]
pub(crate) struct CloudTriangles {
    pub(crate) occluders: Vec<Occluder>,
    pub(crate) nodes: Vec<BoxTile>,
}

impl CloudTriangles {
    /// Packs the triangles in `order`, or, where there is none, as they lie. Those that block nothing within `extent`, a box
    /// around the light and all receivers, leave gaps. The levels above the lowest are still to be built.
    pub(crate) fn pack(
        scene: &Occluders,
        cloud: &CloudTiles<'_>,
        order: Option<&[u32]>,
        levels: &Levels,
        extent: [IVec3; 2],
    ) -> Self {
        let count = scene.triangles().len();
        let mut occluders: Vec<Occluder> = zeroed_vec(count);
        let mut nodes = vec![BoxTile::NOTHING; levels.tiles()];
        let leaves = occluders.par_chunks_mut(NODE).zip(&mut nodes).with_min_len(NODES_A_JOB).enumerate();
        leaves.for_each(|(leaf, (occluders, boxes))| {
            for (lane, place) in occluders.iter_mut().enumerate() {
                let index = leaf * NODE + lane;
                let id = order.map_or(index, |order| order[index] as usize);
                let Some(corners) = scene.corners(id) else { continue };
                let [low, high] = box_of(corners);
                if !meet([low, high], extent) {
                    continue;
                }
                if let Some(occluder) = cloud.occluder(corners) {
                    *place = occluder;
                    boxes.set(lane, low, high);
                }
            }
        });
        Self { occluders, nodes }
    }

    /// One level, from the one below it.
    pub(crate) fn build_level(&mut self, levels: &Levels, level: usize) {
        let (below, above) = self.nodes.split_at_mut(levels.range(level).start);
        let below = &below[levels.range(level - 1)];
        let above = &mut above[..levels.range(level).len()];
        let nodes = above.par_iter_mut().with_min_len(NODES_A_JOB).enumerate();
        nodes.for_each(|(id, tile)| *tile = build_box_level(id, below));
    }
}
