//! The hard cases, by name. Each is compared with the oracle; most also say themselves what must come out.
//!
//! Exact expectations come from *windows*: a quad half-way between a receiver and the light whose corners lie half-way
//! to given half-integer rows and columns. What it blocks follows by counting, not by geometry.

use umbra4_core::{
    AreaLight, Bounds, Jitter, Lattice, LatticeLight, Lift,
    glam::{DVec3, IVec3, Vec3},
};
use umbra4_cpu::{Occluders, Receivers};

use crate::{
    meshes::{Mesh, cuboid, icosphere},
    rng::Rng,
    scene::{Inputs, Scene, WorldScene},
    scenes,
};

/// What must hold beyond equality with the oracle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Check {
    /// No sample is blocked from any receiver.
    Lit,
    /// Every sample is blocked from every receiver.
    Blocked,
    /// Some bits are set and some are not: the scene tests something.
    Mixed,
    /// The masks are these.
    Masks(Vec<u64>),
    /// These samples (receiver, row, column) are blocked.
    BlockedAt(Vec<(usize, u32, u32)>),
    /// There are no receivers, hence no masks.
    NoMasks,
}

/// One scene with what must hold.
#[derive(Clone, Debug)]
pub struct Case {
    /// What the executor is given.
    pub inputs: Inputs,
    /// What must hold.
    pub check: Check,
}

/// Builds the scenes of a hard case, for a light of given rows and columns where the case leaves them open.
pub type HardCase = fn(u32, u32) -> Vec<Case>;

/// All hard cases.
pub const HARD_CASES: &[(&str, HardCase)] = &[
    ("receiver_on_edge", receiver_on_edge),
    ("receiver_on_vertex", receiver_on_vertex),
    ("receiver_in_triangle_plane", receiver_in_triangle_plane),
    ("receiver_behind_light", receiver_behind_light),
    ("light_row_in_edge_plane", light_row_in_edge_plane),
    ("light_column_in_edge_plane", light_column_in_edge_plane),
    ("light_plane_coplanar_with_triangle", light_plane_coplanar_with_triangle),
    ("ceiling_coplanar_with_lamp", ceiling_coplanar_with_lamp),
    ("triangle_through_light_plane", triangle_through_light_plane),
    ("triangle_through_receiver_plane", triangle_through_receiver_plane),
    ("triangle_behind_light", triangle_behind_light),
    ("roof_over_the_light", roof_over_the_light),
    ("slivers_of_aspect_a_million", slivers_of_aspect_a_million),
    ("needles_with_a_flat_short_side", needles_with_a_flat_short_side),
    ("neighbour_at_the_light_plane", neighbour_at_the_light_plane),
    ("zero_area_triangles", zero_area_triangles),
    ("closed_mesh_around_receiver", closed_mesh_around_receiver),
    ("closed_mesh_silhouette", closed_mesh_silhouette),
    ("offset_1e4_details_1e_2", offset_1e4_details_1e_2),
    ("offset_1e6_details_quarter", offset_1e6_details_quarter),
    ("offset_1e6_details_1e_2_f64", offset_1e6_details_1e_2_f64),
    ("scale_1e_6", scale_1e_6),
    ("scale_1e6", scale_1e6),
    ("switch_at_column_zero", switch_at_column_zero),
    ("switch_at_word_width", switch_at_word_width),
    ("light_1x1", light_1x1),
    ("light_1xn", light_1xn),
    ("light_nx1", light_nx1),
    ("light_64x64", light_64x64),
    ("parallelogram_light", parallelogram_light),
    ("duplicated_triangles", duplicated_triangles),
    ("no_triangles", no_triangles),
    ("no_receivers", no_receivers),
    ("contact", contact),
    ("own_surface", own_surface),
];

/// Sample grids that the catalogue is run with.
pub const GRIDS: [(u32, u32); 13] = [
    (1, 1),
    (1, 16),
    (16, 1),
    (5, 15),
    (16, 16),
    (3, 17),
    (1, 31),
    (32, 32),
    (9, 33),
    (64, 63),
    (64, 64),
    (1, 64),
    (64, 1),
];

/// Distance of neighbouring samples of [`lamp`]; a multiple of 8, so that a half of a half step is an integer.
const STEP: i32 = 4096;

/// Height of [`lamp`] over the receivers, which are at height 0.
const HEIGHT: i32 = 1 << 20;

/// A lamp that shines straight down, over the middle of the floor.
fn lamp(rows: u32, columns: u32) -> LatticeLight {
    let origin = IVec3::new(-(columns as i32 - 1) * STEP / 2, HEIGHT, -(rows as i32 - 1) * STEP / 2);
    LatticeLight {
        origin,
        step_u: IVec3::new(STEP, 0, 0),
        step_v: IVec3::new(0, 0, STEP),
        rows,
        columns,
        jitter: Jitter::NONE,
    }
}

