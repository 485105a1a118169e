//! Irradiance from masks: against a direct sum in f64, within the documented error; against a form factor that is known; and how
//! far the usual product of unshadowed irradiance and visibility is from it.

use std::f64::consts::PI;

use umbra4_core::{
    AreaLight, Bounds, Jitter, Lattice, LatticeLight, Lift,
    emission::{Emission, WHOLE},
    glam::{DVec3, IVec3, Vec3},
    irradiance::{Lambertian, unit},
};
use umbra4_cpu::{CpuExecutor, ExecutorError, Occluders, Receivers, SceneError};
use umbra4_tests::{
    facings,
    irradiance::{Expected, check, expected},
    ledger::say,
    rng::Rng,
    scenes::{self, EXPONENTS, GENERATORS, SampleGrid},
    slab::slab_and_wall,
    spheres::spheres,
    weights::weights,
};

const GRIDS: [(u32, u32); 5] = [(16, 16), (5, 31), (64, 64), (1, 1), (33, 17)];

#[test]
fn sums_are_those_of_the_oracle_s_masks() {
    let executor = CpuExecutor::new();
    let (mut worst, mut lit, mut receivers) = (0.0_f64, 0, 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(2, &format!("irradiance {name}"));
        for (round, (rows, columns)) in GRIDS.into_iter().enumerate() {
            let grid = SampleGrid::regular(rows, columns);
            let grid = if round % 2 == 1 { grid.jittered(&mut rng) } else { grid };
            let inputs = generator(&mut rng, grid).inputs(EXPONENTS[round]);
            let normals = facings::normals(&mut rng, &inputs, &facings::samples(&inputs));
            let weights = weights(&mut rng, inputs.light.sample_count() as usize);
            let emission = Emission::new(rows, columns, &weights[..]).expect("weights are fine");
            let found = executor.irradiance(&inputs.occluders, &inputs.light, &inputs.receivers, &normals, &emission);
            let (found, _) = found.unwrap_or_else(|error| panic!("{error}"));
            let wanted = expected(&inputs, &normals, &weights);
            let (error, some) = check(&inputs, &wanted, &found).unwrap_or_else(|error| panic!("{name}: {error}"));
            (worst, lit, receivers) = (worst.max(error), lit + some, receivers + found.len());
        }
    }
    assert!(lit > receivers / 10, "{lit} of {receivers} receivers get light");
    assert!(worst > 0.001 && worst <= 1.0);
    say(&format!("irradiance: {lit} of {receivers} receivers get light, errors at most {worst:.3} of what is allowed"));
}

#[test]
fn the_comparator_compares() {
    let inputs = GENERATORS[0].1(&mut Rng::named(0, "comparator"), SampleGrid::regular(4, 4)).inputs(0);
    let one = Expected { irradiance: [1.0; 3], facing: [1.0; 3] };
    assert!(check(&inputs, &[one], &[[1.0; 3]]).is_ok());
    for found in [vec![], vec![[1.0; 3]; 2], vec![[1.0, 1.0, 1.0001]], vec![[0.9999; 3]], vec![[f32::NAN; 3]]] {
        assert!(check(&inputs, &[one], &found).is_err(), "{found:?}");
    }
}

/// A lamp of 2 × 2 that shines down from the height 1.5, and the lattice it is on.
fn lamp(samples: u32, jitter: Jitter) -> (Lattice, LatticeLight) {
    let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) }).expect("bounds");
    let lamp = AreaLight::new(DVec3::new(-1.0, 1.5, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0, samples, samples);
    let lamp = lamp.expect("a lamp").with_jitter(jitter);
    (lattice, lamp.snap(&lattice, Lift::NONE).expect("it is coarse enough"))
}

/// The form factor of a rectangle, a × b, above a parallel receiver below one of its corners, c away, times π.
fn corner(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let half = |x: f64, y: f64| x / (1.0 + x * x).sqrt() * (y / (1.0 + x * x).sqrt()).atan();
    (half(x, y) + half(y, x)) / 2.0
}

