//! What the snap moves: masks on the lattice against masks on the original coordinates, exactly.

use umbra4_core::{Bounds, Lattice};
use umbra4_tests::{
    budget,
    ledger::say,
    oracle::hit,
    rng::Rng,
    scene::WorldScene,
    scenes::world,
    second_oracle::{ExactScene, bits_of_largest},
};

/// Largest share of the bits that the snap may change on realistic scenes, on the lattice that fits them. A bit is in
/// reach only if the sample is within some 32 lattice units of a silhouette that crosses steps of 2^22 units.
const DIFFERING_SHARE: f64 = 1.0e-5;

struct Report {
    bits: u64,
    differing: u64,
    blocked: u64,
}

/// Compares a scene on a lattice, bit by bit.
fn compare(scene: &WorldScene, lattice: Lattice) -> Report {
    let inputs = scene.inputs_on(lattice);
    let (masks, triangles) = (inputs.oracle(), inputs.triangles());
    let exact = ExactScene::new(scene, &lattice);
    assert!(bits_of_largest(&exact) > 24, "the integers hold all of the floats");
    let snapped = |r: usize, row: usize, column: usize, t: usize| {
        hit(inputs.receivers.points()[r], inputs.light.sample(row as u32, column as u32), triangles[t])
    };
    let rows = scene.rows as usize;
    let mut differing = 0;
    for (r, mask) in masks.chunks_exact(rows).enumerate() {
        let (count, unexplained) = exact.differences(r, mask, &snapped);
        assert!(unexplained.is_empty(), "the snap does not explain {unexplained:?} of {scene:?}");
        differing += count;
    }
    let bits = masks.len() as u64 * u64::from(scene.columns);
    Report { bits, differing, blocked: masks.iter().map(|w| u64::from(w.count_ones())).sum() }
}

fn compare_all(name: &str, scenes: usize, lattice: impl Fn(Bounds) -> Lattice) -> Report {
    let mut rng = Rng::named(0, name);
    let mut total = Report { bits: 0, differing: 0, blocked: 0 };
    for k in 0..budget::of(scenes) {
        let (rows, columns) = [(16, 16), (8, 32), (5, 15)][k % 3];
        let scene = world(&mut rng, rows, columns, 80, 24);
        let report = compare(&scene, lattice(scene.bounds()));
        total.bits += report.bits;
        total.differing += report.differing;
        total.blocked += report.blocked;
    }
    let share = total.differing as f64 / total.bits as f64;
    say(&format!("{name}: bits compared: {}, moved by the snap: {} ({share:.1e})", total.bits, total.differing));
    assert!(total.blocked > total.bits / 50 && total.blocked < total.bits / 2, "the scenes have shadows");
    total
}

#[test]
fn the_snap_moves_nothing_visible() {
    let report = compare_all("fitting lattice", 120, |bounds| Lattice::covering(bounds).expect("the scene is finite"));
    assert!(report.differing as f64 <= DIFFERING_SHARE * report.bits as f64);
}

/// On a lattice that is far too coarse the snap does move bits: each of them must be explained.
#[test]
fn every_bit_that_the_snap_moves_is_explained() {
    let report = compare_all("coarse lattice", 80, |bounds| {
        let wide = Bounds { min: bounds.min * f64::from(1 << 15), max: bounds.max * f64::from(1 << 15) };
        Lattice::covering(wide).expect("the bounds are finite")
    });
    assert!(report.differing > 100, "only {} bits were moved: the criterion was hardly tried", report.differing);
}

/// A mask that is wrong where no edge is near is not explained by the snap.
#[test]
fn a_wrong_bit_is_not_explained() {
    let scene = world(&mut Rng::named(0, "wrong bit"), 8, 8, 20, 16);
    let inputs = scene.inputs();
    let triangles = inputs.triangles();
    let exact = ExactScene::new(&scene, &inputs.lattice);
    let snapped = |r: usize, row: usize, column: usize, t: usize| {
        hit(inputs.receivers.points()[r], inputs.light.sample(row as u32, column as u32), triangles[t])
    };
    for (r, mask) in inputs.oracle().chunks_exact(8).enumerate() {
        let mut wrong = mask.to_vec();
        wrong[3] ^= 1 << 5;
        let (differing, unexplained) = exact.differences(r, &wrong, &snapped);
        assert_eq!((differing, unexplained.len()), (1, 1));
        assert_eq!((unexplained[0].receiver, unexplained[0].row, unexplained[0].column), (r, 3, 5));
    }
}
