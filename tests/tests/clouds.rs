//! Clouds of samples: every bit of every instruction set against the oracle, sample by sample, on the suite's scenes, with samples put
//! where signs are zero.

use rayon::prelude::*;
use umbra4_core::{
    Bounds, Jitter, Lattice, Precision, Punctual, SphereLight,
    cloud::{Cloud, CloudError, MAX_CLOUD},
    cloud_table::{CloudTable, TableSize},
    glam::{DVec3, IVec3},
    snap::LIMIT,
    stage::Stage,
};
use umbra4_cpu::{CpuExecutor, Isa, Occluders, Receivers};
use umbra4_tests::{
    compare::{Amount, Compared, compare_masks, compare_visibility},
    ledger::say,
    meshes::{Mesh, icosphere},
    oracle::{behind, hit},
    rng::Rng,
    scene::{Inputs, REACH, Scene},
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
};

/// Scenes of each generator.
const ROUNDS: usize = 8;

/// Questions to the oracle that a case may take.
const QUESTIONS: usize = 500_000;

/// Sizes of clouds: around words, tiles of sixteen, and the most.
const SIZES: [usize; 16] = [1, 2, 15, 16, 17, 31, 32, 33, 64, 100, 255, 256, 257, 500, 1023, MAX_CLOUD];

/// The masks from the rule alone: words of 32 bits, receiver-major.
fn oracle(samples: &[IVec3], receivers: &[IVec3], triangles: &[[IVec3; 3]]) -> Vec<u64> {
    let bit = |p: IVec3, s: IVec3| u64::from(triangles.iter().any(|&t| hit(p, s, t)));
    let word = |p: IVec3, of_word: &[IVec3]| of_word.iter().enumerate().map(|(k, &s)| bit(p, s) << k).sum::<u64>();
    receivers.par_iter().flat_map_iter(|&p| samples.chunks(32).map(move |of_word| word(p, of_word))).collect()
}

fn inside(p: IVec3) -> IVec3 {
    p.clamp(IVec3::splat(-REACH), IVec3::splat(REACH))
}

/// Kinds of clouds: anywhere, on geometry, among receivers, on a line, in a plane, the samples of the scene's area light, a
/// sphere around a vertex, the lattice's outermost points, all in one place.
const KINDS: [&str; 9] =
    ["anywhere", "on geometry", "among receivers", "line", "plane", "area", "sphere", "outermost", "one place"];

/// A cloud for a scene; of `size` samples, but for the kind "area".
fn samples(rng: &mut Rng, scene: &Scene, kind: &str, size: usize) -> Vec<IVec3> {
    let corners = |rng: &mut Rng| match scene.mesh.triangles.len() {
        0 => [rng.point(1 << 20), rng.point(1 << 20), rng.point(1 << 20)],
        count => scene.mesh.triangles[rng.below(count)].map(|vertex| scene.mesh.vertices[vertex as usize]),
    };
    let far = |points: &[IVec3]| points.iter().map(|p| p.abs().max_element()).max().unwrap_or(REACH);
    let extent = far(&scene.mesh.vertices).max(far(&scene.receivers)).min(REACH);
    let [a, b, c] = corners(rng);
    let center = if rng.one_in(2) { a } else { rng.point(extent) };
    let spread = (extent >> rng.below(14)).max(1);
    let [along, across] = [rng.point(spread), rng.point(spread)];
    match kind {
        "area" => {
            let light = scene.light;
            (0..light.rows).flat_map(|i| (0..light.columns).map(move |j| light.sample(i, j))).collect()
        }
        "sphere" => {
            let bounds = Bounds { min: DVec3::splat(-1024.0), max: DVec3::splat(1024.0) };
            let lattice = Lattice::covering(bounds).expect("bounds are fine");
            let radius = f64::from(spread.clamp(64, 1 << 26)) * lattice.step();
            let center = lattice.to_world(center.clamp(IVec3::splat(-(1 << 28)), IVec3::splat(1 << 28)));
            let light = SphereLight { center, radius }.snap(&lattice, vec![IVec3::ZERO; size]);
            light.unwrap_or_else(|error| panic!("{error}")).samples().to_vec()
        }
        _ => {
            let mut sample = || match kind {
                "anywhere" => center + rng.point(spread),
                "on geometry" => {
                    let [a, b, c] = corners(rng);
                    match rng.below(6) {
                        0 => a,
                        1 => a + (b - a) / 2,
                        2 => b + (b - a) / 4,
                        3 => a + (b - a) / 4 + (c - a) / 4,
                        4 => a + (b - a) / 2 - (c - a) / 4,
                        _ => a + rng.point(1),
                    }
                }
                "among receivers" => match scene.receivers.len() {
                    0 => rng.point(extent),
                    count => {
                        let p = scene.receivers[rng.below(count)];
                        if rng.one_in(2) { p } else { p + rng.point(spread) }
                    }
                },
                "line" => center + along / 64 * rng.around(64),
                "plane" if rng.one_in(2) => center + along / 64 * rng.around(64) + across / 64 * rng.around(64),
                // That of a triangle.
                "plane" => a + (b - a) / 64 * rng.around(64) + (c - a) / 64 * rng.around(32),
                "outermost" => rng.point(1) * REACH,
                _ => center,
            };
            (0..size).map(|_| inside(sample())).collect()
        }
    }
}