/// A lamp whose grid is askew in all three axes.
fn skew_lamp(rows: u32, columns: u32) -> LatticeLight {
    let (step_u, step_v) = (IVec3::new(STEP, STEP / 4, 0), IVec3::new(STEP / 2, 0, STEP));
    LatticeLight { step_u, step_v, ..lamp(rows, columns) }
}

fn case(light: LatticeLight, receivers: &[IVec3], mesh: Mesh, check: Check) -> Case {
    let scene = Scene { light, receivers: receivers.to_vec(), mesh };
    Case { inputs: scene.inputs(20), check }
}

/// Half-open or closed, a range of half rows or half columns: `low..=high`.
type Halves = (i32, i32);

/// The quad that blocks, from `p`, the samples with `rows.0 ≤ 2·row ≤ rows.1` and `columns.0 ≤ 2·column ≤ columns.1`.
fn window(light: &LatticeLight, p: IVec3, rows: Halves, columns: Halves) -> [IVec3; 4] {
    [(rows.0, columns.0), (rows.0, columns.1), (rows.1, columns.1), (rows.1, columns.0)].map(|(i, j)| {
        let doubled = p + light.origin + light.step_v / 2 * i + light.step_u / 2 * j;
        assert_eq!(doubled % 2, IVec3::ZERO, "corners of windows are lattice points");
        doubled / 2
    })
}

/// The mask that [`window`] causes, by counting.
fn window_mask(light: &LatticeLight, rows: Halves, columns: Halves) -> Vec<u64> {
    let inside = |k: u32, (low, high): Halves| (low..=high).contains(&(2 * k as i32));
    (0..light.rows)
        .map(|i| (0..light.columns).filter(|&j| inside(i, rows) && inside(j, columns)).fold(0, |w, j| w | 1 << j))
        .collect()
}

/// The window alone, seen from one receiver, wound either way.
fn window_cases(light: LatticeLight, rows: Halves, columns: Halves) -> Vec<Case> {
    let p = IVec3::new(8 * 12_345, 0, -8 * 54_321);
    let mut corners = window(&light, p, rows, columns);
    let mask = window_mask(&light, rows, columns);
    [false, true]
        .iter()
        .map(|&flip| {
            if flip {
                corners.reverse();
            }
            let mut mesh = Mesh::default();
            mesh.add_quad(corners);
            case(light, &[p], mesh, Check::Masks(mask.clone()))
        })
        .collect()
}

/// All half rows of a light, and a bit.
fn all(count: u32) -> Halves {
    (-1, 2 * count as i32 - 1)
}

fn receiver_on_edge(rows: u32, columns: u32) -> Vec<Case> {
    // The triangle stands between receivers and lamp; its plane holds the receiver all the same, so it blocks nothing.
    let [a, b, c] = [IVec3::new(-STEP, 0, 0), IVec3::new(STEP, 0, 0), IVec3::new(0, HEIGHT / 2, 64)];
    let mut mesh = Mesh::default();
    mesh.add_triangle([a, b, c]);
    let on = [IVec3::ZERO, IVec3::new(1, 0, 0), (a + c) / 2, (b + c) / 2];
    vec![case(lamp(rows, columns), &on, mesh, Check::Lit)]
}

fn receiver_on_vertex(rows: u32, columns: u32) -> Vec<Case> {
    let corners = [IVec3::new(-STEP, 0, 3), IVec3::new(STEP, 7, 0), IVec3::new(1, HEIGHT / 2, 64)];
    let mut mesh = Mesh::default();
    mesh.add_triangle(corners);
    vec![case(lamp(rows, columns), &corners, mesh, Check::Lit)]
}

fn receiver_in_triangle_plane(rows: u32, columns: u32) -> Vec<Case> {
    let [a, b, c] = [IVec3::new(-STEP, -64, 0), IVec3::new(STEP, -64, 0), IVec3::new(0, HEIGHT / 2, 1 << 19)];
    let mut mesh = Mesh::default();
    mesh.add_triangle([a, b, c]);
    let inside = a + (b - a) / 4 + (c - a) / 4;
    let outside = [a + (a - b), b + (b - a) * 3, a + (a - c) / 4 + (b - a) / 2];
    vec![case(lamp(rows, columns), &[inside, outside[0], outside[1], outside[2]], mesh, Check::Lit)]
}

fn receiver_behind_light(rows: u32, columns: u32) -> Vec<Case> {
    let light = lamp(rows, columns);
    let behind = [light.origin, light.origin + IVec3::new(1 << 22, 0, 5), IVec3::new(0, HEIGHT + 1, 0)];
    let before = IVec3::new(0, HEIGHT - 1, 0);
    vec![case(light, &behind, Mesh::default(), Check::Blocked), case(light, &[before], Mesh::default(), Check::Lit)]
}

