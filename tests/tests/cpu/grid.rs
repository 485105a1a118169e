//! The paper's grid: its cells lose no pair, and none of its optimisations changes a bit.

use umbra4_core::{
    frame::LightFrame,
    grid::{CellRange, Extent, FrameBuffer, FramePlane},
    proj4::Keys,
    stage::{key_receivers::key_receivers, key_triangles::key_triangles},
};
use umbra4_cpu::{Binning, CpuExecutor, GridOptions, Index, Isa, Precision, Rows};
use umbra4_tests::{
    budget,
    compare::{Amount, compare_masks},
    ledger::say,
    oracle::oracle_mask,
    rng::Rng,
    scene::Scene,
    scenes::{GENERATORS, grid, world},
};

/// All combinations of the options, on one grid of cells.
fn combinations(cells: [u32; 2]) -> Vec<GridOptions> {
    let mut all = Vec::new();
    for binning in [Binning::OneCell, Binning::AllCells] {
        for early_rejection in [false, true] {
            for rows in [Rows::Words, Rows::Bits] {
                all.push(GridOptions { cells, binning, early_rejection, rows });
            }
        }
    }
    all
}

fn frame_buffer(frame: &LightFrame, receivers: &[Keys], cells: [u32; 2]) -> FrameBuffer {
    let highest = receivers.iter().map(|keys| -keys[4]).fold(0.0, f32::max);
    let plane = FramePlane::new(frame, highest);
    let extent = receivers.iter().map(|keys| plane.stretch(keys)).fold(Extent::EMPTY, Extent::union);
    FrameBuffer::new(plane, extent, cells)
}

fn contains(range: &CellRange, part: &CellRange) -> bool {
    (0..2).all(|axis| range.first[axis] <= part.first[axis] && part.end[axis] <= range.end[axis])
}

/// Wherever the oracle finds a blocked sample, the triangle is in the receiver's one cell, and in all of its cells; unless
/// the receiver has none. Returns pairs, relevant pairs, pairs that share the one cell, receivers, receivers apart.
fn cells_lose_no_pair(name: &str, scene: &Scene, cells: [u32; 2]) -> [u64; 5] {
    let frame = LightFrame::new(&scene.light);
    let receivers: Vec<(usize, Keys)> = (0..scene.receivers.len())
        .filter_map(|r| Some((r, key_receivers(r, &frame, &scene.light, &scene.receivers)?)))
        .collect();
    let keys: Vec<Keys> = receivers.iter().map(|(_, keys)| *keys).collect();
    let buffer = frame_buffer(&frame, &keys, cells);
    let mut mask = vec![0; scene.light.rows as usize];
    let mut found = [0; 5];
    for (r, keys) in &receivers {
        found[3] += 1;
        let (one, all) = (buffer.receiver_cell(keys), buffer.receiver_cells(keys));
        let (Some(one), Some(all)) = (one, all) else {
            assert!(one.is_none() && all.is_none());
            found[4] += 1;
            continue;
        };
        assert!(one.count() == 1 && contains(&all, &one), "{name}: {one:?} is not in {all:?}");
        assert!((0..2).all(|axis| all.end[axis] <= buffer.size()[axis]), "{name}: {all:?}");
        for (t, triangle) in scene.mesh.triangles.iter().enumerate() {
            let corners = triangle.map(|v| scene.mesh.vertices[v as usize]);
            oracle_mask(&scene.light, scene.receivers[*r], &[corners], &mut mask);
            let matters = mask.iter().any(|&row| row != 0);
            let offered = key_triangles(t, &frame, &scene.light, &scene.mesh.vertices, &scene.mesh.triangles);
            let range = offered.map(|(keys, _)| buffer.triangle_cells(&keys));
            if let Some(range) = &range {
                assert!((0..2).all(|axis| range.first[axis] <= range.end[axis]), "{name}: {range:?}");
                assert!((0..2).all(|axis| range.end[axis] <= buffer.size()[axis]), "{name}: {range:?}");
            }
            let met = range.is_some_and(|range| contains(&range, &one));
            if matters {
                assert!(
                    met && range.is_some_and(|range| contains(&range, &all)),
                    "{name}, {cells:?} cells: the pair is lost: {:?} {:?} {corners:?}: {range:?} {all:?} {buffer:?}",
                    scene.light,
                    scene.receivers[*r]
                );
            }
            found[0] += 1;
            found[1] += u64::from(matters);
            found[2] += u64::from(met);
        }
    }
    found
}

