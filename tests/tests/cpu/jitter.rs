//! Jittered samples: where they lie, what they are good for, and how frames of them accumulate. That their masks have the right
//! bits is the conformance suite's.

use half::f16;
use umbra4_core::{
    AreaLight, Bounds, Jitter, Lattice, Lift, LightError,
    accumulate::{Accumulation, AccumulationError, most_frames},
    area_light::MIN_PLACE_STEP,
    glam::{DVec3, IVec3},
    jitter::PLACES,
    ratio::{MOST_WHOLE, float16, float32, unorm8},
};
use umbra4_cpu::{CpuExecutor, ExecutorError, GridOptions, Index};
use umbra4_tests::{
    budget,
    rng::Rng,
    scene::{Inputs, WorldScene},
    scenes::world,
};
use umbra4_wgpu::VisibilityFormat;

fn lattice() -> Lattice {
    Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) }).expect("bounds are fine")
}

/// A light on whose lattice a place is a whole number of units: 2^12.
fn light(rows: u32, columns: u32) -> AreaLight {
    let place = 4096.0 * lattice().step();
    let (u, v) = (f64::from(columns * PLACES) * place, f64::from(rows * PLACES) * place);
    AreaLight::new(DVec3::new(-1.0, 3.0, -1.0), DVec3::X * u, DVec3::Z * v, rows, columns).expect("a light with area")
}

/// Places of all samples, from the first of the light: row and column.
fn places(light: AreaLight, number: u32) -> Vec<[i32; 2]> {
    let snapped = light.with_jitter(Jitter::pattern(number)).snap(&lattice(), Lift::NONE).expect("fine enough");
    let pairs = (0..snapped.rows).flat_map(|i| (0..snapped.columns).map(move |j| (i, j)));
    let place = |(i, j)| {
        let d: IVec3 = snapped.sample(i, j) - snapped.origin;
        assert_eq!((d.x % 4096, d.y, d.z % 4096), (0, 0, 0), "samples lie on places");
        [d.z / 4096, d.x / 4096]
    };
    pairs.map(place).collect()
}

#[test]
fn every_cell_has_a_sample() {
    for (rows, columns) in [(1, 1), (3, 7), (8, 8), (32, 16), (64, 64)] {
        for number in [0, 1, 31, 32, 1000, u32::MAX >> 1] {
            for (k, [row, column]) in places(light(rows, columns), number).into_iter().enumerate() {
                let cell = [k as i32 / columns as i32, k as i32 % columns as i32];
                assert_eq!([row / PLACES as i32, column / PLACES as i32], cell, "pattern {number}, sample {k}");
            }
        }
    }
}

/// As many rows of samples as there are samples a row, or places a cell: what keeps shadows of edges along the light from banding.
#[test]
fn samples_are_spread_over_both_edges() {
    for side in [4, 8, 16, 32] {
        let side_of = |axis: usize| {
            let mut seen: Vec<i32> = places(light(side, side), 5).iter().map(|place| place[axis]).collect();
            seen.sort_unstable();
            seen.dedup();
            seen.len() as u32
        };
        assert_eq!([side_of(0), side_of(1)], [side * side; 2], "{side}");
    }
}

#[test]
fn patterns_that_follow_on_one_another_fill_the_cell() {
    for first in [0, 3 * PLACES] {
        let of_sample: Vec<[i32; 2]> =
            (first..first + PLACES).map(|number| places(light(8, 8), number)[8 * 3 + 5]).collect();
        for axis in [0, 1] {
            let mut seen: Vec<i32> = of_sample.iter().map(|place| place[axis] % PLACES as i32).collect();
            seen.sort_unstable();
            assert_eq!(seen, (0..PLACES as i32).collect::<Vec<_>>());
        }
    }
    assert_ne!(places(light(8, 8), 0), places(light(8, 8), PLACES), "sets differ");
}

#[test]
fn a_jittered_light_keeps_its_centre_and_its_size() {
    let jittered = light(5, 9).with_jitter(Jitter::pattern(7));
    let snapped = jittered.snap(&lattice(), Lift::NONE).expect("fine enough");
    // From the first place to the last.
    let last =
        snapped.step_u * 9 - snapped.step_u / PLACES as i32 + snapped.step_v * 5 - snapped.step_v / PLACES as i32;
    let middle = lattice().to_world(snapped.origin) + last.as_dvec3() * (0.5 * lattice().step());
    assert!(middle.distance(jittered.center()) <= 2.0 * lattice().step());
    assert_eq!(jittered.jitter().number(), Some(7));
    assert_eq!(light(5, 9).jitter(), Jitter::NONE);
}