#[test]
fn a_square_gives_what_its_form_factor_says() {
    let mut before = f64::INFINITY;
    for samples in [4, 8, 16, 32, 64] {
        let (lattice, light) = lamp(samples, Jitter::NONE);
        let places = [[0.0, 0.0], [0.25, -0.5], [1.0, 1.0], [0.5, 0.875], [-1.0, 0.0]];
        let points: Vec<Vec3> = places.iter().map(|[x, z]| Vec3::new(*x, 0.0, *z)).collect();
        let receivers = Receivers::raw(&lattice, &points).expect("inside");
        let emission = vec![[WHOLE; 3]; (samples * samples) as usize];
        let emission = Emission::new(samples, samples, emission).expect("weights");
        let executor = CpuExecutor::new();
        let normals = vec![Vec3::Y * 7.0; points.len()];
        let (found, _) =
            executor.irradiance(&Occluders::default(), &light, &receivers, &normals, &emission).expect("all is fine");
        let mut worst = 0.0_f64;
        for (found, [x, z]) in found.iter().zip(places.map(|at| at.map(f64::from))) {
            let [left, right, near, far] = [1.0 + x, 1.0 - x, 1.0 + z, 1.0 - z];
            let wanted: f64 = [(left, near), (left, far), (right, near), (right, far)]
                .map(|(a, b)| if a > 0.0 && b > 0.0 { corner(a, b, 1.5) } else { 0.0 })
                .iter()
                .sum();
            worst = worst.max((f64::from(found[0]) / wanted - 1.0).abs());
            assert_eq!(found[0], found[2]);
        }
        // Samples are the middles of their cells: errors fall with the square of their distance.
        assert!(worst < before / 3.0 && worst < 0.3 / f64::from(samples * samples), "{samples}: {worst}");
        before = worst;
        say(&format!("irradiance of a square, {samples} × {samples} samples: off by at most {worst:.1e}"));
    }
    // Jittered samples converge, too.
    let (_, light) = lamp(64, Jitter::pattern(5));
    let receiver = Lambertian::new(&light, IVec3::ZERO, Vec3::Y);
    let sum: f64 = (0..4096).map(|k| f64::from(receiver.form_factor(light.sample(k / 64, k % 64)))).sum();
    assert!((sum / (4.0 * corner(1.0, 1.0, 1.5)) - 1.0).abs() < 2e-3, "{sum}");
    assert!(sum < PI);
}

#[test]
fn what_faces_away_gets_nothing() {
    let (lattice, light) = lamp(8, Jitter::NONE);
    let points = [Vec3::ZERO, Vec3::ZERO, Vec3::new(0.0, 3.0, 0.0), Vec3::new(3.5, 1.5, 0.0), Vec3::new(0.0, 1.4, 0.0)];
    let normals = [Vec3::NEG_Y, Vec3::X, Vec3::NEG_Y, Vec3::NEG_X, Vec3::Y];
    let receivers = Receivers::raw(&lattice, &points).expect("inside");
    let emission = Emission::new(8, 8, [[WHOLE, 0, WHOLE / 3]; 64]).expect("weights");
    let (nothing, executor) = (Occluders::default(), CpuExecutor::new());
    let (found, _) = executor.irradiance(&nothing, &light, &receivers, &normals, &emission).expect("all is fine");
    // Away; half of the light before its horizon; behind the light; in its plane; close below it.
    assert_eq!([found[0], found[2], found[3]], [[0.0; 3]; 3]);
    assert!(found[1][0] > 0.0 && found[1][0] < found[4][0] && found.iter().all(|e| e[1] == 0.0));
    assert_eq!(executor.unshadowed_irradiance(&light, &receivers, &normals, &emission).expect("all is fine"), found);
}