fn light_row_in_edge_plane(rows: u32, columns: u32) -> Vec<Case> {
    let row = rows as i32 / 2;
    let edges = [(-1, 2 * row), (2 * row, 2 * row), (2 * row, 2 * rows as i32), (2 * row + 1, 2 * rows as i32)];
    // The second is a segment: a window of no height blocks nothing, although a row lies in it.
    let mut cases: Vec<Case> = [edges[0], edges[2], edges[3]]
        .iter()
        .flat_map(|&e| window_cases(lamp(rows, columns), e, all(columns)))
        .collect();
    let mut flat = window_cases(lamp(rows, columns), edges[1], all(columns));
    for case in &mut flat {
        case.check = Check::Lit;
    }
    cases.append(&mut flat);
    cases
}

fn light_column_in_edge_plane(rows: u32, columns: u32) -> Vec<Case> {
    let column = 2 * (columns as i32 / 2);
    [(-1, column), (column, 2 * columns as i32), (column - 1, column + 1), (column, column + 1)]
        .iter()
        .flat_map(|&edges| window_cases(lamp(rows, columns), all(rows), edges))
        .collect()
}

fn switch_at_column_zero(rows: u32, columns: u32) -> Vec<Case> {
    let end = 2 * columns as i32;
    [(0, end), (-1, end), (1, end), (-2, 0), (-2, -1), (0, 1)]
        .iter()
        .flat_map(|&edges| window_cases(lamp(rows, columns), all(rows), edges))
        .collect()
}

fn switch_at_word_width(rows: u32, columns: u32) -> Vec<Case> {
    // With 16, 32 or 64 columns the switch at `end` is a shift by the whole word.
    let end = 2 * columns as i32;
    [
        (-1, end),
        (-1, end - 1),
        (-1, end - 2),
        (-1, end - 3),
        (end, end + 2),
        (end - 1, end),
        (end - 2, end),
        (-2, end + 9),
    ]
    .iter()
    .flat_map(|&edges| window_cases(lamp(rows, columns), all(rows), edges))
    .collect()
}

fn windows(light: LatticeLight) -> Vec<Case> {
    let (r, c) = (2 * light.rows as i32, 2 * light.columns as i32);
    [
        ((-1, r), (-1, c)),
        ((0, r / 2), (0, c / 2)),
        ((r / 2 - 1, r), (c / 2 - 1, c)),
        ((r, r + 2), (-1, c)),
        ((0, 1), (0, 1)),
    ]
    .iter()
    .flat_map(|&(rows, columns)| window_cases(light, rows, columns))
    .collect()
}

fn light_1x1(_: u32, _: u32) -> Vec<Case> {
    windows(lamp(1, 1))
}

fn light_1xn(_: u32, columns: u32) -> Vec<Case> {
    windows(lamp(1, columns))
}

fn light_nx1(rows: u32, _: u32) -> Vec<Case> {
    windows(lamp(rows, 1))
}

fn light_64x64(_: u32, _: u32) -> Vec<Case> {
    windows(lamp(64, 64))
}

fn parallelogram_light(rows: u32, columns: u32) -> Vec<Case> {
    windows(skew_lamp(rows, columns))
}

/// Receivers on the floor.
fn floor(count: usize) -> Vec<IVec3> {
    let mut rng = Rng::named(1, "floor");
    (0..count).map(|_| rng.point(HEIGHT) * IVec3::new(1, 0, 1)).collect()
}

fn light_plane_coplanar_with_triangle(rows: u32, columns: u32) -> Vec<Case> {
    [lamp(rows, columns), skew_lamp(rows, columns)]
        .iter()
        .map(|&light| {
            let mut mesh = Mesh::default();
            let at = |i: i32, j: i32| light.origin + light.step_v * i + light.step_u * j;
            mesh.add_triangle([at(-2, -2), at(-2, 300), at(300, -2)]);
            mesh.add_triangle([at(0, 0), at(0, 1), at(1, 0)]);
            case(light, &floor(16), mesh, Check::Lit)
        })
        .collect()
}

fn ceiling_coplanar_with_lamp(rows: u32, columns: u32) -> Vec<Case> {
    // The floor holds its receivers, the ceiling the samples: neither blocks, and the walls do not stand between.
    let room = cuboid(IVec3::new(-2 * HEIGHT, 0, -2 * HEIGHT), IVec3::new(2 * HEIGHT, HEIGHT, 2 * HEIGHT));
    vec![case(lamp(rows, columns), &floor(16), room, Check::Lit)]
}

