//! What is found once of a mesh that is asked about again: an order that suits every light, and its neighbours.

use rayon::prelude::*;
use umbra4_core::glam::IVec3;

use crate::{
    morton::{along, curve_through},
    neighbours::Neighbours,
};

/// What stays of a mesh while only its vertices move.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Arrangement {
    /// Which of the vertices that were given lies where.
    given: Vec<u32>,
    pub(crate) neighbours: Neighbours,
}

impl Arrangement {
    /// Puts triangles in order along a Morton curve, vertices in the order in which triangles name them, and finds neighbours.
    pub(crate) fn of(vertices: &mut Vec<IVec3>, triangles: &mut Vec<[u32; 3]>) -> Self {
        *triangles = along_curve(vertices, triangles);
        let given = first_named(vertices.len(), triangles);
        let mut places = vec![0; given.len()];
        for (place, vertex) in (0..).zip(&given) {
            places[*vertex as usize] = place;
        }
        triangles.par_iter_mut().for_each(|triangle| *triangle = triangle.map(|vertex| places[vertex as usize]));
        *vertices = gathered(vertices, &given);
        Self { neighbours: Neighbours::of(vertices, triangles), given }
    }

    /// The vertices as given, in the order in which they lie.
    pub(crate) fn follow(&mut self, vertices: &[IVec3], triangles: &[[u32; 3]]) -> Vec<IVec3> {
        let vertices = gathered(vertices, &self.given);
        self.neighbours.follow(&vertices, triangles);
        vertices
    }
}

fn gathered(vertices: &[IVec3], which: &[u32]) -> Vec<IVec3> {
    which.par_iter().map(|vertex| vertices[*vertex as usize]).collect()
}

/// Triangles along a Morton curve through the box around the vertices, by their middles.
fn along_curve(vertices: &[IVec3], triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let curve = curve_through(vertices, 3);
    let place = |index: usize| curve.place(triangles[index].map(|vertex| vertices[vertex as usize]));
    along(triangles.len(), place).par_iter().map(|index| triangles[*index as usize]).collect()
}

/// All vertices, in the order in which triangles name them first; those that none names come last.
fn first_named(vertices: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut named = vec![false; vertices];
    let mut order = Vec::with_capacity(vertices);
    let mut name = |vertex: u32| {
        if !std::mem::replace(&mut named[vertex as usize], true) {
            order.push(vertex);
        }
    };
    triangles.iter().flatten().copied().for_each(&mut name);
    (0..vertices as u32).for_each(name);
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_stays_what_it_is() {
        let corner = |k: i32| IVec3::new(k * 7919 % 101, k * 104_729 % 103, i32::MIN + k * 1_299_709 % 107);
        let given: Vec<IVec3> = (0..60).map(corner).collect();
        // Some vertices are named by no triangle, some triangles are points.
        let mesh: Vec<[u32; 3]> = (0..90_u32).map(|k| [k * 31 % 50, k * 17 % 50, k * 13 % 50]).collect();
        let places = |vertices: &[IVec3], triangles: &[[u32; 3]]| {
            let mut places: Vec<[[i32; 3]; 3]> =
                triangles.iter().map(|t| t.map(|vertex| vertices[vertex as usize].to_array())).collect();
            places.sort_unstable();
            places
        };
        let (mut vertices, mut triangles) = (given.clone(), mesh.clone());
        let mut arrangement = Arrangement::of(&mut vertices, &mut triangles);
        assert_eq!(places(&vertices, &triangles), places(&given, &mesh));
        let moved: Vec<IVec3> = given.iter().map(|p| IVec3::new(p.y + 1, 2 - p.x, p.z)).collect();
        let vertices = arrangement.follow(&moved, &triangles);
        assert_eq!(places(&vertices, &triangles), places(&moved, &mesh));
    }

    #[test]
    fn ranges_of_all_sizes_are_coded() {
        for vertices in [vec![], vec![IVec3::ZERO; 3], vec![IVec3::MIN, IVec3::MAX, IVec3::ZERO]] {
            let triangles: &[[u32; 3]] = if vertices.is_empty() { &[] } else { &[[0, 1, 2], [0, 0, 0]] };
            assert_eq!(along_curve(&vertices, triangles).len(), triangles.len());
        }
    }
}
