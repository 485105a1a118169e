//! Stage `snap_receivers`: world → lattice, and off the surface that the receiver lies on.

use glam::{IVec3, Vec3};

use crate::{
    snap::SnapParams,
    stage::snap_vertices::snap_vertices,
    surface::{self, Lift, Upwards, by_normal},
};

/// Rounds receiver `id` and lifts it along the dominant axis of its normal. `None` where the point cannot be snapped, or
/// the normal is zero or not finite.
#[inline]
pub fn snap_receivers(id: usize, params: &SnapParams, lift: Lift, world: &[Vec3], normals: &[Vec3]) -> Option<IVec3> {
    let point = snap_vertices(id, params, world)?;
    lifted(point, *normals.get(id)?, lift)
}

/// Lifts a snapped point along the dominant axis of `normal`; `None` where that is zero or not finite.
#[inline]
pub fn lifted(point: IVec3, normal: Vec3, lift: Lift) -> Option<IVec3> {
    let Upwards { axis, sign } = by_normal(normal);
    if sign == 0 { None } else { Some(surface::lift(point, axis, sign * lift.steps())) }
}
