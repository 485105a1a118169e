//! A scaffold: thin bars in all three directions and braces across, layer upon layer, so that hundreds of small
//! silhouettes lie between a receiver and the light.
//!
//! Widths differ from bar to bar, so that no sides of bars that cross lie in one plane. Units are metres.

use umbra4::model::Model;
use umbra4_core::glam::DVec3;
use umbra4_tests::rng::Rng;

use super::solids::{Solids, between};

const SEED: u64 = 1;
/// Bays of one metre along either edge.
const BAYS: u32 = 30;
/// Layers, one metre high.
const LAYERS: u32 = 12;
/// Widths of bars along x and z, of uprights and of braces.
const WIDTHS: [f64; 4] = [0.045, 0.04, 0.052, 0.028];
/// Share of its length that a bar ends before its node, at most: inside the other bars there.
const MOST_SHORT: f64 = 0.01;

/// The scaffold, without the ground.
pub(super) fn model() -> Model {
    let (mut solids, mut rng) = (Solids::default(), Rng::named(SEED, "lattice"));
    let node = |x: u32, y: u32, z: u32| DVec3::new(x.into(), y.into(), z.into());
    for y in 0..LAYERS {
        for z in 0..=BAYS {
            for x in 0..=BAYS {
                let mut bar = |from: DVec3, to: DVec3, width: f64| {
                    // Ends differ as well: those of bars in a line do not share a face.
                    let mut end = |end: DVec3, other: DVec3| end + (other - end) * between(&mut rng, 0.0, MOST_SHORT);
                    let (from, to) = (end(from, to), end(to, from));
                    solids.bar(from, to, width * between(&mut rng, 0.9, 1.1));
                };
                bar(node(x, y, z), node(x, y + 1, z), WIDTHS[2]);
                if x < BAYS {
                    bar(node(x, y + 1, z), node(x + 1, y + 1, z), WIDTHS[0]);
                    // Braces turn about from bay to bay.
                    let (low, high) = if (x + y + z) % 2 == 0 { (x, x + 1) } else { (x + 1, x) };
                    bar(node(low, y, z), node(high, y + 1, z), WIDTHS[3]);
                }
                if z < BAYS {
                    bar(node(x, y + 1, z), node(x, y + 1, z + 1), WIDTHS[1]);
                }
            }
        }
    }
    solids.finish()
}