#[test]
fn lights_that_are_too_fine_for_places_are_refused() {
    // Regular samples are fine with 64 units, places with 32 each.
    let least = f64::from(MIN_PLACE_STEP * PLACES as i32) * lattice().step();
    let sized = |factor: f64| {
        let edge = 16.0 * least * factor;
        AreaLight::new(DVec3::ZERO, DVec3::X * edge, DVec3::Z * edge, 16, 16).expect("a light with area")
    };
    let snap = |light: AreaLight| light.snap(&lattice(), Lift::NONE);
    assert!(snap(sized(1.0).with_jitter(Jitter::pattern(0))).is_ok());
    assert!(snap(sized(0.5)).is_ok());
    let error = snap(sized(0.5).with_jitter(Jitter::pattern(0))).expect_err("too fine");
    let LightError::LightTooFine { field: "edge_u", least: 1024, largest_bounds, .. } = error else {
        panic!("{error:?}");
    };
    assert!(error.to_string().contains("at least 1024 are needed"), "{error}");
    assert!(largest_bounds > 1.0 && largest_bounds <= 4.0, "{largest_bounds}");
}

#[test]
fn the_grid_takes_regular_samples_only() {
    let scene = world(&mut Rng::named(1, "jitter"), 8, 8, 10, 10);
    let inputs = jittered(&scene, 0);
    let grid = CpuExecutor::new().with_index(Index::Grid(GridOptions::default()));
    let error = grid.visibility(&inputs.occluders, &inputs.light, &inputs.receivers).expect_err("jittered");
    assert_eq!(error, ExecutorError::JitteredGrid);
    assert!(error.to_string().contains("the light's samples are jittered"), "{error}");
}

fn jittered(scene: &WorldScene, number: u32) -> Inputs {
    let inputs = scene.inputs();
    let light = scene.light().with_jitter(Jitter::pattern(number));
    Inputs { light: light.snap(&inputs.lattice, Lift::NONE).expect("fine enough"), ..inputs }
}

fn error(visibility: impl Iterator<Item = f32>, reference: &[f32]) -> f64 {
    let squares: f64 = visibility.zip(reference).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (squares / reference.len() as f64).sqrt()
}

#[test]
fn frames_converge() {
    let scene = |side| WorldScene { rows: side, columns: side, ..world(&mut Rng::named(2, "jitter"), 8, 8, 60, 400) };
    let executor = CpuExecutor::new();
    let visibility = |inputs: &Inputs| {
        executor.visibility(&inputs.occluders, &inputs.light, &inputs.receivers).expect("the scene is sound").0
    };
    let reference = visibility(&scene(64).inputs());
    let regular = error(visibility(&scene(8).inputs()).into_iter(), &reference);
    let coarse = scene(8);
    let mut accumulation = Accumulation::new(vec![0; reference.len()]);
    let mut errors = Vec::new();
    for number in 0..64 {
        let inputs = jittered(&coarse, number);
        assert_eq!(accumulation.next_jitter(), inputs.light.jitter);
        let lit = executor.lit_counts(&inputs.occluders, &inputs.light, &inputs.receivers).expect("sound").0;
        assert_eq!(accumulation.add(0, &inputs.light, &lit), Ok(number + 1));
        errors.push(error(accumulation.visibility(), &reference));
    }
    // 64 frames of 8² samples are as many as the reference has.
    let [first, fourth, last] = [errors[0], errors[3], errors[63]];
    println!("regular {regular:.5}, jittered after 1, 4, 64 frames: {first:.5}, {fourth:.5}, {last:.5}");
    assert!(first < 1.5 * regular, "one jittered frame is about as good as a regular one");
    assert!(fourth < 0.5 * first && last < 0.15 * first, "{errors:?}");
}

