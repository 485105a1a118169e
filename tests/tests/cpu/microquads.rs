//! The arithmetic of microquad soft shadow mapping, formula by formula, against direct evaluations that are written for these tests
//! alone: in f64, by brute force, without the map's own shortcuts. (What executors make of it: `microquad_runs`.)

use umbra4_core::{
    LatticeLight, MaskWord, PairWord,
    glam::{DVec2, DVec3, IVec3},
    jitter::{Jitter, Pattern, Samples},
};
use umbra4_maps::{
    arithmetic::Arithmetic,
    draw,
    microquad::{
        Field, Footprint, HalfSpaces, MapOptions, MicroOccluders, MicroquadError, MicroquadOptions, area,
        fit::{self, LightAxes, Tangents},
        gather::{self, ByArea, ByRectangles, ByRows, ByTable, Gathered},
        half_spaces,
        hull::{self, Hull},
        params::MicroquadParams,
        projection::{Point, Viewer},
        rectangles, rows,
        search::{self, Found},
    },
    pyramid::{self, Node},
    shadow_map::texel,
};
use umbra4_tests::{budget, rng::Rng};

const A: Arithmetic = Arithmetic::new(0);

fn light(rows: u32, columns: u32, jitter: Jitter) -> LatticeLight {
    let (step_u, step_v) = (IVec3::new(320, 64, -32), IVec3::new(-32, 96, 384));
    LatticeLight { origin: IVec3::new(1000, 9_000_000, -500), step_u, step_v, rows, columns, jitter }
}

/// Somewhere before that light: `far` is the depth in light widths.
fn before(rng: &mut Rng, light: &LatticeLight, far: f64, spread: f64) -> IVec3 {
    let (u, v) = (light.step_u.as_dvec3() * f64::from(light.columns), light.step_v.as_dvec3() * f64::from(light.rows));
    let normal = u.cross(v).normalize() * u.length();
    let off = u * rng.real(spread * far) + v * rng.real(spread * far) + normal * far;
    light.origin + off.round().as_ivec3()
}

fn options(size: u32, occluders: MicroOccluders, footprint: Footprint) -> MicroquadOptions {
    MicroquadOptions { map: MapOptions { size, ..MapOptions::default() }, occluders, footprint }
}

/// Of receivers some widths before the light.
fn params(rng: &mut Rng, options: &MicroquadOptions, light: &LatticeLight) -> (MicroquadParams, Vec<IVec3>) {
    let receivers: Vec<IVec3> = (0..40)
        .map(|_| {
            let far = 2.0 + rng.unit() * 3.0;
            before(rng, light, far, 0.3)
        })
        .collect();
    let axes = LightAxes::new(light);
    let tangents = receivers.iter().fold(Tangents::NONE, |t, p| t.with(&axes, options.map.widest, *p));
    let params = fit::params(options, light, &tangents, f64::INFINITY);
    (params, receivers)
}

fn point(p: Point) -> DVec2 {
    DVec2::new(f64::from(p.x), f64::from(p.y))
}

/// Gift wrapping, of points on a small integer grid: exact.
fn wrapped(points: &[DVec2]) -> Vec<DVec2> {
    let mut start = points[0];
    for &p in points {
        if (p.x, p.y) < (start.x, start.y) {
            start = p;
        }
    }
    let (mut hull, mut at) = (vec![], start);
    loop {
        hull.push(at);
        let Some(mut next) = points.iter().copied().find(|p| *p != at) else { return hull };
        for &p in points {
            let turn = (next - at).perp_dot(p - at);
            if p != at && (turn < 0.0 || turn == 0.0 && p.distance(at) > next.distance(at)) {
                next = p;
            }
        }
        at = next;
        if at == start {
            return hull;
        }
    }
}

fn doubled_area(polygon: &[DVec2]) -> f64 {
    (0..polygon.len()).map(|i| polygon[i].perp_dot(polygon[(i + 1) % polygon.len()])).sum()
}

fn corners(hull: &Hull) -> Vec<DVec2> {
    hull.corners.iter().take(hull.count as usize).map(|p| point(*p)).collect()
}

#[test]
fn hulls_are_those_of_gift_wrapping() {
    let mut rng = Rng::named(0, "hulls");
    let (mut by_count, mut inside) = ([0; 5], 0);
    for round in 0..budget::of(200_000) {
        let extent = [2, 3, 7, 40][round % 4];
        let mut v = [Point::default(); 4];
        v.fill_with(|| Point { x: rng.around(extent) as f32, y: rng.around(extent) as f32 });
        let three = round % 5 == 0;
        let given: Vec<DVec2> = v.iter().take(if three { 3 } else { 4 }).map(|p| point(*p)).collect();
        let found = if three { hull::of_three(A, v[0], v[1], v[2]) } else { hull::of_four(A, v) };
        let found = corners(&found);
        let expected = wrapped(&given);
        let area = if expected.len() < 3 { 0.0 } else { doubled_area(&expected) };
        by_count[found.len()] += 1;
        if area == 0.0 {
            assert!(found.is_empty(), "{given:?}");
            continue;
        }
        assert_eq!(doubled_area(&found), area, "{given:?} → {found:?}");
        assert!(found.iter().all(|p| given.contains(p)), "{given:?} → {found:?}");
        for (i, p) in found.iter().enumerate() {
            let q = found[(i + 1) % found.len()];
            assert!(given.iter().all(|r| (q - *p).perp_dot(*r - *p) >= 0.0), "{given:?} → {found:?}");
        }
        inside += usize::from(found.len() == 3 && given.len() == 4);
    }
    assert!(by_count[0] > 1000 && by_count[3] > 1000 && by_count[4] > 1000 && inside > 1000, "{by_count:?} {inside}");
}

