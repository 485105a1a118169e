//! A wall with a window: panes of many colours in lead, some of them one behind the other, one with a texture. Its light
//! falls on a floor, a bench and a ball.

use umbra4_core::glam::{DVec3, Vec3};

use super::{Builder, BuiltinScene, View, random::Random, rosette, window};
use crate::model::Surface;

pub(super) const RUBY: Vec3 = Vec3::new(0.80, 0.03, 0.04);
pub(super) const COBALT: Vec3 = Vec3::new(0.03, 0.12, 0.85);
pub(super) const AMBER: Vec3 = Vec3::new(0.98, 0.60, 0.06);
pub(super) const VIOLET: Vec3 = Vec3::new(0.45, 0.07, 0.62);
pub(super) const TURQUOISE: Vec3 = Vec3::new(0.08, 0.62, 0.60);
pub(super) const PALE: Vec3 = Vec3::new(0.88, 0.92, 0.80);
const EMERALD: Vec3 = Vec3::new(0.05, 0.55, 0.12);

const GLASS: [(&str, Vec3); 7] = [
    ("ruby", RUBY),
    ("cobalt", COBALT),
    ("amber", AMBER),
    ("violet", VIOLET),
    ("turquoise", TURQUOISE),
    ("pale", PALE),
    ("emerald", EMERALD),
];

/// Left, right, lower and upper edge of the window, in the plane z = 0.
const WINDOW: [f64; 4] = [-1.4, 1.4, 0.7, 4.2];
const COLUMNS: usize = 4;
const ROWS: usize = 5;
/// Half the thickness of the wall, and its other edges.
const WALL: f64 = 0.18;
const SIDES: f64 = 12.0;
const TOP: f64 = 7.0;
/// Radius of the lead between panes.
const LEAD: f64 = 0.018;
/// Where the second panes are.
const BEHIND: f64 = -0.05;

pub(super) fn scene() -> BuiltinScene {
    let mut builder = Builder::default();
    floor(&mut builder);
    wall(&mut builder);
    furniture(&mut builder);
    let mut panes = Vec::new();
    glaze(&mut panes);
    builder.color(0.05, 0.05, 0.055);
    panes.iter().for_each(|pane| lead(&mut builder, &pane.corners));
    rim(&mut builder);
    for (index, (name, tint)) in GLASS.into_iter().enumerate() {
        builder.part(name, Surface::Tinted(tint), |builder| {
            for pane in panes.iter().filter(|pane| pane.glass == index) {
                let corners: Vec<u32> = pane.corners.iter().map(|corner| builder.vertex(*corner)).collect();
                (2..corners.len()).for_each(|last| builder.triangle([corners[0], corners[last - 1], corners[last]]));
            }
        });
    }
    builder.part("rosette", rosette::surface(), |builder| {
        let corner = |u: f64, v: f64| (at(1.0 + 2.0 * u, 4.0 - 2.0 * v, 0.0), [u as f32, v as f32]);
        let corners = [corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0), corner(0.0, 0.0)];
        let corners = corners.map(|(position, coordinates)| builder.textured_vertex(position, coordinates));
        builder.quad(corners);
    });
    let view = View {
        eye: DVec3::new(4.3, 4.0, 10.2),
        target: DVec3::new(0.75, 1.5, 1.4),
        fov: 37.0,
        focus: DVec3::new(0.0, 0.5, 2.2),
        fade: 30.0,
    };
    let light = window(DVec3::new(-2.2, 10.2, -6.4), DVec3::new(0.2, 0.6, 1.6), 0.4);
    BuiltinScene::of(builder, light, view)
}

/// A point of the window's plane, or of one `z` before it, in columns from the left and rows from below.
fn at(column: f64, row: f64, z: f64) -> DVec3 {
    let [left, right, low, high] = WINDOW;
    DVec3::new(left + (right - left) * column / COLUMNS as f64, low + (high - low) * row / ROWS as f64, z)
}

/// A flat pane with three corners or four.
struct Pane {
    /// Which of `GLASS`.
    glass: usize,
    corners: Vec<DVec3>,
}