/// A wall across the lamp, between two columns of samples, from height `bottom` to far above the lamp.
fn wall_across_lamp(rows: u32, columns: u32, bottom: i32) -> Vec<Case> {
    let light = lamp(rows, columns);
    let (x, far) = (light.origin.x + (columns as i32 / 2) * STEP - STEP / 2, 1 << 22);
    let mut mesh = Mesh::default();
    mesh.add_quad([[x, bottom, -far], [x, bottom, far], [x, far, far], [x, far, -far]].map(IVec3::from_array));
    let receivers =
        [IVec3::new(x - HEIGHT, 0, 0), IVec3::new(x + HEIGHT, 0, 77), IVec3::new(x - 1, 0, 0), IVec3::new(x, 0, 9)];
    let beyond = window_mask(&light, all(rows), (columns as i32 / 2 * 2, 2 * columns as i32));
    let before = window_mask(&light, all(rows), (-1, columns as i32 / 2 * 2 - 1));
    let masks = [beyond.clone(), before, beyond, vec![0; rows as usize]].concat();
    vec![case(light, &receivers, mesh, Check::Masks(masks))]
}

fn triangle_through_light_plane(rows: u32, columns: u32) -> Vec<Case> {
    wall_across_lamp(rows, columns, -1)
}

fn triangle_through_receiver_plane(rows: u32, columns: u32) -> Vec<Case> {
    // Deep below the receivers' floor, and from the floor itself.
    [wall_across_lamp(rows, columns, -HEIGHT), wall_across_lamp(rows, columns, 0)].concat()
}

fn triangle_behind_light(rows: u32, columns: u32) -> Vec<Case> {
    let mut mesh = Mesh::default();
    for height in [1, 2, 1000, HEIGHT] {
        let y = HEIGHT + height;
        mesh.add_triangle(
            [[-(1 << 23), y, -(1 << 23)], [1 << 23, y, -(1 << 23)], [0, y, 1 << 23]].map(IVec3::from_array),
        );
    }
    vec![case(lamp(rows, columns), &floor(16), mesh, Check::Lit)]
}

/// Roofs that start beside and below the lamp and lean over it: seen from the floor, the part behind the lamp lies before
/// it, and its sides run across the samples. Nothing is blocked.
fn roof_over_the_light(rows: u32, columns: u32) -> Vec<Case> {
    let light = lamp(rows, columns);
    let edge = (rows.max(columns) as i32 + 1) * STEP;
    let receivers: Vec<_> = floor(64).into_iter().map(|p| IVec3::new(p.x.abs(), 0, p.z / 8)).collect();
    let mut cases = Vec::new();
    for width in [edge / 5, edge / 2, edge, 3 * edge] {
        for top in [width, width / 2, 0] {
            let corners = [(-3, -2, -width), (1, 2, -top), (1, 2, top), (-3, -2, width)];
            let corners = corners.map(|(x, y, z)| IVec3::new(x * edge, HEIGHT + y * edge, z));
            for along_columns in [true, false] {
                let turn = |p: IVec3| if along_columns { p } else { IVec3::new(p.z, p.y, p.x) };
                let mut mesh = Mesh::default();
                mesh.add_quad(corners.map(turn));
                let receivers: Vec<_> = receivers.iter().map(|p| turn(*p)).collect();
                cases.push(case(light, &receivers, mesh, Check::Lit));
            }
        }
    }
    cases
}

fn slivers_of_aspect_a_million(rows: u32, columns: u32) -> Vec<Case> {
    // A sliver one step wide and 2^20 long whose edge lies exactly under column `column`: it blocks that column alone.
    let light = lamp(rows, columns);
    let p = IVec3::new(8 * 777, 0, 8 * 333);
    let column = columns as i32 / 2;
    let [from, _, to, _] = window(&light, p, (-512, 512), (2 * column, 2 * column));
    let mask = window_mask(&light, (-512, 512), (2 * column, 2 * column));
    [[from, to, to + IVec3::X], [to, from, from - IVec3::X], [from, to, (from + to) / 2 + IVec3::X]]
        .iter()
        .map(|&corners| {
            let mut mesh = Mesh::default();
            mesh.add_triangle(corners);
            case(light, &[p], mesh, Check::Masks(mask.clone()))
        })
        .collect()
}

fn needles_with_a_flat_short_side(rows: u32, columns: u32) -> Vec<Case> {
    let mut rng = Rng::named(5, "needles_with_a_flat_short_side");
    [lamp(rows, columns), skew_lamp(rows, columns)]
        .iter()
        .flat_map(|&light| [false, true].map(|slanting| needles(&mut rng, light, slanting)))
        .collect()
}

