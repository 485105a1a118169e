//! Receivers that face away from a light: none that faces it is taken for one, nearly all that do are settled, and masks are
//! full there and the oracle's elsewhere.

use umbra4_core::{
    AreaLight, Bounds, Facing, Jitter, Lattice, LatticeLight, Lift, Punctual,
    cloud::Cloud,
    glam::{DVec3, IVec3, Vec3},
    stage::Stage,
};
use umbra4_cpu::{CpuExecutor, GridOptions, Index, Lit, Occluders, Receivers, SceneError};
use umbra4_tests::{
    budget,
    compare::{Amount, compare_masks},
    facings::{cosine, given, normal, normals, samples, sees_none, settled},
    hard_shadows,
    ledger::say,
    oracle::hit,
    rng::Rng,
    scene::{Inputs, REACH},
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
};

const GRIDS: [(u32, u32); 4] = [(16, 16), (5, 31), (33, 17), (64, 9)];

/// With receivers that face some way.
fn facing(inputs: &Inputs, normals: &[Vec3]) -> Receivers {
    inputs.receivers.clone().facing(normals).expect("normals point somewhere")
}

#[test]
fn nothing_that_faces_a_light_is_settled() {
    let mut rng = Rng::named(0, "facing");
    let (mut away, mut clearly, mut settled) = (0, 0, 0);
    for round in 0..budget::of(20_000) {
        let (rows, columns) = (1 + rng.below(9) as u32, 1 + rng.below(9) as u32);
        let extent = REACH >> rng.below(20);
        let step = |v: IVec3| v / 10 / 32 * 32;
        let (step_u, step_v) = (step(rng.point(extent)), step(rng.point(extent)));
        let origin = rng.point(REACH / 20);
        let jitter = if round % 2 == 0 { Jitter::NONE } else { Jitter::pattern(round) };
        let light = LatticeLight { origin, step_u, step_v, rows, columns, jitter };
        let all: Vec<IVec3> =
            (0..rows).flat_map(|row| (0..columns).map(move |column| light.sample(row, column))).collect();
        let far = REACH >> rng.below(24);
        let p = if rng.one_in(8) { rng.pick(&all) } else { rng.point(far) };
        let exact = normal(&mut rng, p, &all);
        let facing = Facing::of(given(&mut rng, exact));
        assert_ne!(facing, Facing::UNKNOWN);
        assert_eq!(Facing::from_word(facing.word()), facing);
        let truly = sees_none(exact, p, &all);
        let found = facing.is_away_from(&light, p);
        assert!(truly || !found, "{exact} at {p} before {light:?}");
        // Nearly edge on, a word of 32 bits cannot tell.
        let is_clear = cosine(exact, p, &all) < -0.02 && step_u != IVec3::ZERO && step_v != IVec3::ZERO;
        away += usize::from(truly);
        clearly += usize::from(is_clear && jitter == Jitter::NONE);
        settled += usize::from(is_clear && jitter == Jitter::NONE && found);
        // A light of one sample, and the box around all.
        if let Some(lamp) = Punctual::point(all[0]) {
            let found = facing.is_away_from_punctual(lamp, p);
            assert!(!found || (sees_none(exact, p, &all[..1]) && p != all[0]), "{exact} at {p} before {lamp:?}");
        }
        let bounds = all.iter().fold([all[0]; 2], |[low, high], s| [low.min(*s), high.max(*s)]);
        assert!(!facing.is_away_from_box(bounds, p) || truly, "{exact} at {p} before {bounds:?}");
    }
    assert!(away > 4_000 && clearly > 2_000, "{away} face away, {clearly} of them clearly");
    assert_eq!(settled, clearly, "some that clearly face away are not settled");
}

