//! The paper's own index, kept as the reference that its ratios are measured on: a frame buffer on a plane parallel to
//! the light, in whose cells receivers and triangles meet.
//!
//! Seed: Wang et al. 2016, section 3.1, Algorithm 1 (lines 3 to 17), section 3.2, Algorithm 2. With the frame plane P at
//! height W, a point with the slopes `S0 = a/w` and `S1 = (a − last)/w` of [`crate::proj4`] has the generalised
//! projection `[last + W·S1, W·S0]` along the columns; along the rows the same. All is divided by W here: `[last/W + S1,
//! S0]`. So W enters by one constant, and nothing overflows where slopes have no bound.
//!
//! Departures from the paper. W is the largest height of a receiver: what lies beyond blocks nothing, and the nearer P,
//! the smaller the boxes. A receiver close to the light plane would stretch the frame beyond all use: below
//! [`NEAREST`]·W it does not, and its rectangle is cut. A rim of cells around the frame stands for all that lies outside.
//!
//! **No pair is lost.** Let a triangle's keys dominate a receiver's (they do for every relevant pair, see
//! [`crate::proj4`]). Then the computed ends of the triangle's box enclose those of the receiver's rectangle, as both are
//! made from the keys by the same monotone operation; and so do their cells, as [`FrameBuffer`]'s cell of a coordinate is
//! a monotone function too: clamped differences and products with a positive factor are monotone under any rounding
//! direction, if it is always the same. A receiver whose low end's cell is at most its high end's is thus met in every
//! one of its cells, the one of its high ends among them: the projection from light corner L0, Algorithm 2. Else its keys'
//! rounding has swallowed its rectangle, or it touches the light plane and has none. It gets no cell, and has to be held
//! against all triangles.

use crate::{frame::LightFrame, lanes::Lanes, proj4::Keys};

/// Receivers nearer to the light plane than this share of the frame plane's height do not stretch the frame.
pub const NEAREST: f32 = 0.125;

/// Most cells along an edge of the frame.
pub const MAX_CELLS: u32 = 4096;

/// Least height of the frame plane, lattice units: all receivers may touch the light plane.
const LEAST_HEIGHT: f32 = 1.0e-3;

/// Spans below this are one cell wide: a quotient by them would overflow.
const LEAST_SPAN: f32 = 1.0e-30;

/// A rectangle on the frame plane, in columns and rows over W. May be inverted, as the rounded one of a point is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Extent {
    /// Lower ends along columns and rows.
    pub low: [f32; 2],
    /// Higher ends.
    pub high: [f32; 2],
}

impl Extent {
    /// The extent of nothing.
    pub const EMPTY: Self = Self { low: [f32::MAX; 2], high: [f32::MIN; 2] };

    /// The step of Algorithm 1, line 6. An inverted rectangle adds nothing that others do not.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            low: [Lanes::min(self.low[0], other.low[0]), Lanes::min(self.low[1], other.low[1])],
            high: [Lanes::max(self.high[0], other.high[0]), Lanes::max(self.high[1], other.high[1])],
        }
    }
}

/// The frame plane P.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FramePlane {
    /// W: its height above the light plane, lattice units.
    pub height: f32,
    /// The last column, and row, over W.
    last: [f32; 2],
}

impl FramePlane {
    /// The plane at the height of the highest receiver: the largest of their `-keys[4]`.
    pub fn new(frame: &LightFrame, highest: f32) -> Self {
        let height = Lanes::max(highest, LEAST_HEIGHT);
        Self { height, last: [frame.last_column / height, frame.last_row / height] }
    }

    /// The generalised projection of a receiver, or the box of a triangle's.
    #[inline]
    pub fn project(&self, keys: &Keys) -> Extent {
        Extent { low: [self.last[0] - keys[1], self.last[1] - keys[3]], high: [keys[0], keys[2]] }
    }

