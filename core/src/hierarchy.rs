//! The default index: a hierarchy over the triangles whose nodes answer the full-coverage test for groups of receivers.
//!
//! The paper's grid (section 3.1) pairs triangles and receivers through the cells of a plane. Its extent explodes when
//! a receiver nears the light plane, and triangles that reach that plane cover every cell. Here the test itself is
//! indexed instead: triangles in Morton order, [`NODE`] to a node and so on upwards, a node's keys the largest of its
//! entries'. There is no topology to store, a level is one pass over the one below, and moved vertices only need
//! the passes again.

use core::marker::PhantomData;

use crate::{
    lanes::Lanes,
    proj4::{KeyTile, Keys, NODE},
};

/// Most levels: 16^8 triangles.
pub const MAX_LEVELS: usize = 8;

/// Where the levels of a hierarchy lie in one array of tiles; level 0 holds the triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Levels {
    starts: [u32; MAX_LEVELS + 1],
    count: u32,
}

impl Levels {
    /// The layout for `entries` triangles, fewer than 2^32 − 16. No triangles, no levels.
    pub fn of(entries: u32) -> Self {
        let mut levels = Self::default();
        let mut tiles = entries.div_ceil(NODE as u32);
        while tiles > 0 && (levels.count as usize) < MAX_LEVELS {
            let level = levels.count as usize;
            levels.starts[level + 1] = levels.starts[level] + tiles;
            levels.count += 1;
            if tiles == 1 {
                break;
            }
            tiles = tiles.div_ceil(NODE as u32);
        }
        levels
    }

    /// As words: the starts, and the number.
    #[inline(always)]
    pub fn words(&self) -> [u32; MAX_LEVELS + 2] {
        let s = &self.starts;
        [s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8], self.count]
    }

    /// The inverse of [`Levels::words`].
    #[inline(always)]
    pub fn from_words(w: [u32; MAX_LEVELS + 2]) -> Self {
        Self { starts: [w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8]], count: w[9] }
    }

    /// Number of levels.
    pub fn count(&self) -> usize {
        self.count as usize
    }

    /// Tiles of all levels together.
    pub fn tiles(&self) -> usize {
        self.starts[self.count as usize % (MAX_LEVELS + 1)] as usize
    }

    /// The tiles of one level, as a range of the array; empty where there is no such level.
    pub fn range(&self, level: usize) -> core::ops::Range<usize> {
        match self.starts.get(level..) {
            Some([start, end, ..]) if level < self.count() => *start as usize..*end as usize,
            _ => 0..0,
        }
    }
}

/// Where a walk starts: at a node of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Root {
    /// Its level; [`Levels::count`] or more where there is nothing to walk.
    pub level: usize,
    /// Its place in the level.
    pub tile: u32,
}

impl Root {
    /// The node above all triangles.
    #[inline(always)]
    pub fn top(levels: &Levels) -> Self {
        Self { level: if levels.count() > 0 { levels.count() - 1 } else { 0 }, tile: 0 }
    }
}

/// What a walk asks of the nodes it meets.
pub trait Question: Copy {
    /// Sixteen entries of a node, as it sees them.
    type Tile;
    /// Which of the entries it wants to look into: bit e is entry e.
    fn open<L: Lanes>(&self, tile: &Self::Tile) -> u32;
}

/// The full-coverage test: what a group of receivers needs.
impl Question for Keys {
    type Tile = KeyTile;

    #[inline(always)]
    fn open<L: Lanes>(&self, tile: &KeyTile) -> u32 {
        tile.dominating::<L>(self)
    }
}

/// Walks the triangles that may block something from a group of receivers, nearest in the order first.
///
/// A walk stops for good once it has returned `None`.
#[derive(Clone, Copy, Debug)]
pub struct Walk<Q = Keys> {
    tile: [u32; MAX_LEVELS],
    bits: [u32; MAX_LEVELS],
    level: usize,
    /// One above the root's level.
    end: usize,
    levels: Levels,
    question: PhantomData<Q>,
}

impl<Q: Question> Walk<Q> {
    /// Starts at the root.
    #[inline(always)]
    pub fn new<L: Lanes>(levels: &Levels, root: Root, tiles: &[Q::Tile], need: &Q) -> Self {
        let end = if root.level < levels.count() { root.level + 1 } else { 0 };
        let mut walk = Self {
            tile: [0; MAX_LEVELS],
            bits: [0; MAX_LEVELS],
            level: end,
            end,
            levels: *levels,
            question: PhantomData,
        };
        if end > 0 {
            walk.enter::<L>(root.level, root.tile, tiles, need);
        }
        walk
    }

    /// Whether the root itself leaves something to be looked at.
    #[inline(always)]
    pub fn is_open(&self) -> bool {
        self.end > 0 && self.bits[(self.end - 1) % MAX_LEVELS] != 0
    }

    #[inline(always)]
    fn enter<L: Lanes>(&mut self, level: usize, tile: u32, tiles: &[Q::Tile], need: &Q) {
        let l = level % MAX_LEVELS;
        self.level = level;
        self.tile[l] = tile;
        let place = (self.levels.starts[l] + tile) as usize;
        self.bits[l] = if place < tiles.len() { need.open::<L>(&tiles[place]) } else { 0 };
    }

    /// The next tile of triangles of which some may block something: its index, and the bits of those.
    #[inline(always)]
    pub fn next<L: Lanes>(&mut self, tiles: &[Q::Tile], need: &Q) -> Option<(u32, u32)> {
        while self.level < self.end {
            let l = self.level % MAX_LEVELS;
            let bits = self.bits[l];
            if bits == 0 {
                self.level += 1;
            } else if l == 0 {
                self.bits[0] = 0;
                return Some((self.tile[0], bits));
            } else {
                self.bits[l] = bits & (bits - 1);
                let entry = self.tile[l] * NODE as u32 + bits.trailing_zeros();
                self.enter::<L>(l - 1, entry, tiles, need);
            }
        }
        None
    }
}
