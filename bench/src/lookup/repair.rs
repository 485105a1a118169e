//! The samples that a table leaves open, decided in floats, sixteen at once; and where those cannot tell, in integers.

use umbra4_core::{
    LatticeLight, MaskWord,
    edge_plane::ReceiverTile,
    exact::{self, Wide},
    lanes::{Lanes, TILE},
    occluder::Occluder,
    row_mask::MaskRows,
};

use super::cells::{MARGIN, Placed};

/// Samples that are not decided yet, of a light with `N` columns: their numbers, row by row.
pub struct Open<const N: usize> {
    places: [i32; TILE],
    count: usize,
}

impl<const N: usize> Open<N> {
    /// None.
    pub const NONE: Self = Self { places: [0; TILE], count: 0 };

    /// Row and column of the k-th.
    #[inline(always)]
    fn sample(&self, k: usize) -> (usize, u32) {
        let place = self.places[k % TILE] as usize;
        (place / N, (place % N) as u32)
    }
}

/// A pair whose samples are decided.
pub struct Pair<'a> {
    /// The light.
    pub light: &'a LatticeLight,
    /// The receivers.
    pub receivers: &'a ReceiverTile,
    /// The triangle.
    pub occluder: &'a Occluder,
    /// Its lines.
    pub placed: &'a Placed,
    /// The receiver.
    pub lane: usize,
}

impl Pair<'_> {
    /// Takes over samples that are open: the bits of `words`, the first of which is number `place`. They are decided when sixteen
    /// have come together, or at the end.
    #[inline(always)]
    pub fn leave<L: Lanes, W: MaskWord, const N: usize>(
        &self,
        mut place: usize,
        words: &[u64],
        open: &mut Open<N>,
        mask: &mut MaskRows<W>,
    ) {
        for &word in words {
            let mut left = word;
            while left != 0 {
                open.places[open.count % TILE] = place as i32 + left.trailing_zeros() as i32;
                open.count += 1;
                left &= left - 1;
                if open.count == TILE {
                    self.decide::<L, W, N>(open, mask);
                }
            }
            place += 64;
        }
    }

    /// Decides what is open: writes those samples that are inside all edges.
    #[inline(always)]
    pub fn decide<L: Lanes, W: MaskWord, const N: usize>(&self, open: &mut Open<N>, mask: &mut MaskRows<W>) {
        let Placed { normal: [columns, rows], distance, .. } = self.placed;
        let (lane, wanted) = (self.lane % TILE, (1 << open.count) - 1);
        let (mut inside, mut near, mut first) = (0, 0, 0);
        let float = |ints: L::Ints| L::difference(ints, L::splat_int(0));
        while first < open.count {
            let place = float(L::load_ints(&open.places, first));
            let row = float(place.mul(L::splat(1.0 / N as f32)).floor());
            let column = place.sub(row.mul(L::splat(N as f32)));
            let deep = |k: usize| {
                let at_row = row.mul_add(L::splat(rows[k][lane]), L::splat(-distance[k][lane]));
                column.mul_add(L::splat(columns[k][lane]), at_row)
            };
            let least = deep(0).min(deep(1)).min(deep(2));
            let sure = L::bits(least.ge(L::splat(MARGIN)));
            inside |= sure << first;
            near |= (L::bits(least.ge(L::splat(-MARGIN))) & !sure) << first;
            first += L::WIDTH;
        }
        if near & wanted != 0 {
            inside |= self.settle(near & wanted, open);
        }
        let mut left = inside & wanted;
        while left != 0 {
            let (row, column) = open.sample(left.trailing_zeros() as usize);
            left &= left - 1;
            mask[row] = mask[row].or(W::columns(column, 1));
        }
        open.count = 0;
    }

    /// Which of the samples in `near` are, in integers.
    #[cold]
    #[inline(never)]
    fn settle<const N: usize>(&self, mut near: u32, open: &Open<N>) -> u32 {
        let ([a, b, c], p) = (self.occluder.corners(), self.receivers.point(self.lane));
        let forms = [(a, b), (b, c), (c, a)].map(|(from, to)| exact::edge_form::<Wide>(*self.light, p, from, to));
        let mut inside = 0;
        while near != 0 {
            let place = near.trailing_zeros() as usize % TILE;
            near &= near - 1;
            let (row, column) = open.sample(place);
            inside |= u32::from(forms.iter().all(|form| form.sign_at(row as i32, column as i32) >= 0)) << place;
        }
        inside
    }
}