fn executors() -> Vec<CpuExecutor> {
    let executor = |(k, isa)| CpuExecutor::new().with_isa(isa).with_threads(1 + k % 2).expect("threads can be started");
    Isa::available().into_iter().enumerate().map(executor).collect()
}

/// What all ways to ask of one executor find, compared with the oracle's masks. Returns the signs decided in integers.
fn check(executor: &CpuExecutor, inputs: &Inputs, cloud: &Cloud<&[IVec3]>, expected: &[u64]) -> Result<u64, String> {
    let Inputs { occluders, receivers, .. } = inputs;
    let samples = cloud.samples().len() as u32;
    let found = executor.cloud_masks(occluders, cloud, receivers).map_err(|error| error.to_string())?;
    let (masks, statistics) = found;
    let amount = if receivers.is_empty() { Amount::None } else { Amount::Some };
    let width = cloud.words();
    assert_eq!((masks.width(), masks.receiver(receivers.len())), (width, None));
    compare_masks(expected, masks.words(), width as u32, 32, amount).map_err(|error| error.to_string())?;
    let blocked = |mask: &[u64]| mask.iter().map(|word| word.count_ones()).sum::<u32>();
    let lit: Vec<u32> = expected.chunks(width).map(|mask| samples - blocked(mask)).collect();
    let (counts, _) = executor.cloud_lit_counts(occluders, cloud, receivers).map_err(|error| error.to_string())?;
    let (visibility, _) = executor.cloud_visibility(occluders, cloud, receivers).map_err(|error| error.to_string())?;
    compare_visibility(&lit, &visibility, samples, amount).map_err(|error| error.to_string())?;
    if counts == lit { Ok(statistics.counts.fallbacks) } else { Err("the counts differ".into()) }
}

