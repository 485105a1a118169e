//! What the silhouette calls for, of one light: edges found and put under a hierarchy, triangles sorted by kind.

use rayon::prelude::*;
use umbra4_core::{
    edge_plane::LightGrid,
    frame::LightFrame,
    hierarchy::Levels,
    occluder::{Facing, Occluder},
    proj4::{KeyTile, Keys},
    silhouette::SilhouetteEdge,
    stage::{
        resolve::Occlusion,
        resolve_silhouette::{Indexed, SilhouetteScene},
    },
};

use crate::{
    Occluders,
    hierarchy::{Hierarchy, build_levels},
    open_sides::{estimated, open_sides},
    order::ordered,
    triangles::KeyedTriangles,
};

/// Triangles for an edge of the silhouette, from which on it is worth its while: depths are counted besides, and mixed
/// triangles rasterised.
const WORTHWHILE: usize = 4;
/// The same where samples are jittered: rows of triangles cost more then, and edges hardly.
const WORTHWHILE_JITTERED: usize = 1;

/// The triangles of a scene, sorted by what they are to one light, and the silhouette.
pub(crate) struct Silhouette {
    corner: LightFrame,
    mixed: Hierarchy<Occluder>,
    /// As the hierarchy of all triangles; mixed ones stand for nothing.
    facing: Vec<KeyTile>,
    edges: Hierarchy<SilhouetteEdge>,
}

/// Whether edges are so few for the triangles that they are done sooner. Where they are not known yet, they are estimated.
pub(crate) fn is_worthwhile(grid: &LightGrid, scene: &Occluders, keyed: &KeyedTriangles) -> bool {
    let triangles_an_edge = if grid.light.jitter.is_some() { WORTHWHILE_JITTERED } else { WORTHWHILE };
    let triangles = keyed.facings.iter().filter(|facing| **facing != Facing::Nothing).count();
    let edges = match &keyed.open_sides {
        Some(sides) => sides.len(),
        None => estimated(scene.triangles(), &keyed.facings),
    };
    edges * triangles_an_edge <= triangles
}

impl Silhouette {
    /// The silhouette of a scene. `corner`: frame of the light of the first sample; `facing`: leaves of the hierarchy for that
    /// light, and room above.
    pub(crate) fn find(
        grid: &LightGrid,
        scene: &Occluders,
        keyed: &mut KeyedTriangles,
        levels: &Levels,
        corner: LightFrame,
        mut facing: Vec<KeyTile>,
    ) -> Self {
        build_levels(levels, &mut facing);
        let mixed = packed(&grid.frame, &keyed.mixed(grid, scene));
        Self { corner, mixed, facing, edges: packed(&grid.frame, &edges(grid, scene, keyed)) }
    }

    pub(crate) fn scene<'a>(&'a self, all: Occlusion<'a>) -> SilhouetteScene<'a> {
        SilhouetteScene {
            all,
            mixed: self.mixed.indexed(),
            facing: Indexed { levels: all.levels, nodes: &self.facing, things: all.occluders },
            corner: &self.corner,
            edges: self.edges.indexed(),
        }
    }
}

/// Things with their keys, under a hierarchy.
fn packed<T: Copy + Sync>(frame: &LightFrame, things: &[(T, Keys)]) -> Hierarchy<T> {
    let order = ordered(frame, things, |(_, keys)| Some(*keys));
    Hierarchy::new(order.iter().map(|entry| things[entry.index as usize]))
}

/// The edges, with their keys.
fn edges(grid: &LightGrid, scene: &Occluders, keyed: &mut KeyedTriangles) -> Vec<(SilhouetteEdge, Keys)> {
    let sides = keyed.open_sides.take().unwrap_or_else(|| open_sides(scene, &keyed.facings));
    let (vertices, mesh) = (scene.vertices(), keyed.mesh(grid, scene));
    let edge = sides.into_par_iter().map(|side| {
        let (from, to) = (vertices[side.from as usize], vertices[side.to as usize]);
        (SilhouetteEdge::new(from, to, side.right), mesh.edge_keys(side.from, side.to))
    });
    edge.collect()
}
