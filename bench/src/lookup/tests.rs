//! Tables against the masks of core's rows, and both against the integers, one sample at a time.

use umbra4_core::{
    AreaLight, Bounds as Box3, Exact, Jitter, Lattice, LatticeLight, Lift, MaskWord,
    exact::{self, Wide},
    glam::{DVec3, IVec3},
    lanes::TILE,
    stage::resolve::Group,
};
use umbra4_cpu::Isa;
use umbra4_tests::rng::Rng;

use super::{
    cells::{Cells, Placed},
    fill::{Fill, GroupMasks, Plain, Repaired, Rows, lanes_of},
    isa::run,
    pairs::{GroupPairs, offered},
    table::{Bounds, Nearest, Table},
};

/// A light of `n` × `n` samples, high above the origin.
fn light(rng: &mut Rng, n: u32) -> LatticeLight {
    let mut around = |extent| rng.around(extent);
    LatticeLight {
        origin: IVec3::new(around(9_000), 900_000 + around(9_000), around(9_000)),
        step_u: IVec3::new(4_000 + around(900), around(700), around(900)),
        step_v: IVec3::new(around(900), around(700), 4_000 + around(900)),
        rows: n,
        columns: n,
        jitter: Jitter::NONE,
    }
}

/// Groups of neighbouring receivers, and triangles of all sizes between them and the light; some with an edge towards
/// samples, or along the rows.
fn groups(rng: &mut Rng, light: &LatticeLight, count: usize) -> Vec<GroupPairs> {
    let mut groups = Vec::new();
    while groups.len() < count {
        let middle = IVec3::new(rng.around(60_000), rng.around(60_000), rng.around(60_000));
        let points: Vec<IVec3> = (0..TILE).map(|_| middle + rng.point(3_000)).collect();
        let triangles = (0..48).map(|_| {
            let sample = |rng: &mut Rng| {
                let last = light.rows as usize;
                light.sample(rng.below(last) as u32, rng.below(last) as u32)
            };
            // Eighths between a receiver and a sample are lattice points where differences are multiples.
            let size = 1 << (10 + rng.below(7));
            let eighth = 1 + rng.below(6) as i32;
            let towards = |rng: &mut Rng| points[0] + (sample(rng) - points[0]) / 8 * eighth;
            let a = towards(rng);
            let b = if rng.one_in(3) { towards(rng) } else { a + rng.point(size) };
            let c = if rng.one_in(4) { a + light.step_u * rng.around(9) } else { a + rng.point(size) };
            [a, b, c]
        });
        let triangles: Vec<_> = triangles.collect();
        let group = GroupPairs::new(light, &points, &offered(light, triangles.into_iter()));
        if group.count() > 0 {
            groups.push(group);
        }
    }
    groups
}

fn filled<W: MaskWord, F: Fill<W>>(fill: &F, light: &LatticeLight, group: &GroupPairs) -> (GroupMasks<W>, u64) {
    let mut masks = Group::empty(light.rows).masks;
    let mut open = 0;
    for isa in Isa::available() {
        masks = Group::empty(light.rows).masks;
        open = run(isa, fill, light, group, &mut masks);
    }
    (masks, open)
}

/// The exact mask of one pair.
fn exact_mask<W: MaskWord, const N: usize>(
    light: &LatticeLight,
    group: &GroupPairs,
    pair: usize,
    lane: usize,
) -> [W; N] {
    let (point, corners) = (group.receivers.point(lane), group.occluders[pair].corners());
    std::array::from_fn(|row| {
        (0..light.columns).fold(W::EMPTY, |word, column| {
            let blocked = exact::blocks::<Wide>(light, point, corners, row as u32, column);
            word.or(W::columns(column, u32::from(blocked)))
        })
    })
}

/// One pair, alone.
fn single(group: &GroupPairs, pair: usize, lane: usize) -> GroupPairs {
    GroupPairs {
        receivers: group.receivers,
        lanes: vec![1 << lane],
        occluders: vec![group.occluders[pair]],
        outlines: vec![group.outlines[pair]],
        edges: vec![group.edges[pair]],
    }
}