#[test]
fn every_bit_is_the_oracle_s() {
    let executors = executors();
    let (mut total, mut cases, mut fallbacks, mut partly, mut fast) = (Compared::default(), 0, 0, 0_u64, 0);
    let mut of_kind = [Compared::default(); KINDS.len()];
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("cloud {name}"));
        let (mut of_generator, mut case) = (Compared::default(), 0);
        for round in 0..ROUNDS {
            let grid = SampleGrid::regular(1 + rng.below(32) as u32, 1 + rng.below(32) as u32);
            let scene = generator(&mut rng, grid);
            for (kind, of_kind) in KINDS.into_iter().zip(&mut of_kind) {
                case += 1;
                let size =
                    if kind == "one place" { rng.pick(&[1, 2, 33]) } else { SIZES[(case + round) % SIZES.len()] };
                let mut samples = samples(&mut rng, &scene, kind, size);
                samples.truncate((QUESTIONS / (1 + scene.mesh.triangles.len())).max(1));
                let mut scene = scene.clone();
                if kind == "among receivers" && rng.one_in(2) {
                    scene.receivers.push(rng.pick(&samples));
                }
                scene.receivers.truncate(1 + QUESTIONS / (1 + scene.mesh.triangles.len()) / samples.len());
                let inputs = scene.inputs(EXPONENTS[round % EXPONENTS.len()]);
                let cloud = Cloud::new(&samples[..]).expect("samples are inside");
                let expected = oracle(&samples, inputs.receivers.points(), &inputs.triangles());
                let what = format!("{name}, scene {round}, {kind}, {} samples", samples.len());
                let mut found = None;
                for executor in &executors {
                    let decided = check(executor, &inputs, &cloud, &expected)
                        .unwrap_or_else(|error| panic!("{what}, {}: {error}", executor.isa()));
                    found = Some(decided);
                }
                fallbacks += found.unwrap_or(0);
                let quick = CpuExecutor::new().with_precision(Precision::Fast);
                let (masks, statistics) =
                    quick.cloud_masks(&inputs.occluders, &cloud, &inputs.receivers).expect("it fits");
                let differing = expected.iter().zip(masks.words()).map(|(e, m)| (*e as u32 ^ m).count_ones());
                assert_eq!(statistics.counts.fallbacks, 0, "{what}");
                fast += u64::from(differing.sum::<u32>());
                for mask in expected.chunks(cloud.words()) {
                    let blocked: u32 = mask.iter().map(|word| word.count_ones()).sum();
                    partly += u64::from(blocked > 0 && (blocked as usize) < samples.len());
                    for compared in [&mut total, &mut of_generator, of_kind] {
                        compared.bits += samples.len() as u64;
                        compared.blocked += u64::from(blocked);
                    }
                }
                cases += 1;
            }
        }
        assert!(of_generator.blocked > 0 && of_generator.blocked < of_generator.bits, "{name}: {of_generator:?}");
    }
    for (kind, compared) in KINDS.into_iter().zip(of_kind) {
        assert!(compared.blocked > 0 && compared.blocked < compared.bits, "{kind}: {compared:?}");
    }
    assert!(fallbacks > total.bits / 1000, "only {fallbacks} signs were hard");
    assert!(partly > 1000, "only {partly} receivers see some samples and not others");
    // Scenes are made of doubtful signs; most bits are right all the same.
    assert!(fast > 0 && fast < total.bits / 8, "{fast} of {total:?} differ without certainty");
    say(&format!(
        "clouds: {} bits of {cases} cases, {} blocked, {partly} receivers see a part, {fallbacks} signs decided in integers, 0 \
         differ; {fast} without certainty",
        total.bits, total.blocked
    ));
}

/// One sample is a point light.
/// Planes that pass just inside, through and beyond the outermost sample of a large light, whose extent no float holds.
#[test]
fn planes_beside_the_outermost_sample() {
    let executors = executors();
    let mut rng = Rng::named(0, "outermost sample");
    let (mut blocked, mut clear) = (0, 0);
    for round in 0..600 {
        let axis = rng.below(3);
        let half = (1 << (24 + rng.below(4))) + 2 * rng.below(1 << 20) as i32 + 1;
        let turned = |along: i32, u: i32, v: i32| {
            let mut p = [0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (along, u, v);
            IVec3::from_array(p)
        };
        let samples = [turned(half, 0, 0), turned(-half, 0, 0)];
        let plane = half - rng.around(16);
        let size = 50 + rng.below(1 << 12) as i32;
        let triangle = [turned(plane, -size, -size), turned(plane, size, -size), turned(plane, 0, 2 * size)];
        let receivers = vec![turned(plane + 100, 0, 0), turned(plane + 1, 1, -1), turned(half + 40, 3, 5)];
        let mesh = Mesh { vertices: triangle.to_vec(), triangles: vec![[0, 1, 2]] };
        let light = GENERATORS[0].1(&mut Rng::named(0, "a light"), SampleGrid::regular(1, 1)).light;
        let inputs = Scene { light, receivers, mesh }.inputs(0);
        let expected = oracle(&samples, inputs.receivers.points(), &inputs.triangles());
        let cloud = Cloud::new(&samples[..]).expect("samples are inside");
        for executor in &executors {
            check(executor, &inputs, &cloud, &expected)
                .unwrap_or_else(|error| panic!("case {round}, {samples:?}, {triangle:?}, {}: {error}", executor.isa()));
        }
        blocked += expected.iter().filter(|mask| **mask & 1 == 1).count();
        clear += expected.iter().filter(|mask| **mask & 1 == 0).count();
    }
    assert!(blocked > 100 && clear > 100, "{blocked} blocked, {clear} not");
}

#[test]
fn one_sample_is_a_point() {
    let (executor, mut blocked, mut bits) = (CpuExecutor::new(), 0, 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("cloud point {name}"));
        for round in 0..20 {
            let scene = generator(&mut rng, SampleGrid::regular(4, 4));
            let samples = samples(&mut rng, &scene, KINDS[round % 5], 1);
            let Inputs { occluders, receivers, .. } = scene.inputs(0);
            let cloud = Cloud::new(&samples[..]).expect("samples are inside");
            let point = Punctual::point(samples[0]).expect("samples are inside");
            let (masks, _) = executor.cloud_masks(&occluders, &cloud, &receivers).expect("it fits");
            let (shadows, _) = executor.hard_shadows(&occluders, &point, &receivers).expect("nothing can fail");
            for (r, word) in masks.words().iter().enumerate() {
                assert_eq!(Some(*word == 1), shadows.is_blocked(r), "{name}, scene {round}, receiver {r}");
            }
            blocked += shadows.count();
            bits += shadows.len();
        }
    }
    assert!(blocked > bits / 100 && blocked < bits / 2, "{blocked} of {bits}");
}

