//! The oracle is right: against itself bit by bit, against big integers, and core's predicate against it.

use umbra4_core::{LatticeLight, exact, glam::IVec3, wide::Limbs};
use umbra4_tests::{
    bigint, budget,
    oracle::{oracle_bit, oracle_masks},
    rng::Rng,
    scene::Scene,
    scenes::{GENERATORS, SampleGrid, grid},
};

struct Bit<'a> {
    light: LatticeLight,
    receiver: IVec3,
    triangles: &'a [[IVec3; 3]],
    row: u32,
    column: u32,
    masks: bool,
}

fn corners(scene: &Scene) -> Vec<[IVec3; 3]> {
    scene.mesh.triangles.iter().map(|t| t.map(|v| scene.mesh.vertices[v as usize])).collect()
}

/// Calls `check` with at least `bits` bits of all generators' scenes, `each` per scene; counts those that are set.
fn for_bits(name: &str, bits: usize, each: usize, most_triangles: usize, mut check: impl FnMut(Bit<'_>)) {
    let mut rng = Rng::named(0, name);
    let (mut seen, mut set) = (0, 0);
    while seen < budget::of(bits) {
        for (_, generator) in GENERATORS {
            let mut samples = grid(&mut rng, 64);
            if rng.one_in(3) {
                samples = samples.jittered(&mut rng);
            }
            let SampleGrid { rows, columns, .. } = samples;
            let mut scene = generator(&mut rng, samples);
            scene.mesh.triangles.truncate(most_triangles);
            let triangles = corners(&scene);
            let masks = oracle_masks(&scene.light, &scene.receivers, &triangles);
            for _ in 0..each {
                let r = rng.below(scene.receivers.len());
                let (row, column) = (rng.below(rows as usize), rng.below(columns as usize));
                let blocked = masks[r * rows as usize + row] >> column & 1 == 1;
                check(Bit {
                    light: scene.light,
                    receiver: scene.receivers[r],
                    triangles: &triangles,
                    row: row as u32,
                    column: column as u32,
                    masks: blocked,
                });
                seen += 1;
                set += usize::from(blocked);
            }
        }
    }
    println!("{name}: bits compared: {seen}, differing: 0 ({set} are set)");
    assert!(set > seen / 50 && set < seen / 50 * 49, "{set} of {seen} bits are set: the scenes test little");
}

#[test]
fn masks_equal_bits() {
    for_bits("masks equal bits", 100_000, 400, 40, |bit| {
        let plain = oracle_bit(&bit.light, bit.receiver, bit.triangles, bit.row, bit.column);
        assert_eq!(bit.masks, plain, "{:?} {:?} {:?}", bit.light, bit.receiver, bit.triangles);
    });
}

#[test]
fn big_integers_agree() {
    for_bits("oracle against big integers", 250_000, 1000, 6, |bit| {
        let big = bigint::bit(&bit.light, bit.receiver, bit.triangles, bit.row, bit.column);
        assert_eq!(bit.masks, big, "{:?} {:?} {:?}", bit.light, bit.receiver, bit.triangles);
    });
}

#[test]
fn core_agrees_in_both_integer_widths() {
    fn core_bit<W: exact::WideInt>(bit: &Bit<'_>) -> bool {
        exact::behind_light::<W>(&bit.light, bit.receiver)
            || bit.triangles.iter().any(|&t| exact::blocks::<W>(&bit.light, bit.receiver, t, bit.row, bit.column))
    }
    for_bits("core against oracle", 250_000, 1000, 20, |bit| {
        assert_eq!(bit.masks, core_bit::<i128>(&bit), "{:?} {:?} {:?}", bit.light, bit.receiver, bit.triangles);
        assert_eq!(bit.masks, core_bit::<Limbs>(&bit), "{:?} {:?} {:?}", bit.light, bit.receiver, bit.triangles);
    });
}
