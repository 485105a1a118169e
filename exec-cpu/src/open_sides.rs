//! The sides of triangles that no neighbour cancels: the boundary of the chain of `umbra4_core::silhouette`.

use rayon::prelude::*;
use rustc_hash::FxHashMap;
use umbra4_core::occluder::Facing;

use crate::Occluders;

/// From vertex, to vertex (the lower first), how many more triangles lie on the right than on the left.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) right: i32,
}

impl Side {
    /// The side `a → b` of a polygon that counts `right` times.
    fn new(a: u32, b: u32, right: i32) -> Self {
        if a < b { Self { from: a, to: b, right } } else { Self { from: b, to: a, right: -right } }
    }

    fn is_along(&self, other: &Self) -> bool {
        (self.from, self.to) == (other.from, other.to)
    }
}

/// Most triangles that are looked through: three sides each can be counted in 32 bits, as edges are.
pub(crate) const MOST_TRIANGLES: usize = 1 << 30;

/// Triangles a job, whatever the number of threads: the sides come out in the same order.
const PART: usize = 1 << 15;

/// The sides of a triangle; none where it is no part of the chain.
fn sides([a, b, c]: [u32; 3], facing: Facing) -> impl Iterator<Item = Side> {
    let right = facing.direction();
    let count = if right == 0 { 0 } else { 3 };
    [(a, b), (b, c), (c, a)].into_iter().take(count).map(move |(from, to)| Side::new(from, to, right))
}

/// About how many sides are open, before vertices are merged: counted for one vertex of sixteen.
pub(crate) fn estimated(triangles: &[[u32; 3]], facings: &[Facing]) -> usize {
    let seen = |side: &Side| side.from.wrapping_mul(0x9e37_79b9) >> 28 == 0;
    let mut found: Vec<Side> = triangles
        .par_chunks(PART)
        .zip(facings.par_chunks(PART))
        .flat_map_iter(|(triangles, facings)| {
            triangles.iter().zip(facings).flat_map(|(triangle, facing)| sides(*triangle, *facing)).filter(seen)
        })
        .collect();
    found.par_sort_unstable();
    let open = found.chunk_by(Side::is_along);
    16 * open.filter(|same| same.iter().map(|side| side.right).sum::<i32>() != 0).count()
}

/// The sides at which the facing triangles end. Vertices are the same where they lie in the same place: meshes repeat them
/// along seams of texture coordinates and normals.
pub(crate) fn open_sides(scene: &Occluders, facings: &[Facing]) -> Vec<Side> {
    let (vertices, triangles) = (scene.vertices(), scene.triangles());
    let left: Vec<Side> = triangles
        .par_chunks(PART)
        .zip(facings.par_chunks(PART))
        .flat_map_iter(|(triangles, facings)| {
            let mut recent = Recent::new();
            for (triangle, facing) in triangles.iter().zip(facings) {
                sides(*triangle, *facing).for_each(|side| recent.add(side));
            }
            recent.finish()
        })
        .collect();
    // By index first, which leaves few to be looked up by place.
    let left = summed(vertices.len(), &left);
    let mut first = FxHashMap::default();
    let mut merged = |vertex: u32| *first.entry(vertices[vertex as usize]).or_insert(vertex);
    let left: Vec<Side> = left.iter().map(|side| Side::new(merged(side.from), merged(side.to), side.right)).collect();
    summed(vertices.len(), &left)
}

/// The sides met last. Neighbours in space mostly are neighbours in a mesh: their sides cancel here, and are never stored.
struct Recent {
    slots: Vec<Side>,
    left: Vec<Side>,
}

/// Binary digits of the number of slots: they fit a core's own cache.
const SLOTS: u32 = 16;

impl Recent {
    fn new() -> Self {
        Self { slots: vec![Side::default(); 1 << SLOTS], left: Vec::new() }
    }

    fn add(&mut self, side: Side) {
        let hash = (side.from.wrapping_mul(0x9e37_79b9) ^ side.to.wrapping_mul(0x85eb_ca6b)) >> (32 - SLOTS);
        let slot = &mut self.slots[hash as usize];
        if slot.is_along(&side) {
            slot.right += side.right;
        } else {
            let evicted = std::mem::replace(slot, side);
            if evicted.right != 0 {
                self.left.push(evicted);
            }
        }
    }

    /// All that did not cancel; sides may come more than once.
    fn finish(mut self) -> Vec<Side> {
        self.left.extend(self.slots.into_iter().filter(|side| side.right != 0));
        self.left
    }
}

/// Sums the sides that are the same, and leaves those where something is left.
fn summed(vertices: usize, sides: &[Side]) -> Vec<Side> {
    // In buckets by their lower vertex: few meet in one.
    let mut starts = vec![0_usize; vertices + 1];
    for side in sides {
        starts[side.from as usize + 1] += 1;
    }
    for vertex in 0..vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut sorted = vec![Side::default(); sides.len()];
    for side in sides {
        let place = &mut starts[side.from as usize];
        sorted[*place] = *side;
        *place += 1;
    }
    let mut left = Vec::new();
    for bucket in sorted.chunk_by_mut(|a, b| a.from == b.from) {
        bucket.sort_unstable_by_key(|side| side.to);
        for same in bucket.chunk_by(Side::is_along) {
            let side = Side { right: same.iter().map(|side| side.right).sum(), ..same[0] };
            if side.right != 0 && side.from != side.to {
                left.push(side);
            }
        }
    }
    left
}
