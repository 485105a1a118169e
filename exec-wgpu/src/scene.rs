//! What the executor is given.

use umbra4_core::glam::IVec3;

/// Triangles on the lattice, as an engine or another executor has snapped them.
#[derive(Clone, Copy, Debug)]
pub struct LatticeScene<'a> {
    /// Lattice positions of vertices.
    pub vertices: &'a [IVec3],
    /// Vertex indices of triangles. One that names a vertex that does not exist blocks nothing.
    pub triangles: &'a [[u32; 3]],
}
