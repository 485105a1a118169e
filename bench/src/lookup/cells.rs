//! Which cell of a table a line belongs to, for sixteen lines at once; and which lines belong to a cell.
//!
//! A half-plane is `n·(s − m) ≥ r`, s a sample's column and row, m the middle of the grid, and `|n_column| + |n_row| = 1`. With
//! this norm instead of the Euclidean one of Hough's parameters, angle and distance take one division and no arc tangent, n is
//! linear in the angle within a quadrant, so that a cell's extremes lie at its corners, and no distance beyond the grid's
//! half is needed at any angle.
//!
//! # Error bound
//! With `s·(1, −β)·w`, `w = 1/(1 + |β|)`, for n and `s·(α − m_column + β·m_row)·w` for r, and h half the grid: only r in −2h to 2h
//! matter, so `|α|·w ≤ 4h`. In units of ε: the line as given has 1·4h for α and 1·h for β, over all rows; the sum for r has at
//! most 3·4h and the product h; w has 5 and its product 1, which make 12h; n has 7, which make 14h over the grid. The cell's
//! number loses 3 of as many cells as there are, in all at most 6h + 6h. In all less than 64h·ε, 1.3e-4 with h = 32 and the
//! roundoff of sixteen lanes; the slope that stands for the steepest lines moves them by less than 64·2^-22. [`MARGIN`] has
//! room for five times that.

use umbra4_core::lanes::{Lanes, TILE};

use super::edges::EdgeTile;

/// How far from a line, in the norm above, a sample surely lies on the side that floats say.
pub const MARGIN: f32 = 1.0 / 1024.0;

/// The cells of a table: so many angles, each with so many distances.
#[derive(Clone, Copy, Debug)]
pub struct Cells {
    angles: usize,
    distances: usize,
    /// Half of the grid's rows and columns, less one half.
    half: f32,
}

/// The lines of a cell: those of two normals and two distances, and all between.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Columns and rows.
    pub normals: [[f64; 2]; 2],
    /// The first and the last cell have all distances beyond.
    pub distances: [f64; 2],
}

/// The lines of an [`EdgeTile`] as cells and as half-planes.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// Their cells.
    pub cells: [[i32; TILE]; 3],
    /// Columns, rows and distance of the half-planes.
    pub normal: [[[f32; TILE]; 3]; 2],
    /// `r`
    pub distance: [[f32; TILE]; 3],
}

impl Placed {
    /// To be written by [`Cells::place`].
    pub const EMPTY: Self = Self { cells: [[0; TILE]; 3], normal: [[[0.0; TILE]; 3]; 2], distance: [[0.0; TILE]; 3] };
}

impl Cells {
    /// Of a light with `samples` rows and columns. `angles` is a multiple of four, so that no cell has two quadrants' lines;
    /// there are at least three distances, and at most 2^20 cells.
    pub fn new(samples: usize, angles: usize, distances: usize) -> Self {
        debug_assert!(angles.is_multiple_of(4) && distances > 2 && angles * distances <= 1 << 20);
        Self { angles, distances, half: (samples - 1) as f32 * 0.5 }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.angles * self.distances
    }

    /// Distances between the second cell and the last but one lie in `-reach..=reach`.
    fn reach(&self) -> f32 {
        self.half + 2.0 * MARGIN
    }

    /// The lines of cell `index`.
    pub fn cell(&self, index: usize) -> Cell {
        let (angle, distance) = (index / self.distances, index % self.distances);
        let per_half = self.angles / 2;
        let (half, angle) = (angle / per_half, angle % per_half);
        let normal = |angle: usize| {
            let row = angle as f64 * 2.0 / per_half as f64 - 1.0;
            [if half == 0 { 1.0 - row.abs() } else { row.abs() - 1.0 }, row]
        };
        let reach = f64::from(self.reach());
        let inner = self.distances - 2;
        let border = |border: usize| match border {
            0 => f64::NEG_INFINITY,
            border if border == self.distances => f64::INFINITY,
            border => ((border - 1) as f64 * 2.0 / inner as f64 - 1.0) * reach,
        };
        Cell { normals: [normal(angle), normal(angle + 1)], distances: [border(distance), border(distance + 1)] }
    }

    /// The middle of cell `index`: the line that stands for all of it. The first and the last are beyond the grid.
    pub fn middle(&self, index: usize) -> ([f64; 2], f64) {
        let Cell { normals: [[a, b], [c, d]], distances: [from, to] } = self.cell(index);
        ([(a + c) * 0.5, (b + d) * 0.5], (from + to) * 0.5)
    }

    /// Finds the cells of a tile of lines, and the half-planes.
    #[inline(always)]
    pub fn place<L: Lanes>(&self, edges: &EdgeTile, placed: &mut Placed) {
        let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(self.half));
        let per_quadrant = self.angles as f32 * 0.25;
        let (last_angle, turn) = (L::splat(2.0 * per_quadrant - 0.5), 2.0 * per_quadrant);
        let scale = (self.distances - 2) as f32 / (2.0 * self.reach());
        let (scale, base) = (L::splat(scale), L::splat(self.reach() * scale + 1.0));
        let last_distance = L::splat(self.distances as f32 - 0.5);
        let whole = |x: L| L::difference(x.floor(), L::splat_int(0));
        for k in 0..3 {
            let mut first = 0;
            while first < TILE {
                let slope = L::load(&edges.slope[k], first);
                let lower = L::mask(edges.lower[k] >> first);
                let weight = one.add(slope.abs()).recip();
                let signed = L::select(lower, weight, zero.sub(weight));
                let row = zero.sub(slope.mul(signed));
                let across = L::load(&edges.start[k], first).sub(half).add(slope.mul(half));
                let distance = across.mul(signed);
                let angle = row.add(one).mul(L::splat(per_quadrant)).max(zero).min(last_angle);
                let angle = angle.add(L::select(lower, zero, L::splat(turn)));
                let place = distance.mul_add(scale, base).max(zero).min(last_distance);
                let cell = whole(angle).mul_add(L::splat(self.distances as f32), whole(place));
                L::store_ints(cell.floor(), &mut placed.cells[k], first);
                signed.store(&mut placed.normal[0][k], first);
                row.store(&mut placed.normal[1][k], first);
                distance.add(signed.add(row).mul(half)).store(&mut placed.distance[k], first);
                first += L::WIDTH;
            }
        }
    }
}
