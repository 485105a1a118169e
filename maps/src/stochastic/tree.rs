//! Where the nodes of the tree over triangles lie. Four triangles, in the order of a space-filling curve, are a node of level 0; four nodes of
//! a level are one of the next; the last level has one.

/// Children of a node.
pub const CHILDREN: u32 = 4;
/// Most levels: those of 2^32 triangles.
pub const MOST_LEVELS: usize = 16;

/// The levels of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tree {
    /// First node of each level, and one more than the last node of the last.
    pub starts: [u32; MOST_LEVELS + 1],
    /// Levels there are.
    pub levels: u32,
}

impl Tree {
    /// That of so many triangles; none has none.
    #[inline(always)]
    pub fn new(triangles: u32) -> Self {
        let mut starts = [0; MOST_LEVELS + 1];
        let mut levels = 0;
        let mut below = triangles;
        let mut end = 0_u32;
        while (levels as usize) < MOST_LEVELS && (below > 1 || (levels == 0 && below > 0)) {
            below = below.div_ceil(CHILDREN);
            starts[levels as usize] = end;
            end = end.wrapping_add(below);
            levels += 1;
        }
        let mut rest = levels as usize;
        while rest <= MOST_LEVELS {
            starts[rest] = end;
            rest += 1;
        }
        Self { starts, levels }
    }

    /// First node of a level.
    #[inline(always)]
    pub fn start(&self, level: u32) -> u32 {
        if (level as usize) < MOST_LEVELS + 1 { self.starts[level as usize] } else { 0 }
    }

    /// Nodes of a level.
    #[inline(always)]
    pub fn count(&self, level: u32) -> u32 {
        self.start(level + 1).wrapping_sub(self.start(level))
    }

    /// Nodes of all levels.
    pub fn nodes(&self) -> u32 {
        self.starts[MOST_LEVELS]
    }
}
