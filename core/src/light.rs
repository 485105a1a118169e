//! A light on the lattice: an integer origin `O` and two integer steps. Sample (row i, column j) is the lattice point
//! `O + i·step_v + j·step_u`, or, where samples are jittered, one in the cell that begins there. It shines towards the side
//! that `step_u × step_v` points to.

use glam::IVec3;

use crate::jitter::Jitter;
#[cfg(not(target_arch = "spirv"))]
use crate::{
    exact::{self, Wide},
    jitter::{Pattern, Samples},
};

/// Most rows, and most columns, of a sample grid: one mask word holds a row.
pub const MAX_SAMPLES: u32 = 64;

/// A light on the lattice. Sample (i, j) is the lattice point `origin + i·step_v + j·step_u`, or one in the cell that begins there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(target_arch = "spirv"), repr(C))]
#[cfg_attr(target_arch = "spirv", repr(C, align(16)))]
pub struct LatticeLight {
    /// Sample (0, 0), or the first place of its cell, lattice units.
    pub origin: IVec3,
    /// Step between columns, lattice units; with jitter, a multiple of [`crate::jitter::PLACES`].
    pub step_u: IVec3,
    /// Step between rows, lattice units; with jitter, a multiple of [`crate::jitter::PLACES`].
    pub step_v: IVec3,
    /// Rows, in `1..=64`.
    pub rows: u32,
    /// Columns, in `1..=64`.
    pub columns: u32,
    /// Whether, and how, samples lie off the cells' first places.
    pub jitter: Jitter,
}

impl LatticeLight {
    /// The lattice point of a sample; `row < rows`, `column < columns`.
    #[cfg(not(target_arch = "spirv"))]
    pub fn sample(&self, row: u32, column: u32) -> IVec3 {
        if !self.jitter.is_some() {
            return self.origin + self.step_v * row as i32 + self.step_u * column as i32;
        }
        let place = Pattern::of(self).place(row as usize, column as usize);
        let fine = self.fine();
        fine.origin + fine.step_v * place.fine_row + fine.step_u * place.fine_column
    }

    /// The light's other side: the same samples, in rows that come in reverse order, shining the other way. A light that shines
    /// to both sides is itself and its back: no receiver lies before both.
    ///
    /// ```
    /// use umbra4_core::{Jitter, LatticeLight, glam::IVec3};
    ///
    /// let (step_u, step_v) = (IVec3::X * 1024, IVec3::Y * 2048);
    /// let light = LatticeLight { origin: IVec3::ZERO, step_u, step_v, rows: 8, columns: 5, jitter: Jitter::pattern(3) };
    /// assert_eq!(light.back().sample(1, 4), light.sample(6, 4));
    /// assert_eq!(light.back().back(), light);
    /// ```
    #[cfg(not(target_arch = "spirv"))]
    #[must_use]
    pub fn back(&self) -> Self {
        let fine = self.fine();
        let origin = fine.origin + fine.step_v * (fine.rows as i32 - 1);
        Self { origin, step_v: -self.step_v, jitter: self.jitter.reversed(), ..*self }
    }

    /// Whether any of these points lies before the light.
    #[cfg(not(target_arch = "spirv"))]
    pub fn reaches(&self, points: &[IVec3]) -> bool {
        points.iter().any(|p| !exact::behind_light::<Wide>(self, *p))
    }

    /// Number of samples.
    pub fn sample_count(&self) -> u32 {
        self.rows * self.columns
    }

    /// The regular light of all places that samples may take: itself, where they are regular. (Its rows and columns may be more
    /// than [`MAX_SAMPLES`].)
    #[inline(always)]
    pub(crate) fn fine(&self) -> Self {
        let bits = self.jitter.place_bits();
        Self {
            origin: self.origin,
            step_u: shifted(self.step_u, bits),
            step_v: shifted(self.step_v, bits),
            rows: self.rows << bits,
            columns: self.columns << bits,
            jitter: Jitter::NONE,
        }
    }

    /// Row of the last place, in rows: samples lie in `0..=last_row`.
    #[inline(always)]
    pub(crate) fn last_row(&self) -> f32 {
        (self.rows - 1) as f32 + self.jitter.last_place()
    }

    /// Column of the last place, in columns.
    #[inline(always)]
    pub(crate) fn last_column(&self) -> f32 {
        (self.columns - 1) as f32 + self.jitter.last_place()
    }
}

/// `v / 2^bits`, of multiples.
#[inline(always)]
fn shifted(v: IVec3, bits: u32) -> IVec3 {
    IVec3::new(v.x >> bits, v.y >> bits, v.z >> bits)
}
