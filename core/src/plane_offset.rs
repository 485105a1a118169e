//! The offset of a triangle's supporting plane towards the light: what lies before the triangle, but nearer to its plane than the
//! offset, is taken for what lies behind it.
//!
//! Source: Sintorn, Eisemann and Assarsson 2008, section 3.3, who keep it against what floats may lose where front and back faces
//! touch. Nothing is lost here, so nobody needs it: receivers on the caster itself fall into its own shadow, unless only triangles that
//! face away cast. It is there to be compared, and for casters that shall darken what they touch.
//!
//! The plane is moved along the axis of its normal's largest component, by whole lattice units, so that the test stays one of integers:
//! a receiver is behind it iff `n·(p − a − d·e) < 0`. Triangles whose plane meets the light have no side towards it: they are not offset.

use glam::IVec3;

use crate::{
    edge_plane::{LightGrid, ReceiverTile, cross_magnitudes, float},
    exact::{self, Wide},
    frame::LightFrame,
    lanes::Lanes,
    light::LatticeLight,
    occluder::Occluder,
    proj4::{Keys, NOTHING, TOUCHING, UNBOUNDED},
    surface::{dominant_axis, lift},
    view::SPARE,
};

/// Largest offset, lattice units.
pub const MOST_OFFSET: u32 = 1 << 26;

/// The receivers among `kept` that lie before the triangle, or in its plane, and behind the plane that is moved by `offset`.
#[inline(always)]
pub(crate) fn between_planes(receivers: &ReceiverTile, occluder: &Occluder, offset: u32, kept: u32) -> u32 {
    if offset == 0 || occluder.is_mixed() {
        return 0;
    }
    let (mut found, mut left) = (0, kept);
    while left != 0 {
        let lane = left.trailing_zeros();
        left &= left - 1;
        let is_between = lies_between(receivers.point(lane as usize), occluder.corners(), offset);
        found |= (is_between as u32) << lane;
    }
    found
}

#[cfg_attr(target_arch = "spirv", inline(never))]
fn lies_between(p: IVec3, [a, b, c]: [IVec3; 3], offset: u32) -> bool {
    let normal = exact::cross::<Wide>(b - a, c - a);
    let (axis, sign) = dominant_axis(&normal.components());
    let moved = lift(p, axis, -sign * offset as i32);
    exact::far_side::<Wide>(p, [a, b, c]) <= 0 && exact::far_side::<Wide>(moved, [a, b, c]) > 0
}

/// Keys of a triangle whose plane is moved, from its own.
///
/// The receivers that it then blocks are `p = q + s·(L − q)`, q on the triangle and L a sample, with s below
/// `s₁ = d·|n_k| / min n·(L − a)`. In the light's frame such a p has the height `(1 − s)·w`, and its slopes exceed those of q by at most
/// `s/(1 − s)` of the grid's extent over w.
#[inline(always)]
pub(crate) fn moved_keys(grid: &LightGrid, occluder: &Occluder, keys: Keys, offset: u32) -> Keys {
    if offset == 0 || occluder.is_mixed() || keys[4] == NOTHING[4] {
        return keys;
    }
    let [a, b, c] = occluder.corners();
    let (e, f) = (float(b - a), float(c - a));
    let magnitudes = cross_magnitudes(e, f);
    let (light, error) = (&grid.light, 16.0 * f32::EPSILON);
    // The samples' plane is at its nearest at a corner of the grid.
    let normal = e.cross(f);
    let at = normal.dot(float(light.origin - a));
    let (across, along) = (normal.dot(far_column(light)), normal.dot(far_row(light)));
    let nearest = at + Lanes::min(across, 0.0) + Lanes::min(along, 0.0);
    let reach = float(light.origin - a).abs() + far_column(light).abs() + far_row(light).abs();
    let clear = nearest - error * SPARE * magnitudes.dot(reach);
    let moved = offset as f32 * magnitudes.max_element() * (1.0 + error);
    let lowest = -keys[4];
    if clear <= 2.0 * moved || lowest < TOUCHING {
        return [UNBOUNDED; 5];
    }
    let s = moved / clear * (1.0 + error);
    let aside = s / (1.0 - s) * (1.0 + error) / lowest;
    let LightFrame { last_column, last_row, .. } = grid.frame;
    let beside = |key: f32, extent: f32| key + aside * extent + Lanes::abs(key) * error;
    [
        beside(keys[0], last_column),
        beside(keys[1], last_column),
        beside(keys[2], last_row),
        beside(keys[3], last_row),
        -lowest * (1.0 - s) * (1.0 - error),
    ]
}

#[inline(always)]
fn far_column(light: &LatticeLight) -> glam::Vec3 {
    float(light.step_u) * light.last_column()
}

#[inline(always)]
fn far_row(light: &LatticeLight) -> glam::Vec3 {
    float(light.step_v) * light.last_row()
}