/// Receivers on the floor beside one that all but touches the light plane. An executor that places a group's receivers and
/// corners from that one knows nothing of where the others see the corners: they may all seem to fall on one point.
fn neighbour_at_the_light_plane(rows: u32, columns: u32) -> Vec<Case> {
    let mut rng = Rng::named(5, "neighbour_at_the_light_plane");
    let light = lamp(rows, columns);
    let mut cases = Vec::new();
    for _ in 0..8 {
        let mut receivers = floor(15);
        let mut mesh = Mesh::default();
        let mut blocked = Vec::new();
        for (r, p) in receivers.iter().enumerate() {
            let (i, j) = (rng.below(light.rows as usize) as u32, rng.below(light.columns as usize) as u32);
            let to_sample = light.sample(i, j).as_dvec3() - p.as_dvec3();
            let corner = |row: f64, column: f64, height: f64| {
                let beside = light.step_v.as_dvec3() * row + light.step_u.as_dvec3() * column;
                (p.as_dvec3() + (to_sample + beside) * height).round().as_ivec3()
            };
            let height = rng.pick(&[0.25, 0.5, 0.75]);
            mesh.add_triangle([corner(-0.7, -0.6, height), corner(0.9, -0.5, height), corner(-0.1, 1.1, height)]);
            blocked.push((r, i, j));
        }
        let aside = rng.point(HEIGHT);
        receivers.push(IVec3::new(aside.x, HEIGHT - 1, aside.z));
        cases.push(case(light, &receivers, mesh, Check::BlockedAt(blocked)));
    }
    cases
}

/// Needles, each through one sample as its own receiver sees it. The short side spans less than 1/32 row, with no row
/// near it: an executor cannot use its slope, and has to tell by other means on which side of it the needle lies. Most
/// short sides lean the way their needle does, but more steeply: there, the way that the side runs says the opposite.
///
/// The ends of a `slanting` short side differ in height, so that it points at the light: so does the needle's plane.
fn needles(rng: &mut Rng, light: LatticeLight, slanting: bool) -> Case {
    let receivers = floor(24);
    let mut mesh = Mesh::default();
    let mut blocked = Vec::new();
    for (r, p) in receivers.iter().enumerate() {
        let (i, j) = (rng.below(light.rows as usize) as u32, rng.below(light.columns as usize) as u32);
        // The lattice point that is seen `row` rows and `column` columns from the sample, at a height between both.
        let seen = |row: f64, column: f64, height: f64| {
            let on_light =
                light.sample(i, j).as_dvec3() + light.step_v.as_dvec3() * row + light.step_u.as_dvec3() * column;
            (p.as_dvec3() + (on_light - p.as_dvec3()) * height).round().as_ivec3()
        };
        // Columns a row: of the needle, and of its short side as a part of that.
        let slope = rng.pick(&[-48.0, -24.0, -8.0, -3.0, 3.0, 8.0, 24.0, 48.0]);
        let leaning = rng.pick(&[0.1, 0.3, 0.6, 0.6, -0.5, 1.5]);
        // Rows from the sample to the middle of the short side, and the other way to the third corner.
        let way = rng.pick(&[-1.0, 1.0]);
        let near = way * (rng.pick(&[0.0, 1.0]) + 0.1 + 0.8 * rng.unit());
        let far = -way * rng.pick(&[0.7, 3.0, 12.0, 40.0]);
        let half = 0.5 / (36.0 + 28.0 * rng.unit());
        let height = 0.5 + 0.3 * rng.unit();
        let other_height = if slanting { height * (1.05 + 0.1 * rng.unit()) } else { height };
        let end = |half: f64, height: f64| seen(near + half, slope * (near + leaning * half), height);
        let mut corners = [end(half, height), end(-half, other_height), seen(far, slope * far, 0.5 + 0.4 * rng.unit())];
        if rng.one_in(2) {
            corners.reverse();
        }
        mesh.add_triangle(corners);
        blocked.push((r, i, j));
    }
    case(light, &receivers, mesh, Check::BlockedAt(blocked))
}

fn zero_area_triangles(rows: u32, columns: u32) -> Vec<Case> {
    let light = lamp(rows, columns);
    let p = IVec3::new(8, 0, -8);
    let middle = window(&light, p, (0, 0), (0, 0))[0];
    let d = IVec3::new(2048, 0, 1024);
    let mut mesh = Mesh::default();
    for corners in [[middle; 3], [middle, middle, middle + d], [middle - d, middle, middle + d], [p; 3], [p, middle, p]]
    {
        mesh.add_triangle(corners);
    }
    vec![case(light, &[p, IVec3::ZERO], mesh, Check::Lit)]
}

fn closed_mesh_around_receiver(rows: u32, columns: u32) -> Vec<Case> {
    // Star-shaped around the origin, smooth or jagged: no way out from inside, through whatever edge or vertex.
    let mut rng = Rng::named(2, "closed_mesh_around_receiver");
    let size = HEIGHT / 4;
    let inside: Vec<IVec3> = (0..12).map(|k| rng.point(if k == 0 { 0 } else { size / 8 })).collect();
    [(0, false), (1, false), (1, true), (2, true)]
        .iter()
        .map(|&(depth, jagged)| {
            let mesh = icosphere(IVec3::ZERO, depth, |_| f64::from(size) * if jagged { 0.5 + rng.unit() } else { 1.0 });
            assert!(mesh.is_closed());
            // The smallest jagged sphere is as large as half its size, less what its flat faces cut off.
            case(lamp(rows, columns), &inside, mesh, Check::Blocked)
        })
        .collect()
}

