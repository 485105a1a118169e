//! Which meshes have an inside: those without a boundary, their vertices told apart by where they are alone.

use std::collections::{BTreeMap, BTreeSet};

use umbra4_core::glam::IVec3;

type Place = [i32; 3];

/// The edges of a triangle, as it runs through them; none where two of its corners are in one place: what it would add to one
/// way, it adds to the other.
fn edges(triangle: [IVec3; 3]) -> Vec<[Place; 2]> {
    let [a, b, c] = triangle.map(|corner| corner.to_array());
    if a == b || b == c || c == a { vec![] } else { vec![[a, b], [b, c], [c, a]] }
}

/// Both ends of an edge in the order of their coordinates.
fn undirected([a, b]: [Place; 2]) -> [Place; 2] {
    [a.min(b), a.max(b)]
}

/// Edges that are not run through as often one way as the other.
pub fn boundary(triangles: &[[IVec3; 3]]) -> BTreeSet<[Place; 2]> {
    let mut ways = BTreeMap::<[Place; 2], i64>::new();
    for edge in triangles.iter().flat_map(|&triangle| edges(triangle)) {
        *ways.entry(edge).or_default() += 1;
    }
    let there = |edge: &[Place; 2]| ways.get(edge).copied().unwrap_or(0);
    ways.keys().filter(|&&[a, b]| there(&[a, b]) != there(&[b, a])).map(|&edge| undirected(edge)).collect()
}

/// For each triangle, whether no triangle that it hangs together with, by edges, has an edge on the boundary.
pub fn in_closed_components(triangles: &[[IVec3; 3]]) -> Vec<bool> {
    let boundary = boundary(triangles);
    let own = |t: usize| edges(triangles[t]).into_iter().map(undirected);
    let mut at_edge = BTreeMap::<[Place; 2], Vec<usize>>::new();
    for t in 0..triangles.len() {
        own(t).for_each(|edge| at_edge.entry(edge).or_default().push(t));
    }
    // What is open makes its neighbours open.
    let mut open: Vec<bool> = (0..triangles.len()).map(|t| own(t).any(|edge| boundary.contains(&edge))).collect();
    let mut waiting: Vec<usize> = (0..triangles.len()).filter(|&t| open[t]).collect();
    while let Some(t) = waiting.pop() {
        for neighbour in own(t).flat_map(|edge| &at_edge[&edge]) {
            if !open[*neighbour] {
                open[*neighbour] = true;
                waiting.push(*neighbour);
            }
        }
    }
    open.into_iter().map(|open| !open).collect()
}
