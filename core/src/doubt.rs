//! Doubtful samples of one pair, decided in integers.

use crate::{
    edge_plane::{Occluder, ReceiverTile},
    exact::{self, GridForm, Wide},
    light::LatticeLight,
    mask_word::MaskWord,
};

/// A pair whose doubtful columns are decided in integers.
pub struct PairIntegers<'a> {
    /// The light.
    pub light: &'a LatticeLight,
    /// Receivers; the pair's is given by its lane.
    pub receivers: &'a ReceiverTile,
    /// The triangle.
    pub occluder: &'a Occluder,
    /// Signs decided, added up over all pairs.
    pub fallbacks: &'a mut u64,
}

/// What floats know of a pair: how far a column lies inside each of its planes.
pub(crate) trait Margins {
    /// Number of planes: the edges', and the triangle's own where it meets the light.
    const PLANES: usize;
    /// How many columns the sample lies inside plane k, for one lane, and how much of that is sure.
    fn margin(&self, k: usize, lane: usize, row: f32, column: f32) -> (f32, f32);
    /// Whether the lane's side of the triangle's plane is the negative one.
    fn flipped(&self, lane: usize) -> bool;
}

/// The integer forms of one pair, each made when it is first needed.
pub(crate) struct PairForms([Option<GridForm<Wide>>; 4]);

impl PairForms {
    pub(crate) const NONE: Self = Self([None; 4]);

    /// Those of the columns in `left` of which the triangle blocks the sample.
    #[inline(always)]
    pub(crate) fn settle<W: MaskWord, M: Margins>(
        &mut self,
        margins: &M,
        lane: usize,
        pair: &mut PairIntegers<'_>,
        row: usize,
        mut left: W,
    ) -> W {
        let mut found = W::EMPTY;
        while left != W::EMPTY {
            let column = left.lowest();
            let bit = W::span(column, column + 1);
            left = left.without(bit);
            if self.blocks(margins, lane, pair, row, column) {
                found = found.or(bit);
            }
        }
        found
    }

    /// Whether the triangle blocks one sample. Only planes that are themselves in doubt there are asked in integers.
    #[inline(always)]
    fn blocks<M: Margins>(
        &mut self,
        margins: &M,
        lane: usize,
        pair: &mut PairIntegers<'_>,
        row: usize,
        column: u32,
    ) -> bool {
        let side = if margins.flipped(lane) { -1 } else { 1 };
        let mut k = 0;
        while k < M::PLANES {
            let (inside, doubt) = margins.margin(k, lane, row as f32, column as f32);
            if inside < -doubt {
                return false;
            }
            if inside <= doubt {
                *pair.fallbacks += 1;
                let sign = self.form(k, lane, pair).sign_at(row as i32, column as i32) * side;
                // Edges are closed; the triangle's own plane blocks strictly.
                if sign < 0 || (k == 3 && sign == 0) {
                    return false;
                }
            }
            k += 1;
        }
        true
    }

    #[inline(always)]
    fn form(&mut self, k: usize, lane: usize, pair: &PairIntegers<'_>) -> GridForm<Wide> {
        let k = k % 4;
        if let Some(form) = self.0[k] {
            return form;
        }
        let ([a, b, c], receiver) = (pair.occluder.corners(), pair.receivers.point(lane));
        let form = match k {
            0 => exact::edge_form(pair.light, receiver, a, b),
            1 => exact::edge_form(pair.light, receiver, b, c),
            2 => exact::edge_form(pair.light, receiver, c, a),
            _ => exact::triangle_form(pair.light, [a, b, c]),
        };
        self.0[k] = Some(form);
        form
    }
}
