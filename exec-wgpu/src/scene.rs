//! What the executor is given.

use umbra4_core::{Facing, Layers, glam::IVec3};

/// Triangles on the lattice, as an engine or another executor has snapped them.
#[derive(Clone, Copy, Debug)]
pub struct LatticeScene<'a> {
    /// Lattice positions of vertices.
    pub vertices: &'a [IVec3],
    /// Vertex indices of triangles. One that names a vertex that does not exist blocks nothing.
    pub triangles: &'a [[u32; 3]],
}

/// The points whose masks are asked for, on the lattice, and, where that is known, which way their surfaces face.
#[derive(Clone, Copy, Debug)]
pub struct LatticeReceivers<'a> {
    /// Lattice positions.
    pub points: &'a [IVec3],
    /// Of all of them, or none: one that faces away from a light has a full mask, without a triangle being looked at.
    pub facings: &'a [Facing],
    /// Of all of them, or none: casters that have no layer in common with one do not matter to it. A scene that is no caster is on no
    /// layer, and shadows every receiver.
    pub layers: &'a [Layers],
}

impl<'a> From<&'a [IVec3]> for LatticeReceivers<'a> {
    fn from(points: &'a [IVec3]) -> Self {
        Self { points, facings: &[], layers: &[] }
    }
}

impl<'a> From<&'a Vec<IVec3>> for LatticeReceivers<'a> {
    fn from(points: &'a Vec<IVec3>) -> Self {
        Self { points, facings: &[], layers: &[] }
    }
}

impl<'a, const N: usize> From<&'a [IVec3; N]> for LatticeReceivers<'a> {
    fn from(points: &'a [IVec3; N]) -> Self {
        Self { points, facings: &[], layers: &[] }
    }
}
