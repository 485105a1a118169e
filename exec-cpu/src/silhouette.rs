//! What the silhouette calls for, of one light: edges found and put under a hierarchy, triangles sorted by kind.

use std::collections::HashMap;

use rayon::prelude::*;
use umbra4_core::{
    corner::corner_light,
    edge_plane::{LightGrid, Occluder},
    frame::LightFrame,
    hierarchy::Levels,
    proj4::{KeyTile, Keys, NODE, NOTHING, VertexKeys, triangle_keys},
    silhouette::{SilhouetteEdge, direction},
    stage::{
        resolve::Occlusion,
        resolve_silhouette::{Indexed, SilhouetteScene},
    },
};

use crate::{
    Occluders,
    hierarchy::{Hierarchy, build_levels},
    order::ordered,
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

/// What earlier stages have found of a scene.
pub(crate) struct Found<'a> {
    pub(crate) grid: &'a LightGrid,
    pub(crate) scene: &'a Occluders,
    pub(crate) vertex_keys: &'a [VertexKeys],
    /// By index.
    pub(crate) triangles: &'a [Option<(Keys, Occluder)>],
    /// Indices of those that count, along the curve.
    pub(crate) order: &'a [u32],
    /// The same triangles.
    pub(crate) in_order: &'a [Occluder],
}

impl Silhouette {
    /// The silhouette of a scene. With `worthwhile`, none where it has so many edges that triangles are done sooner.
    pub(crate) fn find(found: &Found<'_>, worthwhile: bool) -> Option<Self> {
        let turned = found.turned();
        let triangles_an_edge = if found.grid.light.jitter.is_some() { WORTHWHILE_JITTERED } else { WORTHWHILE };
        if worthwhile && found.estimated_edges(&turned) * triangles_an_edge > found.in_order.len() {
            return None;
        }
        let corner = LightFrame::new(&corner_light(&found.grid.light));
        let mixed = found.order.iter().zip(found.in_order).filter(|(_, occluder)| occluder.is_mixed());
        let keyed = mixed
            .map(|(index, occluder)| (*occluder, found.triangles[*index as usize].map_or(NOTHING, |(keys, _)| keys)));
        let mixed = Hierarchy::new(keyed);
        let (facing, edges) = rayon::join(|| found.corner_nodes(&corner), || found.edges(&turned));
        Some(Self { corner, mixed, facing, edges })
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

impl Found<'_> {
    /// How the sides of every triangle count: see [`direction`]. 0 for those that block nothing.
    fn turned(&self) -> Vec<i8> {
        let (vertices, triangles) = (self.scene.vertices(), self.scene.triangles());
        let turned = triangles.par_iter().zip(self.triangles).map(|(triangle, found)| {
            found.as_ref().map_or(0, |(_, occluder)| direction(occluder, vertices[triangle[1] as usize]) as i8)
        });
        turned.collect()
    }

    /// About how many edges the silhouette has, before vertices are merged: counted for one vertex of sixteen.
    fn estimated_edges(&self, turned: &[i8]) -> usize {
        let mut sides = Vec::new();
        for (&[a, b, c], &right) in self.scene.triangles().iter().zip(turned).filter(|(_, right)| **right != 0) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if from.min(to).wrapping_mul(0x9e37_79b9) >> 28 == 0 {
                    sides.push((from.min(to), from.max(to), if from < to { right } else { -right }));
                }
            }
        }
        sides.sort_unstable();
        let open = sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
        16 * open.filter(|same| same.iter().map(|side| i32::from(side.2)).sum::<i32>() != 0).count()
    }

    /// The hierarchy for the light's first sample, over all triangles along the curve.
    fn corner_nodes(&self, corner: &LightFrame) -> Vec<KeyTile> {
        let levels = Levels::of(self.scene.triangles().len() as u32);
        let mut nodes = vec![KeyTile::NOTHING; levels.tiles()];
        let leaves = &mut nodes[levels.range(0)];
        leaves.par_iter_mut().zip(self.order.par_chunks(NODE)).zip(self.in_order.par_chunks(NODE)).for_each(
            |((tile, order), occluders)| {
                for (entry, (index, occluder)) in order.iter().zip(occluders).enumerate() {
                    if !occluder.is_mixed() {
                        tile.set(entry, &self.corner_keys(*index as usize, corner, occluder));
                    }
                }
            },
        );
        build_levels(&levels, &mut nodes);
        nodes
    }

    /// Keys of a triangle for the light's first sample.
    fn corner_keys(&self, index: usize, corner: &LightFrame, occluder: &Occluder) -> Keys {
        let [a, b, c] = self.scene.triangles()[index].map(|vertex| &self.vertex_keys[vertex as usize]);
        let between = a.and(b).and(c);
        if between.touches() {
            return triangle_keys(corner, &occluder.corners()).unwrap_or(NOTHING);
        }
        between.for_corner()
    }

    /// The edges under a hierarchy.
    fn edges(&self, turned: &[i8]) -> Hierarchy<SilhouetteEdge> {
        let (vertices, frame) = (self.scene.vertices(), &self.grid.frame);
        let edges: Vec<(SilhouetteEdge, Keys)> = open_sides(self.scene, turned)
            .into_iter()
            .map(|(from, to, right)| {
                let between = self.vertex_keys[from as usize].and(&self.vertex_keys[to as usize]);
                let (from, to) = (vertices[from as usize], vertices[to as usize]);
                let keys = if between.touches() {
                    triangle_keys(frame, &[from, to, to]).unwrap_or(NOTHING)
                } else {
                    between.for_light()
                };
                (SilhouetteEdge::new(from, to, right), keys)
            })
            .collect();
        let order = ordered(frame, &edges, |(_, keys)| Some(*keys));
        Hierarchy::new(order.iter().map(|entry| edges[entry.index as usize]))
    }
}