#[test]
fn words_are_the_nearest_integers() {
    let mut rng = Rng::named(0, "words");
    for _ in 0..budget::of(100_000) {
        let extent = 1 << rng.below(21);
        let n = rng.point(extent);
        if n == IVec3::ZERO {
            continue;
        }
        let word = Facing::of(given(&mut rng, n)).word();
        let largest = i64::from(n.abs().max_element());
        for k in 0..3 {
            let component = i64::from((word << (22 - 10 * k)) as i32 >> 22);
            // |component·largest − 511·n| ≤ largest/2, but for the roundoff of the products that are compared.
            let twice_off = 2 * (component * largest - 511 * i64::from(n[k])).abs();
            assert!(twice_off <= largest + (largest >> 12) + 1, "{n}: {component}");
        }
    }
    for n in [Vec3::ZERO, Vec3::NAN, Vec3::new(1.0, f32::INFINITY, 0.0), Vec3::splat(1.0e-38), Vec3::splat(2.0e38)] {
        assert_eq!(Facing::of(n), Facing::UNKNOWN, "{n}");
    }
}

#[test]
fn masks_are_full_where_receivers_face_away_and_the_oracles_elsewhere() {
    let executors = [
        CpuExecutor::new().with_index(Index::Hierarchy),
        CpuExecutor::new().with_index(Index::Silhouette),
        CpuExecutor::new().with_index(Index::Grid(GridOptions::default())),
    ];
    let (mut receivers, mut away, mut bits) = (0, 0, 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("facing {name}"));
        for (round, (rows, columns)) in GRIDS.into_iter().enumerate() {
            let grid = SampleGrid::regular(rows, columns);
            let grid = if round % 2 == 1 { grid.jittered(&mut rng) } else { grid };
            let inputs = generator(&mut rng, grid).inputs(EXPONENTS[round]);
            let normals = normals(&mut rng, &inputs, &samples(&inputs));
            let facing = facing(&inputs, &normals);
            let (light, points) = (inputs.light, inputs.receivers.points());
            let full = vec![u64::MAX >> (64 - columns); rows as usize];
            let is_away = |r: usize, facing: Facing| facing.is_away_from(&light, points[r]);
            let wanted = settled(inputs.oracle(), &full, facing.facings(), is_away);
            away += (0..points.len()).filter(|&r| is_away(r, facing.facings()[r])).count();
            receivers += points.len();
            for executor in executors.iter().take(if light.jitter.is_some() { 2 } else { 3 }) {
                let (masks, _) = executor.masks::<u64>(&inputs.occluders, &light, &facing).expect("masks");
                let compared = compare_masks(&wanted, masks.words(), rows, columns, Amount::Some);
                let compared = compared.unwrap_or_else(|e| panic!("{name}: {e}"));
                bits += compared.bits;
            }
        }
    }
    assert!(away > receivers / 6 && away < receivers * 5 / 6, "{away} of {receivers} face away");
    say(&format!("receivers that face some way: {bits} bits, {away} of {receivers} receivers away, 0 differ"));
}

#[test]
fn other_lights_settle_them_too() {
    let executor = CpuExecutor::new();
    let mut away = [0; 2];
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("facing others {name}"));
        let inputs = generator(&mut rng, SampleGrid::regular(4, 4)).inputs(EXPONENTS[0]);
        let (points, triangles) = (inputs.receivers.points(), inputs.triangles());
        let cloud: Vec<IVec3> = (0..70).map(|_| rng.point(REACH >> 4)).collect();
        let receivers = facing(&inputs, &normals(&mut rng, &inputs, &cloud));
        let facings = receivers.facings();

        let cloud = Cloud::new(&cloud[..]).expect("inside");
        let full = [u64::from(u32::MAX), u64::from(u32::MAX), 0x3f];
        let bit = |p: IVec3, s: IVec3| u64::from(triangles.iter().any(|&t| hit(p, s, t)));
        let word = |p, of_word: &[IVec3]| of_word.iter().enumerate().map(|(k, &s)| bit(p, s) << k).sum::<u64>();
        let oracle = points.iter().flat_map(|&p| cloud.samples().chunks(32).map(move |w| word(p, w))).collect();
        let is_away = |r: usize, facing: Facing| facing.is_away_from_box(cloud.bounds(), points[r]);
        let wanted = settled(oracle, &full, facings, is_away);
        let (masks, _) = executor.cloud_masks(&inputs.occluders, &cloud, &receivers).expect("masks");
        compare_masks(&wanted, masks.words(), 3, 32, Amount::Some).unwrap_or_else(|e| panic!("{name}: {e}"));
        away[0] += (0..points.len()).filter(|&r| is_away(r, facings[r])).count();

        for lamp in [Punctual::point(rng.point(REACH >> 3)), Punctual::direction(rng.point(1 << 12) | IVec3::X)] {
            let lamp = lamp.expect("inside");
            let is_away = |r: usize, facing: Facing| facing.is_away_from_punctual(lamp, points[r]);
            let wanted = settled(hard_shadows::oracle(lamp, points, &triangles), &[1], facings, is_away);
            let (shadows, _) = executor.hard_shadows(&inputs.occluders, &lamp, &receivers).expect("shadows");
            let found: Vec<u64> =
                (0..points.len()).map(|r| u64::from(shadows.is_blocked(r).expect("a receiver"))).collect();
            assert_eq!(found, wanted, "{name}, {lamp:?}");
            away[1] += (0..points.len()).filter(|&r| is_away(r, facings[r])).count();
        }
    }
    assert!(away[0] > 50 && away[1] > 100, "{away:?} face away");
}

