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
    let (corner, corners) = (Punctual::at_sample(grid.light.origin), occluder.corners());
    punctual::blocked::<L, P>(corner, &view.offsets, receivers, occluder, kept, fallbacks, |p| {
        blocks_beside(&grid.light, p, corners)
    })
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