/// The edges at which the facing triangles end. Vertices are the same where they lie in the same place: meshes repeat them
/// along seams of texture coordinates and normals.
fn open_sides(scene: &Occluders, turned: &[i8]) -> Vec<Side> {
    let (vertices, triangles) = (scene.vertices(), scene.triangles());
    // By index first, which leaves few to be looked up by place.
    let open = summed(vertices.len(), triangles, turned);
    let mut first = HashMap::new();
    let mut merged = |vertex: u32| *first.entry(vertices[vertex as usize]).or_insert(vertex);
    let (edges, sums): (Vec<[u32; 2]>, Vec<i32>) =
        open.into_iter().map(|(a, b, right)| ([merged(a), merged(b)], right)).unzip();
    summed(vertices.len(), &edges, &sums)
}

/// From vertex, to vertex, how many more triangles lie on the right than on the left.
type Side = (u32, u32, i32);

/// Sums all sides of the same edges, in either direction, and leaves those where something is left. Sides are those of polygons
/// with N vertices (of two: one side), and count as often as `right` says.
fn summed<const N: usize, R: Copy + Into<i32>>(vertices: usize, polygons: &[[u32; N]], right: &[R]) -> Vec<Side> {
    let sides = if N > 2 { N } else { 1 };
    // In buckets by their lower vertex: few meet in one.
    let mut starts = vec![0_u32; vertices + 1];
    for (polygon, _) in polygons.iter().zip(right).filter(|(_, right)| (**right).into() != 0) {
        for k in 0..sides {
            starts[polygon[k].min(polygon[(k + 1) % N]) as usize + 1] += 1;
        }
    }
    for vertex in 0..vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut halves = vec![(0_u32, 0_i32); starts[vertices] as usize];
    for (polygon, &right) in polygons.iter().zip(right).filter(|(_, right)| (**right).into() != 0) {
        let right: i32 = right.into();
        for k in 0..sides {
            let (a, b) = (polygon[k], polygon[(k + 1) % N]);
            let place = &mut next[a.min(b) as usize];
            halves[*place as usize] = (a.max(b), if a < b { right } else { -right });
            *place += 1;
        }
    }
    let mut left = Vec::new();
    for (vertex, range) in starts.windows(2).enumerate() {
        let bucket = &mut halves[range[0] as usize..range[1] as usize];
        for k in 0..bucket.len() {
            let (other, mut right) = bucket[k];
            for (_, more) in bucket[k + 1..].iter_mut().filter(|(to, _)| *to == other) {
                right += std::mem::take(more);
            }
            if right != 0 && other as usize != vertex {
                left.push((vertex as u32, other, right));
            }
        }
    }
    left
}
