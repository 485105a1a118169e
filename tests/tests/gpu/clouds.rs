//! Clouds of samples on a GPU, against the oracle, bit by bit.

use libtest_mimic::Failed;
use umbra4_core::{
    Facing, Precision, Punctual,
    cloud::{Cloud, MAX_CLOUD},
    cloud_table::{CloudTable, TableSize},
    glam::IVec3,
};
use umbra4_cpu::{CpuExecutor, Occluders};
use umbra4_tests::{
    budget,
    clouds::{Case, KINDS, ball, beside_the_outermost, by_lookups, oracle, property, samples, table_of},
    compare::{Amount, compare_masks, compare_visibility},
    facings,
    gpu::{Check, Test, of_executor, scene},
    ledger::say,
    meshes::{Mesh, icosphere},
    rng::Rng,
    scene::{Inputs, Scene},
    scenes::{GENERATORS, SampleGrid},
};
use umbra4_wgpu::{GpuError, LatticeReceivers, LatticeScene, Loading, WgpuExecutor};

/// Scenes of each generator.
const ROUNDS: usize = 2;
/// What all ways to ask find, compared with the oracle's masks. Returns the signs decided in integers.
fn check(executor: &WgpuExecutor, inputs: &Inputs, cloud: &Cloud<&[IVec3]>, expected: &[u64]) -> Result<u64, String> {
    let (scene, points, samples) = (scene(inputs), inputs.receivers.points(), cloud.samples().len() as u32);
    let amount = if points.is_empty() { Amount::None } else { Amount::Some };
    let width = cloud.words();
    let (masks, statistics) = executor.cloud_masks(&scene, cloud, points).map_err(|error| error.to_string())?;
    compare_masks(expected, &masks, width as u32, 32, amount).map_err(|error| error.to_string())?;
    let blocked = |mask: &[u64]| mask.iter().map(|word| word.count_ones()).sum::<u32>();
    let lit: Vec<u32> = expected.chunks(width).map(|mask| samples - blocked(mask)).collect();
    let (counts, _) = executor.cloud_lit_counts(&scene, cloud, points).map_err(|error| error.to_string())?;
    let (visibility, _) = executor.cloud_visibility(&scene, cloud, points).map_err(|error| error.to_string())?;
    compare_visibility(&lit, &visibility, samples, amount).map_err(|error| error.to_string())?;
    let done = statistics.counts.ok_or("counts were asked for")?;
    if done.pairs_tested < done.pairs_kept || done.pairs_kept < done.pairs_relevant {
        return Err(format!("{done:?}"));
    }
    if counts == lit { Ok(done.fallbacks) } else { Err("the counts differ".into()) }
}

fn oracle_s(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (mut bits, mut blocked, mut fallbacks, mut failed) = (0, 0, 0, None);
    property(name, budget::of(ROUNDS), |Case { what, inputs, cloud, expected, .. }| {
        match check(executor, inputs, cloud, expected) {
            Ok(decided) => fallbacks += decided,
            Err(error) => failed = failed.take().or(Some(format!("{what}: {error}"))),
        }
        bits += (cloud.samples().len() * inputs.receivers.len()) as u64;
        blocked += expected.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
    });
    if let Some(error) = failed {
        return Err(error.into());
    }
    assert!(blocked > 0 && blocked < bits, "{blocked} of {bits}");
    say(&format!(
        "clouds on a GPU, {name}: {bits} bits, {blocked} blocked, {fallbacks} signs decided in integers, 0 differ"
    ));
    Ok(())
}

/// Tables: the bits of the rule, pair by pair, and of the processor, of receivers that face some way too. Where all samples lie in
/// one place, masks are the oracle's.
fn by_table(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (mut bits, mut blocked, mut differing, mut failed) = (0, 0, 0, None);
    let mut rng = Rng::named(1, &format!("tables, facing {name}"));
    property(name, budget::of(ROUNDS), |case| {
        let wanted = match check_table(executor, case, &mut rng) {
            Ok(wanted) => wanted,
            Err(error) => {
                failed = failed.take().or(Some(format!("{}: {error}", case.what)));
                return;
            }
        };
        let apart = |(a, b): (&u64, &u64)| u64::from((a ^ b).count_ones());
        differing += wanted.iter().zip(&case.expected).map(apart).sum::<u64>();
        bits += (case.cloud.samples().len() * case.inputs.receivers.len()) as u64;
        blocked += wanted.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
    });
    if let Some(error) = failed {
        return Err(error.into());
    }
    assert!(blocked > 0 && blocked < bits && differing < bits / 4, "{blocked} of {bits}, {differing} not exact");
    say(&format!("tables on a GPU, {name}: {bits} bits, {blocked} blocked, 0 differ; {differing} from exact masks"));
    Ok(())
}