fn closed_mesh_silhouette(rows: u32, columns: u32) -> Vec<Case> {
    let light = lamp(rows, columns);
    let center = IVec3::new(0, HEIGHT / 2, 0);
    let radius = f64::from(STEP) * f64::from(rows.max(columns)).max(8.0) / 6.0;
    [1, 2]
        .iter()
        .map(|&depth| {
            let mesh = icosphere(center, depth, |_| radius);
            assert!(mesh.is_closed());
            // The largest ball inside: what passes through it passes through the mesh.
            let ball = mesh.triangles.iter().fold(f64::INFINITY, |ball, t| {
                let [a, b, c] = t.map(|v| (mesh.vertices[v as usize] - center).as_dvec3());
                ball.min((b - a).cross(c - a).normalize().dot(a))
            }) * 0.999;
            assert!(ball > 0.0);
            let receivers =
                [IVec3::ZERO, IVec3::new(STEP / 2, 0, 1), IVec3::new(-3 * STEP, 0, 2 * STEP), IVec3::new(0, 0, STEP)];
            let mut blocked = Vec::new();
            for (r, p) in receivers.iter().enumerate() {
                for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
                    let along = (light.sample(i, j) - *p).as_dvec3().normalize();
                    if (center - *p).as_dvec3().cross(along).length() < ball {
                        blocked.push((r, i, j));
                    }
                }
            }
            assert!(!blocked.is_empty(), "some samples lie well inside the silhouette");
            case(light, &receivers, mesh, Check::BlockedAt(blocked))
        })
        .collect()
}

fn duplicated_triangles(rows: u32, columns: u32) -> Vec<Case> {
    let light = lamp(rows, columns);
    let p = IVec3::new(8, 0, -8);
    let (r, c) = ((0, rows as i32), (0, columns as i32));
    let [q, s, t, u] = window(&light, p, r, c);
    let mut mesh = Mesh::default();
    for _ in 0..3 {
        mesh.add_quad([q, s, t, u]);
        mesh.add_quad([u, t, s, q]);
        mesh.add_quad([s, t, u, q]);
    }
    vec![case(light, &[p], mesh, Check::Masks(window_mask(&light, r, c)))]
}

fn no_triangles(rows: u32, columns: u32) -> Vec<Case> {
    let unused = Mesh { vertices: vec![IVec3::ZERO, IVec3::ONE], triangles: Vec::new() };
    vec![
        case(lamp(rows, columns), &floor(8), Mesh::default(), Check::Lit),
        case(lamp(rows, columns), &floor(8), unused, Check::Lit),
        case(lamp(rows, columns), &[IVec3::new(3, HEIGHT, 4)], Mesh::default(), Check::Blocked),
    ]
}

fn no_receivers(rows: u32, columns: u32) -> Vec<Case> {
    let mesh = cuboid(IVec3::splat(-64), IVec3::splat(64));
    vec![
        case(lamp(rows, columns), &[], mesh, Check::NoMasks),
        case(lamp(rows, columns), &[], Mesh::default(), Check::NoMasks),
    ]
}

/// The scene in world floats that offsets and scales are tried on. `step` is the distance of neighbouring samples, as
/// large as the offset's lattice needs it.
fn world(rows: u32, columns: u32, step: f64) -> WorldScene {
    let mut scene = scenes::world(&mut Rng::named(3, "world"), rows, columns, 60, 24);
    let middle = scene.light().center();
    // Their cross product points down: that is where the light shines.
    scene.edge_u = DVec3::new(step, 0.0, step / 8.0) * f64::from(columns);
    scene.edge_v = DVec3::new(0.0, step / 16.0, step) * f64::from(rows);
    scene.corner = middle - (scene.edge_u + scene.edge_v) * 0.5;
    scene
}

fn mixed(scene: &WorldScene) -> Vec<Case> {
    vec![Case { inputs: scene.inputs(), check: Check::Mixed }]
}

fn offset_1e4_details_1e_2(rows: u32, columns: u32) -> Vec<Case> {
    mixed(&world(rows, columns, 0.25).transformed(1e-2, DVec3::new(1e4, -1e4, 1e4)))
}

fn offset_1e6_details_quarter(rows: u32, columns: u32) -> Vec<Case> {
    mixed(&world(rows, columns, 0.6).transformed(0.25, DVec3::new(-1e6, 1e6, 1e6)))
}

fn scale_1e_6(rows: u32, columns: u32) -> Vec<Case> {
    mixed(&world(rows, columns, 0.1).transformed(1e-6, DVec3::ZERO))
}

