//! Jittered light samples: where in its cell each sample lies. Regular samples band; jittered ones turn bands into noise,
//! and, over frames, into neither.
//!
//! Seed: Wang et al. 2016, section 4.3, who name the regular pattern as the first limit and propose to perturb it; and
//! Eisemann and Décoret's successors (section 4.2 of the paper on volumetric sources), who let samples change from frame to frame.
//!
//! A cell has [`PLACES`]² places, on a lattice of its own, so that all places of a light form one regular, finer light: signs
//! stay determinants of integers, linear along its rows and columns. The pattern is that of correlated multi-jittered sampling
//! (Kensler 2013): all samples of a row are moved along the columns by the same part of a cell, those of a column along the
//! rows, each by a part of its own. So the samples are spread evenly over the light's area, and over both its edges,
//! however an occluder lies. And it is what keeps whole rows cheap ([`crate::jittered_rows`]): a plane's switch column in a row
//! differs from column to column by a term that is the same in all rows.

use crate::lanes::{Lanes, TILE, Table};
#[cfg(not(target_arch = "spirv"))]
use crate::light::LatticeLight;
use crate::light::MAX_SAMPLES;

/// Places along each edge of a cell.
pub const PLACES: u32 = 1 << PLACE_BITS;
/// Binary digits of a place.
pub(crate) const PLACE_BITS: u32 = 5;
/// The last place of a cell, in cells.
pub(crate) const LAST_PLACE: f32 = 1.0 - 1.0 / PLACES as f32;

/// Which pattern samples are jittered by, if they are.
///
/// Patterns are numbered. Of any [`PLACES`] that follow on one another, beginning at a multiple of it, no two have a sample at
/// the same row or column of places: a light that takes the next one every frame converges. Lights that shall not share
/// noise take numbers that are far apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Jitter(u32);

impl Jitter {
    /// Regular samples, at the middle of their cells.
    pub const NONE: Self = Self(0);

    /// Pattern `number`, modulo 2^30.
    pub const fn pattern(number: u32) -> Self {
        Self(number << 2 | 1)
    }

    /// The pattern's number; `None` for regular samples.
    pub const fn number(self) -> Option<u32> {
        if self.is_some() { Some(self.0 >> 2) } else { None }
    }

    /// The same pattern with its rows in reverse order, places within them too; of regular samples, those.
    #[must_use]
    pub const fn reversed(self) -> Self {
        if self.is_some() { Self(self.0 ^ 2) } else { self }
    }

    /// Whether rows come in reverse order.
    #[cfg(not(target_arch = "spirv"))]
    const fn is_reversed(self) -> bool {
        self.0 & 2 != 0
    }

    /// Whether samples are jittered.
    #[inline(always)]
    pub const fn is_some(self) -> bool {
        self.0 != 0
    }

    /// As kernels are told.
    #[inline(always)]
    pub const fn code(self) -> u32 {
        self.0
    }

    /// From what kernels are told.
    #[inline(always)]
    pub const fn from_code(code: u32) -> Self {
        Self(code)
    }

    /// Binary digits of the number of places along an edge of a cell: 0 where samples are regular.
    #[inline(always)]
    pub(crate) const fn place_bits(self) -> u32 {
        if self.is_some() { PLACE_BITS } else { 0 }
    }

    /// What the last place of a cell is away from the first, in cells.
    #[inline(always)]
    pub(crate) const fn last_place(self) -> f32 {
        if self.is_some() { LAST_PLACE } else { 0.0 }
    }
}

/// One sample: where it lies on the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Rows from the first place.
    pub row: f32,
    /// Columns from the first place.
    pub column: f32,
    /// Places along the rows.
    pub fine_row: i32,
    /// Places along the columns.
    pub fine_column: i32,
}

/// Where samples lie. Kernels are compiled for one kind, so that regular samples pay nothing for the others.
pub trait Samples {
    /// Whether they lie anywhere but where rows and columns cross.
    const JITTERED: bool;
    /// Where sample (`row`, `column`) lies.
    fn place(&self, row: usize, column: usize) -> Place;
    /// By how much rows are moved along the columns, in columns. Rows modulo [`MAX_SAMPLES`].
    fn row_shifts<L: Lanes>(&self, rows: L::Ints) -> L;
    /// By how much columns are moved along the rows, in rows. Columns modulo [`MAX_SAMPLES`].
    fn column_shifts<L: Lanes>(&self, columns: L::Ints) -> L;
}

