//! How many facing triangles stand between receivers and one light sample, (0, 0): the depth from which those of the
//! others follow (`silhouette`).
//!
//! One sample is a point light: its full-coverage test is that of a light with one row and one column, which keeps but the
//! triangles whose box on the light's frame the receiver lies in. Planes pass through the sample, not the receiver, so
//! that they serve all receivers of a group.
//!
//! Where the segment to the sample runs through an edge that two triangles share, one of them has to count. So the
//! sample is thought of as moved by a little along the columns, and by much less along the rows.

use glam::IVec3;

use crate::{
    edge_plane::{LightGrid, ReceiverTile},
    exact::{self, Wide, WideInt},
    jitter::Jitter,
    lanes::Lanes,
    light::LatticeLight,
    occluder::Occluder,
    precision::PrecisionMode,
    punctual::{self, Punctual},
    statistics::Tally,
    view::View,
};

/// The light of one sample: of jittered ones, the first place of the first.
pub const fn corner_light(light: &LatticeLight) -> LatticeLight {
    LatticeLight { rows: 1, columns: 1, jitter: Jitter::NONE, ..*light }
}

/// Lanes of `kept` from which the triangle blocks the sample. It faces the light.
#[inline(always)]
pub(crate) fn blocked<L: Lanes, P: PrecisionMode>(
    grid: &LightGrid,
    view: &View<L::Long>,
    receivers: &ReceiverTile,
    occluder: &Occluder,
    kept: u32,
    fallbacks: &mut Tally,
) -> u32 {
    let offsets = &view.offsets;
    let planes = punctual::planes::<L, P>(Punctual::point(grid.light.origin), offsets, occluder.corners());
    let (mut inside, mut unsure) = (kept, 0);
    let mut k = 0;
    while k < 4 {
        let (positive, near) = planes.signs::<L, P>(offsets, k);
        inside &= positive | near;
        unsure |= near;
        k += 1;
    }
    unsure &= inside;
    if unsure == 0 { inside } else { settle(grid, receivers, occluder.corners(), inside, unsure, fallbacks) }
}

/// Decides the lanes in `unsure`, in integers. Out of line: few come here.
#[inline(never)]
fn settle(
    grid: &LightGrid,
    receivers: &ReceiverTile,
    corners: [IVec3; 3],
    mut inside: u32,
    mut unsure: u32,
    fallbacks: &mut Tally,
) -> u32 {
    while unsure != 0 {
        let lane = unsure.trailing_zeros() as usize;
        unsure &= unsure - 1;
        *fallbacks += 1;
        if !blocks_beside(&grid.light, receivers.point(lane), corners) {
            inside &= !(1 << lane);
        }
    }
    inside
}

/// Whether a facing triangle blocks sample (0, 0), moved by a little along the columns and by much less along the rows.
pub fn blocks_beside(light: &LatticeLight, p: IVec3, [a, b, c]: [IVec3; 3]) -> bool {
    let inside = |from: IVec3, to: IVec3| {
        let form = exact::edge_form::<Wide>(*light, p, from, to);
        let (at, along, across) = (form.at_origin.sign(), form.per_column.sign(), form.per_row.sign());
        let first = if at == 0 { along } else { at };
        (if first == 0 { across } else { first }) > 0
    };
    exact::far_side::<Wide>(p, [a, b, c]) > 0 && inside(a, b) && inside(b, c) && inside(c, a)
}