/// Returns the masks of the rule.
fn check_table(executor: &WgpuExecutor, case: &Case<'_>, rng: &mut Rng) -> Result<Vec<u64>, String> {
    let Case { kind, inputs, cloud, expected, .. } = case;
    let (table, points, samples) = (table_of(case), inputs.receivers.points(), cloud.samples().len() as u32);
    let wanted = by_lookups(&table, points, &inputs.triangles());
    if KINDS[*kind] == "one place" && wanted != *expected {
        return Err("the rule is not exact".into());
    }
    let amount = if points.is_empty() { Amount::None } else { Amount::Some };
    let (lamp, width) = (scene(inputs), cloud.words());
    let quick = WgpuExecutor::new(executor.gpu().clone()).with_precision(Precision::Fast);
    for executor in [executor, &quick] {
        let (masks, _) = executor.cloud_masks_by_table(&lamp, &table, points).map_err(|error| error.to_string())?;
        compare_masks(&wanted, &masks, width as u32, 32, amount).map_err(|error| error.to_string())?;
    }
    let lit = |mask: &[u64]| samples - mask.iter().map(|word| word.count_ones()).sum::<u32>();
    let lit: Vec<u32> = wanted.chunks(width).map(lit).collect();
    let (found, statistics) =
        executor.cloud_visibility_by_table(&lamp, &table, points).map_err(|error| error.to_string())?;
    compare_visibility(&lit, &found, samples, amount).map_err(|error| error.to_string())?;
    let done = statistics.counts.ok_or("counts were asked for")?;
    if done.pairs_tested < done.pairs_kept || done.pairs_kept < done.pairs_relevant {
        return Err(format!("{done:?}"));
    }
    let normals = facings::normals(rng, inputs, cloud.samples());
    let receivers = inputs.receivers.clone().facing(&normals).map_err(|error| error.to_string())?;
    let given = LatticeReceivers { points, facings: receivers.facings(), layers: &[] };
    let (masks, _) = executor.cloud_masks_by_table(&lamp, &table, given).map_err(|error| error.to_string())?;
    let cpu = CpuExecutor::new().cloud_masks_by_table(&inputs.occluders, &table, &receivers);
    let same = masks == cpu.map_err(|error| error.to_string())?.0.words();
    if same { Ok(wanted) } else { Err("receivers that face some way".into()) }
}

/// A scene as they are, of a few levels, by tables of two sizes: the processor's bits, and as close to the exact ones.
fn a_ball_s_shadow_by_table(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let (occluders, receivers, cloud) = ball(3, 24);
    let lamp = LatticeScene { vertices: occluders.vertices(), triangles: occluders.triangles() };
    let (exact, _) = executor.cloud_masks(&lamp, &cloud, receivers.points())?;
    let bits = (cloud.samples().len() * receivers.len()) as f64;
    for (directions, distances, most) in [(8, 8, 0.06), (32, 32, 0.016)] {
        let size = TableSize { directions, distances };
        let table = CloudTable::new(&cloud, size, vec![0; CloudTable::words_of(&cloud, size)?])?;
        let (masks, statistics) = executor.cloud_masks_by_table(&lamp, &table, receivers.points())?;
        let (expected, _) = CpuExecutor::new().cloud_masks_by_table(&occluders, &table, &receivers)?;
        assert_eq!(masks, expected.words());
        let apart: u32 = exact.iter().zip(&masks).map(|(a, b)| (a ^ b).count_ones()).sum();
        assert!(apart > 0 && f64::from(apart) / bits < most, "{apart} of {bits} by {size:?}");
        let ran: Vec<&str> = statistics.stages.iter().map(|(stage, _)| *stage).collect();
        assert!(ran.is_empty() || ran.contains(&"resolve_cloud") && !ran.contains(&"resolve"), "{ran:?}");
        let raw = WgpuExecutor::new(executor.gpu().clone()).with_loading(Loading::Passthrough);
        if let Ok(raw) = raw {
            assert_eq!(raw.cloud_masks_by_table(&lamp, &table, receivers.points())?.0, expected.words());
        }
    }
    Ok(())
}