#[test]
fn what_is_refused() {
    let (lattice, light) = lamp(8, Jitter::NONE);
    let receivers = Receivers::raw(&lattice, &[Vec3::ZERO; 3]).expect("inside");
    let (nothing, executor) = (Occluders::default(), CpuExecutor::new());
    let emission = Emission::new(8, 8, [[1; 3]; 64]).expect("weights");
    let ask = |normals: &[Vec3]| executor.irradiance(&nothing, &light, &receivers, normals, &emission);
    assert!(ask(&[Vec3::Y; 3]).is_ok() && ask(&[Vec3::Y * 1e-42, Vec3::MAX, Vec3::Y]).is_ok());
    for bad in [Vec3::ZERO, Vec3::new(0.0, f32::NAN, 1.0), Vec3::new(f32::INFINITY, 0.0, 0.0)] {
        let refused = ask(&[Vec3::Y, bad, Vec3::ZERO]);
        assert!(
            matches!(refused, Err(ExecutorError::Scene(SceneError::Normal { index: 1, .. }))),
            "{bad}: {refused:?}"
        );
        assert_eq!(unit(bad), None);
    }
    let count = ExecutorError::Scene(SceneError::NormalCount { count: 2, receivers: 3 });
    assert_eq!(ask(&[Vec3::Y; 2]).map(|_| ()), Err(count.clone()));
    assert_eq!(executor.unshadowed_irradiance(&light, &receivers, &[Vec3::Y; 2], &emission), Err(count));
    let other = Emission::new(8, 4, [[1; 3]; 32]).expect("weights");
    let refused = executor.irradiance(&nothing, &light, &receivers, &[Vec3::Y; 3], &other);
    assert_eq!(refused.map(|_| ()), Err(ExecutorError::EmissionSize { emission: [8, 4], light: [8, 8] }));
}

/// How far the usual product is off: the mean and the largest error, relative to the irradiance itself, over receivers in penumbra
/// that get at least a thousandth of what the brightest gets.
fn product_error(what: &str, occluders: &Occluders, light: &LatticeLight, receivers: &Receivers, normals: &[Vec3]) {
    let (rows, columns) = (light.rows, light.columns);
    let emission = Emission::new(rows, columns, vec![[WHOLE; 3]; (rows * columns) as usize]).expect("weights");
    let executor = CpuExecutor::new();
    let (exact, _) = executor.irradiance(occluders, light, receivers, normals, &emission).expect("all is fine");
    let plain = executor.unshadowed_irradiance(light, receivers, normals, &emission).expect("all is fine");
    let (seen, _) = executor.visibility(occluders, light, receivers).expect("all is fine");
    let most = exact.iter().map(|e| e[0]).fold(0.0, f32::max);
    let errors: Vec<f64> = exact
        .iter()
        .zip(&plain)
        .zip(&seen)
        .filter(|((exact, _), seen)| exact[0] > most / 1000.0 && **seen < 1.0)
        .map(|((exact, plain), seen)| (f64::from(plain[0] * seen) / f64::from(exact[0]) - 1.0).abs())
        .collect();
    // Where nothing is hidden, both are the same but for the order of sums.
    for ((exact, plain), _) in exact.iter().zip(&plain).zip(&seen).filter(|(_, seen)| **seen == 1.0) {
        assert!((exact[0] - plain[0]).abs() <= most * 1e-5);
    }
    let (mean, largest) =
        (errors.iter().sum::<f64>() / errors.len() as f64, errors.iter().copied().fold(0.0, f64::max));
    assert!(errors.len() > 100 && largest > 0.01, "{what}: {} in penumbra, {largest}", errors.len());
    say(&format!(
        "unshadowed irradiance × visibility, {what}: off by {:.1} % on average, at most {:.0} %, of {} in penumbra",
        mean * 100.0,
        largest * 100.0,
        errors.len()
    ));
}

#[test]
fn the_usual_product_is_something_else() {
    let lit = spheres(27, 40);
    for (side, height) in [(1.0, 3.0), (4.0, 3.0), (8.0, 2.5)] {
        let corner = DVec3::new(-side / 2.0, height, -side / 2.0);
        let lamp = AreaLight::new(corner, DVec3::X * side, DVec3::Z * side, 16, 16).expect("a lamp");
        let lamp = lamp.snap(&lit.lattice, Lift::NONE).expect("it is coarse enough");
        let normals = vec![Vec3::Y; lit.receivers.len()];
        let what = format!("spheres over a floor, lamp {side} × {side} at height {height}");
        product_error(&what, &lit.occluders, &lamp, &lit.receivers, &normals);
    }
    for (name, scene) in [
        ("leaves", scenes::world(&mut Rng::named(0, "product"), 16, 16, 300, 1500)),
        ("slab and wall", slab_and_wall(40)),
    ] {
        let inputs = scene.inputs();
        let normals = vec![Vec3::Y; inputs.receivers.len()];
        product_error(name, &inputs.occluders, &inputs.light, &inputs.receivers, &normals);
    }
}
