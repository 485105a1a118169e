//! Microquad soft shadow mapping on the CPU executor: kernels one id after the other, words, threads, the switch, refusals, and how far
//! it is from the exact masks.

use umbra4_core::{
    Bounds, Jitter, Lattice, LatticeLight, Lift, MaskWord, PairWord,
    glam::{DVec3, IVec3, Vec3},
};
use umbra4_cpu::{
    CpuExecutor, ExecutorError, Occluders, Receivers,
    maps::{
        Technique,
        kernel::microquads::{ROWS, build_parents, build_tiles, draw_map},
        microquad::{Footprint, HalfSpaces, MicroOccluders, MicroquadError, MicroquadOptions, params::MapPass},
        pyramid::{self, Node},
    },
};
use umbra4_tests::{
    meshes::cuboid,
    spheres::{Lit, lamp, options, spheres},
};

/// Mean absolute difference.
fn error(a: &[f32], b: &[f32]) -> f64 {
    assert_eq!(a.len(), b.len());
    assert!(!a.is_empty());
    a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / a.len() as f64
}

/// The claims of section 4 on errors, against exact masks instead of the paper's reference.
#[test]
fn hulls_are_nearer_to_the_exact_shadows_than_rectangles_and_microtris_nearest() {
    for (count, grid) in [(3, 8), (3, 16), (3, 32), (27, 8), (27, 16), (27, 32)] {
        let lit = spheres(count, 64);
        let light = lamp(&lit, grid, grid, Jitter::NONE);
        let executor = CpuExecutor::new();
        let (exact, _) = executor.visibility(&lit.occluders, &light, &lit.receivers).expect("it runs");
        let of = |size, occluders, footprint| {
            let options = options(size, occluders, footprint);
            let done = executor.microquad_visibility(&options, &lit.occluders, &light, &lit.receivers);
            error(&done.expect("it runs").0, &exact)
        };
        for size in [64, 128] {
            let fine = HalfSpaces { directions: 256, distances: 256 };
            let patches = of(size, MicroOccluders::Micropatches, Footprint::Rectangles);
            let areas = of(size, MicroOccluders::Microquads, Footprint::Area);
            let rectangles = of(size, MicroOccluders::Microquads, Footprint::Rectangles);
            let quads = of(size, MicroOccluders::Microquads, Footprint::Rows);
            let tris = of(size, MicroOccluders::Microtris, Footprint::Rows);
            let table = of(size, MicroOccluders::Microtris, Footprint::Table(fine));
            println!(
                "{count} spheres, {grid}² samples, map {size}: patches {patches:.5}, areas {areas:.5}, rectangles {rectangles:.5}, \
                 quads {quads:.5} ({:+.0} %), tris {tris:.5} ({:+.0} %), tris by table {table:.5}",
                (quads / rectangles - 1.0) * 100.0,
                (tris / rectangles - 1.0) * 100.0
            );
            assert!(tris < quads, "microtris make occluders less thin: {tris} {quads}");
            assert!(tris < rectangles, "{tris} {rectangles}");
            assert!((table - tris).abs() < 0.1 * tris, "the table's lines are near the edges: {table} {tris}");
        }
        let [coarse, fine] = [64, 512].map(|size| of(size, MicroOccluders::Microtris, Footprint::Rows));
        assert!(fine < coarse, "finer maps are nearer: {coarse} {fine}");
    }
}

