//! An engine's mesh as kernels read it: words of its vertex, index and instance buffers, where the engine keeps them.

use glam::Vec3;

use crate::{params::Dispatched, snap::SnapParams};

/// Where the data of a mesh lies, in words of 32 bits, and where its snapped vertices and its triangles go.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MeshParams {
    /// The lattice.
    pub snap: SnapParams,
    /// Ids there are: vertices or triangles, of all instances.
    pub count: u32,
    /// See [`crate::params::PassParams::row`].
    pub row: u32,
    /// Word of the first vertex's position, f32 × 3.
    pub vertex_first: u32,
    /// Words from one vertex to the next.
    pub vertex_stride: u32,
    /// Vertices of an instance.
    pub vertices: u32,
    /// Place of the mesh's first snapped vertex.
    pub vertex_base: u32,
    /// Word of the first instance's matrix, f32 × 16.
    pub instance_first: u32,
    /// Words from one instance to the next.
    pub instance_stride: u32,
    /// First index to be read.
    pub index_first: u32,
    /// Bits of an index: 16 or 32.
    pub index_bits: u32,
    /// Added to every index, as in an indexed draw.
    pub index_offset: i32,
    /// Triangles of an instance.
    pub triangles: u32,
    /// Place of the mesh's first triangle.
    pub triangle_base: u32,
    /// Nothing: fills the last vector of four.
    pub padding: [u32; 2],
}

impl Dispatched for MeshParams {
    #[inline(always)]
    fn count(&self) -> u32 {
        self.count
    }

    #[inline(always)]
    fn row(&self) -> u32 {
        self.row
    }

    fn with_row(self, row: u32) -> Self {
        Self { row, ..self }
    }
}

/// A column-major 4 × 4 matrix, object → world; affine, so its last row is not looked at.
pub type Matrix = [[f32; 4]; 4];

/// A point in world space. A float stage, before the snap: exactness starts with what comes out of it.
#[inline]
pub fn to_world(m: &Matrix, p: Vec3) -> Vec3 {
    let row = |r: usize| m[0][r] * p.x + m[1][r] * p.y + m[2][r] * p.z + m[3][r];
    Vec3::new(row(0), row(1), row(2))
}
