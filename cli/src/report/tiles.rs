//! Receivers in whole tiles of the picture, spread evenly over it: what slow methods are timed on.

use crate::{primary::GBuffer, report::flip};

/// Pixels along each edge of a tile: neighbours stay together, and FLIP has pixels that see no border.
const TILE: u32 = 32;

/// So many tiles stand for the picture.
const FEWEST: u32 = 24;

/// Some or all of the receivers of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Indices of the receivers, by rising tile, row and column.
    pub receivers: Vec<u32>,
    /// One tile in so many was taken.
    pub one_in: u32,
}

impl Choice {
    /// The receivers of one tile in `one_in`, a power of two: of 1, all.
    pub fn new(seen: &GBuffer, one_in: u32) -> Self {
        let columns = seen.width.div_ceil(TILE);
        let mut tiles = vec![Vec::new(); (columns * seen.height.div_ceil(TILE)) as usize];
        let pixels = (0..seen.height).flat_map(|y| (0..seen.width).map(move |x| (x, y)));
        let hits = pixels.zip(&seen.hits).filter(|(_, hit)| hit.is_some());
        for (receiver, ((x, y), _)) in (0_u32..).zip(hits) {
            if taken(x, y, one_in) {
                tiles[(y / TILE * columns + x / TILE) as usize].push(receiver);
            }
        }
        Self { receivers: tiles.concat(), one_in }
    }

    /// The largest number of tiles of which one can be taken, so that enough are left to stand for the picture; a power of
    /// two, at most 64.
    pub fn sparsest(seen: &GBuffer) -> u32 {
        let tiles = seen.width.div_ceil(TILE) * seen.height.div_ceil(TILE);
        [64, 32, 16, 8, 4, 2].into_iter().find(|one_in| tiles / one_in >= FEWEST).unwrap_or(1)
    }

    /// All of `count` receivers, in their own order.
    pub fn everyone(count: usize) -> Self {
        Self { receivers: (0..count as u32).collect(), one_in: 1 }
    }

    /// The chosen of `values`, which holds one for every receiver.
    pub fn of(&self, values: &[f32]) -> Vec<f32> {
        self.receivers.iter().map(|&i| values[i as usize]).collect()
    }

    /// A value for every receiver: those of `chosen`, and `others` where there is none.
    pub fn filled(&self, chosen: &[f32], others: &[f32]) -> Vec<f32> {
        let mut all = others.to_vec();
        for (&receiver, &value) in self.receivers.iter().zip(chosen) {
            all[receiver as usize] = value;
        }
        all
    }

    /// Whether nothing outside of the chosen tiles reaches into FLIP at pixel (`x`, `y`).
    pub fn inside(&self, seen: &GBuffer, x: u32, y: u32) -> bool {
        let ends = |at: u32, length: u32| [at.saturating_sub(flip::REACH), (at + flip::REACH).min(length - 1)];
        // Tiles are wider than the reach: the corners stand for all that lies between.
        ends(y, seen.height).iter().all(|&y| ends(x, seen.width).iter().all(|&x| taken(x, y, self.one_in)))
    }
}

/// Whether the tile of pixel (`x`, `y`) is taken: those on a skewed lattice are.
fn taken(x: u32, y: u32, one_in: u32) -> bool {
    // Steps from row to row that leave no large gaps.
    let skew = match one_in {
        0..=16 => 3,
        17..=32 => 7,
        _ => 19,
    };
    (x / TILE + skew * (y / TILE)).is_multiple_of(one_in)
}

#[cfg(test)]
mod tests {
    use umbra4_core::glam::Vec3;

    use super::*;
    use crate::primary::Hit;

    /// Every third pixel sees nothing.
    fn seen(width: u32, height: u32) -> GBuffer {
        let hit = Hit { position: Vec3::ZERO, normal: Vec3::Y, triangle: 0 };
        let hits = (0..width * height).map(|i| (i % 3 != 0).then_some(hit)).collect();
        GBuffer { width, height, hits, tints: Vec::new() }
    }

    #[test]
    fn all_are_all() {
        let seen = seen(70, 50);
        let mut receivers = Choice::new(&seen, 1).receivers;
        receivers.sort_unstable();
        assert_eq!(receivers, (0..seen.seen().count() as u32).collect::<Vec<_>>());
    }

    #[test]
    fn one_tile_in_so_many_is_taken() {
        let seen = seen(2048, 64);
        let all = seen.seen().count() as f64;
        for one_in in [2, 4, 8, 16, 32, 64] {
            let share = Choice::new(&seen, one_in).receivers.len() as f64 / all;
            assert!((share * f64::from(one_in) - 1.0).abs() < 0.05, "one in {one_in}: {share}");
        }
    }

    #[test]
    fn small_pictures_are_not_thinned_out() {
        assert_eq!([(48, 48), (512, 512), (2048, 2048)].map(|(w, h)| Choice::sparsest(&seen(w, h))), [1, 8, 64]);
    }

    #[test]
    fn values_come_back_to_their_places() {
        let seen = seen(64, 64);
        let choice = Choice::new(&seen, 4);
        let values: Vec<f32> = (0..seen.seen().count()).map(|i| i as f32).collect();
        assert_eq!(choice.filled(&choice.of(&values), &values), values);
        let zeros = vec![0.0; values.len()];
        assert_eq!(choice.of(&choice.filled(&choice.of(&values), &zeros)), choice.of(&values));
    }

    #[test]
    fn the_inside_of_a_tile_is_inside() {
        let seen = seen(128, 128);
        let all = Choice::new(&seen, 1);
        assert!(all.inside(&seen, 0, 0) && all.inside(&seen, 127, 31));
        let some = Choice::new(&seen, 4);
        assert!(some.inside(&seen, 16, 16) && !some.inside(&seen, 30, 16) && !some.inside(&seen, 48, 16));
    }
}
