//! Lights without extent: every bit of every instruction set against the oracle, on the suite's scenes, with lights put where
//! signs are zero.

use umbra4_core::{
    Bounds, DirectionalLight, Lattice, PointLight, Punctual, PunctualLightError, SnapError,
    glam::{DVec3, IVec3},
    snap::LIMIT,
    stage::TABLE,
};
use umbra4_cpu::{CpuExecutor, HardShadows, Isa, Statistics};
use umbra4_tests::{
    budget,
    compare::{Amount, Compared, compare_masks},
    hard_shadows::{oracle, property},
    ledger::say,
    meshes::Mesh,
    oracle::{hit, hit_towards},
    rng::Rng,
    scene::Scene,
    scenes::{GENERATORS, SampleGrid},
};

/// Scenes of each generator.
const ROUNDS: usize = 12;

fn bits(shadows: &HardShadows) -> Vec<u16> {
    let bits = (0..shadows.len()).map(|r| u16::from(shadows.is_blocked(r).expect("there is such a receiver")));
    let bits: Vec<u16> = bits.collect();
    assert_eq!(shadows.is_blocked(shadows.len()), None);
    assert_eq!(shadows.count(), bits.iter().filter(|bit| **bit == 1).count());
    assert_eq!(shadows.words().len(), shadows.len().div_ceil(32));
    bits
}

#[test]
fn every_bit_is_the_oracle_s() {
    let executors: Vec<CpuExecutor> = Isa::available()
        .into_iter()
        .enumerate()
        .map(|(k, isa)| CpuExecutor::new().with_isa(isa).with_threads(1 + k % 2).expect("threads can be started"))
        .collect();
    let mut total = Compared::default();
    for ((name, _), executor) in GENERATORS.iter().flat_map(|g| executors.iter().map(move |e| (g, e))) {
        let compared = property(name, budget::of(ROUNDS), |inputs, light| {
            let found = executor.hard_shadows(&inputs.occluders, light, &inputs.receivers);
            Ok(bits(&found.map_err(|error| format!("{}: {error}", executor.isa()))?.0))
        });
        total.bits += compared.bits;
        total.blocked += compared.blocked;
    }
    say(&format!("lights without extent: {} bits, {} blocked, 0 differ", total.bits, total.blocked));
}

/// A light that is far enough away is as good as one at infinity: two formulas of the oracle against each other.
#[test]
fn directions_are_far_points() {
    let mut rng = Rng::named(0, "far");
    let (mut blocked, rounds) = (0, budget::of(20_000));
    for _ in 0..rounds {
        let triangle = [rng.point(6), rng.point(6), rng.point(6)];
        let (p, towards) = (rng.point(6), rng.point(3));
        if towards != IVec3::ZERO {
            let far = hit(p, p + towards * (1 << 20), triangle);
            assert_eq!(hit_towards(p, towards, triangle), far, "{p} {towards} {triangle:?}");
            blocked += usize::from(far);
        }
    }
    assert!(blocked > rounds / 100 && blocked < rounds / 2, "{blocked}");
}

#[test]
fn only_faces_with_receivers_are_looked_at() {
    let mut rng = Rng::named(0, "faces");
    let mut scene = GENERATORS[0].1(&mut rng, SampleGrid::regular(4, 4));
    let light = Punctual::point(IVec3::ZERO).expect("the middle of the lattice");
    let run = |scene: &Scene| {
        let inputs = scene.inputs(0);
        let found = CpuExecutor::new().hard_shadows(&inputs.occluders, &light, &inputs.receivers);
        found.expect("nothing can fail")
    };
    // All triangles lie above the light, as do the receivers of one of the faces.
    let size = 1 << 20;
    for vertex in &mut scene.mesh.vertices {
        *vertex = IVec3::new(vertex.x % size, 2 * size + vertex.y.abs() % size, vertex.z % size);
    }
    scene.receivers = (0..64).map(|_| IVec3::new(rng.around(size), -2 * size, rng.around(size))).collect();
    let (shadows, statistics) = run(&scene);
    assert_eq!((shadows.count(), statistics.counts.pairs_tested), (0, 0), "{statistics:?}");
    let ordered = |statistics: &Statistics| statistics.seconds_by_stage.iter().any(|(n, _)| *n == "order_triangles");
    assert!(!ordered(&statistics), "{statistics:?}");
    // Behind corners of triangles, as the light sees them: in shadow.
    let corners: Vec<IVec3> = scene.mesh.vertices.iter().map(|vertex| vertex * 2).take(16).collect();
    scene.receivers.extend(&corners);
    let (shadows, statistics) = run(&scene);
    assert!(ordered(&statistics) && shadows.count() > corners.len() / 2, "{shadows:?}, {statistics:?}");
    assert!(statistics.counts.pairs_tested > 0, "{statistics:?}");
    let places: Vec<_> =
        TABLE.iter().filter_map(|info| statistics.seconds_by_stage.iter().position(|(n, _)| *n == info.name)).collect();
    assert!(places.is_sorted() && places.len() == statistics.seconds_by_stage.len(), "{statistics:?}");
    scene.receivers = vec![IVec3::ZERO];
    let (shadows, statistics) = run(&scene);
    assert!(shadows.count() == 0 && statistics.seconds_by_stage.is_empty(), "{statistics:?}");
}