/// A table that is larger than what the device can bind.
fn large_tables_are_refused(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let limit = executor.gpu().device.limits().max_storage_buffer_binding_size;
    let (occluders, receivers, cloud) = ball(2, 4);
    let lamp = LatticeScene { vertices: occluders.vertices(), triangles: occluders.triangles() };
    let fits = |side: &u32| u64::from(side * side) * 256 * cloud.words() as u64 * 4 <= limit;
    let Some(directions) = (1..=256).find(|side| !fits(side)) else {
        say(&format!("tables: none that is tried is larger than the {limit} bytes that the device can bind"));
        return Ok(());
    };
    let size = TableSize { directions, distances: 256 };
    let table = CloudTable::new(&cloud, size, vec![0; CloudTable::words_of(&cloud, size)?])?;
    let refused = executor.cloud_lit_counts_by_table(&lamp, &table, receivers.points());
    assert!(matches!(refused, Err(GpuError::TooLarge { what: "table of planes", .. })), "{refused:?}");
    Ok(())
}

/// Without certainty: most bits are right all the same, though scenes are made of doubtful signs, and none is decided in integers.
fn fast(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let quick = WgpuExecutor::new(executor.gpu().clone()).with_precision(Precision::Fast).with_counts(true);
    let (mut bits, mut differing) = (0, 0);
    for (name, _) in GENERATORS {
        property(name, 1, |Case { what, inputs, cloud, expected, .. }| {
            let done = quick.cloud_masks(&scene(inputs), cloud, inputs.receivers.points());
            let (masks, statistics) = done.unwrap_or_else(|error| panic!("{what}: {error}"));
            assert_eq!(statistics.counts.map(|counts| counts.fallbacks), Some(0), "{what}");
            assert_eq!(masks.len(), expected.len(), "{what}");
            differing += expected.iter().zip(&masks).map(|(e, m)| u64::from((*e as u32 ^ m).count_ones())).sum::<u64>();
            bits += (cloud.samples().len() * inputs.receivers.len()) as u64;
        });
    }
    assert!(differing > 0 && differing < bits / 8, "{differing} of {bits}");
    Ok(())
}

fn outermost(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let mut rng = Rng::named(0, "outermost sample");
    let (mut blocked, mut clear) = (0, 0);
    for round in 0..budget::of(60) {
        let (samples, inputs) = beside_the_outermost(&mut rng);
        let expected = oracle(&samples, inputs.receivers.points(), &inputs.triangles());
        let cloud = Cloud::new(&samples[..])?;
        check(executor, &inputs, &cloud, &expected).map_err(|error| format!("case {round}, {samples:?}: {error}"))?;
        blocked += expected.iter().filter(|mask| **mask & 1 == 1).count();
        clear += expected.iter().filter(|mask| **mask & 1 == 0).count();
    }
    assert!(blocked > 10 && clear > 10, "{blocked} blocked, {clear} not");
    Ok(())
}

/// One sample is a point light.
fn one_sample(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let (mut bits, mut blocked) = (0, 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("cloud point {name}"));
        for kind in ["anywhere", "on geometry", "among receivers"] {
            let made = generator(&mut rng, SampleGrid::regular(4, 4));
            let samples = samples(&mut rng, &made, kind, 1);
            let inputs = made.inputs(0);
            let (scene, points) = (scene(&inputs), inputs.receivers.points());
            let point = Punctual::point(samples[0]).ok_or("samples are inside")?;
            let (masks, _) = executor.cloud_masks(&scene, &Cloud::new(&samples[..])?, points)?;
            let (shadows, _) = executor.hard_shadows(&scene, &point, points)?;
            for (r, word) in masks.iter().enumerate() {
                assert_eq!(*word, shadows[r / 32] >> (r % 32) & 1, "{name}, {kind}, receiver {r}");
            }
            blocked += masks.iter().filter(|word| **word == 1).count();
            bits += masks.len();
        }
    }
    assert!(blocked > bits / 100 && blocked < bits / 2, "{blocked} of {bits}");
    Ok(())
}