/// Before an area light, the cloud of its samples is that light.
#[test]
fn the_samples_of_an_area_light_are_that_light() {
    let (executor, mut blocked, mut bits) = (CpuExecutor::new(), 0_u64, 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("cloud area {name}"));
        for round in 0..12 {
            let (rows, columns) = (1 + rng.below(32) as u32, 1 + rng.below(32) as u32);
            let mut scene = generator(&mut rng, SampleGrid { rows, columns, jitter: Jitter::NONE });
            let light = scene.light;
            scene.receivers.retain(|p| !behind(&light, *p));
            let samples = samples(&mut rng, &scene, "area", 0);
            let inputs = scene.inputs(0);
            let (occluders, receivers) = (inputs.occluders.arranged(), inputs.receivers);
            let cloud = Cloud::new(&samples[..]).expect("samples are inside");
            let (found, _) = executor.cloud_masks(&occluders, &cloud, &receivers).expect("it fits");
            let (masks, _) = executor.masks::<u32>(&occluders, &light, &receivers).expect("the word fits");
            for (r, mask) in found.words().chunks(cloud.words()).enumerate() {
                let rows = masks.receiver(r).expect("there is such a receiver");
                for (k, _) in samples.iter().enumerate() {
                    let wanted = rows[k / columns as usize] >> (k % columns as usize) & 1;
                    assert_eq!(mask[k / 32] >> (k % 32) & 1, wanted, "{name}, scene {round}, receiver {r}, sample {k}");
                    blocked += u64::from(wanted);
                }
                bits += samples.len() as u64;
            }
        }
    }
    assert!(blocked > bits / 50 && blocked < bits, "{blocked} of {bits}");
}

/// A ball over a floor, before a sphere: a scene as they are, large enough for a hierarchy of some levels and several jobs.
fn ball(subdivisions: u32, side: i32) -> (Occluders, Receivers, Cloud<Vec<IVec3>>) {
    let lattice =
        Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("bounds are fine");
    let unit = (1.0 / lattice.step()) as i32;
    let mesh = icosphere(IVec3::new(0, unit, 0), subdivisions, |_| f64::from(unit));
    let world = |p: &IVec3| lattice.to_world(*p);
    let vertices: Vec<DVec3> = mesh.vertices.iter().map(world).collect();
    let occluders = Occluders::from_f64(&lattice, &vertices, &mesh.triangles).expect("vertices are inside");
    let step = 4.0 / f64::from(side);
    let points = (0..side).flat_map(|i| (0..side).map(move |j| (f64::from(i) * step - 2.0, f64::from(j) * step - 2.0)));
    let points: Vec<DVec3> = points.map(|(x, z)| DVec3::new(x, -0.25, z)).collect();
    let receivers = Receivers::raw_f64(&lattice, &points).expect("points are inside");
    let light = SphereLight { center: DVec3::new(1.0, 6.0, 0.5), radius: 0.75 };
    (occluders, receivers, light.snap(&lattice, vec![IVec3::ZERO; 256]).expect("it fits"))
}

