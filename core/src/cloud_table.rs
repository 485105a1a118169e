//! A table of all planes, roughly: which samples of a cloud lie on the inner side of a plane, by its direction and distance.
//!
//! Seed: the lookup table LU of Sintorn, Eisemann and Assarsson 2008, section 4.2: a plane is two angles and a distance, an
//! entry the bit mask of the samples behind it; a triangle's mask is the AND over its planes, a receiver's the OR over triangles.
//! Departures: directions are cells of an octahedron unfolded onto a square, which takes no trigonometry, in the place of two
//! angles; pairs are found as for exact masks, and a plane that surely cuts nothing is not looked up. So the only error is
//! that of the table: planes are moved to the nearest ones that it has.

use glam::{IVec3, Vec3};
use thiserror::Error;

use crate::{
    cloud::{Cloud, CloudMask, WORD_BITS},
    cloud_pair::{Pair, SampleTest},
    edge_plane::float,
    lanes::Lanes,
    precision::PrecisionMode,
    statistics::Tally,
    view::Offsets,
};

/// Most cells on a side of the square of directions.
pub const MAX_DIRECTIONS: u32 = 1024;

/// Most distances.
pub const MAX_DISTANCES: u32 = 4096;

/// How finely planes are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableSize {
    /// Cells on a side of the square of directions, in `1..=1024`: there are as many directions as its square.
    pub directions: u32,
    /// Distances from the cloud's middle, of each direction, in `1..=4096`.
    pub distances: u32,
}

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
    size: TableSize,
    /// Words of an entry.
    words: usize,
    /// Planes are placed from its base.
    offsets: Offsets,
    /// No sample lies farther from the base.
    radius: f32,
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
        let [low, high] = cloud.bounds();
        let base = low + (high - low) / 2;
        let limit = float((high - base).max(base - low));
        let (mut radius, mut full) = (1.0, CloudMask::default());
        for (k, sample) in cloud.samples().iter().enumerate() {
            radius = Lanes::max(radius, float(sample - base).length());
            if let Some(word) = full.get_mut(k / WORD_BITS) {
                *word |= 1 << (k % WORD_BITS);
            }
        }
        let offsets = Offsets::at_base(base, limit);
        // None of them is 0, which has to be said here: nothing may panic.
        let (words, cells) = (cloud.words().max(1), size.directions.max(1));
        for (cell, of_direction) in
            entries.as_mut().chunks_exact_mut((size.distances as usize * words).max(1)).enumerate()
        {
            let (row, column) = (cell as u32 / cells, cell as u32 % cells);
            fill(cloud.samples(), base, radius, direction([row, column], cells), words, of_direction);
        }
        Ok(Self { cloud, layout: Layout { size, words, offsets, radius, full }, entries })
    }
}

impl<'a, C, S: AsRef<[u32]>> CloudTable<'a, C, S> {
    /// The cloud it is of.
    pub fn cloud(&self) -> &'a Cloud<C> {
        self.cloud
    }

    /// How finely planes are told apart.
    pub fn size(&self) -> TableSize {
        self.layout.size
    }

    /// The planes, for lookups.
    pub fn planes(&self) -> PlaneTable<'_> {
        PlaneTable { layout: &self.layout, entries: self.entries.as_ref() }
    }
}

impl PlaneTable<'_> {
    /// ANDs the samples `x` with `outward·(x − base) ≤ at_base`, roughly, to a mask.
    #[inline(always)]
    fn cut(&self, outward: Vec3, at_base: f32, mask: &mut CloudMask) {
        let Layout { size, words, radius, .. } = *self.layout;
        let length = outward.length();
        // A plane without a direction has nothing on its inner side.
        let distance = if length > 0.0 { -at_base / (length * radius) } else { 1.0 };
        if distance <= -1.0 {
            return;
        }
        let entry = if distance >= 1.0 {
            None
        } else {
            let [row, column] = cell(-outward, size.directions);
            let distances = size.distances as usize;
            let slot = ((0.5 * distance + 0.5) * distances as f32) as usize;
            let place = (row * size.directions + column) as usize * distances + slot.min(distances - 1);
            self.entries.get(place * words..(place + 1) * words)
        };
        let entry = entry.unwrap_or(&[]);
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

/// The cell that a direction, of any length above zero, lies in: row and column.
#[inline(always)]
fn cell(v: Vec3, cells: u32) -> [u32; 2] {
    let v = v / (v.x.abs() + v.y.abs() + v.z.abs());
    let folded = |at: f32, other: f32| {
        if v.z >= 0.0 {
            at
        } else {
            let outward = 1.0 - other.abs();
            if at >= 0.0 { outward } else { -outward }
        }
    };
    let place = |at: f32| (((0.5 * at + 0.5) * cells as f32) as u32).min(cells - 1);
    [place(folded(v.y, v.x)), place(folded(v.x, v.y))]
}

impl SampleTest for PlaneTable<'_> {
    #[inline(always)]
    fn mark<L: Lanes, P: PrecisionMode, const N: usize>(
        &self,
        pair: &Pair,
        mask: &mut CloudMask,
        _: &mut Tally,
    ) -> u32 {
        let planes = pair.planes::<L, P, N>(&self.layout.offsets);
        let (mut blocked, mut k) = (self.layout.full, 0);
        while k < N {
            if pair.cuts >> k & 1 == 1 {
                let outward = Vec3::new(planes.normals[0][k], planes.normals[1][k], planes.normals[2][k]);
                self.cut(outward * SCALE, planes.at_base[k] * SCALE, &mut blocked);
            }
            k += 1;
        }
        let (mut found, mut word) = (0, 0);
        while word < self.layout.words && word < blocked.len() {
            found += (blocked[word] & !mask[word]).count_ones();
            mask[word] |= blocked[word];
            word += 1;
        }
        found
    }
}

/// Keeps squares of normals within the range of a float.
const SCALE: f32 = 1.0 / (1_u64 << 40) as f32;
