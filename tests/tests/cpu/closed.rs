//! Closed parts of meshes, against the definition taken literally; and what they are good for: the triangles of a closed mesh that
//! face away from a sample block it wherever any of its triangles does.

use std::f64::consts::PI;

use umbra4_core::{
    Bounds, Lattice,
    closed::{ClosedError, Room, Side, find},
    glam::{DVec3, IVec3},
};
use umbra4_cpu::{ClosedParts, Occluders};
use umbra4_tests::{
    budget,
    meshes::{Mesh, cuboid, icosphere},
    rng::Rng,
};

fn parts(mesh: &Mesh) -> ClosedParts {
    let reach = DVec3::splat(f64::from((1 << 29) - 1024));
    let lattice = Lattice::covering(Bounds { min: -reach, max: reach }).expect("bounds are fine");
    assert_eq!(lattice.exponent(), 0);
    let vertices: Vec<DVec3> = mesh.vertices.iter().map(|v| v.as_dvec3()).collect();
    Occluders::from_f64(&lattice, &vertices, &mesh.triangles).expect("the mesh is fine").closed_parts()
}

fn places(mesh: &Mesh, triangle: usize) -> [IVec3; 3] {
    mesh.triangles[triangle].map(|vertex| mesh.vertices[vertex as usize])
}

fn sides([a, b, c]: [IVec3; 3]) -> [(IVec3, IVec3); 3] {
    [(a, b), (b, c), (c, a)]
}

fn is_line([a, b, c]: [IVec3; 3]) -> bool {
    a == b || b == c || c == a
}

/// The definition: pairs of triangles, one after the other.
struct Literal {
    closed: Vec<bool>,
    lowest: Vec<u32>,
    open: Option<(u32, [u32; 2])>,
}

fn literally(mesh: &Mesh) -> Literal {
    let count = mesh.triangles.len();
    let corners: Vec<[IVec3; 3]> = (0..count).map(|t| places(mesh, t)).collect();
    let counted: Vec<[(IVec3, IVec3); 3]> = corners.iter().filter(|c| !is_line(**c)).map(|c| sides(*c)).collect();
    let balance = |(from, to): (IVec3, IVec3)| {
        let all = counted.iter().flatten();
        all.map(|side| i32::from(*side == (from, to)) - i32::from(*side == (to, from))).sum::<i32>()
    };
    let has_open = |t: usize| !is_line(corners[t]) && sides(corners[t]).iter().any(|side| balance(*side) != 0);
    let open: Vec<bool> = (0..count).map(has_open).collect();
    let touch = |s: usize, t: usize| {
        let lines = is_line(corners[s]) || is_line(corners[t]);
        !lines && sides(corners[s]).iter().any(|&(a, b)| sides(corners[t]).iter().any(|&e| e == (a, b) || e == (b, a)))
    };
    let mut lowest: Vec<Option<u32>> = vec![None; count];
    for start in 0..count {
        let mut reached = vec![start];
        while let Some(t) = reached.pop() {
            if lowest[t].is_none() {
                lowest[t] = Some(start as u32);
                reached.extend((0..count).filter(|other| lowest[*other].is_none() && touch(t, *other)));
            }
        }
    }
    let lowest: Vec<u32> = lowest.into_iter().map(|part| part.expect("all are reached")).collect();
    let closed = (0..count).map(|t| (0..count).all(|other| lowest[other] != lowest[t] || !open[other])).collect();
    let first = (0..count).find(|t| open[*t]).map(|t| {
        let side = sides(corners[t]).iter().position(|side| balance(*side) != 0).expect("it is open");
        let of = mesh.triangles[t];
        (t as u32, [of[side], of[(side + 1) % 3]])
    });
    Literal { closed, lowest, open: first }
}

fn check(mesh: &Mesh) -> ClosedParts {
    let (found, wanted) = (parts(mesh), literally(mesh));
    assert_eq!(found.triangles(), wanted.closed, "{mesh:?}");
    assert_eq!(found.parts(), wanted.lowest, "{mesh:?}");
    assert_eq!(found.open_edge().map(|edge| (edge.triangle, edge.vertices)), wanted.open, "{mesh:?}");
    assert_eq!(found.all(), wanted.open.is_none());
    found
}

/// Every triangle with corners of its own.
fn split(mesh: &Mesh) -> Mesh {
    let mut out = Mesh::default();
    (0..mesh.triangles.len()).for_each(|t| out.add_triangle(places(mesh, t)));
    out
}

fn box_at(x: i32, y: i32, z: i32) -> Mesh {
    cuboid(IVec3::new(x, y, z), IVec3::new(x + 10, y + 10, z + 10))
}

