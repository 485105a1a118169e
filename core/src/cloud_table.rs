//! A table of all planes, roughly: which samples of a cloud lie on the inner side of a plane, by its direction and distance.
//!
//! Seed: the lookup table LU of Sintorn, Eisemann and Assarsson 2008, section 4.2: a plane is two angles and a distance, an
//! entry the bit mask of the samples behind it; a triangle's mask is the AND over its planes, a receiver's the OR over triangles.
//! Departures: directions are cells of an octahedron unfolded onto a square, which takes no trigonometry, in the place of two
//! angles; pairs are found as for exact masks, and a plane that surely cuts nothing is not looked up. So the only error is
//! that of the table: planes are moved to the nearest ones that it has.
//!
//! **The rule** is one of integers, so that masks are the same bits on every executor, in whatever order and groups they come:
//! a triangle counts for a receiver that does not lie in its plane if its box reaches into the shaft between receiver and
//! cloud, as seen along each axis; then it blocks the samples that are in the entries of all four planes, as
//! [`crate::plane_cell`] places them. Who finds out in floats that a pair, or a plane of it, changes nothing finds what the rule says.

use glam::{IVec3, Vec3};
use thiserror::Error;

pub use crate::plane_cell::TableSize;
use crate::{
    cloud::{Cloud, CloudMask, WORD_BITS},
    cloud_extent::CloudExtent,
    cloud_pair::{Pair, SampleTest},
    edge_plane::float,
    lanes::Lanes,
    plane_cell::{CellGrid, radius_of},
    precision::PrecisionMode,
    shaft::{box_of, reaches},
    statistics::Tally,
};

/// Most cells on a side of the square of directions.
pub const MAX_DIRECTIONS: u32 = 1024;

/// Most distances.
pub const MAX_DISTANCES: u32 = 4096;

/// Why a table is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TableError {
    /// A size is outside its range.
    #[error("table {field} is {value}, outside 1..={most}")]
    Size {
        /// "directions" or "distances".
        field: &'static str,
        /// Its value.
        value: u32,
        /// The most it may be.
        most: u32,
    },
    /// The buffer has another length than the table.
    #[error("a buffer of {got} words for a table of {needed}")]
    Buffer {
        /// Words of the table.
        needed: usize,
        /// Words given.
        got: usize,
    },
    /// The table would not fit the address space.
    #[error("a table of {size:?} is too large for the memory")]
    TooLarge {
        /// The size asked for.
        size: TableSize,
    },
}

/// The table of a cloud, in a buffer of the caller's.
///
/// ```
/// use umbra4_core::{cloud::Cloud, cloud_table::{CloudTable, TableSize}, glam::IVec3};
/// let cloud = Cloud::new([IVec3::ZERO, IVec3::new(400, 0, 200)])?;
/// let size = TableSize { directions: 8, distances: 16 };
/// let table = CloudTable::new(&cloud, size, vec![0; CloudTable::words_of(&cloud, size)?])?;
/// assert_eq!(table.cloud().samples().len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct CloudTable<'a, C, S> {
    cloud: &'a Cloud<C>,
    layout: Layout,
    /// Entry by entry: `((row · directions) + column) · distances + distance`, each of the cloud's words.
    entries: S,
}

/// What a table's entries stand for.
#[derive(Clone, Debug)]
struct Layout {
    cells: CellGrid,
    /// Words of an entry.
    words: usize,
    /// The box around the samples.
    bounds: [IVec3; 2],
    full: CloudMask,
}

/// A table as kernels take it, whatever holds its entries.
#[derive(Clone, Copy, Debug)]
pub struct PlaneTable<'a> {
    layout: &'a Layout,
    entries: &'a [u32],
}

impl<C: AsRef<[IVec3]>> CloudTable<'_, C, &[u32]> {
    /// Words of a table of that size.
    ///
    /// # Errors
    /// A size of 0, or above the most; a table that would not fit the address space.
    pub fn words_of(cloud: &Cloud<C>, size: TableSize) -> Result<usize, TableError> {
        let TableSize { directions, distances } = size;
        for (field, value, most) in
            [("directions", directions, MAX_DIRECTIONS), ("distances", distances, MAX_DISTANCES)]
        {
            if !(1..=most).contains(&value) {
                return Err(TableError::Size { field, value, most });
            }
        }
        let planes = (directions * directions) as usize;
        let words = planes.checked_mul(distances as usize).and_then(|entries| entries.checked_mul(cloud.words()));
        words.ok_or(TableError::TooLarge { size })
    }
}

