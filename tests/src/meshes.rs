//! Closed meshes in lattice integers. Triangles are wound so that their normals point outwards.

use std::collections::HashMap;

use umbra4_core::glam::{DVec3, IVec3};

/// An indexed mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mesh {
    /// Lattice coordinates.
    pub vertices: Vec<IVec3>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Appends another mesh.
    pub fn add(&mut self, other: &Self) {
        let base = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + base)));
    }

    /// Appends one triangle with corners of its own.
    pub fn add_triangle(&mut self, corners: [IVec3; 3]) {
        let base = self.vertices.len() as u32;
        self.vertices.extend(corners);
        self.triangles.push([base, base + 1, base + 2]);
    }

    /// Appends the two triangles of a quad, given in order around it.
    pub fn add_quad(&mut self, corners: [IVec3; 4]) {
        let base = self.vertices.len() as u32;
        self.vertices.extend(corners);
        self.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }

    /// True where every edge has two triangles, which run through it in opposite directions.
    pub fn is_closed(&self) -> bool {
        let mut edges = HashMap::<(u32, u32), i32>::new();
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from, to)).or_default() += 1;
            }
        }
        !edges.is_empty() && edges.iter().all(|(&(a, b), &count)| count == 1 && edges.get(&(b, a)) == Some(&1))
    }
}

/// The box between two corners, `min < max` on every axis.
pub fn cuboid(min: IVec3, max: IVec3) -> Mesh {
    let corner = |k: u32| {
        let pick = |bit: u32, axis: usize| if k >> bit & 1 == 1 { max[axis] } else { min[axis] };
        IVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    // Faces −x, +x, −y, +y, −z, +z, counter-clockwise from outside.
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { vertices: (0..8).map(corner).collect(), triangles }
}

/// An icosahedron, subdivided `depth` times, its vertices moved to the distance that `radius` tells for them (by index)
/// and rounded to the lattice.
pub fn icosphere(center: IVec3, depth: u32, mut radius: impl FnMut(usize) -> f64) -> Mesh {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)]
        .iter()
        .map(|&(x, y)| DVec3::new(x, y, 0.0))
        .chain([(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)].iter().map(|&(y, z)| DVec3::new(0.0, y, z)))
        .chain([(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)].iter().map(|&(z, x)| DVec3::new(x, 0.0, z)))
        .collect();
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..depth {
        let mut middles = HashMap::<(u32, u32), u32>::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push(points[a as usize].normalize() + points[b as usize].normalize());
                points.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let vertices =
        points.iter().enumerate().map(|(k, p)| center + (p.normalize() * radius(k)).round().as_ivec3()).collect();
    Mesh { vertices, triangles }
}
