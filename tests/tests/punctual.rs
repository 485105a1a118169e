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
    compare::{Amount, Compared, compare_masks},
    ledger::say,
    meshes::Mesh,
    oracle::{hit, hit_towards},
    rng::Rng,
    scene::{REACH, Scene},
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
};

/// Scenes of each generator.
const ROUNDS: usize = 12;

/// A bit a receiver, from the rule alone.
fn oracle(light: Punctual, receivers: &[IVec3], triangles: &[[IVec3; 3]]) -> Vec<u64> {
    let blocks = |p: IVec3, triangle: [IVec3; 3]| match (light.position(), light.towards()) {
        (Some(position), _) => hit(p, position, triangle),
        (_, Some(towards)) => hit_towards(p, towards, triangle),
        _ => panic!("{light:?} is neither a point nor a direction"),
    };
    receivers.iter().map(|&p| u64::from(triangles.iter().any(|&t| blocks(p, t)))).collect()
}

fn bits(shadows: &HardShadows) -> Vec<u16> {
    let bits = (0..shadows.len()).map(|r| u16::from(shadows.is_blocked(r).expect("there is such a receiver")));
    let bits: Vec<u16> = bits.collect();
    assert_eq!(shadows.is_blocked(shadows.len()), None);
    assert_eq!(shadows.count(), bits.iter().filter(|bit| **bit == 1).count());
    assert_eq!(shadows.words().len(), shadows.len().div_ceil(32));
    bits
}

/// Lights where signs are zero: in corners, receivers and planes, along edges and planes, through corners; and anywhere.
fn lights(rng: &mut Rng, scene: &Scene) -> Vec<Punctual> {
    let inside = |p: IVec3| p.clamp(IVec3::splat(-REACH), IVec3::splat(REACH));
    let mut points = vec![scene.light.sample(0, 0), rng.point(REACH), rng.point(REACH / 4)];
    let mut directions = vec![rng.point(LIMIT), IVec3::from_array(rng.pick(&[[1, 0, 0], [0, -1, 0], [0, 0, LIMIT]]))];
    if !scene.receivers.is_empty() {
        points.push(rng.pick(&scene.receivers));
    }
    if !scene.mesh.triangles.is_empty() {
        let corners = rng.pick(&scene.mesh.triangles).map(|vertex| scene.mesh.vertices[vertex as usize]);
        let [a, b, c] = corners;
        points.extend([a, inside(a + (b - a) / 2 + (c - a) / 2), inside(b + b / 2 - a / 2)]);
        directions.extend([b - a, (c - a) / 2 + (b - c) / 2]);
        if !scene.receivers.is_empty() {
            directions.push((c - rng.pick(&scene.receivers)) / 2 * 2);
        }
    }
    let directions = directions.into_iter().map(|d| d.clamp(IVec3::splat(-LIMIT), IVec3::splat(LIMIT)));
    let directions = directions.filter_map(Punctual::direction);
    points.into_iter().filter_map(Punctual::point).chain(directions).collect()
}

#[test]
fn every_bit_is_the_oracle_s() {
    let executors: Vec<CpuExecutor> = Isa::available()
        .into_iter()
        .enumerate()
        .map(|(k, isa)| CpuExecutor::new().with_isa(isa).with_threads(1 + k % 2).expect("threads can be started"))
        .collect();
    let (mut total, mut cases) = (Compared::default(), 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("punctual {name}"));
        let mut of_generator = Compared::default();
        for round in 0..ROUNDS {
            let mut scene = generator(&mut rng, SampleGrid::regular(4, 4));
            let lights = lights(&mut rng, &scene);
            // Receivers in the light, and on the edges and corners of its faces.
            for position in lights.iter().filter_map(|light| light.position()) {
                let size = 1 + rng.below(1 << 20) as i32;
                for along in [[0, 0, 0], [1, 1, 1], [-1, 1, 1], [1, 0, -1], [0, 1, 0]] {
                    let p = position + IVec3::from_array(along) * size;
                    scene.receivers.push(p.clamp(IVec3::splat(-REACH), IVec3::splat(REACH)));
                }
            }
            let inputs = scene.inputs(EXPONENTS[round % EXPONENTS.len()]);
            let triangles = inputs.triangles();
            for light in lights {
                let expected = oracle(light, inputs.receivers.points(), &triangles);
                for executor in &executors {
                    let found = executor.hard_shadows(&inputs.occluders, &light, &inputs.receivers);
                    let (shadows, _) = found.unwrap_or_else(|error| panic!("{error}"));
                    let compared = compare_masks(&expected, &bits(&shadows), 1, 1, Amount::Some)
                        .unwrap_or_else(|e| panic!("{name}, scene {round}, {light:?}, {}: {e}", executor.isa()));
                    of_generator.bits += compared.bits;
                    of_generator.blocked += compared.blocked;
                    cases += 1;
                }
            }
        }
        assert!(of_generator.blocked > 0 && of_generator.blocked < of_generator.bits, "{name}: {of_generator:?}");
        total.bits += of_generator.bits;
        total.blocked += of_generator.blocked;
    }
    say(&format!("lights without extent: {} bits of {cases} cases, {} blocked, 0 differ", total.bits, total.blocked));
}

/// A light that is far enough away is as good as one at infinity: two formulas of the oracle against each other.
#[test]
fn directions_are_far_points() {
    let mut rng = Rng::named(0, "far");
    let (mut blocked, rounds) = (0, 20_000);
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
        for _ in 0..400 {
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
