//! Which parts of a mesh are closed: bound a volume, or several, with nothing open. Decided on the lattice, without a tolerance.
//!
//! Vertices are the same where they lie in the same place (meshes repeat them along seams), and a part is what hangs together by
//! sides of triangles that lie in the same place. *A part is closed iff each of those sides is run through as often in one direction
//! as in the other*: as a chain it has no boundary. So two solids that share an edge are one closed part, and a solid with one
//! triangle turned around is open. A triangle with two corners in the same place has no sides that count: it is a part of its own,
//! closed, and blocks nothing.
//!
//! **Why it matters.** Along the segment from a receiver to a light sample, a closed mesh's winding number changes by −1 at every
//! triangle that faces the sample and by +1 at every one that faces the receiver. Where it is 0 at both ends (both lie outside),
//! there are as many of one as of the other: a sample that any triangle blocks is blocked by one that faces away from it. So only
//! those have to be looked at; they lie on the far side of the solid from the light, which does not shadow its own lit side then,
//! however roughly that is tessellated. (All this of opaque triangles, of segments that meet no edge, and of samples in no triangle's
//! plane. Through a hole that is cut out of the far side, light falls in from the near one.)
//!
//! Seed: Sintorn, Eisemann and Assarsson 2008, section 4.3, where shadow casters are the triangles that face away from the light.

use glam::IVec3;
use thiserror::Error;

use crate::order::sort_by;

/// What lies on one side of a triangle, and what it is sorted by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side {
    /// The vertices that stand for the places of its ends, the lower first.
    ends: [u32; 2],
    triangle: u32,
    /// 0, 1 or 2.
    side: u32,
    /// 1 where the triangle runs from the lower end to the higher, else −1.
    way: i32,
}

/// Memory to work in; what it holds is not looked at. Lengths are the least that will do.
#[derive(Debug)]
pub struct Room<'a> {
    /// As many as there are vertices.
    pub order: &'a mut [u32],
    /// As many as there are vertices. Afterwards: of every vertex, the lowest in the same place.
    pub same: &'a mut [u32],
    /// Three a triangle.
    pub sides: &'a mut [Side],
    /// As many as there are triangles. Afterwards: of every triangle, the lowest of its part.
    pub parts: &'a mut [u32],
}

/// A side of a triangle that others do not run against as often as with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenEdge {
    /// The triangle: the first that has such a side.
    pub triangle: u32,
    /// The side's ends, by the triangle's own vertex indices, in its order; the first such side of the triangle.
    pub vertices: [u32; 2],
}

/// Why nothing is found out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ClosedError {
    /// A slice to work in is too short.
    #[error("room for {length} {field}: {least} are needed")]
    Room {
        /// "vertices", "sides", "triangles" or "answers".
        field: &'static str,
        /// Its length.
        length: usize,
        /// The least that will do.
        least: usize,
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
    /// There are more than a 32-bit index can name.
    #[error("{count} {field} are too many: a 32-bit index has to name them")]
    TooMany {
        /// "vertices" or "triangles".
        field: &'static str,
        /// How many there are.
        count: usize,
    },
}

