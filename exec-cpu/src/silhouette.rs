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
        build_level::build_level,
        resolve::Occlusion,
        resolve_silhouette::{Indexed, SilhouetteScene},
    },
};

use crate::{Occluders, order::ordered};

/// Facing triangles for an edge of the silhouette, from which on it is worth its while. (A triangle has three sides, and
/// a depth is counted besides.)
const WORTHWHILE: usize = 2;

/// Things under a hierarchy.
struct Hierarchy<T> {
    levels: Levels,
    nodes: Vec<KeyTile>,
    things: Vec<T>,
}

impl<T> Hierarchy<T> {
    /// Of things in the order in which they are packed, with their keys.
    fn new(packed: impl Iterator<Item = (T, Keys)>) -> Self {
        let (mut things, mut nodes) = (Vec::new(), Vec::new());
        for (thing, keys) in packed {
            if things.len() % NODE == 0 {
                nodes.push(KeyTile::NOTHING);
            }
            if let Some(tile) = nodes.last_mut() {
                tile.set(things.len() % NODE, &keys);
            }
            things.push(thing);
        }
        let levels = Levels::of(things.len() as u32);
        for level in 1..levels.count() {
            let below = levels.range(level - 1);
            for id in 0..levels.range(level).len() {
                let tile = build_level(id, &nodes[below.clone()]);
                nodes.push(tile);
            }
        }
        Self { levels, nodes, things }
    }

    fn indexed(&self) -> Indexed<'_, T> {
        Indexed { levels: &self.levels, nodes: &self.nodes, things: &self.things }
    }
}

/// The triangles of a scene, sorted by what they are to one light, and the silhouette.
pub(crate) struct Silhouette {
    corner: LightFrame,
    mixed: Hierarchy<Occluder>,
    facing: Hierarchy<Occluder>,
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
        let sides = open_sides(found);
        let facing = found.in_order.iter().filter(|occluder| !occluder.is_mixed()).count();
        if worthwhile && sides.len() * WORTHWHILE > facing {
            return None;
        }
        let corner = LightFrame::new(&corner_light(&found.grid.light));
        Some(Self {
            mixed: Hierarchy::new(found.in_turn(true).map(|(index, occluder)| {
                (occluder, found.triangles[index].map_or(NOTHING, |(keys, _)| keys))
            })),
            facing: Hierarchy::new(found.in_turn(false).map(|(index, occluder)| {
                (occluder, found.corner_keys(index, &corner, occluder))
            })),
            edges: found.edges(sides),
            corner,
        })
    }

    pub(crate) fn scene<'a>(&'a self, all: Occlusion<'a>) -> SilhouetteScene<'a> {
        SilhouetteScene {
            all,
            mixed: self.mixed.indexed(),
            facing: self.facing.indexed(),
            corner: &self.corner,
            edges: self.edges.indexed(),
        }
    }
}

impl Found<'_> {
    /// The triangles whose plane meets the light, or the others, along the curve.
    fn in_turn(&self, mixed: bool) -> impl Iterator<Item = (usize, Occluder)> {
        let all = self.order.iter().zip(self.in_order);
        all.filter(move |(_, occluder)| occluder.is_mixed() == mixed).map(|(index, occluder)| (*index as usize, *occluder))
    }

    /// Keys of a triangle for the light's first sample.
    fn corner_keys(&self, index: usize, corner: &LightFrame, occluder: Occluder) -> Keys {
        let [a, b, c] = self.scene.triangles()[index].map(|vertex| self.vertex_keys[vertex as usize]);
        let between = a.and(&b).and(&c);
        if between.touches() {
            return triangle_keys(corner, &occluder.corners()).unwrap_or(NOTHING);
        }
        between.for_corner()
    }

    /// The edges under a hierarchy.
    fn edges(&self, sides: Vec<Side>) -> Hierarchy<SilhouetteEdge> {
        let (vertices, frame) = (self.scene.vertices(), &self.grid.frame);
        let edges: Vec<(SilhouetteEdge, Keys)> = sides
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
fn open_sides(found: &Found<'_>) -> Vec<Side> {
    let (vertices, triangles) = (found.scene.vertices(), found.scene.triangles());
    let turned = triangles.par_iter().zip(found.triangles).map(|(triangle, found)| {
        found.as_ref().map_or(0, |(_, occluder)| direction(occluder, vertices[triangle[1] as usize]) as i8)
    });
    let turned: Vec<i8> = turned.collect();
    // By index first, which leaves few to be looked up by place.
    let open = summed(vertices.len(), triangles, &turned);
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