fn scale_1e6(rows: u32, columns: u32) -> Vec<Case> {
    mixed(&world(rows, columns, 0.1).transformed(1e6, DVec3::ZERO))
}

fn offset_1e6_details_1e_2_f64(rows: u32, columns: u32) -> Vec<Case> {
    // Coordinates are multiples of 2^-24, so that f64 holds them at the offset as exactly as at zero: the masks must be
    // the very same.
    let here = world(rows, columns, 0.25).transformed(1e-2, DVec3::ZERO);
    let grid = |p: DVec3| (p * f64::from(1 << 24)).round() / f64::from(1 << 24);
    let build = |offset: DVec3| {
        let moved = |points: &[Vec3]| points.iter().map(|p| grid(p.as_dvec3()) + offset).collect::<Vec<DVec3>>();
        let (vertices, points) = (moved(&here.vertices), moved(&here.receivers));
        // Halves and quarters of the edges are needed exactly too.
        let (u, v) = (grid(here.edge_u * 0.125) * 8.0, grid(here.edge_v * 0.125) * 8.0);
        let light = AreaLight::new(grid(here.corner) + offset, u, v, rows, columns).expect("the light has area");
        let bounds = Bounds::of(vertices.iter().chain(&points).copied().chain(light.corners()));
        let lattice = Lattice::covering_about(bounds, offset).expect("the scene is finite");
        Inputs {
            lattice,
            light: light.snap(&lattice, Lift::NONE).expect("the light is inside"),
            occluders: Occluders::from_f64(&lattice, &vertices, &here.triangles).expect("vertices are inside"),
            receivers: Receivers::raw_f64(&lattice, &points).expect("receivers are inside"),
        }
    };
    let (at_zero, far) = (build(DVec3::ZERO), build(DVec3::new(1e6, 1e6, -1e6)));
    vec![Case { check: Check::Masks(at_zero.oracle()), inputs: far }, Case { inputs: at_zero, check: Check::Mixed }]
}

