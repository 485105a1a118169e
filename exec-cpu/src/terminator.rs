//! The shadow terminator of coarse meshes, for all receivers of a mesh: see [`umbra4_core::terminator`].

use rayon::prelude::*;
use rustc_hash::FxHashMap;
use thiserror::Error;
use umbra4_core::{
    glam::{DVec3, Vec3},
    irradiance::unit,
    terminator::{interpolated, least_cosine, lifted},
};

/// Why a mesh, or a place on it, is refused.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SmoothError {
    /// There are more normals, or fewer, than vertices.
    #[error("{count} normals for {vertices} vertices")]
    NormalCount {
        /// Normals given.
        count: usize,
        /// Vertices given.
        vertices: usize,
    },
    /// A vertex normal is zero or not finite.
    #[error("normal {index} is {normal}: it points nowhere")]
    Normal {
        /// Index of the vertex.
        index: usize,
        /// The normal given.
        normal: Vec3,
    },
    /// A vertex is not finite.
    #[error("vertex {index} is at {vertex}: not finite")]
    Vertex {
        /// Index of the vertex.
        index: usize,
        /// The vertex given.
        vertex: Vec3,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices}")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex index it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A receiver names a triangle that does not exist.
    #[error("receiver {index} lies on triangle {triangle}, but there are only {triangles}")]
    NoTriangle {
        /// Index of the receiver.
        index: usize,
        /// The triangle it names.
        triangle: u32,
        /// Number of triangles.
        triangles: usize,
    },
    /// A barycentric coordinate is not in `0.0..=1.0`, or their sum is not 1.
    #[error("receiver {index} has barycentric coordinates {barycentric:?}: not all in 0..=1, or not with a sum of 1")]
    Barycentric {
        /// Index of the receiver.
        index: usize,
        /// The coordinates given.
        barycentric: [f32; 3],
    },
    /// A point of the light is not finite.
    #[error("point {index} of the light is {point}: not finite")]
    Light {
        /// Its index.
        index: usize,
        /// The point given.
        point: DVec3,
    },
    /// There are more values of vertices, or fewer, than vertices.
    #[error("{count} least cosines for {vertices} vertices")]
    CosineCount {
        /// Values given.
        count: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
}

/// Where on a mesh a receiver lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnTriangle {
    /// Index of the triangle.
    pub triangle: u32,
    /// Barycentric coordinates, of its corners in order: each in `0.0..=1.0`, their sum 1 to within [`SmoothMesh::SUM`].
    pub barycentric: [f32; 3],
}

/// A mesh that stands for a smooth surface, in world space: triangles are wound so that their normals, `(b − a) × (c − a)`, point to
/// the side that is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothMesh<'a> {
    vertices: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    /// Of length 1.
    normals: Vec<Vec3>,
}

impl<'a> SmoothMesh<'a> {
    /// How far from 1 the sum of barycentric coordinates may be: a hundred times what rounding leaves of 1.
    pub const SUM: f32 = 1e-5;

