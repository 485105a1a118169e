//! The silhouette: the edges at which the surface ends that faces the light.
//!
//! Where a fine mesh stands between a receiver and the light, most of its edges change nothing: behind an edge that two
//! triangles share, both sides are dark. Triangles that face the light (after [`crate::occluder::Facing::occluder`] all do that have it on
//! one side) are a *chain*: their directed edges are summed, and those that two neighbours run through in opposite
//! directions cancel. What is left is the silhouette, of about √n edges for n triangles of a closed mesh.
//!
//! **Depth.** For receiver p let D(L) be the number of facing triangles that block sample L. *D changes only where the
//! segment from p to L meets an edge of the silhouette, there by the edge's sum.*
//! *Proof.* Let C be the triangles with p strictly on their far side; the others block nothing for p. Take L anywhere in the
//! samples' hull R. Let e be an edge of t, and q a point of e strictly between p and L. Along the segment the signed distance
//! to t's plane is linear, 0 at q and positive at L, as t faces all of R; so it is negative at p, and t is in C. So all
//! triangles around an edge that a segment meets are in C or none is, and C's boundary is met where the silhouette is. A
//! plane of C separates p from R, so the points of C in the cone over R from p all lie between them, and each triangle of C
//! projects from p with the same orientation. So D is the degree of the projection, which is constant but for its
//! boundary, where it changes by the boundary's multiplicity. ∎
//!
//! So the masks of a receiver follow from D at one sample and the edges of the silhouette (`depth`, `corner`); a receiver
//! before which the full-coverage test keeps no such edge is in full light or in full shadow.
//!
//! Seed: the wedges of soft shadow volumes (Assarsson and Akenine-Möller 2003; with depths, Laine et al. 2005), for a
//! light's samples and with exact bits. Wang et al. 2016 rasterise triangles only.

use glam::IVec3;

/// An edge of the silhouette.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SilhouetteEdge {
    /// From where, to where, lattice; and how many more triangles lie on its right (as p sees the light's grid, rows
    /// upwards) than on its left.
    from: [i32; 3],
    to: [i32; 3],
    right: i32,
}

impl SilhouetteEdge {
    /// The edge `from → to`, along which `right` more triangles run than against it; not 0.
    pub const fn new(from: IVec3, to: IVec3, right: i32) -> Self {
        Self { from: from.to_array(), to: to.to_array(), right }
    }

    /// Where it starts.
    #[inline(always)]
    pub const fn from(&self) -> IVec3 {
        IVec3::from_array(self.from)
    }

    /// Where it ends.
    #[inline(always)]
    pub const fn to(&self) -> IVec3 {
        IVec3::from_array(self.to)
    }

    /// How much deeper the shadow is on its right.
    #[inline(always)]
    pub const fn right(&self) -> i32 {
        self.right
    }

    /// Axis-major differences of both ends from a point; the others repeat the second.
    #[inline(always)]
    pub(crate) fn relative_to(&self, base: IVec3) -> [[i32; 4]; 3] {
        let (a, b) = (self.from() - base, self.to() - base);
        [[a.x, b.x, b.x, b.x], [a.y, b.y, b.y, b.y], [a.z, b.z, b.z, b.z]]
    }
}