fn masks_are_exact<W: MaskWord, const N: usize>(seed: u64, wanted: usize, cells: usize) {
    let mut rng = Rng::new(seed);
    let (bounds, plain) =
        (Table::<W, Bounds<W, N>, N>::new(cells, cells), Table::<W, Nearest<W, N>, N>::new(cells, cells));
    let (mut pairs, mut open, mut wrong, mut blocked) = (0, 0, 0, 0);
    while pairs < wanted {
        let light = light(&mut rng, N as u32);
        for group in groups(&mut rng, &light, 2) {
            for pair in 0..group.lanes.len() {
                // A few lanes of each: integers are slow.
                for lane in lanes_of(group.lanes[pair]).filter(|_| rng.one_in(4)) {
                    let expected = exact_mask::<W, N>(&light, &group, pair, lane);
                    let alone = single(&group, pair, lane);
                    let (rows, _) = filled::<W, _>(&Rows::<Exact>::NEW, &light, &alone);
                    let (found, left) = filled::<W, _>(&Repaired::<W, N, true>(&bounds), &light, &alone);
                    assert_eq!(rows[lane][..N], expected, "rows, pair {pairs}");
                    assert_eq!(found[lane][..N], expected, "table, pair {pairs}");
                    assert_bounds(&bounds, &alone, lane, &expected);
                    let (near, _) = filled::<W, _>(&Plain(&plain), &light, &alone);
                    for (near, expected) in near[lane].iter().zip(expected) {
                        wrong += near.xor(expected).count();
                        blocked += expected.count();
                    }
                    (pairs, open) = (pairs + 1, open + left);
                }
            }
        }
    }
    // The test means nothing unless triangles block something, and tables leave something open.
    assert!(open > 0 && blocked > 8 * pairs as u32, "{open} open, {blocked} blocked");
    assert!(wrong > 0 && wrong < blocked / 2, "{wrong} of {blocked}");
}

/// What is sure is inside, and what is inside is possible.
fn assert_bounds<W: MaskWord, const N: usize>(
    table: &Table<W, Bounds<W, N>, N>,
    alone: &GroupPairs,
    lane: usize,
    expected: &[W; N],
) {
    let mut placed = Placed::EMPTY;
    table.cells.place::<f32>(&alone.edges[0], &mut placed);
    let [a, b, c] = table.entries(&placed, lane);
    for (row, &expected) in expected.iter().enumerate() {
        let sure = a.sure[row].and(b.sure[row]).and(c.sure[row]);
        let possible = a.possible[row].and(b.possible[row]).and(c.possible[row]);
        assert_eq!(sure.without(expected), W::EMPTY);
        assert_eq!(expected.without(possible), W::EMPTY);
    }
}

#[test]
fn masks_are_exact_16() {
    masks_are_exact::<u16, 16>(1, 4_000, 64);
}

#[test]
fn masks_are_exact_32() {
    masks_are_exact::<u32, 32>(2, 4_000, 128);
}

#[test]
fn masks_are_exact_64() {
    masks_are_exact::<u64, 64>(3, 2_000, 64);
}

#[test]
fn bounds_hold_for_every_line_of_a_cell() {
    let (cells, table) = (Cells::new(16, 24, 20), Table::<u16, Bounds<u16, 16>, 16>::new(24, 20));
    let mut rng = Rng::new(4);
    for index in 0..cells.count() {
        let (cell, entry) = (cells.cell(index), table.entry(index as i32));
        for _ in 0..50 {
            let (t, u) = (rng.unit(), rng.unit());
            let [from, to] = cell.distances.map(|distance| distance.clamp(-40.0, 40.0));
            let distance = from + (to - from) * u;
            let [column, row] = [0, 1].map(|k| cell.normals[0][k] * (1.0 - t) + cell.normals[1][k] * t);
            assert!((column.abs() + row.abs() - 1.0).abs() < 1e-12);
            for (i, (&sure, &possible)) in entry.sure.iter().zip(&entry.possible).enumerate() {
                for j in 0..16 {
                    let inside = column * (f64::from(j) - 7.5) + row * (i as f64 - 7.5) >= distance;
                    let j = j as u32;
                    assert!(!sure.bit(j) || inside, "cell {index}, sample {i}, {j}");
                    assert!(possible.bit(j) || !inside, "cell {index}, sample {i}, {j}");
                }
            }
        }
    }
}

#[test]
fn lanes_agree_on_the_bits_of_a_scene() {
    let bounds = Box3 { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) };
    #[expect(clippy::unwrap_used, reason = "a light with an area, in the bounds")]
    let light = {
        let lattice = Lattice::covering(bounds).unwrap();
        let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 32, 32).unwrap();
        light.snap(&lattice, Lift::NONE).unwrap()
    };
    let step = light.step_u.x;
    let points: Vec<IVec3> =
        (0..TILE as i32).map(|k| light.origin + IVec3::new(k * step, -60 * step, 16 * step)).collect();
    let corner = |x: i32, z: i32| light.origin + IVec3::new(x * step, -30 * step, z * step);
    let triangles = [[corner(2, 3), corner(18, 5), corner(9, 24)], [corner(18, 5), corner(30, 20), corner(9, 24)]];
    let group = GroupPairs::new(&light, &points, &offered(&light, triangles.into_iter()));
    assert!(group.count() > TILE);
    let table = Table::<u32, Bounds<u32, 32>, 32>::new(64, 64);
    for isa in Isa::available() {
        let mut masks = [Group::<u32>::empty(32).masks; 2];
        run(isa, &Rows::<Exact>::NEW, &light, &group, &mut masks[0]);
        run(isa, &Repaired::<u32, 32, false>(&table), &light, &group, &mut masks[1]);
        assert_eq!(masks[0], masks[1], "{isa}");
    }
}
