//! What triangles of special casters cover: of each pair that the hierarchy keeps, the samples that the triangle blocks, in a mask of
//! its own. What is then done with them is the business of [`crate::stage::resolve_cutout`] and [`crate::stage::add_tint`].

// On a GPU no structure holds references: what goes together is handed on one by one.
#![allow(clippy::too_many_arguments)]

use crate::{
    doubt::{PairForms, PairIntegers},
    edge_plane::LightGrid,
    jitter::Samples,
    lanes::{Lanes, TILE},
    mask_word::MaskWord,
    occluder::Occluder,
    plane_offset::between_planes,
    precision::Exact,
    row_mask::MASK_ROWS,
    stage::resolve::{Group, Meeting},
};

/// Makes `cover` a group of the same receivers, with nothing covered. Its masks are empty already.
#[inline(always)]
pub(crate) fn start<W: MaskWord>(cover: &mut Group<W>, group: &Group<W>, edges_once: bool) {
    cover.receivers = group.receivers;
    cover.edges_once = edges_once;
    (cover.touched, cover.shadowed) = (0, 0);
}

/// Adds what one triangle covers to the masks of `cover`. Returns the lanes of which it covers anything.
#[inline(always)]
pub(crate) fn cover<L: Lanes, W: MaskWord, S: Samples>(
    grid: &LightGrid,
    samples: &S,
    meeting: &mut Meeting<L::Long>,
    occluder: &Occluder,
    offset: u32,
    kept: u32,
    cover: &mut Group<W>,
) -> u32 {
    cover.shadowed = 0;
    meeting.meet::<L, W, Exact, S>(grid, samples, occluder, kept, cover);
    let mut near = between_planes(&cover.receivers, occluder, offset, kept);
    while near != 0 {
        let lane = near.trailing_zeros() as usize % TILE;
        near &= near - 1;
        let mut pair = PairIntegers::new::<S>(&grid.light, &cover.receivers, occluder, lane, cover.edges_once);
        cover_pyramid::<W, S>(samples, grid.light.columns, grid.light.rows, &mut pair, &mut cover.masks[lane]);
        cover.counts.fallbacks += pair.fallbacks;
        cover.shadowed |= 1 << lane;
    }
    cover.shadowed & kept
}

/// The samples from which the receiver lies inside the pyramid through the triangle, one by one, in integers.
#[inline(never)]
fn cover_pyramid<W: MaskWord, S: Samples>(
    samples: &S,
    columns: u32,
    rows: u32,
    pair: &mut PairIntegers,
    mask: &mut [W; MASK_ROWS],
) {
    let mut forms = PairForms::NONE;
    let mut row = 0;
    while row < rows as usize && row < MASK_ROWS {
        let mut column = 0;
        while column < columns {
            let place = samples.place(row, column as usize);
            pair.fallbacks += 1;
            if forms.is_inside(0, 1, pair, &place)
                && forms.is_inside(1, 1, pair, &place)
                && forms.is_inside(2, 1, pair, &place)
            {
                mask[row] = mask[row].or(W::span(column, column + 1));
            }
            column += 1;
        }
        row += 1;
    }
}
