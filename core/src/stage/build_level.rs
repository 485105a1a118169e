//! Stage `build_level`: one level of the hierarchy from the one below.

use crate::proj4::{KeyTile, NODE, NOTHING};

/// Tile `id` of a level, from the tiles of the level below it.
#[inline]
pub fn build_level(id: usize, below: &[KeyTile]) -> KeyTile {
    let mut tile = KeyTile::NOTHING;
    let mut entry = 0;
    while entry < NODE {
        let keys = match below.get(id * NODE + entry) {
            Some(child) => child.largest(),
            None => NOTHING,
        };
        tile.set(entry, &keys);
        entry += 1;
    }
    tile
}
