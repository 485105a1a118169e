//! Stage `snap_vertices`: world → lattice.

use glam::{IVec3, Vec3};

use crate::snap::{SnapParams, snap_point};

/// Rounds point `id`; `None` where it is NaN, infinite or outside the lattice (or there is no such point).
#[inline]
pub fn snap_vertices(id: usize, params: &SnapParams, world: &[Vec3]) -> Option<IVec3> {
    snap_point(params, *world.get(id)?)
}
