//! Doubtful samples of one pair, decided in integers.

// On a GPU no structure holds references: what goes together is handed on one by one.
#![allow(clippy::too_many_arguments)]

use glam::IVec3;

use crate::{
    edge_plane::ReceiverTile,
    exact::{self, GridForm, Wide, WideInt},
    jitter::{Place, Samples},
    light::LatticeLight,
    mask_word::MaskWord,
    occluder::Occluder,
    statistics::Tally,
};

/// A pair whose doubtful columns are decided in integers.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(target_arch = "spirv", repr(C, align(16)))]
pub struct PairIntegers {
    /// The light; where its samples are jittered, that of all places.
    pub light: LatticeLight,
    /// The receiver.
    pub receiver: IVec3,
    /// The triangle's corners, in the order of its planes.
    pub corners: [IVec3; 3],
    /// Whether what meets an edge that two triangles share meets one of them only ([`GridForm::sign_beside`]), not both.
    pub edges_once: bool,
    /// Signs decided.
    pub fallbacks: Tally,
}

impl PairIntegers {
    /// Of one lane's receiver.
    #[inline(always)]
    pub fn new<S: Samples>(
        light: &LatticeLight,
        receivers: &ReceiverTile,
        occluder: &Occluder,
        lane: usize,
        edges_once: bool,
    ) -> Self {
        let light = if S::JITTERED { light.fine() } else { *light };
        Self { light, receiver: receivers.point(lane), corners: occluder.corners(), edges_once, fallbacks: 0 }
    }
}

/// What floats know of a pair: how far a column lies inside each of its planes.
pub(crate) trait Margins {
    /// How many columns the sample lies inside plane k, for one lane, and how much of that is sure.
    fn margin(&self, k: usize, lane: usize, row: f32, column: f32) -> (f32, f32);
    /// Whether the lane's side of the triangle's plane is the negative one.
    fn flipped(&self, lane: usize) -> bool;
}

/// The integer forms of one pair, each made when it is first needed.
pub(crate) struct PairForms([Option<GridForm<Wide>>; 4]);

impl PairForms {
    pub(crate) const NONE: Self = Self([None; 4]);

    /// Those of the columns in `left` of which the triangle blocks the sample. It has `planes` planes: the edges', and its own
    /// where that meets the light.
    #[inline(always)]
    pub(crate) fn settle<W: MaskWord, S: Samples, M: Margins>(
        &mut self,
        margins: &M,
        samples: &S,
        planes: usize,
        lane: usize,
        pair: &mut PairIntegers,
        row: usize,
        mut left: W,
    ) -> W {
        let mut found = W::EMPTY;
        while left != W::EMPTY {
            let column = left.lowest();
            let bit = W::span(column, column + 1);
            left = left.without(bit);
            if self.blocks(margins, planes, lane, pair, &samples.place(row, column as usize)) {
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
        planes: usize,
        lane: usize,
        pair: &mut PairIntegers,
        place: &Place,
    ) -> bool {
        // No loop: some drivers count rounds (`kernel::resolve`).
        self.holds(0, margins, lane, pair, place)
            && self.holds(1, margins, lane, pair, place)
            && self.holds(2, margins, lane, pair, place)
            && (planes < 4 || self.holds(3, margins, lane, pair, place))
    }

    /// Whether the sample is on the inner side of plane k.
    #[inline(always)]
    fn holds<M: Margins>(
        &mut self,
        k: usize,
        margins: &M,
        lane: usize,
        pair: &mut PairIntegers,
        place: &Place,
    ) -> bool {
        let (inside, doubt) = margins.margin(k, lane, place.row, place.column);
        if inside < -doubt || inside > doubt {
            return inside > 0.0;
        }
        pair.fallbacks += 1;
        let side = if margins.flipped(lane) { -1 } else { 1 };
        self.is_inside(k, side, pair, place)
    }

    /// The same in integers, whatever floats say. `side`: the receiver's side of the triangle's plane, opposite to the sample's.
    #[inline(always)]
    pub(crate) fn is_inside(&mut self, k: usize, side: i32, pair: &PairIntegers, place: &Place) -> bool {
        let form = self.form(k, pair);
        if pair.edges_once && k != 3 {
            return form.sign_beside(place.fine_row, place.fine_column) * side > 0;
        }
        let sign = form.sign_at(place.fine_row, place.fine_column) * side;
        // Edges are closed; the triangle's own plane blocks strictly.
        sign > 0 || (sign == 0 && k != 3)
    }

    /// What corners a, b, c count where the ray to a sample meets the triangle's plane: magnitudes, in words.
    #[inline(always)]
    pub(crate) fn weights(&mut self, pair: &PairIntegers, place: &Place) -> [[u32; 3]; 3] {
        [self.weight(1, pair, place), self.weight(2, pair, place), self.weight(0, pair, place)]
    }

    /// That of the corner opposite to edge k.
    #[inline(always)]
    fn weight(&mut self, k: usize, pair: &PairIntegers, place: &Place) -> [u32; 3] {
        self.form(k, pair).at(place.fine_row, place.fine_column).magnitude_words()
    }

    #[inline(always)]
    fn form(&mut self, k: usize, pair: &PairIntegers) -> GridForm<Wide> {
        let k = k % 4;
        if let Some(form) = self.0[k] {
            return form;
        }
        let ([a, b, c], receiver, light) = (pair.corners, pair.receiver, pair.light);
        let form = match k {
            0 => exact::edge_form(light, receiver, a, b),
            1 => exact::edge_form(light, receiver, b, c),
            2 => exact::edge_form(light, receiver, c, a),
            _ => exact::triangle_form(light, [a, b, c]),
        };
        self.0[k] = Some(form);
        form
    }
}
