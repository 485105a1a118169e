//! Clouds of samples: every bit of every instruction set against the oracle, sample by sample, on the suite's scenes, with samples put
//! where signs are zero.

use umbra4_core::{
    Bounds, Jitter, Lattice, Precision, Punctual,
    cloud::{Cloud, CloudError, MAX_CLOUD},
    cloud_extent::CloudExtent,
    cloud_pair::Pair,
    cloud_table::{CloudTable, TableSize},
    cloud_tiles::CloudTiles,
    exact::{Wide, far_side},
    glam::{DVec3, IVec3},
    plane_cell::CellGrid,
    snap::LIMIT,
    stage::Stage,
};
use umbra4_cpu::{CpuExecutor, Isa};
use umbra4_tests::{
    budget,
    clouds::{Case, KINDS, ball, beside_the_outermost, by_lookups, oracle, property, samples, table_of},
    compare::{Amount, Compared, compare_masks, compare_visibility},
    ledger::say,
    meshes::{Mesh, icosphere},
    oracle::behind,
    rng::Rng,
    scene::Inputs,
    scenes::{GENERATORS, SampleGrid},
};

/// Scenes of each generator.
const ROUNDS: usize = 6;

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
    for (name, _) in GENERATORS {
        let mut of_generator = Compared::default();
        property(name, budget::of(ROUNDS), |case| {
            let Case { what, kind, inputs, cloud, expected } = case;
            let mut found = None;
            for executor in &executors {
                let decided = check(executor, inputs, cloud, expected)
                    .unwrap_or_else(|error| panic!("{what}, {}: {error}", executor.isa()));
                found = Some(decided);
            }
            fallbacks += found.unwrap_or(0);
            let quick = CpuExecutor::new().with_precision(Precision::Fast);
            let (masks, statistics) = quick.cloud_masks(&inputs.occluders, cloud, &inputs.receivers).expect("it fits");
            let differing = expected.iter().zip(masks.words()).map(|(e, m)| (*e as u32 ^ m).count_ones());
            assert_eq!(statistics.counts.fallbacks, 0, "{what}");
            fast += u64::from(differing.sum::<u32>());
            let samples = cloud.samples().len();
            for mask in expected.chunks(cloud.words()) {
                let blocked: u32 = mask.iter().map(|word| word.count_ones()).sum();
                partly += u64::from(blocked > 0 && (blocked as usize) < samples);
                for compared in [&mut total, &mut of_generator, &mut of_kind[*kind]] {
                    compared.bits += samples as u64;
                    compared.blocked += u64::from(blocked);
                }
            }
            cases += 1;
        });
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

/// A table's masks are what the rule says, pair by pair: however pairs are found, by every instruction set and in both precisions.
/// Where all samples lie in one place, they are exact.
#[test]
fn tables_are_their_rule() {
    let executors = executors();
    let (mut bits, mut blocked, mut partly, mut differing) = (0, 0, 0, 0);
    for (name, _) in GENERATORS {
        property(name, budget::of(ROUNDS / 2), |case| {
            let Case { what, kind, inputs, cloud, expected } = case;
            let table = table_of(case);
            let (points, samples) = (inputs.receivers.points(), cloud.samples().len() as u32);
            let wanted = by_lookups(&table, points, &inputs.triangles());
            let amount = if points.is_empty() { Amount::None } else { Amount::Some };
            for executor in &executors {
                let quick = CpuExecutor::new().with_isa(executor.isa()).with_precision(Precision::Fast);
                for executor in [executor, &quick] {
                    let what = format!("{what}, {:?}, {}", table.size(), executor.isa());
                    let Inputs { occluders, receivers, .. } = inputs;
                    let (masks, _) = executor.cloud_masks_by_table(occluders, &table, receivers).expect("it fits");
                    compare_masks(&wanted, masks.words(), cloud.words() as u32, 32, amount)
                        .unwrap_or_else(|error| panic!("{what}: {error}"));
                    let lit = |mask: &[u64]| samples - mask.iter().map(|word| word.count_ones()).sum::<u32>();
                    let lit: Vec<u32> = wanted.chunks(cloud.words()).map(lit).collect();
                    let counts = executor.cloud_lit_counts_by_table(occluders, &table, receivers);
                    assert_eq!(counts.expect("it fits").0, lit, "{what}");
                    let found = executor.cloud_visibility_by_table(occluders, &table, receivers);
                    compare_visibility(&lit, &found.expect("it fits").0, samples, amount)
                        .unwrap_or_else(|error| panic!("{what}: {error}"));
                }
            }
            let apart = |(a, b): (&u64, &u64)| (a ^ b).count_ones();
            let apart: u32 = wanted.iter().zip(expected).map(apart).sum();
            if KINDS[*kind] == "one place" {
                assert_eq!(apart, 0, "{what}");
            }
            differing += u64::from(apart);
            bits += u64::from(samples) * points.len() as u64;
            for mask in wanted.chunks(cloud.words()) {
                let of_one: u32 = mask.iter().map(|word| word.count_ones()).sum();
                blocked += u64::from(of_one);
                partly += u64::from(of_one > 0 && of_one < samples);
            }
        });
    }
    assert!(blocked > bits / 100 && blocked < bits / 2 && partly > 1000, "{blocked} of {bits}, {partly} in part");
    assert!(differing > 0 && differing < bits / 8, "{differing} of {bits} differ from the exact ones");
    say(&format!("tables: {bits} bits, {blocked} blocked, 0 differ from their rule; {differing} from exact masks"));
}

/// Planes lie in the cells that long floats put them in, unless those see them at an edge.
#[test]
fn planes_lie_in_their_cells() {
    let mut rng = Rng::named(0, "cells of planes");
    let (mut cut, mut all, mut none) = (0, 0, 0);
    for round in 0..budget::of(40_000) {
        let reach = rng.pick(&[60, 1000, 1 << 20, LIMIT - 1]);
        let spread = 1 + (reach >> (1 + rng.below(11)));
        let center = rng.point(reach - spread);
        let samples: Vec<IVec3> = (0..1 + rng.below(3)).map(|_| center + rng.point(spread)).collect();
        let cells = TableSize { directions: 1 + rng.below(1024) as u32, distances: 1 + rng.below(4096) as u32 };
        let (extent, corners) = (CloudExtent::of(&samples), [rng.point(reach), rng.point(reach), rng.point(reach)]);
        let pair = Pair { receiver: rng.point(reach), corners, flipped: rng.one_in(2), cuts: 0b1111 };
        let (p, [a, b, c]) = (pair.receiver, corners);
        let normals = [(a - p, b - a), (b - p, c - b), (c - p, a - c), (b - a, c - a)];
        for (k, (e, f)) in normals.into_iter().enumerate() {
            let what = format!("case {round}, plane {k} of {pair:?}, {samples:?}, {cells:?}");
            let side = if pair.flipped { -1.0 } else { 1.0 };
            let n = e.as_dvec3().cross(f.as_dvec3()) * side;
            let to_middle = (extent.middle() - if k < 3 { p } else { a }).as_dvec3();
            let away = n.dot(to_middle);
            let doubt = 1.0e-14 * e.as_dvec3().length() * f.as_dvec3().length() * to_middle.length();
            if k < 3 && n.length() * spread.max(1) as f64 * 1.0e-4 < doubt || n.length() == 0.0 {
                continue;
            }
            let [low, high] = extent.bounds();
            let half = (high - extent.middle()).max(extent.middle() - low).as_dvec3();
            let radius = f64::from(extent.radius()).max(1.0);
            let within = (n.length() * radius).min(n.abs().dot(half));
            let found = CellGrid::new(&extent, cells).cell(&pair, k);
            // Components, the radius and half extents have 15 bits.
            let slack = n.length() * radius * 3.0e-4 + doubt;
            match found.slot {
                -1 => assert!(away >= within - slack, "{what}: {away} of {within}"),
                slot if slot == cells.distances as i32 => {
                    assert!(-away >= within - slack, "{what}: {away} of {within}")
                }
                slot => {
                    assert!(away.abs() <= within + slack, "{what}: {away} of {within}");
                    let along = (0.5 - 0.5 * away / (n.length() * radius)) * f64::from(cells.distances);
                    let off = 1.0e-3 * f64::from(cells.distances) + 1.0e-3;
                    let slot = f64::from(slot);
                    assert!(along > slot - off && along < slot + 1.0 + off, "{what}: {along}, not in {slot}");
                    let u = n / (n.x.abs() + n.y.abs() + n.z.abs());
                    let folded = |at: f64, other: f64| if u.z >= 0.0 { at } else { (1.0 - other.abs()).copysign(at) };
                    let place =
                        [folded(u.y, u.x), folded(u.x, u.y)].map(|at| (0.5 * at + 0.5) * f64::from(cells.directions));
                    let cell = [found.direction / cells.directions, found.direction % cells.directions].map(f64::from);
                    let is_in = |k: usize| place[k] > cell[k] - 0.05 && place[k] < cell[k] + 1.05;
                    assert!(is_in(0) && is_in(1), "{what}: {place:?}, not in {cell:?}");
                    cut += 1;
                }
            }
            all += usize::from(found.slot == -1);
            none += usize::from(found.slot == cells.distances as i32);
        }
    }
    assert!(cut > 5000 && all > 5000 && none > 5000, "{cut} cut, {all} hold all, {none} none");
}

/// Planes that pass just inside, through and beyond the outermost sample of a large light, whose extent no float holds.
#[test]
fn planes_beside_the_outermost_sample() {
    let executors = executors();
    let mut rng = Rng::named(0, "outermost sample");
    let (mut blocked, mut clear) = (0, 0);
    for round in 0..budget::of(600) {
        let (samples, inputs) = beside_the_outermost(&mut rng);
        let expected = oracle(&samples, inputs.receivers.points(), &inputs.triangles());
        let cloud = Cloud::new(&samples[..]).expect("samples are inside");
        for executor in &executors {
            check(executor, &inputs, &cloud, &expected)
                .unwrap_or_else(|error| panic!("case {round}, {samples:?}, {}: {error}", executor.isa()));
        }
        blocked += expected.iter().filter(|mask| **mask & 1 == 1).count();
        clear += expected.iter().filter(|mask| **mask & 1 == 0).count();
    }
    assert!(blocked > 100 && clear > 100, "{blocked} blocked, {clear} not");
}

/// One sample is a point light.
#[test]
fn one_sample_is_a_point() {
    let (executor, mut blocked, mut bits) = (CpuExecutor::new(), 0, 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("cloud point {name}"));
        for round in 0..budget::of(20) {
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
        for round in 0..budget::of(12) {
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
    let size = TableSize { directions: 4, distances: 4 };
    let room = vec![0; CloudTable::words_of(&cloud, size).expect("a size")];
    let table = CloudTable::new(&cloud, size, room).expect("the room is that of the table");
    let plan = CpuExecutor::new().cloud_plan_by_table(&occluders, &table, &receivers, true);
    assert_eq!(plan.reason(Stage::ResolveCloud), (true, "receivers to shadow, by a table of planes"));
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

/// Triangles are oriented right in short floats too, as a GPU does it: or both sides of them are looked at.
#[test]
fn short_floats_orient_triangles() {
    let mut rng = Rng::named(0, "orientation");
    let (mut turned, mut kept, mut mixed, mut nothing) = (0, 0, 0, 0);
    for round in 0..budget::of(20_000) {
        let reach = rng.pick(&[4, 1000, 1 << 20, LIMIT - 1]);
        let less = 1 + (reach >> rng.below(12));
        let samples = [rng.point(reach), rng.point(reach), rng.point(less)];
        let cloud = Cloud::new(&samples[..]).expect("samples are inside");
        let tiles = CloudTiles::new(cloud.samples());
        let a = if rng.one_in(3) { samples[0] } else { rng.point(reach) };
        let corners = [a, rng.point(reach), if rng.one_in(9) { a } else { rng.point(reach) }];
        let side = |[a, b, c]: [IVec3; 3], s: IVec3| -far_side::<Wide>(s, [a, b, c]);
        for found in [tiles.extent().occluder::<f32>(corners), tiles.extent().occluder::<f64>(corners)] {
            let what = format!("case {round}: {samples:?} before {corners:?}");
            match found {
                None => {
                    assert!(samples.iter().all(|s| side(corners, *s) == 0), "{what}");
                    nothing += 1;
                }
                Some(occluder) if occluder.is_mixed() => mixed += 1,
                Some(occluder) => {
                    assert!(samples.iter().all(|s| side(occluder.corners(), *s) > 0), "{what}");
                    *(if occluder.corners() == corners { &mut kept } else { &mut turned }) += 1;
                }
            }
        }
    }
    for count in [turned, kept, mixed, nothing] {
        assert!(count > 1000, "{turned} turned, {kept} kept, {mixed} mixed, {nothing} nothing");
    }
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
