//! Tables of the masks of half-planes.

use std::marker::PhantomData;

use umbra4_core::MaskWord;

use super::cells::{Cell, Cells, MARGIN, Placed};

/// A mask, from its first row on.
pub type Mask<W, const N: usize> = [W; N];

/// What is known of all lines of a cell.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Bounds<W, const N: usize> {
    /// Samples that are inside all of them.
    pub sure: Mask<W, N>,
    /// Samples that are inside one of them.
    pub possible: Mask<W, N>,
}

/// The line in the middle of a cell.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Nearest<W, const N: usize>(pub Mask<W, N>);

/// What a table holds for a cell.
pub trait Entry<W, const N: usize>: Copy {
    /// That of cell `index`.
    fn of(cells: &Cells, index: usize) -> Self;
}

impl<W: MaskWord, const N: usize> Entry<W, N> for Bounds<W, N> {
    fn of(cells: &Cells, index: usize) -> Self {
        let Cell { normals: [one, other], distances: [from, to] } = cells.cell(index);
        let margin = f64::from(MARGIN);
        // A half-plane's distance is linear in both parameters of a cell: its extremes lie at the corners.
        let sure = both(half_plane(one, to + margin), half_plane(other, to + margin), W::and);
        let possible = both(half_plane(one, from - margin), half_plane(other, from - margin), W::or);
        Self { sure, possible }
    }
}

impl<W: MaskWord, const N: usize> Entry<W, N> for Nearest<W, N> {
    fn of(cells: &Cells, index: usize) -> Self {
        let (normal, distance) = cells.middle(index);
        Self(half_plane(normal, distance))
    }
}

fn both<W: MaskWord, const N: usize>(a: Mask<W, N>, b: Mask<W, N>, of: impl Fn(W, W) -> W) -> Mask<W, N> {
    std::array::from_fn(|row| of(a[row], b[row]))
}

/// The samples of which `normal·(sample − middle) ≥ distance`.
fn half_plane<W: MaskWord, const N: usize>([column, row]: [f64; 2], distance: f64) -> Mask<W, N> {
    let (columns, half) = (N as f64, (N - 1) as f64 * 0.5);
    let within = |x: f64| x.clamp(0.0, columns) as u32;
    std::array::from_fn(|i| {
        let left = distance - row * (i as f64 - half);
        let at = left / column + half;
        match column {
            column if column > 0.0 => W::span(within(at.ceil()), N as u32),
            column if column < 0.0 => W::span(0, within(at.floor() + 1.0)),
            _ => W::below(if left <= 0.0 { N as u32 } else { 0 }),
        }
    })
}

/// An entry a cell, of a light with `N` rows and columns.
#[derive(Clone, Debug)]
pub struct Table<W, E, const N: usize> {
    /// Its cells.
    pub cells: Cells,
    entries: Vec<E>,
    word: PhantomData<W>,
}

impl<W, E: Entry<W, N>, const N: usize> Table<W, E, N> {
    /// Computes all entries.
    pub fn new(angles: usize, distances: usize) -> Self {
        let cells = Cells::new(N, angles, distances);
        Self { cells, entries: (0..cells.count()).map(|index| E::of(&cells, index)).collect(), word: PhantomData }
    }

    /// Bytes of all entries.
    pub fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice())
    }

    /// The entry of a cell.
    #[inline(always)]
    pub fn entry(&self, cell: i32) -> &E {
        &self.entries[cell as usize]
    }

    /// The entries of one lane's lines. (Without `map`, which is not inlined everywhere.)
    #[inline(always)]
    pub fn entries(&self, placed: &Placed, lane: usize) -> [&E; 3] {
        let [a, b, c] = &placed.cells;
        [self.entry(a[lane]), self.entry(b[lane]), self.entry(c[lane])]
    }
}