/// The kernels that GPUs run, one id after the other, against what the executor made in its own way: the same bits.
#[test]
fn kernels_draw_and_build_what_the_executor_does() {
    let lit = spheres(8, 24);
    let light = lamp(&lit, 16, 16, Jitter::NONE);
    for size in [16, 64, 256] {
        let options = options(size, MicroOccluders::Microtris, Footprint::Rows);
        let (map, _) =
            CpuExecutor::new().shadow_map(&options, &lit.occluders, &light, &lit.receivers).expect("it is drawn");
        let (texels, nodes, table) = map.buffers();
        assert!(table.is_empty());
        assert!(texels.iter().filter(|word| **word != 0).count() > texels.len() / 4, "the floor is there");
        assert!(map.inverse_depths().all(|inverse| (0.0..=1.0).contains(&inverse)));

        let vertices: Vec<[i32; 3]> = lit.occluders.vertices().iter().map(|v| v.to_array()).collect();
        let triangles = lit.occluders.triangles();
        let parts = size.div_ceil(ROWS);
        let pass = MapPass { count: triangles.len() as u32 * parts, number: parts, ..MapPass::default() };
        let params = map.params().with_pass(&pass);
        let mut drawn = vec![0; texels.len()];
        for id in 0..pass.count as usize + 3 {
            draw_map(id, &params, &vertices, triangles, &mut drawn, |texel, word| *texel = word.max(*texel));
        }
        assert_eq!(drawn, texels);

        let mut built = vec![Node::default(); nodes.len()];
        for level in 0..pyramid::levels(size) {
            let count = pyramid::start(size, level + 1) - pyramid::start(size, level);
            let params = map.params().with_pass(&MapPass { count, number: level, ..MapPass::default() });
            for id in 0..count as usize + 3 {
                match level {
                    0 => build_tiles(id, &params, texels, &mut built),
                    _ => build_parents(id, &params, &mut built),
                }
            }
        }
        assert_eq!(built, nodes);
    }
}

fn blocked<W: MaskWord>(words: &[W]) -> Vec<u64> {
    let row = |word: &W| (0..W::BITS).filter(|bit| word.bit(*bit)).fold(0, |row, bit| row | 1 << bit);
    words.iter().map(row).collect()
}

#[test]
fn words_and_threads_make_no_difference() {
    let lit = spheres(8, 20);
    for (jitter, footprint) in
        [(Jitter::NONE, Footprint::Rows), (Jitter::pattern(4), Footprint::Table(HalfSpaces::default()))]
    {
        let light = lamp(&lit, 13, 16, jitter);
        let options = options(128, MicroOccluders::Microtris, footprint);
        let one = CpuExecutor::new().with_threads(1).expect("a thread");
        let many = CpuExecutor::new().with_threads(3).expect("threads");
        fn masks<W: MaskWord + umbra4_cpu::maps::microquad::half_spaces::TableWord>(
            executor: &CpuExecutor,
            options: &MicroquadOptions,
            lit: &Lit,
            light: &LatticeLight,
        ) -> Vec<u64> {
            let done = executor.microquad_masks::<W>(options, &lit.occluders, light, &lit.receivers);
            let (masks, statistics) = done.expect("it runs");
            assert_eq!(masks.words().len(), lit.receivers.len() * 13);
            let stages: Vec<&str> = statistics.seconds_by_stage.iter().map(|(name, _)| *name).collect();
            assert!(stages.starts_with(&["fit_map", "draw_map", "build_pyramid"]) && stages.ends_with(&["gather"]));
            blocked(masks.words())
        }
        let expected = masks::<u32>(&one, &options, &lit, &light);
        assert!(expected.iter().any(|row| *row != 0) && expected.contains(&0));
        assert_eq!(masks::<u16>(&many, &options, &lit, &light), expected);
        assert_eq!(masks::<u32>(&many, &options, &lit, &light), expected);
        assert_eq!(masks::<u64>(&many, &options, &lit, &light), expected);
        assert_eq!(masks::<PairWord>(&one, &options, &lit, &light), expected);
        let (visibility, _) =
            many.microquad_visibility(&options, &lit.occluders, &light, &lit.receivers).expect("it runs");
        for (visibility, rows) in visibility.iter().zip(expected.chunks(13)) {
            let blocked: u32 = rows.iter().map(|row| row.count_ones()).sum();
            assert_eq!(*visibility, (208 - blocked) as f32 / 208.0);
        }
    }
}