/// The fourth corner in each of the seven places around a triangle, whichever way that turns.
#[test]
fn all_seven_cases_are_met() {
    let triangle = [(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)];
    let fourth = [(1.0, 1.0), (3.0, 3.0), (-2.0, 1.0), (1.0, -2.0), (-1.0, -1.0), (9.0, -2.0), (-2.0, 9.0)];
    let expected = [3, 4, 4, 4, 3, 3, 3];
    for turned in [false, true] {
        for ((x, y), count) in fourth.into_iter().zip(expected) {
            let mut v = triangle.map(|(x, y)| Point { x, y });
            if turned {
                v.swap(1, 2);
            }
            let found = hull::of_four(A, [v[0], v[1], v[2], Point { x, y }]);
            assert_eq!(found.count, count, "{x} {y}");
            let all: Vec<DVec2> = v.iter().map(|p| point(*p)).chain([DVec2::new(x.into(), y.into())]).collect();
            assert_eq!(doubled_area(&corners(&found)), doubled_area(&wrapped(&all)));
        }
    }
}

/// How far inside of a hull a place is: negative outside.
fn depth_inside(hull: &[DVec2], p: DVec2) -> f64 {
    let edge = |i: usize| {
        let (from, to) = (hull[i], hull[(i + 1) % hull.len()]);
        if from == to { f64::INFINITY } else { (to - from).normalize().perp_dot(p - from) }
    };
    (0..hull.len()).map(edge).fold(f64::INFINITY, f64::min)
}

fn bit<W: MaskWord>(mask: &rows::Mask<W>, row: u32, column: u32) -> bool {
    mask[row as usize].bit(column)
}