/// A scene as they are, of a few levels, for every way to load kernels: the processor's bits.
fn a_ball_s_shadow(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let (occluders, receivers, sphere) = ball(3, 24);
    let lamp = LatticeScene { vertices: occluders.vertices(), triangles: occluders.triangles() };
    let most: Vec<IVec3> = (0..MAX_CLOUD).map(|k| sphere.samples()[k % 256] + IVec3::splat(k as i32 / 256)).collect();
    for cloud in [sphere.samples(), &most] {
        let cloud = Cloud::new(cloud)?;
        let (expected, _) = CpuExecutor::new().cloud_masks(&occluders, &cloud, &receivers)?;
        let (lit, _) = CpuExecutor::new().cloud_lit_counts(&occluders, &cloud, &receivers)?;
        let (masks, statistics) = executor.cloud_masks(&lamp, &cloud, receivers.points())?;
        assert_eq!(masks, expected.words());
        assert_eq!(executor.cloud_lit_counts(&lamp, &cloud, receivers.points())?.0, lit);
        let counts = statistics.counts.ok_or("counts were asked for")?;
        let pairs = (receivers.len() * occluders.triangles().len()) as u64;
        assert!(counts.pairs_tested < pairs / 20, "{counts:?} of {pairs}");
        let ran: Vec<&str> = statistics.stages.iter().map(|(stage, _)| *stage).collect();
        assert!(ran.is_empty() || ran.contains(&"resolve_cloud") && !ran.contains(&"resolve"), "{ran:?}");
        let raw = WgpuExecutor::new(executor.gpu().clone()).with_loading(Loading::Passthrough);
        if let Ok(raw) = raw {
            assert_eq!(raw.cloud_masks(&lamp, &cloud, receivers.points())?.0, expected.words());
        }
    }
    Ok(())
}

/// Receivers that face some way: the processor's bits, where triangles lie between, and where none do.
fn facing(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let (mut away, mut all) = (0, 0);
    for (name, _) in GENERATORS {
        let mut rng = Rng::named(1, &format!("clouds, facing {name}"));
        property(name, 1, |Case { what, inputs, cloud, .. }| {
            let normals = facings::normals(&mut rng, inputs, cloud.samples());
            let receivers = inputs.receivers.clone().facing(&normals).expect("a normal each");
            let given = LatticeReceivers { points: receivers.points(), facings: receivers.facings(), layers: &[] };
            let nothing = (LatticeScene { vertices: &[], triangles: &[] }, Occluders::default());
            for (on_gpu, occluders) in [(scene(inputs), &inputs.occluders), (nothing.0, &nothing.1)] {
                let (wanted, _) = CpuExecutor::new().cloud_masks(occluders, cloud, &receivers).expect("it fits");
                let (lit, _) = CpuExecutor::new().cloud_lit_counts(occluders, cloud, &receivers).expect("it fits");
                let (masks, _) = executor.cloud_masks(&on_gpu, cloud, given).expect("the device answers");
                assert!(masks == wanted.words(), "{what}");
                let (counts, _) = executor.cloud_lit_counts(&on_gpu, cloud, given).expect("the device answers");
                assert!(counts == lit, "{what}");
            }
            let is_away = |(facing, p): (&Facing, &IVec3)| facing.is_away_from_box(cloud.bounds(), *p);
            away += given.facings.iter().zip(given.points).filter(|pair| is_away(*pair)).count();
            all += given.points.len();
        });
    }
    assert!(away > all / 50 && away < all, "{away} of {all} face away");
    let few = LatticeReceivers { points: &[IVec3::ZERO; 2], facings: &[Facing::UNKNOWN], layers: &[] };
    let nothing = LatticeScene { vertices: &[], triangles: &[] };
    let refused = executor.cloud_lit_counts(&nothing, &Cloud::new([IVec3::ONE])?, few);
    assert!(matches!(refused, Err(GpuError::FacingCount { facings: 1, receivers: 2 })), "{refused:?}");
    Ok(())
}

