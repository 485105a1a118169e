//! A seeded subset of the receivers, in whole 8×8 image tiles: neighbours stay together, as coherence needs it.

use std::collections::BTreeMap;

use crate::primary::Hit;

/// Pixels along each edge of a tile.
const TILE: u32 = 8;

/// Indices of at least `wanted` hits (all, where there are not more), tile after tile.
pub fn tiles(hits: &[Hit], wanted: usize, seed: u64) -> Vec<usize> {
    if wanted >= hits.len() {
        return (0..hits.len()).collect();
    }
    let mut tiles: Vec<Vec<usize>> = by_tile(hits).into_values().collect();
    shuffle(&mut tiles, seed);
    let mut kept = 0;
    let enough = tiles.iter().position(|tile| {
        kept += tile.len();
        kept >= wanted
    });
    tiles.truncate(enough.map_or(tiles.len(), |last| last + 1));
    // In image order again, as a renderer would go through them.
    tiles.sort();
    tiles.concat()
}

/// Indices of all hits, tile after tile.
pub fn in_tile_order(hits: &[Hit]) -> Vec<usize> {
    by_tile(hits).into_values().flatten().collect()
}

/// Indices of the hits of every tile, by its row and column.
fn by_tile(hits: &[Hit]) -> BTreeMap<(u32, u32), Vec<usize>> {
    let mut tiles: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (index, hit) in hits.iter().enumerate() {
        tiles.entry((hit.y / TILE, hit.x / TILE)).or_default().push(index);
    }
    tiles
}

/// Fisher and Yates' shuffle, with splitmix64.
fn shuffle<T>(items: &mut [T], mut state: u64) {
    for last in (1..items.len()).rev() {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        items.swap(last, (z % (last as u64 + 1)) as usize);
    }
}

#[cfg(test)]
mod tests {
    use umbra4_core::glam::Vec3;

    use super::*;

    fn grid(size: u32) -> Vec<Hit> {
        let hit = |i| Hit { x: i % size, y: i / size, position: Vec3::ZERO, normal: Vec3::Y };
        (0..size * size).map(hit).collect()
    }

    #[test]
    fn whole_tiles_without_repetition() {
        let hits = grid(64);
        let mut chosen = tiles(&hits, 100, 1);
        assert_eq!(chosen.len(), 128);
        chosen.sort_unstable();
        chosen.dedup();
        assert_eq!(chosen.len(), 128);
        assert_ne!(chosen, tiles(&hits, 100, 2));
        assert_eq!(tiles(&hits, 5000, 1).len(), hits.len());
    }
}