impl<'a, C: AsRef<[IVec3]>, S: AsRef<[u32]> + AsMut<[u32]>> CloudTable<'a, C, S> {
    /// Fills the table, whose buffer's contents are not looked at.
    ///
    /// # Errors
    /// As [`CloudTable::words_of`]; a buffer of another length.
    pub fn new(cloud: &'a Cloud<C>, size: TableSize, mut entries: S) -> Result<Self, TableError> {
        let needed = CloudTable::words_of(cloud, size)?;
        let got = entries.as_ref().len();
        if got != needed {
            return Err(TableError::Buffer { needed, got });
        }
        let extent = CloudExtent::of(cloud.samples());
        let (base, radius) = (extent.middle(), radius_of(&extent));
        let mut full = CloudMask::default();
        for k in 0..cloud.samples().len() {
            if let Some(word) = full.get_mut(k / WORD_BITS) {
                *word |= 1 << (k % WORD_BITS);
            }
        }
        // None of them is 0, which has to be said here: nothing may panic.
        let (words, cells) = (cloud.words().max(1), size.directions.max(1));
        for (cell, of_direction) in
            entries.as_mut().chunks_exact_mut((size.distances as usize * words).max(1)).enumerate()
        {
            let (row, column) = (cell as u32 / cells, cell as u32 % cells);
            fill(cloud.samples(), base, radius, direction([row, column], cells), words, of_direction);
        }
        let cells = CellGrid::new(&extent, size);
        Ok(Self { cloud, layout: Layout { cells, words, bounds: extent.bounds(), full }, entries })
    }
}

impl<'a, C, S: AsRef<[u32]>> CloudTable<'a, C, S> {
    /// The cloud it is of.
    pub fn cloud(&self) -> &'a Cloud<C> {
        self.cloud
    }

    /// How finely planes are told apart.
    pub fn size(&self) -> TableSize {
        self.layout.cells.size()
    }

    /// All words: entry by entry, those of a direction one after the other by their distances.
    pub fn words(&self) -> &[u32] {
        self.entries.as_ref()
    }

    /// The planes, for lookups.
    pub fn planes(&self) -> PlaneTable<'_> {
        PlaneTable { layout: &self.layout, entries: self.entries.as_ref() }
    }
}

impl PlaneTable<'_> {
    /// Takes the samples outside plane `k` of a pair out of a mask.
    #[inline(always)]
    fn cut(&self, pair: &Pair, k: usize, mask: &mut CloudMask) {
        let Layout { cells, words, .. } = self.layout;
        let cell = cells.cell(pair, k);
        if cell.slot < 0 {
            return;
        }
        let entry = match cells.entry(cell) {
            Some(place) => self.entries.get(place as usize * words..(place as usize + 1) * words).unwrap_or(&[]),
            None => &[],
        };
        let mut k = 0;
        while k < mask.len() {
            mask[k] &= if k < entry.len() { entry[k] } else { 0 };
            k += 1;
        }
    }
}

/// The entries of one direction: bit k of distance j is set where `u·(s_k − base)` is at least the middle of slot j.
fn fill(samples: &[IVec3], base: IVec3, radius: f32, u: Vec3, words: usize, of_direction: &mut [u32]) {
    of_direction.fill(0);
    let distances = of_direction.len() / words;
    for (k, sample) in samples.iter().enumerate() {
        let along = u.dot(float(sample - base)) / radius;
        let slots = (0.5 * along + 0.5) * distances as f32 + 0.5;
        // The last slot whose middle is not above it, if there is one.
        let last = (slots as usize).min(distances);
        if let Some(word) = last.checked_sub(1).and_then(|slot| of_direction.get_mut(slot * words + k / WORD_BITS)) {
            *word |= 1 << (k % WORD_BITS);
        }
    }
    // What lies beyond one distance lies beyond all smaller ones.
    for place in (words..of_direction.len()).rev() {
        let farther = of_direction.get(place).copied().unwrap_or(0);
        if let Some(nearer) = of_direction.get_mut(place - words) {
            *nearer |= farther;
        }
    }
}

/// The direction in the middle of a cell of the square.
fn direction(cell: [u32; 2], cells: u32) -> Vec3 {
    let [y, x] = cell.map(|place| (place as f32 + 0.5) / cells as f32 * 2.0 - 1.0);
    let z = 1.0 - x.abs() - y.abs();
    let fold = if z < 0.0 { -z } else { 0.0 };
    let inward = |at: f32| if at >= 0.0 { at - fold } else { at + fold };
    Vec3::new(inward(x), inward(y), z).normalize_or_zero()
}

impl SampleTest for PlaneTable<'_> {
    #[inline(always)]
    fn mark<L: Lanes, P: PrecisionMode, const N: usize>(
        &self,
        pair: &Pair,
        mask: &mut CloudMask,
        _: &mut Tally,
    ) -> u32 {
        let Layout { words, bounds, full, .. } = self.layout;
        let (mut blocked, mut k) = (*full, 0);
        while k < N {
            if pair.cuts >> k & 1 == 1 {
                self.cut(pair, k, &mut blocked);
            }
            k += 1;
        }
        let (mut found, mut word) = (0, 0);
        while word < *words && word < blocked.len() {
            found += (blocked[word] & !mask[word]).count_ones();
            word += 1;
        }
        if found == 0 || !reaches(pair.receiver, *bounds, box_of(pair.corners)) {
            return 0;
        }
        let mut word = 0;
        while word < *words && word < blocked.len() {
            mask[word] |= blocked[word];
            word += 1;
        }
        found
    }
}
