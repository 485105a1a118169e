//! What the samples of a light emit: coloured textures, and stencils that leave some of them out. Weights are integers, so that
//! sums over lit samples are the same bits everywhere; they have nothing to do with geometry, and may be others in every frame.
//!
//! Seed: textured and arbitrarily shaped lights of Sintorn, Eisemann and Assarsson 2008, section 4, there a weight for every bit of
//! a mask. A disk, or any other shape on the light's plane, is a light of which only some samples exist.

use thiserror::Error;

use crate::{
    light::MAX_SAMPLES,
    mask_word::MaskWord,
    tint::{Depth, tinted_weight},
};

/// Weight of one sample: red, green, blue.
pub type Weight = [u16; 3];

/// The weight of a sample that emits as much as any.
pub const WHOLE: u16 = u16::MAX;

const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Why an emission is refused.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum EmissionError {
    /// There are more, or fewer, samples than the light has.
    #[error("{count} {field} for a light of {rows}×{columns} samples")]
    Count {
        /// "weights" or "radiances".
        field: &'static str,
        /// How many were given.
        count: usize,
        /// Rows of the light.
        rows: u32,
        /// Columns of the light.
        columns: u32,
    },
    /// The number of rows or columns is outside `1..=64`.
    #[error("emission {field} is {value}, outside 1..=64")]
    SampleCount {
        /// "rows" or "columns".
        field: &'static str,
        /// Its value.
        value: u32,
    },
    /// A radiance is negative or not finite.
    #[error("radiance of sample (row {row}, column {column}) has {channel} = {value}: not a number of at least 0")]
    Radiance {
        /// Row of the sample.
        row: u32,
        /// Column of the sample.
        column: u32,
        /// "red", "green" or "blue".
        channel: &'static str,
        /// Its value.
        value: f32,
    },
    /// A corner of a polygon is not finite.
    #[error("corner {index} of the polygon is at ({x}, {y}): not finite")]
    Corner {
        /// Index of the corner.
        index: usize,
        /// Its place along the columns.
        x: f64,
        /// Its place along the rows.
        y: f64,
    },
    /// No sample emits anything.
    #[error("no sample of the light emits anything")]
    Dark,
}

/// The weights of a light's samples, row by row, in a buffer of the caller's.
///
/// ```
/// use umbra4_core::emission::{Emission, Shape, WHOLE};
///
/// let disk = Emission::shaped(8, 8, [[0; 3]; 64], Shape::Disk)?;
/// assert_eq!((disk.weight(0, 0), disk.weight(3, 3)), (Some([0; 3]), Some([WHOLE; 3])));
/// // Of a receiver that sees the first four columns only:
/// assert_eq!(disk.fraction(disk.lit(&[0xf0_u16; 8])), [0.5; 3]);
/// # Ok::<(), umbra4_core::emission::EmissionError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Emission<S> {
    rows: u32,
    columns: u32,
    weights: S,
    total: [u32; 3],
}

/// A shape on a light, of which the columns and rows span the unit square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<'a> {
    /// The ellipse that touches all four edges: a disk, where the light is a square.
    Disk,
    /// The inside of a polygon (even-odd rule), by its corners: (along the columns, along the rows).
    Polygon(&'a [[f64; 2]]),
}

impl Shape<'_> {
    /// Whether a point belongs to the shape.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        match self {
            Self::Disk => (x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) <= 0.25,
            Self::Polygon(corners) => {
                let mut inside = false;
                let mut from = corners.last();
                for to in *corners {
                    if let Some([x0, y0]) = from {
                        let [x1, y1] = to;
                        let crosses = (*y0 > y) != (*y1 > y);
                        inside ^= crosses && x < x0 + (y - y0) / (y1 - y0) * (x1 - x0);
                    }
                    from = Some(to);
                }
                inside
            }
        }
    }
}

fn check(field: &'static str, count: usize, rows: u32, columns: u32) -> Result<(), EmissionError> {
    for (field, value) in [("rows", rows), ("columns", columns)] {
        if !(1..=MAX_SAMPLES).contains(&value) {
            return Err(EmissionError::SampleCount { field, value });
        }
    }
    if count == (rows * columns) as usize { Ok(()) } else { Err(EmissionError::Count { field, count, rows, columns }) }
}

impl<S: AsRef<[Weight]>> Emission<S> {
    /// Of weights as they are, `rows` × `columns` of them, row by row.
    ///
    /// # Errors
    /// Rows or columns outside `1..=64`; another number of weights; weights that are all zero.
    pub fn new(rows: u32, columns: u32, weights: S) -> Result<Self, EmissionError> {
        check("weights", weights.as_ref().len(), rows, columns)?;
        let mut total = [0; 3];
        for weight in weights.as_ref() {
            add(&mut total, weight);
        }
        if total == [0; 3] { Err(EmissionError::Dark) } else { Ok(Self { rows, columns, weights, total }) }
    }

    /// Rows and columns of the light.
    pub fn size(&self) -> [u32; 2] {
        [self.rows, self.columns]
    }

    /// The weight of a sample, or `None` where there is no such sample.
    pub fn weight(&self, row: u32, column: u32) -> Option<Weight> {
        if row >= self.rows || column >= self.columns {
            return None;
        }
        self.weights.as_ref().get((row * self.columns + column) as usize).copied()
    }

    /// The same, over borrowed weights.
    pub fn by_reference(&self) -> Emission<&[Weight]> {
        Emission { rows: self.rows, columns: self.columns, weights: self.weights.as_ref(), total: self.total }
    }

    /// All weights, row by row.
    pub fn weights(&self) -> &[Weight] {
        self.weights.as_ref()
    }

