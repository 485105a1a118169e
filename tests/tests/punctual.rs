//! Lights without extent: every bit of every instruction set against the oracle, on the suite's scenes, with lights put where
//! signs are zero.

use umbra4_core::{
    Bounds, DirectionalLight, Lattice, PointLight, Punctual, PunctualLightError, SnapError,
    glam::{DVec3, IVec3},
    snap::LIMIT,
};
use umbra4_cpu::{CpuExecutor, HardShadows, Isa};
use umbra4_tests::{
    compare::{Amount, Compared, compare_masks},
    ledger::say,
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
    let directions = directions.filter(|d| *d != IVec3::ZERO).map(Punctual::direction);
    points.into_iter().map(Punctual::point).chain(directions).collect()
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
    let light = Punctual::point(IVec3::ZERO);
    scene.receivers = vec![IVec3::new(0, -REACH, 0)];
    let inputs = scene.inputs(0);
    let executor = CpuExecutor::new();
    let (_, statistics) =
        executor.hard_shadows(&inputs.occluders, &light, &inputs.receivers).expect("threads can be started");
    // One group, which looks at no more triangles than there are.
    assert!(statistics.counts.pairs_tested <= scene.mesh.triangles.len() as u64, "{statistics:?}");
    scene.receivers.clear();
    let inputs = scene.inputs(0);
    let (shadows, statistics) =
        executor.hard_shadows(&inputs.occluders, &light, &inputs.receivers).expect("threads can be started");
    assert!(shadows.is_empty() && statistics.seconds_by_stage.is_empty(), "{statistics:?}");
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
    // Neither tiny nor huge directions lose anything.
    for scale in [1.0, 1e-300, 1e300] {
        let sun = DirectionalLight { towards: DVec3::new(-3.0, 1.5, 0.0) * scale }.snap().expect("finite");
        assert_eq!(sun, Punctual::direction(IVec3::new(-LIMIT, LIMIT / 2, 0)));
    }
}