fn rows_are_the_samples_inside<W: MaskWord>(sizes: &[(u32, u32)]) {
    let mut rng = Rng::named(1, "rows");
    let mut compared = 0;
    for round in 0..budget::of(1200) {
        let (rows_, columns) = sizes[round % sizes.len()];
        let light = light(rows_, columns, Jitter::NONE);
        let (params, _) = params(&mut rng, &options(16, MicroOccluders::Microtris, Footprint::Rows), &light);
        let scale = [0.5, 3.0, 20.0, 5000.0][rng.below(4)];
        let center = DVec2::new(rng.real(40.0), rng.real(40.0)) + 16.0;
        let mut v = [Point::default(); 4];
        v.fill_with(|| Point { x: (center.x + rng.real(scale)) as f32, y: (center.y + rng.real(scale)) as f32 });
        if rng.one_in(4) {
            // Horizontal and vertical edges, on samples and off them.
            v[1].y = v[0].y.round();
            v[0].y = v[1].y;
            v[2].x = v[1].x;
        }
        let hull = hull::of_four(A, v);
        let mut mask = [W::EMPTY; 64];
        rows::fill(A, &params, &hull, &mut mask);
        let polygon = corners(&hull);
        // Rounding moves an edge by some units in the last place of its corners.
        let blurred = 1e-6 * scale.max(64.0);
        for row in 0..64 {
            for column in 0..W::BITS {
                let inside = depth_inside(&polygon, DVec2::new(column.into(), row.into()));
                let there = row < rows_ && column < columns && hull.count > 0;
                if !there || inside.abs() > blurred {
                    assert_eq!(bit(&mask, row, column), there && inside > 0.0, "{row} {column} {hull:?}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 800_000);
}

#[test]
fn rows_are_the_samples_inside_16() {
    rows_are_the_samples_inside::<u16>(&[(16, 16), (8, 8), (1, 1), (64, 13)]);
}

#[test]
fn rows_are_the_samples_inside_32() {
    rows_are_the_samples_inside::<u32>(&[(32, 32), (16, 16), (5, 31)]);
}

#[test]
fn rows_are_the_samples_inside_64() {
    rows_are_the_samples_inside::<u64>(&[(64, 64), (33, 63), (64, 1)]);
    rows_are_the_samples_inside::<PairWord>(&[(64, 64), (17, 40)]);
}

/// A distorted grid of quads, cut into triangles, covers the light: each sample lies in one triangle, whatever rounding does.
#[test]
fn triangles_that_share_edges_share_no_sample_and_miss_none() {
    let mut rng = Rng::named(2, "mesh");
    for round in 0..budget::of(400) {
        let light = light(32, 32, Jitter::NONE);
        let (params, _) = params(&mut rng, &options(16, MicroOccluders::Microtris, Footprint::Rows), &light);
        let step = [1.0, 2.0, 3.3, 9.0][round % 4];
        let side = (40.0 / step) as usize + 2;
        let mut corner = |i: usize, j: usize| {
            // Some on samples, some not.
            let off = |rng: &mut Rng| if rng.one_in(3) { 0.0 } else { rng.real(0.3 * step) };
            let (x, y) = (i as f64 * step - 4.0 + off(&mut rng), j as f64 * step - 4.0 + off(&mut rng));
            let whole = rng.one_in(3);
            let as_point = |v: f64| if whole { v.round() as f32 } else { v as f32 };
            if step > 2.5 { Point { x: as_point(x), y: as_point(y) } } else { Point { x: x as f32, y: y as f32 } }
        };
        let grid: Vec<Vec<Point>> = (0..side).map(|j| (0..side).map(|i| corner(i, j)).collect()).collect();
        let (mut sum, mut all) = ([0_u32; 64], 0_u64);
        for j in 0..side - 1 {
            for i in 0..side - 1 {
                let [p, q, r, s] = [grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i]];
                for [a, b, c] in [[p, q, r], [p, r, s]] {
                    let hull = hull::of_three(A, a, b, c);
                    // Folded ones would overlap.
                    if hull.count == 3 && hull.corners[1] != b {
                        continue;
                    }
                    let mut mask = [0_u32; 64];
                    rows::fill(A, &params, &hull, &mut mask);
                    for (sum, row) in sum.iter_mut().zip(mask) {
                        assert_eq!(*sum & row, 0, "a sample in two triangles");
                        *sum |= row;
                        all += u64::from(row.count_ones());
                    }
                }
            }
        }
        assert_eq!(all, 1024, "step {step}");
    }
}

/// Where the samples of a light lie.
fn samples(light: &LatticeLight) -> Vec<DVec2> {
    let pattern = Pattern::of(light);
    (0..light.rows as usize)
        .flat_map(|i| (0..light.columns as usize).map(move |j| (i, j)))
        .map(|(i, j)| {
            if light.jitter.is_some() {
                let place = pattern.place(i, j);
                DVec2::new(place.column.into(), place.row.into())
            } else {
                DVec2::new(j as f64, i as f64)
            }
        })
        .collect()
}

fn table(light: &LatticeLight, fineness: HalfSpaces) -> Vec<u32> {
    let mut words = vec![0; half_spaces::table_length(light, fineness)];
    let entry = words.len() / (fineness.directions * fineness.distances) as usize;
    for (index, rows) in words.chunks_exact_mut(entry).enumerate() {
        half_spaces::write_entry(light, fineness, index, rows);
    }
    words
}

const TABLE_LIGHTS: [(u32, u32, Jitter); 5] = [
    (8, 8, Jitter::NONE),
    (16, 16, Jitter::pattern(3)),
    (32, 32, Jitter::pattern(77)),
    (9, 64, Jitter::NONE),
    (33, 40, Jitter::pattern(5)),
];

#[test]
fn opposite_half_spaces_share_no_sample_and_miss_none() {
    for (rows, columns, jitter) in TABLE_LIGHTS {
        let light = light(rows, columns, jitter);
        for (directions, distances) in [(4, 2), (16, 9), (64, 32)] {
            let fineness = HalfSpaces { directions, distances };
            let table = table(&light, fineness);
            let entry = table.len() / (directions * distances) as usize;
            let all: u32 = rows * columns;
            let bits = |index: u32| &table[index as usize * entry..][..entry];
            for direction in 0..directions {
                assert_eq!(
                    bits(direction * distances).iter().map(|w| w.count_ones()).sum::<u32>(),
                    all,
                    "the nearest end"
                );
                assert!(bits(direction * distances + distances - 1).iter().all(|w| *w == 0), "the farthest end");
                for distance in 0..distances {
                    let there = bits(direction * distances + distance);
                    let reverse =
                        bits((direction + directions / 2) % directions * distances + distances - 1 - distance);
                    assert!(there.iter().zip(reverse).all(|(a, b)| a & b == 0));
                    assert_eq!(there.iter().chain(reverse).map(|w| w.count_ones()).sum::<u32>(), all);
                }
            }
        }
    }
}

/// The line that an entry stands for, measured with a ruler: how far it is from the edge that asked for it.
#[test]
fn entries_are_lines_near_the_edges_that_ask_for_them() {
    let mut rng = Rng::named(4, "entries");
    for (rows, columns, jitter) in TABLE_LIGHTS {
        let light = light(rows, columns, jitter);
        let fineness = HalfSpaces { directions: 128, distances: 128 };
        let (params, _) = params(&mut rng, &options(16, MicroOccluders::Microtris, Footprint::Table(fineness)), &light);
        let half = DVec2::new(f64::from(columns), f64::from(rows)) * 0.5;
        let [low, _] = rectangles::light(&params).map(point);
        let middle = low + half;
        for round in 0..budget::of(20_000) {
            let scale = [1.0, 10.0, 100.0][round % 3];
            let mut place = || {
                let p = middle + DVec2::new(rng.real(half.x), rng.real(half.y)) * scale;
                Point { x: p.x as f32, y: p.y as f32 }
            };
            let (p, q) = (place(), place());
            let index = half_spaces::entry(A, &params, p, q);
            assert!(index < fineness.directions * fineness.distances);
            let [x, y, distance] = half_spaces::line(fineness, index as usize);
            // The edge's own, on the light that spans −1 to 1: the left side is inside.
            let (p, q) = ((point(p) - middle) / half, (point(q) - middle) / half);
            let normal = (q - p).perp();
            let normal = normal / (normal.x.abs() + normal.y.abs());
            assert!((normal.x - x).abs() <= 2.1 / 128.0 && (normal.y - y).abs() <= 2.1 / 128.0, "{normal} {x} {y}");
            let own = normal.dot(p).clamp(-1.0, 1.0);
            assert!((own - distance).abs() <= 1.01 / 127.0, "{own} {distance}");
        }
    }
}

fn table_masks_are_near_the_hull<W: half_spaces::TableWord>(lights: &[(u32, u32, Jitter)]) {
    let mut rng = Rng::named(5, "table masks");
    for &(rows, columns, jitter) in lights {
        let light = light(rows, columns, jitter);
        let fineness = HalfSpaces { directions: 256, distances: 256 };
        let (params, _) = params(&mut rng, &options(16, MicroOccluders::Microtris, Footprint::Table(fineness)), &light);
        let (table, places) = (table(&light, fineness), samples(&light));
        let (mut wrong, mut all) = (0, 0);
        for _ in 0..budget::of(300) {
            let mut v = [Point::default(); 4];
            v.fill_with(|| Point {
                x: (rng.unit() * 1.5 - 0.25) as f32 * columns as f32,
                y: (rng.unit() * 1.5 - 0.25) as f32 * rows as f32,
            });
            let hull = hull::of_four(A, v);
            if hull.count == 0 {
                continue;
            }
            let mut mask = [W::EMPTY; 64];
            half_spaces::fill(A, &params, &table, &hull, &mut mask);
            // By brute force: the entries' own lines, sample by sample.
            let (middle, half) = (
                point(rectangles::light(&params)[0]) + DVec2::new(columns.into(), rows.into()) * 0.5,
                DVec2::new(columns.into(), rows.into()) * 0.5,
            );
            let count = hull.count as usize;
            let lines: Vec<[f64; 3]> = (0..count)
                .map(|k| half_spaces::entry(A, &params, hull.corners[k], hull.corners[(k + 1) % count]))
                .map(|index| half_spaces::line(fineness, index as usize))
                .collect();
            let polygon = corners(&hull);
            for (k, place) in places.iter().enumerate() {
                let (row, column) = (k as u32 / columns, k as u32 % columns);
                let on = (*place - middle) / half;
                let beyond = lines.iter().map(|[x, y, d]| x * on.x + y * on.y - d).fold(f64::INFINITY, f64::min);
                if beyond.abs() > 1e-12 {
                    assert_eq!(bit(&mask, row, column), beyond > 0.0);
                }
                let inside = depth_inside(&polygon, *place);
                all += 1;
                if bit(&mask, row, column) != (inside > 0.0) {
                    wrong += 1;
                    // What directions and distances between entries can move an edge by, within the light.
                    assert!(inside.abs() < 0.04 * f64::from(rows.max(columns)), "{inside} {hull:?}");
                }
            }
            let beyond = (0..64).flat_map(|row| (0..W::BITS).map(move |column| (row, column)));
            let beyond = beyond.filter(|(row, column)| *row >= rows || *column >= columns);
            assert!(beyond.into_iter().all(|(row, column)| !bit(&mask, row, column)));
        }
        assert!(f64::from(wrong) < 0.02 * f64::from(all), "{rows} × {columns}: {wrong} of {all}");
    }
}

#[test]
fn table_masks_are_near_the_hull_in_all_words() {
    table_masks_are_near_the_hull::<u16>(&TABLE_LIGHTS[..2]);
    table_masks_are_near_the_hull::<u32>(&TABLE_LIGHTS[..3]);
    table_masks_are_near_the_hull::<u64>(&TABLE_LIGHTS[3..]);
    table_masks_are_near_the_hull::<PairWord>(&TABLE_LIGHTS[3..]);
}

#[test]
fn rectangles_and_areas_are_those_of_direct_evaluation() {
    let mut rng = Rng::named(6, "rectangles");
    for _ in 0..budget::of(20_000) {
        let (rows_, columns) = rng.pick(&[(8, 8), (16, 16), (32, 32), (5, 31)]);
        let light = light(rows_, columns, Jitter::NONE);
        let (params, _) = params(&mut rng, &options(16, MicroOccluders::Microquads, Footprint::Rectangles), &light);
        let mut v = [Point::default(); 4];
        v.fill_with(|| Point { x: rng.real(40.0) as f32, y: rng.real(40.0) as f32 });
        let (low, high) = (DVec2::splat(-0.5), DVec2::new(columns.into(), rows_.into()) - 0.5);
        let c = v.map(|p| point(p).clamp(low, high));
        let (x, y) =
            (((c[0].x + c[3].x) / 2.0, (c[1].x + c[2].x) / 2.0), ((c[0].y + c[1].y) / 2.0, (c[2].y + c[3].y) / 2.0));
        let mut mask = [0_u32; 64];
        rectangles::fill(&params, rectangles::of_quad(A, &params, v), &mut mask);
        for row in 0..64 {
            for column in 0..32 {
                let within = |v: u32, (a, b): (f64, f64)| (a.min(b)..a.max(b)).contains(&f64::from(v));
                let near = |v: u32, (a, b): (f64, f64)| (a - f64::from(v)).abs().min((b - f64::from(v)).abs()) < 1e-5;
                if !near(column, x) && !near(row, y) {
                    assert_eq!(bit(&mask, row, column), within(column, x) && within(row, y));
                }
            }
        }
        let expected = (0.5 * (c[1] - c[0]).perp_dot(c[2] - c[0]) + 0.5 * (c[2] - c[0]).perp_dot(c[3] - c[0])).abs();
        assert!((f64::from(area::of_quad(A, &params, v)) - expected).abs() < 1e-3);
        let clipped = (point(v[1]).clamp(low, high) - point(v[0]).clamp(low, high)).max(DVec2::ZERO);
        assert!((f64::from(area::of_rectangle(A, &params, [v[0], v[1]])) - clipped.x * clipped.y).abs() < 1e-3);
    }
}

/// The line from a receiver through a point, on to the light's plane: by ruler, in the world, in f64.
#[test]
fn projected_texels_lie_where_lines_meet_the_light() {
    let mut rng = Rng::named(7, "projection");
    let mut compared = 0;
    for round in 0..budget::of(2000) {
        let jitter = if round % 2 == 0 { Jitter::NONE } else { Jitter::pattern(9) };
        let light = light(32, 16, jitter);
        let (params, receivers) = params(&mut rng, &options(256, MicroOccluders::Microtris, Footprint::Area), &light);
        let frame = params.frame();
        let receiver = receivers[0];
        let viewer = Viewer::new(A, &params, receiver);
        let normal = light.step_u.as_dvec3().cross(light.step_v.as_dvec3());
        for _ in 0..20 {
            // Somewhere between the receiver and around the light.
            let target = light.sample(rng.below(32) as u32, rng.below(16) as u32) + rng.point(9000);
            let between = 0.2 + 0.6 * rng.unit();
            let occluder = receiver + ((target - receiver).as_dvec3() * between).round().as_ivec3();
            let on = frame.place(A, occluder);
            let inverse = 1.0 / on.z;
            if !(on.z > 1.0 && inverse > viewer.threshold) {
                continue;
            }
            let found = viewer.project(A, &params, on.x * inverse - 0.5, on.y * inverse - 0.5, inverse);
            let (p, q) = ((receiver - light.origin).as_dvec3(), (occluder - light.origin).as_dvec3());
            let hit = p + (q - p) * (p.dot(normal) / (p - q).dot(normal));
            let (u, v) = (light.step_u.as_dvec3(), light.step_v.as_dvec3());
            let column = hit.cross(v).dot(normal) / u.cross(v).dot(normal);
            let row = u.cross(hit).dot(normal) / u.cross(v).dot(normal);
            let error = (f64::from(found.x) - column).abs().max((f64::from(found.y) - row).abs());
            let size = column.abs().max(row.abs());
            assert!(error < 0.02 + 1e-4 * size, "{found:?}, not {column} {row}");
            compared += 1;
        }
    }
    assert!(compared > 10_000, "{compared}");
}

/// Rays from the light's centre through texel centres, one by one, in f64.
#[test]
fn drawn_triangles_are_those_that_rays_meet() {
    let mut rng = Rng::named(8, "draw");
    let light = light(32, 32, Jitter::NONE);
    let axes = LightAxes::new(&light);
    let (mut covered, mut uncovered, mut small) = (0, 0, 0);
    for round in 0..budget::of(600) {
        let mut options = options(64, MicroOccluders::Microtris, Footprint::Rows);
        options.map.slope_bias = 0.0;
        let (params, _) = params(&mut rng, &options, &light);
        let frame = params.frame();
        let far = 1.0 + 3.0 * rng.unit();
        let around = before(&mut rng, &light, far, 0.3);
        let extent = [200, 3000, 20_000, 200_000][round % 4];
        let corners = [(); 3].map(|()| around + rng.point(extent));
        let drawing = draw::set_up(A, frame, corners);
        // The map's own camera, from its corners: a place on the map → a ray in the light's frame.
        let at = corners.map(|c| axes.place(c));
        let normal = (at[1] - at[0]).cross(at[2] - at[0]);
        let unit = IVec3::new(frame_center(&light).x, frame_center(&light).y, frame_center(&light).z);
        let step = |p: IVec3| {
            let p = frame.place(A, unit + p);
            DVec3::new(p.x.into(), p.y.into(), p.z.into())
        };
        // Columns of the matrix that places points, from three points.
        let big = 1 << 22;
        let (x, y, z) = (
            step(IVec3::X * big) / f64::from(big),
            step(IVec3::Y * big) / f64::from(big),
            step(IVec3::Z * big) / f64::from(big),
        );
        let matrix = umbra4_core::glam::DMat3::from_cols(x, y, z);
        let back = matrix.inverse();
        for ty in 0..64_u32 {
            for tx in 0..64_u32 {
                let word = if (drawing.columns[0]..drawing.columns[1]).contains(&tx)
                    && (drawing.rows[0]..drawing.rows[1]).contains(&ty)
                {
                    drawing.texel(A, tx, ty)
                } else {
                    0
                };
                let ray = back * DVec3::new(f64::from(tx) + 0.5, f64::from(ty) + 0.5, 1.0);
                let world = corners.map(|c| (c - unit).as_dvec3());
                let n = (world[1] - world[0]).cross(world[2] - world[0]);
                let depth = n.dot(world[0]) / n.dot(ray);
                let hit = ray * depth;
                let sides = [0, 1, 2].map(|k| {
                    let (p, q) = (world[k], world[(k + 1) % 3]);
                    (q - p).cross(hit - p).dot(n) / (n.length() * (q - p).length())
                });
                let least = sides.into_iter().fold(f64::INFINITY, f64::min);
                // Edges are moved by a thousandth of a texel, which grows with the depth: a multiple of that, for tilted triangles.
                let near = 20.0 * depth.abs().max(1.0);
                if normal.length() < 1e4 || !depth.is_finite() || least.abs() < near {
                    continue;
                }
                let inside = least > 0.0 && depth >= 1.0;
                assert_eq!(word != 0, inside, "{corners:?} {tx} {ty}: {least} {depth}");
                if inside {
                    let inverse = f64::from(f32::from_bits(word));
                    assert!((inverse * depth - 1.0).abs() < 1e-3, "{inverse} {}", 1.0 / depth);
                    covered += 1;
                    small += usize::from(round % 4 == 0);
                } else {
                    uncovered += 1;
                }
            }
        }
    }
    assert!(covered > 5_000 && uncovered > 100_000, "{covered} {uncovered} {small}");
}

fn frame_center(light: &LatticeLight) -> IVec3 {
    let (u, v) = (light.step_u.as_dvec3(), light.step_v.as_dvec3());
    let middle = u * ((f64::from(light.columns) - 1.0) / 2.0) + v * ((f64::from(light.rows) - 1.0) / 2.0);
    (light.origin.as_dvec3() + middle).round().as_ivec3()
}

fn pyramid_of(map: &[u32], size: u32) -> Vec<Node> {
    let mut nodes = vec![Node::default(); pyramid::start(size, pyramid::levels(size)) as usize];
    for index in 0..pyramid::start(size, 1) {
        nodes[index as usize] = pyramid::tile(map, size, index);
    }
    for level in 1..pyramid::levels(size) {
        for index in 0..pyramid::start(size, level + 1) - pyramid::start(size, level) {
            nodes[(pyramid::start(size, level) + index) as usize] = pyramid::parent(&nodes, size, level, index);
        }
    }
    nodes
}

/// A map with walls, slopes, noise and holes.
fn map(rng: &mut Rng, size: u32, least: f32) -> Vec<u32> {
    let mut map = vec![0_u32; (size * size) as usize];
    let noise = if rng.one_in(2) { 0.02 } else { 0.0 };
    let whole = rng.one_in(3);
    for k in 0..1 + rng.below(6) {
        let mut ends = [(); 4].map(|()| rng.below(size as usize) as u32);
        if whole && k == 0 {
            ends = [0, size - 1, 0, size - 1];
        }
        let [x0, x1, y0, y1] = ends;
        let (base, along, across) = (rng.unit(), rng.real(0.01), rng.real(0.01));
        for y in y0.min(y1)..=y0.max(y1) {
            for x in x0.min(x1)..=x0.max(x1) {
                let inverse = (base + along * f64::from(x) + across * f64::from(y) + rng.real(noise)) as f32;
                let word = if inverse > least && inverse <= 1.0 { inverse.to_bits() } else { 0 };
                let texel = &mut map[(y * size + x) as usize];
                *texel = (*texel).max(word);
            }
        }
    }
    map
}

#[test]
fn nodes_hold_the_extremes_of_their_texels() {
    let mut rng = Rng::named(9, "pyramid");
    for size in [16, 32, 64, 128] {
        let map = map(&mut rng, size, 0.0);
        let nodes = pyramid_of(&map, size);
        let inverse = |x: u32, y: u32| f32::from_bits(texel(&map, size, x, y));
        for level in 0..pyramid::levels(size) {
            let side = pyramid::tiles(size) >> level;
            let quads = pyramid::TILE << level;
            for index in 0..side * side {
                let (x, y) = (index % side * quads, index / side * quads);
                let texels = (y..=y + quads).flat_map(|y| (x..=x + quads).map(move |x| (x, y)));
                let all: Vec<f32> = texels.map(|(x, y)| inverse(x, y)).collect();
                let node = nodes[(pyramid::start(size, level) + index) as usize];
                assert_eq!(node.most, all.iter().copied().fold(0.0, f32::max));
                assert_eq!(node.least, all.iter().copied().fold(f32::MAX, f32::min));
            }
        }
        let tiles = pyramid::tiles(size) as usize;
        for _ in 0..2000 {
            let [a, b, c, d] = [(); 4].map(|()| rng.below(tiles) as u32);
            let (x, y) = ([a.min(b), a.max(b)], [c.min(d), c.max(d)]);
            let found = pyramid::around(&nodes, size, x, y);
            for ty in y[0]..=y[1] {
                for tx in x[0]..=x[1] {
                    let node = pyramid::of_tile(&nodes, size, tx, ty);
                    assert!(node.most <= found.most && node.least >= found.least);
                }
            }
        }
    }
}

/// All micro-occluders of a map, one after the other, as section 2 has them, without search and without tiles.
fn brute_force<G: Gathered>(
    params: &MicroquadParams,
    kind: MicroOccluders,
    map: &[u32],
    table: &[u32],
    viewer: &Viewer,
    out: &mut G,
) {
    let size = params.frame().size();
    let corner = |x: u32, y: u32| {
        let inverse = f32::from_bits(texel(map, size, x, y));
        (inverse > viewer.threshold).then(|| viewer.project(A, params, x as f32, y as f32, inverse))
    };
    for y in 0..size {
        for x in 0..size {
            if kind == MicroOccluders::Micropatches {
                let inverse = f32::from_bits(texel(map, size, x, y));
                if inverse > viewer.threshold {
                    let at = |dx: f32, dy: f32| viewer.project(A, params, x as f32 + dx, y as f32 + dy, inverse);
                    out.add_rectangle(A, params, table, [at(-0.5, -0.5), at(0.5, 0.5)]);
                }
                continue;
            }
            let all = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            let there: Vec<Point> = all.into_iter().flatten().collect();
            match there[..] {
                [p, q, r, s] => out.add_quad(A, params, table, [p, q, r, s], 4),
                [p, q, r] if kind == MicroOccluders::Microtris => out.add_quad(A, params, table, [p, q, r, p], 3),
                _ => {}
            }
        }
    }
}

/// The way a receiver goes, against brute force; and how often each way was gone.
fn searched<G: Gathered + Clone>(
    kind: MicroOccluders,
    footprint: Footprint,
    jitter: Jitter,
    empty: &G,
    same: impl Fn(&G, &G) -> bool,
) -> [u32; 3] {
    let mut rng = Rng::named(10, "search");
    let mut ways = [0; 3];
    for _ in 0..budget::of(20) {
        let light = light(16, 16, jitter);
        let (params, receivers) = params(&mut rng, &options(64, kind, footprint), &light);
        let table = match footprint {
            Footprint::Table(fineness) => table(&light, fineness),
            _ => Vec::new(),
        };
        let map = map(&mut rng, 64, 0.05);
        let nodes = pyramid_of(&map, 64);
        for p in receivers {
            let viewer = Viewer::new(A, &params, p);
            let (mut found, mut expected) = (empty.clone(), empty.clone());
            gather::gather(&params, &map, &nodes, &table, p, &mut found);
            brute_force(&params, kind, &map, &table, &viewer, &mut expected);
            let dark = G::CLOSED && kind != MicroOccluders::Micropatches;
            let (way, _) = search::search(A, &params, &nodes, &viewer, dark);
            ways[match way {
                Found::Lit => 0,
                Found::Dark => 1,
                Found::Some => 2,
            }] += 1;
            assert!(same(&found, &expected), "{kind:?} {footprint:?}, {way:?}");
        }
    }
    ways
}

#[test]
fn searches_lose_nothing_by_rows() {
    for kind in [MicroOccluders::Microquads, MicroOccluders::Microtris, MicroOccluders::Micropatches] {
        let same = |a: &ByRows<u16>, b: &ByRows<u16>| a.mask == b.mask;
        let ways = searched(kind, Footprint::Rows, Jitter::NONE, &ByRows::of([0; 64]), same);
        assert!(ways[0] > 20 && ways[2] > 100, "{ways:?}");
        assert!(kind == MicroOccluders::Micropatches || ways[1] > 5, "{ways:?}");
    }
}

#[test]
fn searches_lose_nothing_by_table_and_fill_its_cracks() {
    let fineness = HalfSpaces { directions: 64, distances: 64 };
    for kind in [MicroOccluders::Microquads, MicroOccluders::Microtris] {
        // In the dark, a table may leave samples open between footprints; nothing else differs.
        let same = |a: &ByTable<u16>, b: &ByTable<u16>| {
            let full = a.mask.iter().take(16).all(|row| *row == u16::MAX);
            a.mask == b.mask || full && b.mask.iter().map(|row| row.count_ones()).sum::<u32>() > 200
        };
        for jitter in [Jitter::NONE, Jitter::pattern(6)] {
            let ways = searched(kind, Footprint::Table(fineness), jitter, &ByTable::of([0; 64]), same);
            assert!(ways[0] > 20 && ways[2] > 100, "{ways:?}");
        }
    }
}

#[test]
fn searches_lose_nothing_by_rectangles_and_areas() {
    let same = |a: &ByRectangles<u32>, b: &ByRectangles<u32>| a.mask == b.mask;
    searched(MicroOccluders::Microquads, Footprint::Rectangles, Jitter::NONE, &ByRectangles::of([0; 64]), same);
    // Sums in another order; past the whole light they are not continued.
    let same = |a: &ByArea, b: &ByArea| (a.0.min(256.0) - b.0.min(256.0)).abs() < 0.05;
    for kind in [MicroOccluders::Microquads, MicroOccluders::Microtris, MicroOccluders::Micropatches] {
        searched(kind, Footprint::Area, Jitter::pattern(1), &ByArea::default(), same);
    }
}

#[test]
fn receivers_behind_the_light_are_dark() {
    let light = light(8, 8, Jitter::NONE);
    let mut rng = Rng::named(11, "behind");
    let (params, _) = params(&mut rng, &options(16, MicroOccluders::Microtris, Footprint::Rows), &light);
    let normal = light.step_u.as_dvec3().cross(light.step_v.as_dvec3()).normalize();
    for (far, expected) in [(-1e6, 0xff), (0.0, 0xff), (1e3, 0), (1e6, 0)] {
        let p = light.origin + (normal * far).round().as_ivec3();
        let mut mask = ByRows::of([0_u16; 64]);
        gather::gather(&params, &[0; 256], &pyramid_of(&[0; 256], 16), &[], p, &mut mask);
        let behind = (p - light.origin).as_dvec3().dot(normal) <= 0.0;
        let expected = if behind { 0xff } else { expected };
        assert!(mask.mask.iter().take(8).all(|row| *row == expected), "{far}");
        assert!(mask.mask.iter().skip(8).all(|row| *row == 0));
    }
}

#[test]
fn bad_options_are_refused_by_name_and_value() {
    let (regular, jittered) = (light(8, 8, Jitter::NONE), light(8, 8, Jitter::pattern(1)));
    let default = MicroquadOptions::default();
    assert_eq!(default.check(&regular), Ok(()));
    for value in [0, 1, 8, 15, 17, 100, 8192, u32::MAX] {
        let bad = MicroquadOptions { map: MapOptions { size: value, ..default.map }, ..default };
        let error = bad.check(&regular).expect_err("no such size");
        assert_eq!(error, MicroquadError::MapSize { value });
        assert!(error.to_string().contains("map.size") && error.to_string().contains(&value.to_string()));
    }
    let with = |field: Field, value: f32| {
        let mut map = default.map;
        *match field {
            Field::Near => &mut map.near,
            Field::Widest => &mut map.widest,
            Field::SlopeBias => &mut map.slope_bias,
            Field::DepthBias => &mut map.depth_bias,
        } = value;
        MicroquadOptions { map, ..default }
    };
    for field in [Field::Near, Field::Widest, Field::SlopeBias, Field::DepthBias] {
        for value in [-1.0, f32::NAN, f32::INFINITY, 1e9] {
            let error = with(field, value).check(&regular).expect_err("out of range");
            assert!(matches!(error, MicroquadError::OutOfRange { field: f, .. } if f == field), "{error}");
            assert!(error.to_string().contains(&field.to_string()), "{error}");
        }
    }
    let by = |occluders, footprint| MicroquadOptions { occluders, footprint, ..default };
    for value in [0, 2, 6, 1028, u32::MAX] {
        let footprint = Footprint::Table(HalfSpaces { directions: value, distances: 64 });
        let error = by(MicroOccluders::Microtris, footprint).check(&regular);
        assert_eq!(error, Err(MicroquadError::Directions { value }));
    }
    for value in [0, 1, 1025] {
        let footprint = Footprint::Table(HalfSpaces { directions: 64, distances: value });
        let error = by(MicroOccluders::Microtris, footprint).check(&regular);
        assert_eq!(error, Err(MicroquadError::Distances { value }));
    }
    let tris = by(MicroOccluders::Microtris, Footprint::Rectangles);
    assert_eq!(tris.check(&regular), Err(MicroquadError::TrisAsRectangles));
    let rows = Err(MicroquadError::JitteredSamples { footprint: "Rows" });
    assert_eq!(default.check(&jittered), rows);
    let rectangles = by(MicroOccluders::Microquads, Footprint::Rectangles);
    assert_eq!(rectangles.check(&jittered), Err(MicroquadError::JitteredSamples { footprint: "Rectangles" }));
    for footprint in [Footprint::Area, Footprint::Table(HalfSpaces::default())] {
        assert_eq!(by(MicroOccluders::Microtris, footprint).check(&jittered), Ok(()));
    }
}