#[test]
fn a_ball_s_shadow() {
    let (occluders, receivers, cloud) = ball(4, 32);
    let triangles: Vec<_> = (0..occluders.triangles().len()).filter_map(|t| occluders.corners(t)).collect();
    let (masks, statistics) = CpuExecutor::new().cloud_masks(&occluders, &cloud, &receivers).expect("it fits");
    // The oracle's, of every twenty-third receiver.
    let (mut some, mut all) = (0, 0);
    for (r, p) in receivers.points().iter().enumerate().step_by(23) {
        let expected = oracle(cloud.samples(), &[*p], &triangles);
        let mask = masks.receiver(r).expect("there is such a receiver");
        compare_masks(&expected, mask, cloud.words() as u32, 32, Amount::Some).unwrap_or_else(|e| panic!("{r}: {e}"));
        let blocked: u32 = mask.iter().map(|word| word.count_ones()).sum();
        (some, all) = (some + usize::from(blocked > 0), all + usize::from(blocked == 256));
    }
    assert!(all > 2 && some > all + 5, "{some} receivers in shadow, {all} of them in full");
    // What is no occluder is not looked at.
    let counts = statistics.counts;
    let pairs = (receivers.len() * triangles.len()) as u64;
    assert!(counts.pairs_tested < pairs / 20 && counts.pairs_kept < counts.pairs_tested / 2, "{counts:?} of {pairs}");
    let plan = CpuExecutor::new().cloud_plan(&occluders, &cloud, &receivers, false);
    assert_eq!(plan.reason(Stage::ResolveCloud), (true, "receivers to shadow"));
    assert_eq!(plan.reason(Stage::Resolve), (false, "the light is a cloud of samples"));
    assert!(plan.reason(Stage::OrderTriangles).0 && !plan.reason(Stage::Reduce).0);
    let arranged = occluders.arranged();
    let (again, statistics) = CpuExecutor::new().cloud_masks(&arranged, &cloud, &receivers).expect("it fits");
    assert_eq!(masks, again);
    assert!(statistics.seconds_by_stage.iter().all(|(stage, _)| *stage != "order_triangles"), "{statistics:?}");
}

#[test]
fn what_is_not_reached_costs_nothing() {
    let executor = CpuExecutor::new();
    let mut rng = Rng::named(0, "no cloud");
    let mut scene = GENERATORS[0].1(&mut rng, SampleGrid::regular(4, 4));
    let samples = [IVec3::ZERO, IVec3::new(1000, 2000, 3000)];
    let cloud = Cloud::new(samples).expect("samples are inside");
    scene.receivers = vec![IVec3::new(5000, 5000, -70); 20];
    for mesh in [Mesh::default(), icosphere(IVec3::splat(1 << 20), 2, |_| 1000.0)] {
        scene.mesh = mesh;
        let Inputs { occluders, receivers, .. } = scene.inputs(0);
        let (masks, statistics) = executor.cloud_masks(&occluders, &cloud, &receivers).expect("it fits");
        assert!(masks.words() == [0; 20] && statistics.seconds_by_stage.is_empty(), "{statistics:?}");
        assert_eq!(executor.cloud_visibility(&occluders, &cloud, &receivers).expect("it fits").0, [1.0; 20]);
        assert_eq!(executor.cloud_lit_counts(&occluders, &cloud, &receivers).expect("it fits").0, [2; 20]);
        let plan = executor.cloud_plan(&occluders, &cloud, &receivers, true).to_string();
        assert!(plan.lines().all(|line| line.starts_with('-')), "{plan}");
    }
    scene.receivers.clear();
    let Inputs { occluders, receivers, .. } = scene.inputs(0);
    let (masks, statistics) = executor.cloud_masks(&occluders, &cloud, &receivers).expect("it fits");
    assert!(masks.words().is_empty() && statistics.seconds_by_stage.is_empty());
    assert!(executor.cloud_visibility(&occluders, &cloud, &receivers).expect("it fits").0.is_empty());
}