#[test]
fn one_switch_changes_the_technique() {
    let lit = spheres(3, 16);
    let light = lamp(&lit, 32, 32, Jitter::NONE);
    let executor = CpuExecutor::new();
    let run = |technique: &Technique| {
        let done = executor.masks_by::<u32>(technique, &lit.occluders, &light, &lit.receivers).expect("it runs");
        let seen = executor.visibility_by(technique, &lit.occluders, &light, &lit.receivers).expect("it runs");
        (done.0.into_words(), seen.0)
    };
    let exact = executor.masks::<u32>(&lit.occluders, &light, &lit.receivers).expect("it runs").0;
    assert_eq!(run(&Technique::default()).0, exact.words());
    let options = MicroquadOptions::default();
    let approximate = executor.microquad_masks::<u32>(&options, &lit.occluders, &light, &lit.receivers);
    let (words, seen) = run(&Technique::Microquads(options));
    assert_eq!(words, approximate.expect("it runs").0.words());
    assert_ne!(words, exact.words(), "it is an approximation");
    assert!(error(&seen, &run(&Technique::Exact).1) < 0.02);
}

#[test]
fn nothing_there_shadows_nothing() {
    let lit = spheres(1, 8);
    let light = lamp(&lit, 8, 8, Jitter::NONE);
    let executor = CpuExecutor::new();
    let empty = Occluders::new(&lit.lattice, &[], &[]).expect("no triangles");
    let nobody = Receivers::raw(&lit.lattice, &[]).expect("no receivers");
    for occluders in [MicroOccluders::Micropatches, MicroOccluders::Microquads, MicroOccluders::Microtris] {
        for footprint in [Footprint::Area, Footprint::Table(HalfSpaces::default()), Footprint::Rows] {
            let options = options(32, occluders, footprint);
            let run = |occluders, receivers| {
                executor.microquad_visibility(&options, occluders, &light, receivers).expect("it runs").0
            };
            assert!(run(&empty, &lit.receivers).iter().all(|v| *v == 1.0));
            assert!(run(&lit.occluders, &nobody).is_empty());
            // Behind the lamp all is dark, nearer than all occluders all is lit.
            let odd = [Vec3::new(0.0, 4.0, 0.0), Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 2.999, 0.0)];
            let odd = Receivers::raw(&lit.lattice, &odd).expect("they are inside");
            assert_eq!(run(&lit.occluders, &odd), [0.0, 0.0, 1.0]);
        }
    }
}

/// A box under the lamp: its own faces lie in the light, its shadow is dark in the middle.
#[test]
fn surfaces_do_not_shadow_themselves() {
    let lattice = Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("a world");
    let unit = 1.0 / lattice.step();
    let at = |p: DVec3| (p * unit).round().as_ivec3();
    let mut mesh = cuboid(at(DVec3::new(-0.8, 0.6, -0.8)), at(DVec3::new(0.8, 0.8, 0.8)));
    mesh.add_quad([[-3, -3], [-3, 3], [3, 3], [3, -3]].map(|[x, z]| IVec3::new(x, 0, z) * unit as i32));
    let vertices: Vec<DVec3> = mesh.vertices.iter().map(|v| lattice.to_world(*v)).collect();
    let occluders = Occluders::from_f64(&lattice, &vertices, &mesh.triangles).expect("vertices are inside");
    let grid = |height: f32, half: f32| -> Vec<Vec3> {
        let at = |k: usize| (k as f32 / 15.0 * 2.0 - 1.0) * half;
        (0..256).map(|k| Vec3::new(at(k % 16), height, at(k / 16))).collect()
    };
    let scene = Lit { occluders, receivers: Receivers::default(), lattice };
    let light = lamp(&scene, 16, 16, Jitter::NONE);
    for (height, half, expected) in [(0.8, 0.7, 1.0), (0.0, 0.25, 0.0)] {
        let points = grid(height, half);
        let receivers = Receivers::on_surfaces(&lattice, &points, &vec![Vec3::Y; 256], Lift::F32_POSITIONS);
        let receivers = receivers.expect("they are inside");
        for footprint in [Footprint::Rows, Footprint::Table(HalfSpaces::default())] {
            let options = options(256, MicroOccluders::Microtris, footprint);
            let done = CpuExecutor::new().microquad_visibility(&options, &scene.occluders, &light, &receivers);
            assert!(done.expect("it runs").0.iter().all(|v| *v == expected), "{height}");
        }
    }
}

