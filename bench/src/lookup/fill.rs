//! The ways to fill masks with the triangles before one group of receivers: by core's rows, or by a table.

use std::marker::PhantomData;

use umbra4_core::{
    LatticeLight, MaskWord, PrecisionMode,
    doubt::PairIntegers,
    jitter::Regular,
    lanes::{Lanes, TILE},
    occluder::Occluder,
    outline::Outlines,
    row_mask::{Ends, MaskRows, fill_outline, settle_outline},
};

use super::{
    cells::{Cells, Placed},
    edges::EdgeTile,
    pairs::GroupPairs,
    repair::{Open, Pair},
    table::{Bounds, Mask, Nearest, Table},
};

/// Masks of one group.
pub type GroupMasks<W> = [MaskRows<W>; TILE];

/// A way to fill masks.
pub trait Fill<W: MaskWord> {
    /// ORs all triangles of a group into its masks. Returns how many samples were left open and had to be decided one by
    /// one, where that is counted.
    fn fill<L: Lanes>(&self, light: &LatticeLight, group: &GroupPairs, masks: &mut GroupMasks<W>) -> u64;
}

/// Core's: lines over the rows, sixteen rows at once.
pub struct Rows<P>(PhantomData<P>);

impl<P> Rows<P> {
    /// With the precision of `P`.
    pub const NEW: Self = Self(PhantomData);
}

impl<W: MaskWord, P: PrecisionMode> Fill<W> for Rows<P> {
    #[inline(always)]
    fn fill<L: Lanes>(&self, light: &LatticeLight, group: &GroupPairs, masks: &mut GroupMasks<W>) -> u64 {
        let ends = Ends::<L>::new(light.columns);
        for ((outlines, occluder), &lanes) in group.outlines.iter().zip(&group.occluders).zip(&group.lanes) {
            for lane in lanes_of(lanes) {
                fill_rows::<L, W, P>(light, group, outlines, occluder, lane, &ends, &mut masks[lane]);
            }
        }
        0
    }
}

/// One pair; as core's resolve stage does it.
#[inline(always)]
pub fn fill_rows<L: Lanes, W: MaskWord, P: PrecisionMode>(
    light: &LatticeLight,
    group: &GroupPairs,
    outlines: &Outlines<3>,
    occluder: &Occluder,
    lane: usize,
    ends: &Ends<L>,
    mask: &mut MaskRows<W>,
) {
    let filled = fill_outline::<L, W, P, 3>(outlines, 3, lane, ends, mask);
    if P::CERTIFIED && filled.is_unsure() {
        let mut pair = PairIntegers::new::<Regular>(light, &group.receivers, occluder, lane, false);
        settle_outline(outlines, 3, lane, &mut pair, filled.unsure, mask);
    }
}

/// The lookup alone, without a mask: what finding the cells costs.
pub struct PlaceOnly(pub Cells);

impl<W: MaskWord> Fill<W> for PlaceOnly {
    #[inline(always)]
    fn fill<L: Lanes>(&self, _: &LatticeLight, group: &GroupPairs, _: &mut GroupMasks<W>) -> u64 {
        let mut placed = Placed::EMPTY;
        for edges in &group.edges {
            self.0.place::<L>(edges, &mut placed);
            std::hint::black_box(&placed);
        }
        0
    }
}

/// By the nearest lines of a table: approximate.
pub struct Plain<'a, W, const N: usize>(pub &'a Table<W, Nearest<W, N>, N>);

impl<W: MaskWord, const N: usize> Fill<W> for Plain<'_, W, N> {
    #[inline(always)]
    fn fill<L: Lanes>(&self, _: &LatticeLight, group: &GroupPairs, masks: &mut GroupMasks<W>) -> u64 {
        let mut placed = Placed::EMPTY;
        for (edges, &lanes) in group.edges.iter().zip(&group.lanes) {
            self.0.cells.place::<L>(edges, &mut placed);
            for lane in lanes_of(lanes) {
                let [Nearest(a), Nearest(b), Nearest(c)] = self.0.entries(&placed, lane);
                for row in Steps::<N>::of(edges, lane) {
                    let [a, b, c] = [part(a, row), part(b, row), part(c, row)];
                    let words = &mut masks[lane][row..row + TILE];
                    for k in 0..TILE {
                        words[k] = words[k].or(a[k].and(b[k]).and(c[k]));
                    }
                }
            }
        }
        0
    }
}

/// By the bounds of a table; what they leave open is decided. Exact.
pub struct Repaired<'a, W, const N: usize, const COUNTED: bool>(pub &'a Table<W, Bounds<W, N>, N>);

impl<W: MaskWord, const N: usize, const COUNTED: bool> Fill<W> for Repaired<'_, W, N, COUNTED> {
    #[inline(always)]
    fn fill<L: Lanes>(&self, light: &LatticeLight, group: &GroupPairs, masks: &mut GroupMasks<W>) -> u64 {
        let (mut placed, mut open, mut count) = (Placed::EMPTY, Open::NONE, 0);
        for ((edges, occluder), &lanes) in group.edges.iter().zip(&group.occluders).zip(&group.lanes) {
            self.0.cells.place::<L>(edges, &mut placed);
            for lane in lanes_of(lanes) {
                let [a, b, c] = self.0.entries(&placed, lane);
                let pair = Pair { light, receivers: &group.receivers, occluder, placed: &placed, lane };
                let mask = &mut masks[lane];
                for row in Steps::<N>::of(edges, lane) {
                    let mut left = Left([W::EMPTY; TILE]);
                    let sure = [part(&a.sure, row), part(&b.sure, row), part(&c.sure, row)];
                    let possible = [part(&a.possible, row), part(&b.possible, row), part(&c.possible, row)];
                    let words = &mut mask[row..row + TILE];
                    for k in 0..TILE {
                        words[k] = words[k].or(sure[0][k].and(sure[1][k]).and(sure[2][k]));
                        // What is blocked already need not be decided.
                        left.0[k] = possible[0][k].and(possible[1][k]).and(possible[2][k]).without(words[k]);
                    }
                    let left: &[u64] = bytemuck::cast_slice(&left.0);
                    if COUNTED {
                        count += left.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
                    }
                    pair.leave::<L, W, N>(row * N, left, &mut open, mask);
                }
                pair.decide::<L, W, N>(&mut open, mask);
            }
        }
        count
    }
}

/// Sixteen rows of open samples, to be looked at in larger words.
#[repr(align(64))]
struct Left<W>([W; TILE]);

/// The rows of a triangle in steps of sixteen: the first of each. Only where they would end beyond the light's does a step repeat
/// rows.
struct Steps<const N: usize> {
    next: usize,
    end: usize,
}

impl<const N: usize> Steps<N> {
    #[inline(always)]
    fn of(edges: &EdgeTile, lane: usize) -> Self {
        let first = edges.first[lane] as usize;
        Self { next: first, end: first + edges.count[lane] as usize }
    }
}

impl<const N: usize> Iterator for Steps<N> {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let wanted = self.next;
        if wanted >= self.end {
            return None;
        }
        self.next = wanted + TILE;
        Some(wanted.min(N - TILE))
    }
}

/// Sixteen rows of a mask.
#[inline(always)]
fn part<W, const N: usize>(mask: &Mask<W, N>, row: usize) -> &[W] {
    &mask[row..row + TILE]
}

/// The lanes whose bits are set.
#[inline(always)]
pub fn lanes_of(bits: u32) -> LanesOf {
    LanesOf(bits)
}

/// See [`lanes_of`].
pub struct LanesOf(u32);

impl Iterator for LanesOf {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize % TILE;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}