#[test]
fn solids_are_closed_however_vertices_are_shared() {
    for solid in
        [box_at(0, 0, 0), icosphere(IVec3::ZERO, 2, |_| 5000.0), icosphere(IVec3::ONE, 1, |k| 100.0 + k as f64)]
    {
        assert!(solid.is_closed());
        for mesh in [&solid, &split(&solid)] {
            let found = check(mesh);
            assert_eq!((found.all(), found.count()), (true, (1, 1)));
        }
    }
    let nothing = check(&Mesh::default());
    assert_eq!((nothing.all(), nothing.count(), nothing.open_edge()), (true, (0, 0), None));
}

#[test]
fn a_hole_and_a_triangle_turned_around_are_open() {
    let whole = split(&box_at(0, 0, 0));
    for t in 0..whole.triangles.len() {
        let mut hole = whole.clone();
        hole.triangles.remove(t);
        assert_eq!(check(&hole).count(), (1, 0));
        let mut turned = whole.clone();
        turned.triangles[t].swap(0, 2);
        assert_eq!(check(&turned).count(), (1, 0));
    }
    let (mut inside_out, mut twice) = (whole.clone(), whole.clone());
    inside_out.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    assert!(check(&inside_out).all(), "closed, though its normals point inwards");
    twice.add(&whole);
    assert_eq!(check(&twice).count(), (1, 1), "a solid twice over is closed");
}

#[test]
fn edges_of_several_triangles() {
    // A fan around an edge: of three triangles it is never closed, of four it may be.
    let (a, b) = (IVec3::ZERO, IVec3::Z * 9);
    let rim = [IVec3::X * 9, IVec3::Y * 9, IVec3::X * -9, IVec3::Y * -9];
    for ways in 0..16_u32 {
        for count in [3, 4] {
            let mut fan = Mesh::default();
            for (k, c) in rim.into_iter().take(count).enumerate() {
                fan.add_triangle(if ways >> k & 1 == 1 { [a, b, c] } else { [b, a, c] });
            }
            assert_eq!(check(&fan).count(), (1, 0));
            // Backs for all of them: two sheets a triangle, which are closed.
            let backs: Vec<[IVec3; 3]> = (0..count).map(|t| places(&fan, t)).collect();
            backs.into_iter().for_each(|[a, b, c]| fan.add_triangle([c, b, a]));
            assert_eq!(check(&fan).count(), (1, 1));
        }
    }
}

#[test]
fn solids_that_touch() {
    let mut at_a_vertex = box_at(0, 0, 0);
    at_a_vertex.add(&box_at(10, 10, 10));
    assert_eq!(check(&at_a_vertex).count(), (2, 2));
    let mut at_an_edge = box_at(0, 0, 0);
    at_an_edge.add(&box_at(10, 10, 0));
    assert_eq!(check(&at_an_edge).count(), (1, 1), "four triangles at that edge, two each way");
    let mut apart = box_at(0, 0, 0);
    apart.add(&box_at(20, 0, 0));
    apart.triangles.remove(17);
    let found = check(&apart);
    assert_eq!(found.count(), (2, 1));
    assert_eq!(found.triangles().iter().filter(|closed| **closed).count(), 12);
    // One open part makes those closed ones open that share an edge with it.
    let mut with_a_fin = box_at(0, 0, 0);
    with_a_fin.add_triangle([IVec3::ZERO, IVec3::X * 10, IVec3::new(5, -5, -5)]);
    assert_eq!(check(&with_a_fin).count(), (1, 0));
}

#[test]
fn triangles_without_an_area() {
    let solid = box_at(0, 0, 0);
    // Two corners in one place, by index and by place: parts of their own.
    let mut points = solid.clone();
    points.add_triangle([IVec3::ZERO, IVec3::ZERO, IVec3::X * 10]);
    points.triangles.extend([[0, 0, 0], [3, 5, 3]]);
    assert_eq!(check(&points).count(), (4, 4));
    // A corner in the middle of an edge leaves a slit, which a triangle without area fills.
    let mut slit = Mesh::default();
    let [a, b, c, d] = [IVec3::ZERO, IVec3::X * 8, IVec3::Y * 8, IVec3::Z * 8];
    let middle = IVec3::X * 4;
    for corners in [[a, middle, d], [middle, b, d], [a, c, b], [b, c, d], [c, a, d]] {
        slit.add_triangle(corners);
    }
    assert_eq!(check(&slit).count(), (1, 0));
    slit.add_triangle([a, b, middle]);
    assert_eq!(check(&slit).count(), (1, 1));
}