#[test]
fn what_all_face_away_from_costs_no_triangle() {
    let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) }).expect("bounds");
    let lamp = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16).expect("shines down");
    let lamp = lamp.snap(&lattice, Lift::NONE).expect("inside");
    let bulb = Punctual::point(lamp.sample(8, 8)).expect("inside");
    let corners = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    let occluders = Occluders::new(&lattice, &corners, &[[0, 1, 2]]).expect("inside");
    let points = [Vec3::ZERO, Vec3::new(3.0, -1.0, 0.0), Vec3::new(0.0, 0.0, -3.0)];
    let receivers = |up: f32| {
        let raw = Receivers::raw(&lattice, &points).expect("inside");
        raw.facing(&[Vec3::NEG_Y, Vec3::new(0.3, -0.9, 0.1), Vec3::Y * up]).expect("normals point somewhere")
    };
    let executor = CpuExecutor::new();
    let (away, seen) = (receivers(-1.0), receivers(1.0));
    let plan = |receivers| executor.plan(&occluders, &lamp, receivers, true);
    assert_eq!(plan(&away).reason(Stage::SettleReceivers), (true, "receivers with normals: some may face away"));
    assert_eq!((plan(&away).facts().triangles, plan(&seen).facts().triangles), (0, 1));
    let lights = [lamp.into(), bulb.into()];
    let found = executor.lights(&occluders, &lights, &away).expect("fine");
    assert!(found.iter().all(|(lit, _)| *lit == Lit::Nowhere), "{found:?}");
    let found = executor.lights(&occluders, &lights, &seen).expect("fine");
    assert!(found.iter().all(|(lit, _)| *lit == Lit::Fractions(vec![0.0, 0.0, 1.0])), "{found:?}");
    let raw = Receivers::raw(&lattice, &points).expect("inside");
    assert!(raw.facings().is_empty());
    assert_eq!(plan(&raw).reason(Stage::SettleReceivers), (false, "receivers may look to any side"));
    assert!(plan(&raw).to_string().contains("- settle_receivers"));
    // Where nothing lies between, a cloud is seen by all but those that face away.
    let cloud = Cloud::new([lamp.sample(3, 3), lamp.sample(9, 1)]).expect("inside");
    let (visibility, _) = executor.cloud_visibility(&Occluders::default(), &cloud, &seen).expect("fine");
    assert_eq!(visibility, [0.0, 0.0, 1.0]);
}

#[test]
fn normals_that_point_nowhere_are_refused() {
    let inputs = GENERATORS[0].1(&mut Rng::named(0, "refused"), SampleGrid::regular(4, 8)).inputs(0);
    let count = inputs.receivers.len();
    let mut normals = vec![Vec3::Y; count];
    normals[1] = Vec3::ZERO;
    let refused = inputs.receivers.clone().facing(&normals);
    assert_eq!(refused, Err(SceneError::Normal { index: 1, normal: Vec3::ZERO }));
    let refused = inputs.receivers.clone().facing(&normals[1..]);
    assert_eq!(refused, Err(SceneError::NormalCount { count: count - 1, receivers: count }));
}