fn contact(rows: u32, columns: u32) -> Vec<Case> {
    // A wall stands on the ground; the lamp is over its left side. The ground is dark right up to the wall's foot on the
    // right, and lit right up to it on the left.
    let ground = [[-8.0, 0.0, -8.0], [-8.0, 0.0, 8.0], [8.0, 0.0, 8.0], [8.0, 0.0, -8.0]];
    let wall = [[0.0, 0.0, -8.0], [0.0, 4.0, -8.0], [0.0, 4.0, 8.0], [0.0, 0.0, 8.0]];
    let vertices: Vec<Vec3> = ground.into_iter().chain(wall).map(Vec3::from_array).collect();
    let triangles = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let light = AreaLight::new(DVec3::new(-6.0, 6.0, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0, rows, columns)
        .expect("the light has area");
    let lattice = Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("finite bounds");
    // From one lattice step on.
    let distances = [lattice.step() as f32, 3.0e-7, 1.0e-5, 1.0e-3, 0.1, 1.0];
    [(1.0_f32, Check::Blocked), (-1.0, Check::Lit)]
        .into_iter()
        .map(|(side, check)| {
            let points = distances.map(|d| Vec3::new(side * d, 0.0, 0.3));
            let receivers = Receivers::on_surfaces(&lattice, &points, &[Vec3::Y; 6], Lift::F32_POSITIONS);
            let inputs = Inputs {
                lattice,
                light: light.snap(&lattice, Lift::NONE).expect("the light is inside"),
                occluders: Occluders::new(&lattice, &vertices, &triangles).expect("vertices are inside"),
                receivers: receivers.expect("receivers are inside"),
            };
            Case { inputs, check }
        })
        .collect()
}

/// A random quad in f32, points on it rounded to f32, and a light that all of the quad sees.
#[derive(Clone, Debug)]
pub struct OwnSurface {
    /// Corners of a parallelogram, each rounded to f32: its two triangles are as coplanar as f32 allows.
    pub vertices: [Vec3; 4],
    /// Points of its two triangles, vertices and points of the shared edge among them.
    pub points: Vec<Vec3>,
    /// Its normal, towards the light.
    pub normal: Vec3,
    /// The light; parallel to the quad, at a height between a half and a few thousandths of the quad's size.
    pub light: AreaLight,
}

/// The two triangles of [`OwnSurface`].
pub const QUAD: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

impl OwnSurface {
    /// A quad at an offset that leaves few bits for its details.
    pub fn random(rng: &mut Rng, rows: u32, columns: u32) -> Self {
        let size = 2.0_f64.powi(rng.below(40) as i32 - 20);
        let reach = size * 2.0_f64.powi(rng.below(4) as i32);
        loop {
            let mut vector = |extent: f64| DVec3::new(rng.real(extent), rng.real(extent), rng.real(extent));
            let a = vector(reach).as_vec3();
            let (b, c) = ((a.as_dvec3() + vector(size)).as_vec3(), (a.as_dvec3() + vector(size)).as_vec3());
            let [da, db, dc] = [a, b, c].map(|p| p.as_dvec3());
            let (u, v) = (db - da, dc - db);
            let normal = u.cross(v);
            // Slivers have no plane that f32 positions could lie on.
            if normal.length() < 0.05 * size * size {
                continue;
            }
            let d = (da + v).as_vec3();
            let corners = [[da, db, dc], [da, dc, d.as_dvec3()]];
            let points = (0..24)
                .map(|k| {
                    let [p, q, r] = corners[k % 2];
                    let (s, t) = (rng.unit(), rng.unit());
                    let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
                    let (s, t) = match k {
                        0..4 => (0.0, 0.0),
                        4..8 => (0.0, t),
                        _ => (s, t),
                    };
                    (p + (q - p) * s + (r - p) * t).as_vec3()
                })
                .collect();
            let towards = normal.normalize() * rng.pick(&[-1.0, 1.0]);
            // The light shines against `towards`: its edges follow the quad's, in the order that makes it so.
            let (edge_u, edge_v) = if towards.dot(normal) < 0.0 { (u, v) } else { (v, u) };
            let center = (da + dc) * 0.5 + u * rng.real(1.0) + towards * size * rng.pick(&[0.5, 0.05, 0.003]);
            let (edge_u, edge_v) = (edge_u * 0.3, edge_v * 0.3);
            let light = AreaLight::new(center - (edge_u + edge_v) * 0.5, edge_u, edge_v, rows, columns);
            let light = light.expect("the quad has area");
            return Self { vertices: [a, b, c, d], points, normal: towards.as_vec3(), light };
        }
    }

    /// The scene on its own lattice, the receivers lifted by `lift`.
    pub fn inputs(&self, lift: Lift) -> Inputs {
        let points = self.vertices.iter().chain(&self.points).map(|p| p.as_dvec3());
        let lattice = Lattice::covering(Bounds::of(points.chain(self.light.corners()))).expect("the scene is finite");
        let normals = vec![self.normal; self.points.len()];
        Inputs {
            lattice,
            light: self.light.snap(&lattice, Lift::NONE).expect("the light is inside"),
            occluders: Occluders::new(&lattice, &self.vertices, &QUAD).expect("vertices are inside"),
            receivers: Receivers::on_surfaces(&lattice, &self.points, &normals, lift).expect("receivers are inside"),
        }
    }
}

fn own_surface(rows: u32, columns: u32) -> Vec<Case> {
    let mut rng = Rng::named(4, "own_surface");
    (0..12)
        .map(|_| {
            let inputs = OwnSurface::random(&mut rng, rows, columns).inputs(Lift::F32_POSITIONS);
            Case { inputs, check: Check::Lit }
        })
        .collect()
}

impl Check {
    /// Whether masks (the oracle's, or those of an executor) are what the case states.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn holds(&self, masks: &[u64], light: &LatticeLight) -> Result<(), String> {
        let full = u64::MAX >> (64 - light.columns);
        let rows = light.rows as usize;
        let fail = |what: String| Err(what);
        match self {
            Self::NoMasks if masks.is_empty() => Ok(()),
            Self::NoMasks => fail(format!("{} words for no receivers", masks.len())),
            _ if masks.is_empty() => fail("no masks".into()),
            Self::Lit => match masks.iter().position(|&w| w != 0) {
                None => Ok(()),
                Some(k) => fail(format!(
                    "receiver {}, row {}: {:#x} is blocked, all should be lit",
                    k / rows,
                    k % rows,
                    masks[k]
                )),
            },
            Self::Blocked => match masks.iter().position(|&w| w != full) {
                None => Ok(()),
                Some(k) => fail(format!(
                    "receiver {}, row {}: only {:#x} of {full:#x} is blocked",
                    k / rows,
                    k % rows,
                    masks[k]
                )),
            },
            Self::Mixed => {
                let (some, all) = (masks.iter().any(|&w| w != 0), masks.iter().all(|&w| w == full));
                if some && !all {
                    Ok(())
                } else {
                    fail(format!("nothing to see: any blocked {some}, all blocked {all}"))
                }
            }
            Self::Masks(expected) if expected == masks => Ok(()),
            Self::Masks(expected) => fail(format!("expected {expected:x?}, got {masks:x?}")),
            Self::BlockedAt(samples) => {
                match samples.iter().find(|&&(r, i, j)| masks[r * rows + i as usize] >> j & 1 == 0) {
                    None => Ok(()),
                    Some(s) => fail(format!("light leaks through: (receiver, row, column) {s:?} is lit")),
                }
            }
        }
    }
}