/// A band around the z axis, turned by half a turn `halves` times.
fn band(halves: u32) -> Mesh {
    const PARTS: usize = 24;
    let mut mesh = Mesh::default();
    let ends: Vec<[IVec3; 2]> = (0..PARTS)
        .map(|k| {
            let (around, turn) = (2.0 * PI * k as f64 / PARTS as f64, PI * f64::from(halves) * k as f64 / PARTS as f64);
            let out = DVec3::new(around.cos(), around.sin(), 0.0);
            let along = (out * turn.cos() + DVec3::Z * turn.sin()) * 300.0;
            [out * 1000.0 - along, out * 1000.0 + along].map(|p| p.round().as_ivec3())
        })
        .collect();
    for k in 0..PARTS {
        let ([a, b], [mut c, mut d]) = (ends[k], ends[(k + 1) % PARTS]);
        if k + 1 == PARTS && halves % 2 == 1 {
            (c, d) = (d, c);
        }
        mesh.add_quad([a, c, d, b]);
    }
    mesh
}

#[test]
fn bands_are_open_and_with_their_backs_closed() {
    for halves in [0, 1, 2, 3] {
        let mut mesh = band(halves);
        assert_eq!(check(&mesh).count(), (1, 0), "{halves} half turns");
        let front = mesh.clone();
        let turned = |t: &[u32; 3]| [t[2], t[1], t[0]];
        mesh.add(&Mesh { triangles: front.triangles.iter().map(turned).collect(), ..front });
        assert_eq!(check(&mesh).count(), (1, 1), "{halves} half turns, both sides: no orientation is needed");
    }
}

#[test]
fn random_meshes_of_few_vertices() {
    let mut rng = Rng::named(7, "closed");
    let (mut closed, mut open, mut mixed) = (0, 0, 0);
    for _ in 0..budget::of(4000) {
        let places: Vec<IVec3> = (0..4 + rng.below(5)).map(|_| rng.point(2)).collect();
        // Each place is there twice: indices say nothing.
        let mut mesh = Mesh { vertices: [&places[..], &places[..]].concat(), triangles: vec![] };
        let mut add = |rng: &mut Rng, corners: [usize; 3]| {
            let turn = rng.below(3);
            let corner = |k: usize| (corners[(k + turn) % 3] + places.len() * rng.below(2)) as u32;
            let corners = [0, 1, 2].map(corner);
            mesh.triangles.push(corners);
        };
        for _ in 0..rng.below(4) {
            let [a, b, c, d] = [0; 4].map(|_| rng.below(places.len()));
            for [a, b, c] in [[a, c, b], [a, b, d], [a, d, c], [b, c, d]] {
                if !rng.one_in(30) {
                    let turned = rng.one_in(30);
                    add(&mut rng, if turned { [c, b, a] } else { [a, b, c] });
                }
            }
        }
        for _ in 0..rng.below(3) / 2 {
            let corners = [0; 3].map(|_| rng.below(places.len()));
            add(&mut rng, corners);
        }
        let found = check(&mesh).count();
        closed += u32::from(found.0 > 0 && found.1 == found.0);
        open += u32::from(found.0 > 0 && found.1 == 0);
        mixed += u32::from(found.1 > 0 && found.1 < found.0);
    }
    assert!(closed > 200 && open > 200 && mixed > 200, "{closed} closed, {open} open, {mixed} mixed");
}

#[test]
fn what_is_refused() {
    let vertices = [IVec3::ZERO, IVec3::X, IVec3::Y];
    let run = |triangles: &[[u32; 3]], lengths: [usize; 5]| {
        let (mut order, mut same) = ([7; 4], [7; 4]);
        let (mut sides, mut parts, mut closed) = ([Side::default(); 8], [7; 4], [false; 4]);
        let room = Room {
            order: &mut order[..lengths[0]],
            same: &mut same[..lengths[1]],
            sides: &mut sides[..lengths[2]],
            parts: &mut parts[..lengths[3]],
        };
        find(&vertices, triangles, room, &mut closed[..lengths[4]]).map(|open| open.map(|edge| edge.vertices))
    };
    let one = [[0, 1, 2]];
    assert_eq!(run(&one, [3, 3, 3, 1, 1]), Ok(Some([0, 1])));
    assert_eq!(run(&one, [4, 4, 8, 4, 4]), Ok(Some([0, 1])), "more room is as good");
    assert_eq!(run(&[], [3, 3, 0, 0, 0]), Ok(None));
    let room = |field, length, least| Err(ClosedError::Room { field, length, least });
    assert_eq!(run(&one, [2, 3, 3, 1, 1]), room("vertices", 2, 3));
    assert_eq!(run(&one, [3, 1, 3, 1, 1]), room("vertices", 1, 3));
    assert_eq!(run(&one, [3, 3, 2, 1, 1]), room("sides", 2, 3));
    assert_eq!(run(&one, [3, 3, 3, 0, 1]), room("triangles", 0, 1));
    assert_eq!(run(&one, [3, 3, 3, 1, 0]), room("answers", 0, 1));
    let missing = Err(ClosedError::IndexOutOfRange { triangle: 1, vertex: 3, vertices: 3 });
    assert_eq!(run(&[[0, 1, 2], [0, 3, 9]], [3, 3, 6, 2, 2]), missing);
}

