//! Stage `snap_vertices`: world → lattice.

use glam::{IVec3, Vec3};

use crate::snap::{SnapParams, snap_coordinate};

/// Rounds point `id`; `None` where it is NaN, infinite or outside the lattice (or there is no such point).
#[inline]
pub fn snap_vertices(id: usize, params: &SnapParams, world: &[Vec3]) -> Option<IVec3> {
    let p = world.get(id)?;
    Some(IVec3::new(snap_coordinate(params, p.x)?, snap_coordinate(params, p.y)?, snap_coordinate(params, p.z)?))
}