/// Exact masks, and approximate ones of the same scene added to them.
#[test]
fn masks_are_added_to_masks() {
    let lit = spheres(8, 16);
    let light = lamp(&lit, 13, 16, Jitter::NONE);
    let (executor, options) = (CpuExecutor::new(), MicroquadOptions::default());
    let exact = executor.masks::<u16>(&lit.occluders, &light, &lit.receivers).expect("it runs").0;
    let alone = executor.microquad_masks::<u16>(&options, &lit.occluders, &light, &lit.receivers);
    let alone = alone.expect("it runs").0;
    let mut sum = exact.clone();
    executor.add_microquad_masks(&options, &lit.occluders, &light, &lit.receivers, &mut sum).expect("it runs");
    let both: Vec<u16> = exact.words().iter().zip(alone.words()).map(|(a, b)| a | b).collect();
    assert_eq!(sum.words(), both);
    assert!(sum.words() != exact.words() && sum.words() != alone.words(), "each has bits that the other has not");
    let few = Receivers::raw(&lit.lattice, &[Vec3::ZERO]).expect("it is inside");
    let refused = executor.add_microquad_masks(&options, &lit.occluders, &light, &few, &mut sum);
    let error = ExecutorError::MaskCount { words: 13 * 256, receivers: 1, rows: 13 };
    assert_eq!(refused.map(|_| ()), Err(error));
    assert_eq!(sum.words(), both);
}

/// As in the exact system: whoever is known to look away from the light sees none of it.
#[test]
fn receivers_that_face_away_are_dark() {
    let lit = spheres(1, 4);
    let light = lamp(&lit, 8, 8, Jitter::NONE);
    let points = [Vec3::new(1.5, 0.5, 1.5); 2];
    let receivers = Receivers::raw(&lit.lattice, &points).and_then(|r| r.facing(&[Vec3::Y, Vec3::NEG_Y]));
    let receivers = receivers.expect("they are inside");
    let (executor, options) = (CpuExecutor::new(), MicroquadOptions::default());
    let (seen, _) = executor.microquad_visibility(&options, &lit.occluders, &light, &receivers).expect("it runs");
    assert_eq!(seen, [1.0, 0.0]);
    let masks = executor.microquad_masks::<u16>(&options, &lit.occluders, &light, &receivers).expect("it runs").0;
    assert_eq!(masks.words(), [[0; 8], [0xff; 8]].concat());
}

#[test]
fn refusals_reach_the_caller() {
    let lit = spheres(1, 4);
    let light = lamp(&lit, 8, 20, Jitter::NONE);
    let executor = CpuExecutor::new();
    let bad = options(0, MicroOccluders::Microtris, Footprint::Rows);
    let refused = executor.microquad_visibility(&bad, &lit.occluders, &light, &lit.receivers);
    let error = refused.expect_err("a map without texels");
    assert_eq!(error, ExecutorError::Microquads(MicroquadError::MapSize { value: 0 }));
    assert!(error.to_string().contains("map.size is 0"), "{error}");
    let narrow = executor.microquad_masks::<u16>(&MicroquadOptions::default(), &lit.occluders, &light, &lit.receivers);
    assert_eq!(narrow.map(|_| ()), Err(ExecutorError::WordTooNarrow { columns: 20, bits: 16 }));
    let areas = options(64, MicroOccluders::Microtris, Footprint::Area);
    let refused = executor.microquad_masks::<u32>(&areas, &lit.occluders, &light, &lit.receivers);
    assert_eq!(refused.map(|_| ()), Err(ExecutorError::Microquads(MicroquadError::NoMasks)));
}