#[test]
fn no_relevant_pair_is_lost_by_cells() {
    let mut rng = Rng::named(0, "cells");
    let mut total = [0; 5];
    for round in 0..budget::of(180) {
        let (name, generator) = GENERATORS[round % GENERATORS.len()];
        let samples = grid(&mut rng, 64);
        let mut scene = generator(&mut rng, samples);
        scene.mesh.triangles.truncate(120);
        let cells = rng.pick(&[[128, 128], [1, 1], [5, 64], [4096, 4096]]);
        let found = cells_lose_no_pair(name, &scene, cells);
        (0..5).for_each(|k| total[k] += found[k]);
    }
    let [pairs, relevant, met, receivers, apart] = total;
    say(&format!(
        "cells: {pairs} pairs, {met} meet, {relevant} relevant, 0 lost; {apart} of {receivers} receivers have no cell"
    ));
    assert!(relevant > 1000 && met < pairs / 2, "the cells must part some, or they are no index");
    assert!(apart < receivers / 4, "most receivers have a cell");
}

/// Every combination of options, instruction set and number of threads gives the oracle's masks; the
/// rejection changes no count of relevant pairs either. (A pair whose only doubtful samples others block already counts by
/// what is certain of it, which rows and single samples see with other roundings.)
#[test]
fn optimisations_change_no_bit() {
    let inputs = world(&mut Rng::named(0, "grid"), 33, 33, 300, 700).inputs();
    let expected = inputs.oracle();
    let hierarchy = CpuExecutor::new();
    let (masks, _) = hierarchy.masks::<u64>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("it fits");
    assert_eq!(masks.words(), expected);
    for isa in Isa::available() {
        let mut relevant = None;
        for threads in [1, 3] {
            for options in combinations([31, 17]) {
                let executor = CpuExecutor::new().with_isa(isa).with_threads(threads).expect("threads can be started");
                let executor = executor.with_index(Index::Grid(options));
                let (masks, statistics) =
                    executor.masks::<u64>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("it fits");
                compare_masks(&expected, masks.words(), 33, 33, Amount::Some)
                    .unwrap_or_else(|e| panic!("{isa}, {options:?}: {e}"));
                let counts = statistics.counts;
                assert!(counts.pairs_tested >= counts.pairs_kept && counts.pairs_kept >= counts.pairs_relevant);
                assert_eq!(counts.pairs_tested == counts.pairs_kept, !options.early_rejection, "{options:?}");
                assert!(statistics.receiver_entries > 0 && statistics.triangle_entries > 0);
                if options.binning == Binning::OneCell {
                    assert!(statistics.receiver_entries <= inputs.receivers.len() as u64, "one cell each");
                    if options.rows == Rows::Words {
                        assert_eq!(
                            *relevant.get_or_insert(counts.pairs_relevant),
                            counts.pairs_relevant,
                            "{options:?}"
                        );
                    }
                }
                let names: Vec<_> = statistics.seconds_by_stage.iter().map(|(name, _)| *name).collect();
                let stages = [
                    "key_triangles",
                    "key_receivers",
                    "define_frame",
                    "bin_receivers",
                    "bin_triangles",
                    "resolve_cells",
                ];
                assert_eq!(names, stages, "the hierarchy's stages do not run");
            }
        }
    }
}

/// Plain f32: rows and single samples are the same lines, held against the same columns.
#[test]
fn fast_bits_are_fast_words() {
    let inputs = world(&mut Rng::named(0, "fast grid"), 32, 32, 300, 700).inputs();
    let run = |rows| {
        let index = Index::Grid(GridOptions { rows, ..GridOptions::default() });
        let executor = CpuExecutor::new().with_precision(Precision::Fast).with_index(index);
        executor.masks::<u32>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("it fits").0
    };
    let (words, bits) = (run(Rows::Words), run(Rows::Bits));
    let differing: u32 = words.words().iter().zip(bits.words()).map(|(a, b)| (a ^ b).count_ones()).sum();
    // Inclusive ends are rounded by one more operation in one of the two.
    assert!(differing <= 2, "{differing} bits differ");
}

#[test]
fn empty_scenes_and_many_blocks() {
    let mut scene = world(&mut Rng::named(0, "grid blocks"), 2, 16, 20, 1);
    let side = 520_u32;
    scene.receivers = (0..side * side)
        .map(|k| umbra4_core::glam::Vec3::new((k % side) as f32, 0.0, (k / side) as f32) / 40.0)
        .collect();
    let inputs = scene.inputs();
    let nothing = umbra4_cpu::Occluders::default();
    let nobody = umbra4_cpu::Receivers::default();
    for binning in [Binning::OneCell, Binning::AllCells] {
        let executor =
            CpuExecutor::new().with_index(Index::Grid(GridOptions { binning, cells: [20, 20], ..Default::default() }));
        let (masks, _) = executor.masks::<u16>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("it fits");
        compare_masks(&inputs.oracle(), masks.words(), 2, 16, Amount::Some).unwrap_or_else(|e| panic!("{e}"));
        let (masks, _) = executor.masks::<u16>(&nothing, &inputs.light, &inputs.receivers).expect("it fits");
        assert!(masks.words().len() == inputs.receivers.len() * 2 && masks.words().iter().all(|&word| word == 0));
        let (masks, _) = executor.masks::<u16>(&inputs.occluders, &inputs.light, &nobody).expect("it fits");
        assert!(masks.words().is_empty());
    }
}