type Vector = [i128; 3];

fn between(from: IVec3, to: IVec3) -> Vector {
    [0, 1, 2].map(|k| i128::from(to[k]) - i128::from(from[k]))
}

fn volume(u: Vector, v: Vector, w: Vector) -> i128 {
    let minor = |a: usize, b: usize| v[a] * w[b] - v[b] * w[a];
    u[0] * minor(1, 2) - u[1] * minor(0, 2) + u[2] * minor(0, 1)
}

/// How the segment passes the triangle: `Some(0)` beside it, 1 from its front to its back, −1 the other way; `None` where it meets
/// an edge, or an end lies in the plane.
fn passage(from: IVec3, to: IVec3, [a, b, c]: [IVec3; 3]) -> Option<i32> {
    let (u, v) = (between(a, b), between(a, c));
    if (0..3).all(|k| u[(k + 1) % 3] * v[(k + 2) % 3] == u[(k + 2) % 3] * v[(k + 1) % 3]) {
        return Some(0); // Without area: its neighbours' edges are where it is.
    }
    let ends = [from, to].map(|end| volume(u, v, between(a, end)).signum());
    if ends.contains(&0) {
        return None;
    }
    if ends[0] == ends[1] {
        return Some(0);
    }
    let along = between(from, to);
    let [ab, bc, ca] =
        sides([a, b, c]).map(|(x, y)| volume(between(from, x), between(from, y), along).signum() * -ends[0]);
    match [ab, bc, ca] {
        around if around.contains(&-1) && around.contains(&1) => Some(0),
        around if around.contains(&0) => None,
        _ => Some(ends[0] as i32),
    }
}

/// The winding number of the mesh at a point, along a segment to `outside`.
fn winding(mesh: &[[IVec3; 3]], point: IVec3, outside: IVec3) -> Option<i32> {
    mesh.iter().map(|t| passage(point, outside, *t)).sum::<Option<i32>>().map(|sum| -sum)
}

/// Of a closed mesh, where both ends lie outside, the triangles that face away from the sample block it iff any does.
#[test]
fn triangles_that_face_away_are_enough() {
    let mut rng = Rng::named(3, "chain");
    let (mut blocked, mut lit, mut otherwise) = (0, 0, 0);
    for round in 0..budget::of(120) {
        let mut mesh = Mesh::default();
        for _ in 0..1 + rng.below(4) {
            let (at, size) = (rng.point(3000), 500 + rng.below(3000) as i32);
            match rng.below(3) {
                0 => mesh.add(&cuboid(at, at + IVec3::splat(size) + rng.point(400))),
                1 => mesh.add(&icosphere(at, 1, |_| f64::from(size))),
                _ => mesh.add(&icosphere(at, rng.below(2) as u32, |_| f64::from(size) * (0.3 + rng.unit()))),
            }
        }
        if round % 2 == 1 {
            mesh = split(&mesh);
        }
        assert!(parts(&mesh).all());
        let corners: Vec<[IVec3; 3]> = (0..mesh.triangles.len()).map(|t| places(&mesh, t)).collect();
        let outside = IVec3::new(20_011, 31_013, 25_117);
        for _ in 0..60 {
            let (p, sample) = (rng.point(6000), rng.point(6000));
            let passages: Option<Vec<i32>> = corners.iter().map(|t| passage(p, sample, *t)).collect();
            let (Some(passages), Some(of_p), Some(of_sample)) =
                (passages, winding(&corners, p, outside), winding(&corners, sample, outside))
            else {
                continue;
            };
            // From the front of a triangle to its back: it faces the receiver, away from the sample.
            let (any, away) = (passages.iter().any(|k| *k != 0), passages.contains(&1));
            assert_eq!(passages.iter().sum::<i32>(), of_sample - of_p, "{p}, {sample}");
            if of_p == 0 && of_sample == 0 {
                assert_eq!(any, away, "{p}, {sample}");
                *(if any { &mut blocked } else { &mut lit }) += 1;
            } else {
                otherwise += u32::from(any != away);
            }
        }
    }
    assert!(blocked > 500 && lit > 500, "{blocked} blocked, {lit} lit");
    assert!(otherwise > 100, "inside, the rules differ: {otherwise}");
}