#[test]
fn what_moves_is_dropped() {
    let lit = [64, 10];
    let mut accumulation = Accumulation::new([7; 2]);
    assert_eq!(accumulation.visibility().collect::<Vec<_>>(), [0.0, 0.0]);
    let snapped = |light: AreaLight, number| {
        light.with_jitter(Jitter::pattern(number)).snap(&lattice(), Lift::NONE).expect("fine enough")
    };
    let (here, there) = (light(8, 8), light(8, 9));
    assert_eq!(accumulation.add(1, &snapped(here, 0), &lit), Ok(1));
    assert_eq!(accumulation.add(1, &snapped(here, 1), &[64, 20]), Ok(2));
    assert_eq!(accumulation.visibility().collect::<Vec<_>>(), [1.0, 30.0 / 128.0]);
    // Another scene, then another light.
    assert_eq!(accumulation.add(2, &snapped(here, 2), &lit), Ok(1));
    assert_eq!(accumulation.add(2, &snapped(there, 3), &lit), Ok(1));
    assert_eq!(accumulation.visibility().collect::<Vec<_>>(), [64.0 / 72.0, 10.0 / 72.0]);
    assert_eq!(accumulation.next_jitter(), Jitter::pattern(4));

    // What is refused changes nothing.
    let before: Vec<f32> = accumulation.visibility().collect();
    let refused = accumulation.add(2, &snapped(there, 4), &[1]);
    assert_eq!(refused, Err(AccumulationError::Receivers { receivers: 1, sums: 2 }));
    let refused = accumulation.add(3, &snapped(there, 4), &[72, 73]).expect_err("more than there are");
    assert_eq!(refused, AccumulationError::Lit { index: 1, lit: 73, samples: 72 });
    assert_eq!(refused.to_string(), "lit count 1 is 73, of 72 samples");
    assert_eq!(accumulation.visibility().collect::<Vec<_>>(), before);
    assert_eq!((accumulation.frames(), accumulation.next_jitter()), (1, Jitter::pattern(4)));
}

#[test]
fn accumulation_ends_where_floats_do() {
    let light = light(64, 64).snap(&lattice(), Lift::NONE).expect("fine enough");
    let mut accumulation = Accumulation::new(vec![0; 1]);
    let most = most_frames(64 * 64);
    assert_eq!(most, 4096);
    for frame in 1..=most + 3 {
        assert_eq!(accumulation.add(0, &light, &[if frame <= most { 4095 } else { 0 }]), Ok(frame.min(most)));
    }
    assert_eq!(accumulation.visibility().collect::<Vec<_>>(), [4095.0 / 4096.0]);
}

#[test]
fn ratios_are_rounded_as_the_formats_ask() {
    let mut rng = Rng::named(0, "ratios");
    let check = |part: u32, whole: u32| {
        let of = f64::from(part) / f64::from(whole);
        assert_eq!(float32(part, whole), (part as f32 / whole as f32).to_bits(), "{part}/{whole}");
        // No other half float is nearer, and none as near is even. All products are exact.
        let off = |bits: u32| (f16::from_bits(bits as u16).to_f64() * f64::from(whole) - f64::from(part)).abs();
        let half = float16(part, whole);
        for other in [half.saturating_sub(1), half + 1] {
            let nearer = off(half) < off(other) || (off(half) == off(other) && half & 1 == 0);
            assert!(nearer || other == half, "{part}/{whole}: {half:#x}, not {other:#x}");
        }
        assert_eq!(unorm8(part, whole), (of * 255.0).round() as u32, "{part}/{whole}");
    };
    for whole in (1..200).chain([1 << 12, (1 << 12) - 1]) {
        (0..=whole).for_each(|part| check(part, whole));
    }
    for _ in 0..budget::of(200_000) {
        let whole = 1 + rng.below(MOST_WHOLE as usize) as u32;
        check(rng.below(whole as usize + 1) as u32 >> rng.below(24), whole);
    }
    for part in [0, 1, 2, 3, MOST_WHOLE / 2, MOST_WHOLE - 1, MOST_WHOLE] {
        check(part, MOST_WHOLE);
    }
    assert_eq!([float32(0, 0), float16(0, 0), unorm8(0, 0)], [0; 3]);
    // A frame alone is the same pixel, accumulated or not.
    for lit in 0..=1024 {
        assert_eq!(float32(lit, 1024), VisibilityFormat::Float32.bits(lit, 1024));
        assert_eq!(float16(lit, 1024), VisibilityFormat::Float16.bits(lit, 1024));
        assert_eq!(unorm8(lit, 1024), VisibilityFormat::Unorm8.bits(lit, 1024));
    }
}