    /// A mesh with the normals of its vertices, of any length.
    ///
    /// ```
    /// use umbra4_cpu::{OnTriangle, SmoothMesh};
    /// use umbra4_core::glam::Vec3;
    ///
    /// // A flat corner of a ball: its normals lean outwards.
    /// let vertices = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    /// let mesh = SmoothMesh::new(&vertices, &[[0, 1, 2]], &vertices)?;
    /// let middle = OnTriangle { triangle: 0, barycentric: [1.0 / 3.0; 3] };
    /// let lifted = mesh.lifted(&[middle])?[0];
    /// assert!((lifted.length() - 0.962).abs() < 1e-3); // not 0.577
    /// # Ok::<(), umbra4_cpu::SmoothError>(())
    /// ```
    ///
    /// # Errors
    /// Another number of normals than vertices; the first normal that points nowhere; the first vertex that is not finite; the
    /// first index out of range.
    pub fn new(vertices: &'a [Vec3], triangles: &'a [[u32; 3]], normals: &[Vec3]) -> Result<Self, SmoothError> {
        if normals.len() != vertices.len() {
            return Err(SmoothError::NormalCount { count: normals.len(), vertices: vertices.len() });
        }
        if let Some((index, vertex)) = vertices.iter().enumerate().find(|(_, vertex)| !vertex.is_finite()) {
            return Err(SmoothError::Vertex { index, vertex: *vertex });
        }
        let of = |(index, normal): (usize, &Vec3)| unit(*normal).ok_or(SmoothError::Normal { index, normal: *normal });
        let normals = normals.iter().enumerate().map(of).collect::<Result<_, _>>()?;
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|vertex| **vertex as usize >= vertices.len()) {
                return Err(SmoothError::IndexOutOfRange { triangle, vertex, vertices: vertices.len() });
            }
        }
        Ok(Self { vertices, triangles, normals })
    }

    /// Where receivers are moved to, world: what is to be snapped and shadowed instead of them. It is beyond the surface that is
    /// meant, by about as much as the triangle lies below it: a tangent plane rises twice as high over a chord as the arc does. They lie off their triangles then, but
    /// where the surface is hollow or flat, so that they are to be lifted as receivers on surfaces always are
    /// ([`crate::Receivers::on_surfaces`]).
    ///
    /// # Errors
    /// The first receiver on no triangle, or with barycentric coordinates that are not taken ([`SmoothError::Barycentric`]).
    pub fn lifted(&self, receivers: &[OnTriangle]) -> Result<Vec<Vec3>, SmoothError> {
        let corners = self.corners_of(receivers)?;
        let of = |(at, corners): (&OnTriangle, &[u32; 3])| {
            let vertices = corners.map(|vertex| self.vertices[vertex as usize]);
            lifted(vertices, corners.map(|vertex| self.normals[vertex as usize]), at.barycentric)
        };
        Ok(receivers.par_iter().zip(&corners).map(of).collect())
    }

    /// The least cosine of every vertex, over the faces around it and over points of a light (its middle, or its corners). Vertices in
    /// the same place share their faces. Faces without area have no part in it; 1 where there are no others.
    ///
    /// # Errors
    /// The first point that is not finite.
    pub fn least_cosines(&self, light: &[DVec3]) -> Result<Vec<f32>, SmoothError> {
        if let Some((index, point)) = light.iter().enumerate().find(|(_, point)| !point.is_finite()) {
            return Err(SmoothError::Light { index, point: *point });
        }
        let mut first = FxHashMap::default();
        let same: Vec<usize> = self
            .vertices
            .iter()
            .enumerate()
            // Both zeros are one place.
            .map(|(index, v)| *first.entry(v.to_array().map(|x| (x + 0.0).to_bits())).or_insert(index))
            .collect();
        let mut least = vec![1.0; self.vertices.len()];
        for corners in self.triangles {
            let [a, b, c] = corners.map(|vertex| self.vertices[vertex as usize].as_dvec3());
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            for (vertex, place) in corners.iter().zip([a, b, c]) {
                let least = &mut least[same[*vertex as usize]];
                for to_light in light.iter().filter_map(|point| (*point - place).try_normalize()) {
                    *least = least_cosine(*least, to_light.as_vec3(), normal.as_vec3());
                }
            }
        }
        Ok(same.into_iter().map(|vertex| least[vertex]).collect())
    }

    /// The least cosines of vertices at receivers: what [`umbra4_core::terminator::coherent`] takes.
    ///
    /// # Errors
    /// Another number of cosines than vertices; as [`SmoothMesh::lifted`].
    pub fn bends(&self, least_cosines: &[f32], receivers: &[OnTriangle]) -> Result<Vec<f32>, SmoothError> {
        if least_cosines.len() != self.vertices.len() {
            return Err(SmoothError::CosineCount { count: least_cosines.len(), vertices: self.vertices.len() });
        }
        let corners = self.corners_of(receivers)?;
        let of = |(at, corners): (&OnTriangle, &[u32; 3])| {
            interpolated(corners.map(|vertex| least_cosines[vertex as usize]), at.barycentric)
        };
        Ok(receivers.par_iter().zip(&corners).map(of).collect())
    }

    fn corners_of(&self, receivers: &[OnTriangle]) -> Result<Vec<[u32; 3]>, SmoothError> {
        let of = |(index, at): (usize, &OnTriangle)| {
            let OnTriangle { triangle, barycentric } = *at;
            let sum: f32 = barycentric.iter().sum();
            if !barycentric.iter().all(|b| (0.0..=1.0).contains(b)) || (sum - 1.0).abs() > Self::SUM {
                return Err(SmoothError::Barycentric { index, barycentric });
            }
            let absent = SmoothError::NoTriangle { index, triangle, triangles: self.triangles.len() };
            self.triangles.get(triangle as usize).copied().ok_or(absent)
        };
        receivers.iter().enumerate().map(of).collect()
    }
}