/// Samples where rows and columns cross.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Regular;

impl Samples for Regular {
    const JITTERED: bool = false;

    #[inline(always)]
    fn place(&self, row: usize, column: usize) -> Place {
        Place { row: row as f32, column: column as f32, fine_row: row as i32, fine_column: column as i32 }
    }

    #[inline(always)]
    fn row_shifts<L: Lanes>(&self, _: L::Ints) -> L {
        L::splat(0.0)
    }

    #[inline(always)]
    fn column_shifts<L: Lanes>(&self, _: L::Ints) -> L {
        L::splat(0.0)
    }
}

const TILES: usize = MAX_SAMPLES as usize / TILE;

/// Jittered samples: the shifts of all rows and columns, multiples of 1/[`PLACES`] below 1.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Pattern {
    /// Of rows, along the columns, in columns.
    rows: Table,
    /// Of columns, along the rows, in rows.
    columns: Table,
}

impl Samples for Pattern {
    const JITTERED: bool = true;

    #[inline(always)]
    fn place(&self, row: usize, column: usize) -> Place {
        let row_shift = self.rows[row / TILE % TILES][row % TILE];
        let column_shift = self.columns[column / TILE % TILES][column % TILE];
        // All exact: a few binary digits each.
        let (row, column) = (row as f32 + column_shift, column as f32 + row_shift);
        Place { row, column, fine_row: (row * PLACES as f32) as i32, fine_column: (column * PLACES as f32) as i32 }
    }

    #[inline(always)]
    fn row_shifts<L: Lanes>(&self, rows: L::Ints) -> L {
        L::lookup(&self.rows, rows)
    }

    #[inline(always)]
    fn column_shifts<L: Lanes>(&self, columns: L::Ints) -> L {
        L::lookup(&self.columns, columns)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Pattern {
    /// That of a light; zero where its samples are regular.
    pub fn of(light: &LatticeLight) -> Self {
        let mut pattern = <Self as bytemuck::Zeroable>::zeroed();
        if let Some(number) = light.jitter.number() {
            let (set, frame) = (number / PLACES, number % PLACES);
            // A point of a two-dimensional set of low discrepancy for every frame.
            let turns = [frame.reverse_bits() >> (u32::BITS - PLACE_BITS), frame * 13 % PLACES];
            write_shifts(&mut pattern.rows, light.rows, turns[0], 2 * set);
            write_shifts(&mut pattern.columns, light.columns, turns[1], 2 * set + 1);
            if light.jitter.is_reversed() {
                pattern.reverse_rows(light);
            }
        }
        pattern
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Pattern {
    /// Turns the light's rows around: sample (i, j) of what results is (rows − 1 − i, j), its place counted from the other end.
    fn reverse_rows(&mut self, light: &LatticeLight) {
        let rows = self.rows.as_flattened_mut();
        let count = rows.len().min(light.rows as usize);
        if let Some(rows) = rows.get_mut(..count) {
            rows.reverse();
        }
        for shift in self.columns.as_flattened_mut().iter_mut().take(light.columns as usize) {
            *shift = LAST_PLACE - *shift;
        }
    }
}

/// Writes places that are spread evenly over the cell, in random order, turned by `turn` places.
#[cfg(not(target_arch = "spirv"))]
fn write_shifts(shifts: &mut Table, count: u32, turn: u32, seed: u32) {
    let count = count.clamp(1, MAX_SAMPLES);
    let mut order = [0_u32; MAX_SAMPLES as usize];
    let mut random = seed;
    // Fisher and Yates, from the inside out.
    for k in 0..count as usize % (order.len() + 1) {
        random = mixed(random.wrapping_add(0x9e37_79b9));
        let other = (random as usize % (k + 1)) % order.len();
        order[k % order.len()] = order[other];
        order[other] = k as u32;
    }
    for (shift, rank) in shifts.as_flattened_mut().iter_mut().zip(order).take(count as usize) {
        let place = (2 * rank + 1) * PLACES / (2 * count) + turn;
        *shift = (place % PLACES) as f32 / PLACES as f32;
    }
}

/// An integer of which every bit depends on all bits of `x` (the finaliser of MurmurHash3).
#[cfg(not(target_arch = "spirv"))]
fn mixed(mut x: u32) -> u32 {
    x = (x ^ x >> 16).wrapping_mul(0x85eb_ca6b);
    x = (x ^ x >> 13).wrapping_mul(0xc2b2_ae35);
    x ^ x >> 16
}
