//! A light on the lattice: an integer origin `O` and two integer steps. Sample (row i, column j) is the lattice point
//! `O + i·step_v + j·step_u`. It shines towards the side that `step_u × step_v` points to.

use glam::IVec3;

/// Most rows, and most columns, of a sample grid: one mask word holds a row.
pub const MAX_SAMPLES: u32 = 64;

/// A light on the lattice. Sample (i, j) is the lattice point `origin + i·step_v + j·step_u`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(target_arch = "spirv"), repr(C))]
#[cfg_attr(target_arch = "spirv", repr(C, align(16)))]
pub struct LatticeLight {
    /// Sample (0, 0), lattice units.
    pub origin: IVec3,
    /// Step between columns, lattice units.
    pub step_u: IVec3,
    /// Step between rows, lattice units.
    pub step_v: IVec3,
    /// Rows, in `1..=64`.
    pub rows: u32,
    /// Columns, in `1..=64`.
    pub columns: u32,
}

impl LatticeLight {
    /// The lattice point of a sample; `row < rows`, `column < columns`.
    #[inline]
    pub fn sample(&self, row: u32, column: u32) -> IVec3 {
        self.origin + self.step_v * row as i32 + self.step_u * column as i32
    }

    /// Number of samples.
    pub fn sample_count(&self) -> u32 {
        self.rows * self.columns
    }
}