/// The table's bits differ from the exact ones, by less the finer it is; its coarsest planes leave a shadow all the same.
#[test]
fn tables_come_close() {
    let (occluders, receivers, cloud) = ball(3, 32);
    let samples = cloud.samples().len() as f64;
    for isa in Isa::available() {
        let executor = CpuExecutor::new().with_isa(isa);
        let (exact, _) = executor.cloud_masks(&occluders, &cloud, &receivers).expect("it fits");
        let mut last = 1.0;
        for (directions, distances, most) in [(8, 8, 0.06), (32, 32, 0.016), (128, 128, 0.004)] {
            let size = TableSize { directions, distances };
            let room = vec![!0; CloudTable::words_of(&cloud, size).expect("a size")];
            let table = CloudTable::new(&cloud, size, room).expect("the room is that of the table");
            let (masks, _) = executor.cloud_masks_by_table(&occluders, &table, &receivers).expect("it fits");
            let differing = exact.words().iter().zip(masks.words()).map(|(a, b)| (a ^ b).count_ones()).sum::<u32>();
            let lit = |mask: &[u32]| mask.iter().map(|word| word.count_zeros()).sum::<u32>();
            let pairs = exact.words().chunks(cloud.words()).zip(masks.words().chunks(cloud.words()));
            let error: u32 = pairs.map(|(a, b)| lit(a).abs_diff(lit(b))).sum();
            let [differing, error] = [differing, error].map(|n| f64::from(n) / samples / receivers.len() as f64);
            assert!(differing > 0.0 && differing < most && differing < last, "{directions}, {isa}: {differing}");
            last = differing;
            say(&format!(
                "a table of {directions}² × {distances} planes, {isa}: {differing:.5} of all bits differ, visibility is off by \
                 {error:.5}"
            ));
        }
    }
}

/// The comparison above would notice.
#[test]
fn a_wrong_bit_is_noticed() {
    let (occluders, receivers, cloud) = ball(2, 8);
    let triangles: Vec<_> = (0..occluders.triangles().len()).filter_map(|t| occluders.corners(t)).collect();
    let inputs = Inputs {
        lattice: Lattice::covering(Bounds { min: DVec3::ZERO, max: DVec3::ONE }).expect("bounds are fine"),
        light: GENERATORS[0].1(&mut Rng::named(0, "a light"), SampleGrid::regular(1, 1)).light,
        occluders,
        receivers,
    };
    let expected = oracle(cloud.samples(), inputs.receivers.points(), &triangles);
    let cloud = Cloud::new(cloud.samples()).expect("as before");
    let executor = CpuExecutor::new();
    assert_eq!(check(&executor, &inputs, &cloud, &expected).map(|_| ()), Ok(()));
    for place in [0, expected.len() / 2, expected.len() - 1] {
        for bit in [0, 17, 31] {
            let mut wrong = expected.clone();
            wrong[place] ^= 1 << bit;
            assert!(check(&executor, &inputs, &cloud, &wrong).is_err());
        }
    }
    // Two samples in each other's place.
    let mut samples = cloud.samples().to_vec();
    samples.swap(0, 255);
    assert!(check(&executor, &inputs, &Cloud::new(&samples[..]).expect("as before"), &expected).is_err());
}

#[test]
fn bad_clouds_are_refused() {
    for count in [0, MAX_CLOUD + 1, 100_000] {
        assert_eq!(Cloud::new(vec![IVec3::ZERO; count]), Err(CloudError::Count { count }));
    }
    for (index, sample) in
        [IVec3::MAX, IVec3::MIN, IVec3::new(0, LIMIT, 0), IVec3::new(0, 0, -LIMIT)].into_iter().enumerate()
    {
        let mut samples = [IVec3::splat(LIMIT - 1), IVec3::splat(1 - LIMIT), IVec3::ZERO, IVec3::ONE];
        assert!(Cloud::new(samples).is_ok());
        samples[index] = sample;
        let error = Cloud::new(samples).expect_err("outside");
        assert_eq!(error, CloudError::OutsideLattice { index, sample });
        assert!(error.to_string().contains(&format!("sample {index}")), "{error}");
    }
}
