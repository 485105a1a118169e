//! What the suite's scenes do not reach: many receivers, world input, statistics, the fast mode, and the index by itself.

use std::sync::atomic::{AtomicU32, Ordering};

use bytemuck::Zeroable;
use umbra4_core::{
    Exact, Lattice, Lift, Plan, SceneFacts,
    frame::LightFrame,
    glam::Vec3,
    occluder::Occluder,
    order::Entry,
    proj4::{KeyTile, NOTHING, covers},
    serial::{Buffers, Serial},
    stage::{key_receivers::key_receivers, key_triangles::key_triangles},
};
use umbra4_cpu::{CpuExecutor, Index, Occluders, Precision, Receivers};
use umbra4_tests::{
    budget,
    compare::{Amount, compare_masks},
    ledger::say,
    oracle::oracle_mask,
    rng::Rng,
    scene::Inputs,
    scenes::{EXPONENTS, GENERATORS, SampleGrid, grid, world},
};

/// Largest share of the bits that `fast` may differ in on a realistic scene. Measured: 2·10^-7.
const FAST_DIFFERING_SHARE: f64 = 1.0e-4;

/// More receivers than an executor takes in one block (2^18), every bit compared.
#[test]
fn more_receivers_than_a_block() {
    let mut scene = world(&mut Rng::named(0, "many receivers"), 4, 16, 40, 1);
    let side = 520_u32;
    scene.receivers = (0..side * side)
        .map(|k| Vec3::new((k % side) as f32, 0.0, (k / side) as f32) * (16.0 / side as f32) - Vec3::new(8.0, 0.0, 8.0))
        .collect();
    assert!(scene.receivers.len() > 1 << 18);
    let inputs = scene.inputs();
    let executor = CpuExecutor::new().with_threads(2).expect("threads can be started").with_index(Index::Hierarchy);
    let (masks, statistics) =
        executor.masks::<u16>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("the word fits");
    let compared =
        compare_masks(&inputs.oracle(), masks.words(), 4, 16, Amount::Some).unwrap_or_else(|e| panic!("{e}"));
    say(&format!("more receivers than a block: bits compared: {}, differing: 0", compared.bits));
    assert!(compared.blocked > compared.bits / 100);

    // The ways to ask agree, and each receiver is visited once.
    let visits: Vec<AtomicU32> = scene.receivers.iter().map(|_| AtomicU32::new(0)).collect();
    let visited = executor
        .visit::<u16>(&inputs.occluders, &inputs.light, &inputs.receivers, |r, rows| {
            visits[r].fetch_add(1, Ordering::Relaxed);
            assert_eq!(Some(rows), masks.receiver(r), "receiver {r}");
        })
        .expect("the word fits");
    assert!(visits.iter().all(|n| n.load(Ordering::Relaxed) == 1));
    assert_eq!(visited.counts, statistics.counts, "counts are as deterministic as bits");
    assert_eq!(masks.receiver(scene.receivers.len()), None);

    let counts = statistics.counts;
    let all = scene.receivers.len() as u64 * scene.triangles.len() as u64;
    assert!(counts.pairs_relevant > 0 && counts.pairs_relevant <= counts.pairs_kept, "{counts:?}");
    assert!(counts.pairs_kept <= all, "{counts:?} of {all} pairs");
}

/// Statistics and masks are the same for any number of threads.
#[test]
fn threads_change_nothing() {
    let inputs = world(&mut Rng::named(0, "threads"), 32, 32, 300, 5000).inputs();
    let run = |threads| {
        let executor = CpuExecutor::new().with_threads(threads).expect("threads can be started");
        let (masks, statistics) =
            executor.masks::<u32>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("the word fits");
        (masks, statistics.counts)
    };
    let one = run(1);
    assert!(one.0.words().iter().any(|&w| w != 0));
    for threads in [2, 3, 7] {
        assert_eq!(run(threads), one, "{threads} threads");
    }
}

/// Plain f32 may differ; how much is shown. No bit may lie beyond the last column.
#[test]
fn fast_differs_in_few_bits() {
    let inputs = world(&mut Rng::named(0, "fast"), 33, 33, 300, 5000).inputs();
    let fast = CpuExecutor::new().with_precision(Precision::Fast);
    let (masks, statistics) =
        fast.masks::<u64>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("the word fits");
    assert_eq!(statistics.counts.fallbacks, 0, "nothing is certified");
    let expected = inputs.oracle();
    assert_eq!(masks.words().len(), expected.len());
    assert!(masks.words().iter().all(|w| w >> 33 == 0), "stray bits");
    let differing: u32 = expected.iter().zip(masks.words()).map(|(a, b)| (a ^ b).count_ones()).sum();
    let bits = expected.len() * 33;
    say(&format!("fast, realistic scene: bits compared: {bits}, differing: {differing}"));
    assert!(f64::from(differing) <= FAST_DIFFERING_SHARE * bits as f64);
}

/// The suite's scenes are hard: plain f32 gets bits wrong in many of them, which the suite would find.
#[test]
fn fast_fails_on_the_scenes_of_the_suite() {
    let mut rng = Rng::named(0, "fast is not exact");
    let fast = CpuExecutor::new().with_precision(Precision::Fast);
    for name in ["coarse_grid", "in_planes", "full_coverage", "slivers", "tiny"] {
        let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).expect("a generator has this name");
        let (mut bits, mut differing) = (0, 0);
        for _ in 0..budget::of(100) {
            let inputs = generator(&mut rng, SampleGrid::regular(16, 16)).inputs(0);
            let (masks, _) =
                fast.masks::<u16>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("the word fits");
            let expected = inputs.oracle();
            assert_eq!(masks.words().len(), expected.len());
            bits += expected.len() * 16;
            differing += expected.iter().zip(masks.words()).map(|(a, &b)| (a ^ u64::from(b)).count_ones()).sum::<u32>();
        }
        say(&format!("fast, {name}: bits compared: {bits}, differing: {differing}"));
        assert!(differing > 0, "{name} asks for no exactness: f32 would do");
    }
}