/// Tells of every triangle whether its part is closed (`closed`: one a triangle), and the first open edge, if there is any.
///
/// # Errors
/// A slice that is too short; a triangle that names a vertex which does not exist; more than 2^32 − 1 of either.
pub fn find(
    vertices: &[IVec3],
    triangles: &[[u32; 3]],
    room: Room<'_>,
    closed: &mut [bool],
) -> Result<Option<OpenEdge>, ClosedError> {
    check(vertices, triangles, &room, closed.len())?;
    let Room { order, same, sides, parts } = room;
    let parts = parts.get_mut(..triangles.len()).unwrap_or_default();
    let closed = closed.get_mut(..triangles.len()).unwrap_or_default();
    merge(vertices, order.get_mut(..vertices.len()).unwrap_or_default(), same);
    let count = list_sides(triangles, same, sides);
    let sides = sides.get_mut(..count).unwrap_or_default();
    sort_by(sides, &|a, b| a < b);

    closed.fill(true);
    for (triangle, part) in parts.iter_mut().enumerate() {
        *part = triangle as u32;
    }
    let mut open: Option<Side> = None;
    for along in sides.chunk_by(|a, b| a.ends == b.ends) {
        let (Some(first), mut sum) = (along.first(), 0_i64) else { continue };
        for side in along {
            sum += i64::from(side.way);
            join(parts, first.triangle, side.triangle);
        }
        if sum != 0 {
            if let Some(closed) = closed.get_mut(first.triangle as usize) {
                *closed = false;
            }
            let is_earlier = |other: &Side| (first.triangle, first.side) < (other.triangle, other.side);
            open = if open.as_ref().is_none_or(is_earlier) { Some(*first) } else { open };
        }
    }
    for triangle in 0..parts.len() {
        let part = root(parts, triangle as u32);
        set(parts, triangle as u32, part);
        if closed.get(triangle) == Some(&false)
            && let Some(of_part) = closed.get_mut(part as usize)
        {
            *of_part = false;
        }
    }
    for triangle in 0..closed.len() {
        let of_part = parts.get(triangle).and_then(|part| closed.get(*part as usize)).copied();
        if let (Some(closed), Some(of_part)) = (closed.get_mut(triangle), of_part) {
            *closed = of_part;
        }
    }
    let edge = |side: Side| {
        let [a, b, c] = *triangles.get(side.triangle as usize)?;
        let vertices = [[a, b], [b, c], [c, a]].get(side.side as usize).copied()?;
        Some(OpenEdge { triangle: side.triangle, vertices })
    };
    Ok(open.and_then(edge))
}

fn check(vertices: &[IVec3], triangles: &[[u32; 3]], room: &Room<'_>, answers: usize) -> Result<(), ClosedError> {
    for (field, count) in [("vertices", vertices.len()), ("triangles", triangles.len())] {
        if count as u64 > u64::from(u32::MAX) {
            return Err(ClosedError::TooMany { field, count });
        }
    }
    let lengths = [
        ("vertices", room.order.len(), vertices.len()),
        ("vertices", room.same.len(), vertices.len()),
        ("sides", room.sides.len(), triangles.len().saturating_mul(3)),
        ("triangles", room.parts.len(), triangles.len()),
        ("answers", answers, triangles.len()),
    ];
    for (field, length, least) in lengths {
        if length < least {
            return Err(ClosedError::Room { field, length, least });
        }
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|vertex| **vertex as usize >= vertices.len()) {
            return Err(ClosedError::IndexOutOfRange { triangle, vertex, vertices: vertices.len() });
        }
    }
    Ok(())
}

/// Of every vertex, the lowest in the same place.
fn merge(vertices: &[IVec3], order: &mut [u32], same: &mut [u32]) {
    let place = |vertex: u32| vertices.get(vertex as usize).map(IVec3::to_array);
    for (vertex, entry) in order.iter_mut().enumerate() {
        *entry = vertex as u32;
    }
    sort_by(order, &|a, b| (place(*a), *a) < (place(*b), *b));
    for in_place in order.chunk_by(|a, b| place(*a) == place(*b)) {
        for vertex in in_place {
            if let (Some(same), Some(lowest)) = (same.get_mut(*vertex as usize), in_place.first()) {
                *same = *lowest;
            }
        }
    }
}

/// The sides of all triangles whose corners lie in three places. Returns their number.
fn list_sides(triangles: &[[u32; 3]], same: &[u32], sides: &mut [Side]) -> usize {
    let (mut room, mut count) = (sides.iter_mut(), 0);
    for (triangle, corners) in triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|vertex| same.get(vertex as usize).copied().unwrap_or(vertex));
        if a == b || b == c || c == a {
            continue;
        }
        for (side, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            if let Some(place) = room.next() {
                let (ends, way) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
                *place = Side { ends, triangle: triangle as u32, side: side as u32, way };
                count += 1;
            }
        }
    }
    count
}

/// The lowest triangle known to be of the same part. Ways to it are halved as they are gone.
fn root(parts: &mut [u32], mut triangle: u32) -> u32 {
    loop {
        let above = of(parts, triangle);
        if above == triangle {
            return triangle;
        }
        let further = of(parts, above);
        set(parts, triangle, further);
        triangle = further;
    }
}

fn join(parts: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parts, a), root(parts, b));
    set(parts, a.max(b), a.min(b));
}

fn of(parts: &[u32], triangle: u32) -> u32 {
    parts.get(triangle as usize).copied().unwrap_or(triangle)
}

fn set(parts: &mut [u32], triangle: u32, part: u32) {
    if let Some(entry) = parts.get_mut(triangle as usize) {
        *entry = part;
    }
}
