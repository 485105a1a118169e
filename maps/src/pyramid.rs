//! The hierarchical shadow map: the greatest and the least inverse depth of larger and larger squares of a map.
//!
//! Seed: Schwarz, Stamminger 2008, who take the restriction of the search area over from Guennebaud et al. 2006 and their own paper of
//! 2007. Here leaves are tiles of 8 × 8 *quads*, that is of 9 × 9 texels: a microquad belongs to one tile with all its corners.

use crate::shadow_map::texel;

/// Quads along each edge of a tile.
pub const TILE: u32 = 8;

/// Inverse depths of a square of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Node {
    /// The greatest, 0 where there is nothing.
    pub most: f32,
    /// The least: 0 where some texel has nothing, or lies outside of the map.
    pub least: f32,
}

impl Node {
    /// Of no texel.
    pub const NONE: Self = Self { most: 0.0, least: f32::MAX };

    /// Of both.
    #[inline(always)]
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            most: if other.most > self.most { other.most } else { self.most },
            least: if other.least < self.least { other.least } else { self.least },
        }
    }
}

/// Tiles along an edge of a map of `size` texels: nodes of level 0. Every level has half as many as the one before, the last has one.
#[inline(always)]
pub const fn tiles(size: u32) -> u32 {
    size / TILE
}

/// Levels of a map.
pub const fn levels(size: u32) -> u32 {
    let (mut side, mut levels) = (tiles(size), 1);
    while side > 1 {
        side /= 2;
        levels += 1;
    }
    levels
}

/// The first node of a level; of the one after the last, the number of nodes.
#[inline(always)]
pub const fn start(size: u32, level: u32) -> u32 {
    let (mut side, mut start, mut k) = (tiles(size), 0, 0);
    while k < level {
        start += side * side;
        side /= 2;
        k += 1;
    }
    start
}

/// Node `index` of level 0.
#[inline(always)]
pub fn tile(map: &[u32], size: u32, index: u32) -> Node {
    let side = tiles(size).max(1);
    let (x, y) = (index % side * TILE, index / side * TILE);
    let (mut most, mut least) = (0, u32::MAX);
    let mut j = 0;
    while j <= TILE {
        let mut i = 0;
        while i <= TILE {
            let word = texel(map, size, x + i, y + j);
            most = if word > most { word } else { most };
            least = if word < least { word } else { least };
            i += 1;
        }
        j += 1;
    }
    Node { most: f32::from_bits(most), least: f32::from_bits(least) }
}

#[inline(always)]
fn node(nodes: &[Node], index: u32) -> Node {
    if (index as usize) < nodes.len() { nodes[index as usize] } else { Node::default() }
}

/// Node `index` of `level`, which is at least 1, from those of the level before.
#[inline(always)]
pub fn parent(nodes: &[Node], size: u32, level: u32, index: u32) -> Node {
    let (side, below) = ((tiles(size) >> level).max(1), start(size, level - 1));
    let first = below + index / side * 2 * (side * 2) + index % side * 2;
    let next = first + side * 2;
    node(nodes, first).with(node(nodes, first + 1)).with(node(nodes, next).with(node(nodes, next + 1)))
}

/// The node of a tile.
#[inline(always)]
pub fn of_tile(nodes: &[Node], size: u32, x: u32, y: u32) -> Node {
    node(nodes, y * tiles(size) + x)
}

/// A node that holds what the tiles `x[0]..=x[1]` by `y[0]..=y[1]` hold, and perhaps some around them.
#[inline(always)]
pub fn around(nodes: &[Node], size: u32, x: [u32; 2], y: [u32; 2]) -> Node {
    let (mut x, mut y, mut level) = (x, y, 0);
    while x[1] - x[0] > 1 || y[1] - y[0] > 1 {
        x = [x[0] / 2, x[1] / 2];
        y = [y[0] / 2, y[1] / 2];
        level += 1;
    }
    let (first, side) = (start(size, level), tiles(size) >> level);
    let (below, above) = (first + y[0] * side, first + y[1] * side);
    let low = node(nodes, below + x[0]).with(node(nodes, below + x[1]));
    low.with(node(nodes, above + x[0])).with(node(nodes, above + x[1]))
}