/// All samples in one place, in the planes of all triangles: every sign is decided in integers, and of as many a thread as there
/// can be.
fn all_in_doubt(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let at = IVec3::new(1 << 20, 3 << 19, 1 << 21);
    let fan = |k: i32| [at, at + IVec3::new(1000 + k, 77 * k, 9000), at + IVec3::new(k, 9001 - k, -k)];
    let vertices: Vec<IVec3> = (0..40).flat_map(fan).collect();
    let triangles: Vec<[u32; 3]> = (0..40).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let receivers: Vec<IVec3> = (0..70).map(|k| at + IVec3::new(k * 31 - 900, k * 7, 5000 - k)).collect();
    let light = GENERATORS[0].1(&mut Rng::named(0, "a light"), SampleGrid::regular(1, 1)).light;
    let inputs = Scene { light, receivers, mesh: Mesh { vertices, triangles } }.inputs(0);
    for samples in [vec![at; MAX_CLOUD], vec![at + IVec3::Z; MAX_CLOUD]] {
        let expected = oracle(&samples, inputs.receivers.points(), &inputs.triangles());
        check(executor, &inputs, &Cloud::new(&samples[..])?, &expected)?;
    }
    Ok(())
}

fn nothing_to_do(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let samples = [IVec3::ZERO, IVec3::new(1000, 2000, 3000)];
    let cloud = Cloud::new(samples)?;
    let receivers = [IVec3::new(5000, 5000, -70); 20];
    let far = icosphere(IVec3::splat(1 << 20), 2, |_| 1000.0);
    let missing = Mesh { vertices: vec![IVec3::ZERO; 3], triangles: vec![[0, 1, 3], [0, 1, u32::MAX]] };
    for Mesh { vertices, triangles } in [Mesh::default(), far, missing] {
        let scene = LatticeScene { vertices: &vertices, triangles: &triangles };
        let (masks, statistics) = executor.cloud_masks(&scene, &cloud, &receivers)?;
        assert!(masks == [0; 20] && statistics.stages.is_empty(), "{statistics:?}");
        assert_eq!(executor.cloud_visibility(&scene, &cloud, &receivers)?.0, [1.0; 20]);
        assert_eq!(executor.cloud_lit_counts(&scene, &cloud, &receivers)?.0, [2; 20]);
        assert!(executor.cloud_masks(&scene, &cloud, &[IVec3::ZERO; 0])?.0.is_empty());
        assert!(executor.cloud_visibility(&scene, &cloud, &[IVec3::ZERO; 0])?.0.is_empty());
    }
    // Triangles that name vertices which do not exist, and degenerate ones, block nothing, beside one that does.
    let vertices = [IVec3::new(-900, -900, -9), IVec3::new(9000, -900, -9), IVec3::new(-900, 9000, -9)];
    let scene = LatticeScene {
        vertices: &vertices,
        triangles: &[[0, 0, 1], [0, 1, 9], [0, 1, 2], [2, 2, 2], [0, 1, u32::MAX]],
    };
    let receivers = [IVec3::new(1, 1, -100), IVec3::new(-50_000, 0, -100), samples[0]];
    let (lit, _) = executor.cloud_lit_counts(&scene, &cloud, &receivers)?;
    assert_eq!(lit, [0, 2, 2]);
    Ok(())
}

pub fn tests() -> Vec<Test> {
    let first = GENERATORS[0].0;
    let checks: [(&str, Check); 9] = [
        ("facing", facing),
        ("fast", fast),
        ("outermost", outermost),
        ("one_sample", one_sample),
        ("a_ball_s_shadow", a_ball_s_shadow),
        ("all_in_doubt", all_in_doubt),
        ("nothing_to_do", nothing_to_do),
        ("a_ball_s_shadow_by_table", a_ball_s_shadow_by_table),
        ("large_tables_are_refused", large_tables_are_refused),
    ];
    let mut checks: Vec<(String, Check, &str)> = checks.map(|(name, check)| (name.to_owned(), check, first)).to_vec();
    for (name, _) in GENERATORS {
        checks.push((format!("oracle::{name}"), oracle_s, name));
        checks.push((format!("by_table::{name}"), by_table, name));
    }
    of_executor(checks)
}