    /// The sum of all weights.
    pub fn total(&self) -> [u32; 3] {
        self.total
    }

    /// The sum of the weights of lit samples, from the rows of a mask: below 2^28.
    #[inline]
    pub fn lit<W: MaskWord>(&self, rows: &[W]) -> [u32; 3] {
        self.lit_of(rows.iter())
    }

    /// The same from a mask of [`LatticeLight::back`](crate::LatticeLight::back), whose rows come in reverse order: `rows` holds all
    /// of them.
    #[inline]
    pub fn lit_of_back<W: MaskWord>(&self, rows: &[W]) -> [u32; 3] {
        self.lit_of(rows.iter().rev())
    }

    /// The same where panes lie before samples: `depths` holds what they take of each, row by row; what is missing is clear. Every
    /// product is rounded by itself ([`crate::tint`]), so that the sum is the same in any order. Below 2^28.
    #[inline]
    pub fn lit_through<W: MaskWord>(&self, rows: &[W], depths: &[Depth]) -> [u32; 3] {
        let (mut sum, all) = ([0; 3], W::below(self.columns));
        let weights = self.weights.as_ref().chunks(self.columns.max(1) as usize);
        for (row, (mask, weights)) in rows.iter().zip(weights).enumerate() {
            let mut lit = all.without(*mask);
            while lit != W::EMPTY {
                let column = lit.lowest();
                lit = lit.without(W::span(column, column + 1));
                let depth = depths.get(row * self.columns as usize + column as usize).copied().unwrap_or_default();
                if let Some(weight) = weights.get(column as usize) {
                    for (sum, part) in sum.iter_mut().zip(tinted_weight(*weight, depth)) {
                        *sum += part;
                    }
                }
            }
        }
        sum
    }

    #[inline]
    fn lit_of<'a, W: MaskWord + 'a>(&self, rows: impl Iterator<Item = &'a W>) -> [u32; 3] {
        let (mut sum, all) = ([0; 3], W::below(self.columns));
        for (row, weights) in rows.zip(self.weights.as_ref().chunks(self.columns.max(1) as usize)) {
            let mut lit = all.without(*row);
            while lit != W::EMPTY {
                let column = lit.lowest();
                lit = lit.without(W::span(column, column + 1));
                if let Some(weight) = weights.get(column as usize) {
                    add(&mut sum, weight);
                }
            }
        }
        sum
    }

    /// A sum of weights as a fraction of what the whole light emits; 0 in channels in which it emits nothing.
    pub fn fraction(&self, lit: [u32; 3]) -> [f32; 3] {
        [0, 1, 2].map(|channel| match self.total[channel] {
            0 => 0.0,
            total => (f64::from(lit[channel]) / f64::from(total)) as f32,
        })
    }
}

impl<S: AsRef<[Weight]> + AsMut<[Weight]>> Emission<S> {
    /// Of a texture: a radiance for every sample, red, green and blue, row by row, in any unit. Weights are rounded; the largest
    /// radiance is [`WHOLE`]. What `room` holds is not looked at.
    ///
    /// # Errors
    /// Rows or columns outside `1..=64`; another number of radiances, or room for another; a radiance that is negative or not finite; a light that is dark.
    pub fn textured(rows: u32, columns: u32, mut room: S, radiance: &[[f32; 3]]) -> Result<Self, EmissionError> {
        check("radiances", radiance.len(), rows, columns)?;
        check("weights", room.as_ref().len(), rows, columns)?;
        let mut largest = 0.0_f32;
        for ((row, column), sample) in places(rows, columns).zip(radiance) {
            for (channel, value) in CHANNELS.into_iter().zip(*sample) {
                if !value.is_finite() || value < 0.0 {
                    return Err(EmissionError::Radiance { row, column, channel, value });
                }
                largest = largest.max(value);
            }
        }
        if largest == 0.0 {
            return Err(EmissionError::Dark);
        }
        let rounded = |value: f32| (f64::from(value) / f64::from(largest) * f64::from(WHOLE) + 0.5) as u16;
        for (weight, sample) in room.as_mut().iter_mut().zip(radiance) {
            *weight = sample.map(rounded);
        }
        Self::new(rows, columns, room)
    }

    /// Of a shape: samples emit where the middle of their cell belongs to it. What `room` holds is not looked at.
    ///
    /// # Errors
    /// Rows or columns outside `1..=64`; room for another number of weights; a corner that is not finite; a shape that holds no
    /// sample.
    pub fn shaped(rows: u32, columns: u32, mut room: S, shape: Shape<'_>) -> Result<Self, EmissionError> {
        check("weights", room.as_ref().len(), rows, columns)?;
        if let Shape::Polygon(corners) = shape {
            let bad = corners.iter().enumerate().find(|(_, corner)| !corner.iter().all(|x| x.is_finite()));
            if let Some((index, &[x, y])) = bad {
                return Err(EmissionError::Corner { index, x, y });
            }
        }
        let middle = |index: u32, count: u32| (f64::from(index) + 0.5) / f64::from(count);
        for ((row, column), weight) in places(rows, columns).zip(room.as_mut()) {
            let emits = shape.holds([middle(column, columns), middle(row, rows)]);
            *weight = if emits { [WHOLE; 3] } else { [0; 3] };
        }
        Self::new(rows, columns, room)
    }
}

fn add(sum: &mut [u32; 3], weight: &Weight) {
    for (sum, weight) in sum.iter_mut().zip(weight) {
        *sum += u32::from(*weight);
    }
}

/// Rows and columns of all samples, in order.
fn places(rows: u32, columns: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
}

// No sum is too large for its word.
const _: () = assert!((MAX_SAMPLES as u64 * MAX_SAMPLES as u64) * (WHOLE as u64) < 1 << 28);