/// The panes around the rosette, which has the four cells in the middle of the upper rows.
fn glaze(panes: &mut Vec<Pane>) {
    let mut pane = |glass: usize, z: f64, corners: &[(f64, f64)]| {
        panes.push(Pane { glass, corners: corners.iter().map(|&(x, y)| at(x, y, z)).collect() });
    };
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let (x, y) = (column as f64, row as f64);
            let (k, mirrored) = (row + column.min(COLUMNS - 1 - column), column >= COLUMNS / 2);
            let square = [(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)];
            let [a, b, c, d] = square;
            let middle = (x + 0.5, y + 0.5);
            match (row, column) {
                (2 | 3, 1 | 2) => {}
                // Rhombs in the lowest row, each with a second pane behind it.
                (0, _) => {
                    let sides = [(x + 0.5, y), (x + 1.0, y + 0.5), (x + 0.5, y + 1.0), (x, y + 0.5)];
                    let [s, e, n, w] = sides;
                    for (corner, from, to) in [(a, w, s), (b, s, e), (c, e, n), (d, n, w)] {
                        pane(5, 0.0, &[corner, to, from]);
                    }
                    pane([2, 4][column % 2], 0.0, &sides);
                    pane(
                        [6, 1, 0, 3][column % 4],
                        BEHIND,
                        &sides.map(|(u, v)| (0.5 * (u + middle.0), 0.5 * (v + middle.1))),
                    );
                }
                // Squares cut along a diagonal, left and right like mirror images.
                _ if k % 2 == 1 => {
                    let (first, second) = ([0, 3, 6, 1][k % 4], [2, 4, 0, 5][(k + row) % 4]);
                    let (lower, upper) = if mirrored { ([a, b, d], [b, c, d]) } else { ([a, b, c], [a, c, d]) };
                    pane(first, 0.0, &lower);
                    pane(second, 0.0, &upper);
                }
                // Four triangles that meet in the middle.
                _ => {
                    for (side, (from, to)) in [(a, b), (b, c), (c, d), (d, a)].into_iter().enumerate() {
                        pane([1, 2, 1, 6][(side + k / 2) % 4], 0.0, &[from, to, middle]);
                    }
                }
            }
        }
    }
}

/// Lead along the edges of a pane.
fn lead(builder: &mut Builder, corners: &[DVec3]) {
    for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        builder.tube(*from, *to, (LEAD, LEAD), 6);
    }
}

/// A frame around the window, and lead around the rosette.
fn rim(builder: &mut Builder) {
    let [left, right, low, high] = WINDOW;
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    lead(builder, &[at(1.0, 2.0, 0.0), at(3.0, 2.0, 0.0), at(3.0, 4.0, 0.0), at(1.0, 4.0, 0.0)]);
    for (from, to) in [
        (corner(left, low), corner(right, low)),
        (corner(right, low), corner(right, high)),
        (corner(right, high), corner(left, high)),
        (corner(left, high), corner(left, low)),
    ] {
        builder.tube(from, to, (2.0 * LEAD, 2.0 * LEAD), 8);
    }
}

/// Slabs in two shades.
fn floor(builder: &mut Builder) {
    let mut random = Random(31);
    for row in 0..16 {
        for column in -14..14 {
            let shade = if (row + column) % 2 == 0 { 0.80 } else { 0.68 } * random.between(0.95, 1.0) as f32;
            builder.color(shade, shade * 0.97, shade * 0.92);
            let (x, z) = (f64::from(column) * 0.9, f64::from(row) * 0.9);
            let corners = [(x, z), (x, z + 0.9), (x + 0.9, z + 0.9), (x + 0.9, z)];
            let slab = corners.map(|(x, z)| builder.vertex(DVec3::new(x, 0.0, z)));
            builder.quad(slab);
        }
    }
}

/// Four blocks around the window.
fn wall(builder: &mut Builder) {
    let [left, right, low, high] = WINDOW;
    builder.color(0.80, 0.76, 0.70);
    for (min, max) in [
        ((-SIDES, 0.0), (left, TOP)),
        ((right, 0.0), (SIDES, TOP)),
        ((left, 0.0), (right, low)),
        ((left, high), (right, TOP)),
    ] {
        builder.cuboid(DVec3::new(min.0, min.1, -WALL), DVec3::new(max.0, max.1, WALL));
    }
    builder.color(0.66, 0.63, 0.58);
    builder.cuboid(DVec3::new(left - 0.15, low - 0.12, -WALL), DVec3::new(right + 0.15, low, WALL + 0.14));
}

/// A bench and a ball.
fn furniture(builder: &mut Builder) {
    builder.color(0.70, 0.66, 0.58);
    let (min, max) = (DVec3::new(-1.5, 0.0, 2.9), DVec3::new(0.3, 0.45, 3.35));
    builder.cuboid(DVec3::new(min.x, 0.37, min.z), max);
    for x in [min.x + 0.1, max.x - 0.22] {
        builder.cuboid(DVec3::new(x, 0.0, min.z + 0.06), DVec3::new(x + 0.12, 0.37, max.z - 0.06));
    }
    builder.color(0.78, 0.77, 0.74);
    builder.sphere(DVec3::new(1.9, 0.36, 1.45), 0.36, 40);
}
