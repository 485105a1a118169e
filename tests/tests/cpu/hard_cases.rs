//! The hard-case catalogue, checked on the oracle alone: what each case states is true of the rule itself.
//! (Executors run the catalogue in `conformance.rs`.)

use umbra4_core::{AreaLight, Bounds, Lattice, Lift, glam::DVec3};
use umbra4_cpu::{Occluders, Receivers};
use umbra4_tests::{
    budget,
    hard_cases::{GRIDS, HARD_CASES, OwnSurface, QUAD},
    rng::Rng,
    scene::Inputs,
};

#[test]
fn the_oracle_agrees_with_what_the_cases_state() {
    for (name, build) in HARD_CASES {
        for (rows, columns) in GRIDS {
            let cases = build(rows, columns);
            assert!(!cases.is_empty(), "{name} has no case");
            for (k, case) in cases.iter().enumerate() {
                let light = &case.inputs.light;
                if let Err(error) = case.check.holds(&case.inputs.oracle(), light) {
                    panic!("{name}, case {k}, {rows}×{columns}: {error}\n{light:?}");
                }
            }
        }
    }
}

#[test]
fn names_are_unique() {
    let mut names: Vec<_> = HARD_CASES.iter().map(|(name, _)| name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), HARD_CASES.len());
}

#[test]
fn no_surface_shadows_itself_and_without_the_lift_it_would() {
    let mut rng = Rng::named(0, "self-shadow");
    let (mut bits, mut raw) = (0, 0);
    for _ in 0..budget::of(3000) {
        let surface = OwnSurface::random(&mut rng, 8, 8);
        let inputs = surface.inputs(Lift::F32_POSITIONS);
        let masks = inputs.oracle();
        assert!(masks.iter().all(|&row| row == 0), "{surface:?} shadows itself: {masks:x?}\n{inputs:?}");
        bits += masks.len() * 8;
        let masks = surface.inputs(Lift::NONE).oracle();
        raw += masks.iter().map(|row| row.count_ones()).sum::<u32>();
    }
    println!("{bits} bits, none shadowed by the own surface; {raw} would be without the lift");
    assert!(raw > 1000, "only {raw} bits needed the lift: the test shows little");
}

/// A lamp in the plane of a random tilted ceiling, from which no sample may be blocked.
fn tilted_lamps(rows: u32, columns: u32, count: usize) {
    let mut rng = Rng::named(0, &format!("tilted ceiling {rows} {columns}"));
    for _ in 0..budget::of(count) {
        // The quad is the ceiling, the lamp lies in its plane, the room is on the lit side.
        let ceiling = OwnSurface::random(&mut rng, 1, 1);
        let [a, b, _, d] = ceiling.vertices.map(|v| v.as_dvec3());
        let (u, v) = (b - a, d - a);
        let (edge_u, edge_v) = if u.cross(v).dot(ceiling.normal.as_dvec3()) > 0.0 { (u, v) } else { (v, u) };
        let corner = a + (edge_u + edge_v) * 0.2;
        let light = AreaLight::new(corner, edge_u * 0.3, edge_v * 0.3, rows, columns).expect("a light with area");
        let size = u.length().max(v.length());
        let points: Vec<DVec3> = (0..8)
            .map(|_| {
                let away = ceiling.normal.as_dvec3().normalize() * size * rng.pick(&[1.0, 0.1, 0.01]);
                corner + u * rng.real(2.0) + v * rng.real(2.0) + away
            })
            .collect();
        let all = ceiling.vertices.iter().map(|v| v.as_dvec3()).chain(light.corners()).chain(points.iter().copied());
        let lattice = Lattice::covering(Bounds::of(all)).expect("the scene is finite");
        let inputs = Inputs {
            lattice,
            light: light.snap(&lattice, Lift::F32_POSITIONS).expect("the light is inside"),
            occluders: Occluders::new(&lattice, &ceiling.vertices, &QUAD).expect("vertices are inside"),
            receivers: Receivers::raw_f64(&lattice, &points).expect("receivers are inside"),
        };
        let masks = inputs.oracle();
        let blocked: u32 = masks.iter().map(|row| row.count_ones()).sum();
        assert!(
            blocked == 0,
            "{rows}×{columns}: the ceiling shades {blocked} samples of its lamp\n{light:?}\n{inputs:?}"
        );
    }
}

#[test]
fn a_lamp_flush_with_a_tilted_ceiling_shines() {
    for (rows, columns) in GRIDS {
        tilted_lamps(rows, columns, 1000);
    }
}

/// The steps of a tilted lamp are rounded, so that its outer samples leave the ceiling's plane by up to
/// 3·((rows + columns − 2)/4 + ½) lattice units: more than the lift of a position rounded once.
#[test]
fn a_64x64_lamp_flush_with_a_tilted_ceiling_shines() {
    tilted_lamps(64, 64, 4000);
}