/// The index drops no pair that matters: wherever the oracle finds a blocked sample, the full-coverage test keeps the
/// pair. (The paper's proof, as a property.)
#[test]
fn no_relevant_pair_is_dropped() {
    let mut rng = Rng::named(0, "full coverage");
    let (mut relevant, mut kept, mut pairs) = (0_u64, 0_u64, 0_u64);
    for round in 0..budget::of(150) {
        let (name, generator) = GENERATORS[round % GENERATORS.len()];
        let mut samples = grid(&mut rng, 64);
        if rng.one_in(3) {
            samples = samples.jittered(&mut rng);
        }
        let rows = samples.rows;
        let mut scene = generator(&mut rng, samples);
        scene.mesh.triangles.truncate(120);
        let frame = LightFrame::new(&scene.light);
        let mut mask = vec![0; rows as usize];
        for r in 0..scene.receivers.len() {
            let Some(asked) = key_receivers(r, &frame, &scene.light, &scene.receivers) else { continue };
            for (t, triangle) in scene.mesh.triangles.iter().enumerate() {
                oracle_mask(
                    &scene.light,
                    scene.receivers[r],
                    &[triangle.map(|v| scene.mesh.vertices[v as usize])],
                    &mut mask,
                );
                let offered = key_triangles(t, &frame, &scene.light, &scene.mesh.vertices, &scene.mesh.triangles);
                let keeps = offered.is_some_and(|(keys, _)| covers(&keys, &asked));
                let matters = mask.iter().any(|&row| row != 0);
                assert!(
                    keeps || !matters,
                    "{name}: the pair is dropped: {:?} {:?} {triangle:?}",
                    scene.light,
                    scene.receivers[r]
                );
                pairs += 1;
                relevant += u64::from(matters);
                kept += u64::from(keeps);
            }
        }
    }
    say(&format!("full coverage: {pairs} pairs, {kept} kept, {relevant} relevant, 0 dropped that matter"));
    assert!(relevant > 1000 && kept < pairs * 3 / 4, "the test must drop some, or it is no test");
}

/// The serial executor from world positions: its own snap gives the host's integers, and the same masks.
#[test]
fn the_serial_executor_snaps_as_the_host_does() {
    for (lift, seed) in [(Lift::NONE, "raw"), (Lift::F32_POSITIONS, "lifted")] {
        let scene = world(&mut Rng::named(0, seed), 16, 16, 100, 333);
        let lattice = Lattice::covering(scene.bounds()).expect("the scene is finite");
        let normals = vec![Vec3::new(0.1, 1.0, -0.2); scene.receivers.len()];
        let host = Inputs {
            lattice,
            light: scene.light().snap(&lattice, Lift::NONE).expect("the light is inside"),
            occluders: Occluders::new(&lattice, &scene.vertices, &scene.triangles).expect("vertices are inside"),
            receivers: Receivers::on_surfaces(&lattice, &scene.receivers, &normals, lift)
                .expect("receivers are inside"),
        };
        let (vertices, receivers) = (scene.vertices.len(), scene.receivers.len());
        let plan = Plan::new(SceneFacts {
            new_vertices: vertices as u32,
            triangles: scene.triangles.len() as u32,
            receivers: receivers as u32,
            world_receivers: true,
            block: 100,
            ..SceneFacts::default()
        });
        let (mut snapped_vertices, mut snapped_receivers) =
            (vec![Default::default(); vertices], vec![Default::default(); receivers]);
        let mut masks = vec![0_u16; receivers * 16];
        let count = scene.triangles.len();
        let buffers = Buffers {
            world_vertices: &scene.vertices,
            vertices: &mut snapped_vertices,
            triangles: &scene.triangles,
            triangle_keys: &mut vec![NOTHING; count],
            triangle_order: &mut vec![Entry::zeroed(); count],
            occluders: &mut vec![Occluder::zeroed(); count],
            nodes: &mut vec![KeyTile::NOTHING; plan.levels().tiles()],
            world_receivers: &scene.receivers,
            normals: &normals,
            receivers: &mut snapped_receivers,
            receiver_keys: &mut vec![NOTHING; receivers],
            receiver_order: &mut vec![Entry::zeroed(); receivers],
            masks: &mut masks,
            visibility: &mut [],
        };
        let snap = lattice.snap_params().expect("the origin is zero");
        let mut serial = Serial::<u16, Exact>::new(&plan, host.light, snap, lift, buffers);
        plan.run(&mut serial).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(snapped_vertices, host.occluders.vertices());
        assert_eq!(snapped_receivers, host.receivers.points());
        compare_masks(&host.oracle(), &masks, 16, 16, Amount::Some).unwrap_or_else(|e| panic!("{seed}: {e}"));
    }
}

/// The step of the lattice is a power of two, and scaling the world by it changes no bit.
#[test]
fn the_scale_of_the_world_changes_no_bit() {
    let mut rng = Rng::named(0, "scale");
    let executor = CpuExecutor::new();
    for (name, generator) in GENERATORS {
        let scene = generator(&mut rng, SampleGrid::regular(16, 16));
        let masks = EXPONENTS.map(|k| {
            let inputs = scene.inputs(k);
            executor.masks::<u16>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("the word fits").0
        });
        assert!(masks.windows(2).all(|pair| pair[0] == pair[1]), "{name}");
    }
}