/// Directions all but along an axis, whose perpendiculars floats get wrong: rays through a corner of a triangle that lies on one
/// side of them.
#[test]
fn directions_beside_an_axis() {
    let mut rng = Rng::named(0, "beside an axis");
    let (mut blocked, mut cases) = (0, 0);
    for axis in 0..3 {
        for _ in 0..budget::of(400) {
            let mut towards = [0; 3];
            towards[axis] = if rng.one_in(2) { LIMIT } else { -LIMIT };
            let tilt = 1 << rng.below(16);
            towards[(axis + 1 + rng.below(2)) % 3] = rng.around(tilt);
            let towards = IVec3::from_array(towards);
            let light = Punctual::direction(towards).expect("a direction");
            // A corner on the ray, as far away as the lattice is large.
            let mut p = [rng.around(3), rng.around(3), rng.around(1)];
            p[axis] = -towards[axis].signum() * (4000 + rng.below(1000) as i32);
            let p = IVec3::from_array(p);
            let corner = p + towards;
            let mut side = || IVec3::new(rng.around(200), rng.around(2000), rng.around(200));
            let triangle = [corner, corner + side(), corner + side()];
            let mesh = Mesh { vertices: triangle.to_vec(), triangles: vec![[0, 1, 2]] };
            let light_of_area = GENERATORS[0].1(&mut Rng::named(0, "a light"), SampleGrid::regular(1, 1)).light;
            let scene = Scene { light: light_of_area, receivers: vec![p, p + IVec3::X, p - IVec3::Z], mesh };
            let inputs = scene.inputs(0);
            let expected = oracle(light, inputs.receivers.points(), &inputs.triangles());
            let (shadows, _) = CpuExecutor::new()
                .hard_shadows(&inputs.occluders, &light, &inputs.receivers)
                .expect("nothing can fail");
            compare_masks(&expected, &bits(&shadows), 1, 1, Amount::Some)
                .unwrap_or_else(|error| panic!("{towards}, {p}, {triangle:?}: {error}"));
            blocked += expected.iter().sum::<u64>();
            cases += 1;
        }
    }
    assert!(blocked > cases / 20 && blocked < 2 * cases, "{blocked} of {cases} cases");
}

#[test]
fn bad_lights_are_refused() {
    let lattice =
        Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("bounds are fine");
    for (axis, value) in [('x', f64::NAN), ('y', f64::INFINITY)] {
        let mut position = DVec3::ONE;
        position[usize::from(axis == 'y')] = value;
        let error = PointLight { position }.snap(&lattice).expect_err("not finite");
        assert!(matches!(error, PunctualLightError::Position(SnapError::NotFinite { axis: a, .. }) if a == axis));
        assert!(error.to_string().contains(&format!("position: coordinate {axis}")), "{error}");
        assert!(DirectionalLight { towards: position }.snap().is_err());
    }
    let outside = PointLight { position: DVec3::new(0.0, 0.0, 99.0) }.snap(&lattice).expect_err("outside");
    assert!(matches!(outside, PunctualLightError::Position(SnapError::OutOfRange { axis: 'z', .. })));
    let nowhere = DirectionalLight { towards: DVec3::ZERO }.snap().expect_err("no direction");
    assert!(nowhere.to_string().contains("[0, 0, 0]"), "{nowhere}");
    for outside in [IVec3::MAX, IVec3::MIN, IVec3::new(0, LIMIT, 0), IVec3::new(0, 0, -LIMIT)] {
        assert_eq!(Punctual::point(outside), None);
    }
    for nowhere in [IVec3::ZERO, IVec3::MAX, IVec3::MIN, IVec3::new(LIMIT + 1, 0, 0)] {
        assert_eq!(Punctual::direction(nowhere), None);
    }
    // Neither tiny nor huge directions lose anything.
    for scale in [1.0, 1e-300, 1e300] {
        let sun = DirectionalLight { towards: DVec3::new(-3.0, 1.5, 0.0) * scale }.snap().expect("finite");
        assert_eq!(Some(sun), Punctual::direction(IVec3::new(-LIMIT, LIMIT / 2, 0)));
    }
}
