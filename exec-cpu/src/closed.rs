//! Which parts of the occluders are closed ([`umbra4_core::closed`]).

use umbra4_core::closed::{OpenEdge, Room, Side, find};

use crate::Occluders;

/// The parts of a mesh, and which of them are closed: see [`umbra4_core::closed`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ClosedParts {
    closed: Vec<bool>,
    parts: Vec<u32>,
    open_edge: Option<OpenEdge>,
}

impl ClosedParts {
    /// Of every triangle, in the order of [`Occluders::triangles`], whether its part is closed.
    pub fn triangles(&self) -> &[bool] {
        &self.closed
    }

    /// Of every triangle, the lowest triangle of its part.
    pub fn parts(&self) -> &[u32] {
        &self.parts
    }

    /// Whether all parts are closed. True of a mesh without triangles.
    pub fn all(&self) -> bool {
        self.closed.iter().all(|closed| *closed)
    }

    /// The first open edge, if there is any: by triangle, then by its sides.
    pub fn open_edge(&self) -> Option<OpenEdge> {
        self.open_edge
    }

    /// How many parts there are, and how many of those are closed. A triangle with two corners in the same place is a part.
    pub fn count(&self) -> (usize, usize) {
        let lowest = self.parts.iter().zip(&self.closed).enumerate().filter(|(t, (part, _))| *t == **part as usize);
        lowest.fold((0, 0), |(parts, closed), (_, (_, is_closed))| (parts + 1, closed + usize::from(*is_closed)))
    }
}

impl Occluders {
    /// Finds the closed parts: those that bound a volume, with vertices taken for the same where they lie in the same place of the
    /// lattice.
    ///
    /// ```
    /// use umbra4_cpu::Occluders;
    /// use umbra4_core::{glam::{DVec3, Vec3}, Bounds, Lattice};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let vertices = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    /// let sides = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// assert!(Occluders::new(&lattice, &vertices, &sides)?.closed_parts().all());
    ///
    /// let without_one = Occluders::new(&lattice, &vertices, &sides[..3])?.closed_parts();
    /// assert_eq!(without_one.triangles(), [false; 3]);
    /// assert_eq!(without_one.open_edge().map(|edge| (edge.triangle, edge.vertices)), Some((0, [2, 1])));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closed_parts(&self) -> ClosedParts {
        let (vertices, triangles) = (self.vertices(), self.triangles());
        let (mut order, mut same) = (vec![0; vertices.len()], vec![0; vertices.len()]);
        let (mut sides, mut parts) = (vec![Side::default(); 3 * triangles.len()], vec![0; triangles.len()]);
        let mut closed = vec![false; triangles.len()];
        let room = Room { order: &mut order, same: &mut same, sides: &mut sides, parts: &mut parts };
        match find(vertices, triangles, room, &mut closed) {
            Ok(open_edge) => ClosedParts { closed, parts, open_edge },
            // Indices are in range, and all room is given. Of a mesh of which nothing is known, nothing is closed.
            Err(_) => ClosedParts { closed, parts, open_edge: None },
        }
    }
}