    /// What a receiver adds to the extent of the frame.
    #[inline]
    pub fn stretch(&self, receiver: &Keys) -> Extent {
        if -receiver[4] >= self.height * NEAREST { self.project(receiver) } else { Extent::EMPTY }
    }
}

/// A rectangle of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct CellRange {
    /// First cell along columns and rows.
    pub first: [u32; 2],
    /// One past the last, at least `first`.
    pub end: [u32; 2],
}

impl CellRange {
    /// Number of cells.
    pub fn count(&self) -> usize {
        (self.end[0] - self.first[0]) as usize * (self.end[1] - self.first[1]) as usize
    }
}

/// The frame buffer: the plane, and its cells with their rim.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FrameBuffer {
    plane: FramePlane,
    extent: Extent,
    cells: [u32; 2],
    per_span: [f32; 2],
}

impl FrameBuffer {
    /// A frame over `extent` (the union of the receivers' [`FramePlane::stretch`]) of `cells` columns and rows of cells,
    /// each in `1..=MAX_CELLS`.
    pub fn new(plane: FramePlane, extent: Extent, cells: [u32; 2]) -> Self {
        let mut frame = Self { plane, extent, cells, per_span: [0.0; 2] };
        let mut axis = 0;
        while axis < 2 {
            // Where no receiver has a rectangle, any frame will do.
            if extent.low[axis] > extent.high[axis] {
                (frame.extent.low[axis], frame.extent.high[axis]) = (0.0, 0.0);
            }
            let span = frame.extent.high[axis] - frame.extent.low[axis];
            if span > LEAST_SPAN {
                frame.per_span[axis] = cells[axis] as f32 / span;
            }
            axis += 1;
        }
        frame
    }

    /// Columns and rows of cells, the rim included.
    pub fn size(&self) -> [u32; 2] {
        [self.cells[0] + 2, self.cells[1] + 2]
    }

    /// The cell of a coordinate: monotone. 0 and the last are the rim.
    #[inline]
    fn cell(&self, axis: usize, x: f32) -> u32 {
        if x < self.extent.low[axis] {
            return 0;
        }
        if x > self.extent.high[axis] {
            return self.cells[axis] + 1;
        }
        let place = (x - self.extent.low[axis]) * self.per_span[axis];
        // Rounding may put the highest coordinate one too far.
        1 + Lanes::min(place, (self.cells[axis] - 1) as f32) as u32
    }

    #[inline]
    fn ends(&self, keys: &Keys) -> [[u32; 2]; 2] {
        let extent = self.plane.project(keys);
        [
            [self.cell(0, extent.low[0]), self.cell(1, extent.low[1])],
            [self.cell(0, extent.high[0]), self.cell(1, extent.high[1])],
        ]
    }

    /// Algorithm 1, lines 9 and 10: all cells of a receiver's rectangle. `None` where it has none.
    #[inline]
    pub fn receiver_cells(&self, keys: &Keys) -> Option<CellRange> {
        let [low, high] = self.ends(keys);
        let proper = low[0] <= high[0] && low[1] <= high[1];
        if proper { Some(CellRange { first: low, end: [high[0] + 1, high[1] + 1] }) } else { None }
    }

    /// Algorithm 2: the cell of a receiver's projection from light corner L0, sample (0, 0). `None` as for
    /// [`FrameBuffer::receiver_cells`].
    #[inline]
    pub fn receiver_cell(&self, keys: &Keys) -> Option<CellRange> {
        let all = self.receiver_cells(keys)?;
        Some(CellRange { first: [all.end[0] - 1, all.end[1] - 1], end: all.end })
    }

    /// Algorithm 1, lines 14 to 16: the cells of a triangle's box; empty where it lies beyond the frame plane.
    #[inline]
    pub fn triangle_cells(&self, keys: &Keys) -> CellRange {
        let [low, high] = self.ends(keys);
        CellRange {
            first: low,
            end: [
                if low[0] <= high[0] { high[0] + 1 } else { low[0] },
                if low[1] <= high[1] { high[1] + 1 } else { low[1] },
            ],
        }
    }
}
