//! Which triangles of a mesh share which sides: found once, and good for as long as only vertices move.

use rayon::prelude::*;
use rustc_hash::{FxBuildHasher, FxHashMap};
use umbra4_core::{glam::IVec3, occluder::Facing};

use crate::open_sides::{MOST_TRIANGLES, Side};

/// The sides of a mesh, and the triangles that have them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Neighbours {
    /// The vertex that stands for all that lay in the same place whenever it was looked.
    stands_for: Vec<u32>,
    /// The lower vertex and the higher.
    sides: Vec<[u32; 2]>,
    /// Where the users of each side start; and their end.
    starts: Vec<u32>,
    /// Twice the triangle's index, and one more where the side runs from its higher vertex to the lower.
    users: Vec<u32>,
}

/// Sides that are worth a job.
const PART: usize = 1 << 15;

impl Neighbours {
    /// Of a mesh. Vertices are the same where they lie in the same place. Meshes of more than [`MOST_TRIANGLES`] have none.
    pub(crate) fn of(vertices: &[IVec3], triangles: &[[u32; 3]]) -> Self {
        Self::refined(vertices, triangles, &vec![0; vertices.len()])
    }

    /// The same mesh with its vertices in other places. Those that lay in the same place and do no more part for good.
    pub(crate) fn follow(&mut self, vertices: &[IVec3], triangles: &[[u32; 3]]) {
        let ends = vertices.par_iter().zip(&self.stands_for);
        if !ends.with_min_len(PART).all(|(vertex, other)| *vertex == vertices[*other as usize]) {
            *self = Self::refined(vertices, triangles, &self.stands_for);
        }
    }

    /// Vertices are the same where they were before, and still lie in the same place.
    fn refined(vertices: &[IVec3], triangles: &[[u32; 3]], before: &[u32]) -> Self {
        if triangles.len() > MOST_TRIANGLES {
            return Self::default();
        }
        let mut first = FxHashMap::with_capacity_and_hasher(vertices.len(), FxBuildHasher);
        let classes = vertices.iter().zip(before).zip(0..);
        let stands_for: Vec<u32> =
            classes.map(|((vertex, class), index)| *first.entry((*class, *vertex)).or_insert(index)).collect();

        let same = |vertex: u32| stands_for[vertex as usize];
        let mut uses: Vec<([u32; 2], u32)> = triangles
            .par_iter()
            .zip(0..triangles.len() as u32)
            .with_min_len(PART)
            .flat_map_iter(|(&[a, b, c], triangle)| {
                let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (same(from), same(to)));
                let sides = sides.into_iter().filter(|(from, to)| from != to);
                sides.map(move |(from, to)| ([from.min(to), from.max(to)], 2 * triangle + u32::from(from > to)))
            })
            .collect();
        uses.par_sort_unstable();
        let (mut sides, mut starts) = (Vec::new(), Vec::new());
        for (place, (side, _)) in uses.iter().enumerate() {
            if sides.last() != Some(side) {
                sides.push(*side);
                starts.push(place as u32);
            }
        }
        starts.push(uses.len() as u32);
        Self { stands_for, sides, starts, users: uses.into_iter().map(|(_, user)| user).collect() }
    }

    /// The sides at which the facing triangles end, as [`crate::open_sides::open_sides`] finds them. `facings`: of all triangles.
    pub(crate) fn open(&self, facings: &[Facing]) -> Vec<Side> {
        let sides = (0..self.sides.len()).into_par_iter().with_min_len(PART);
        let open = sides.map(|index| {
            let [from, to] = self.sides[index];
            let users = &self.users[self.starts[index] as usize..self.starts[index + 1] as usize];
            let right = users.iter().map(|user| {
                let direction = facings[(user >> 1) as usize].direction();
                if user & 1 == 0 { direction } else { -direction }
            });
            Side { from, to, right: right.sum() }
        });
        open.filter(|side| side.right != 0).collect()
    }
}
