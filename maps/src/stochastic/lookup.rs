//! Receivers look planes up (section 6.1): projected from the light's middle, bilinearly, and linearly between the two nearest planes, by inverse depth
//! (the paper: by depth), in which the width of penumbrae is linear. What is interpolated are moments; the receiver's own depth comes in last.

use glam::{IVec3, Vec3};
use umbra4_core::{Facing, kernel::fetch};

use crate::stochastic::{float::larger, gather::Gathered, moments, params::LensParams};

/// By how much a receiver at inverse depth `at` takes the plane: 1 on it, 0 on the planes beside it; 1 beyond the outermost ones.
#[inline(always)]
pub fn plane_weight(params: &LensParams, at: f32) -> f32 {
    let away = at - params.plane;
    let other = if away > 0.0 { params.before } else { params.behind } - params.plane;
    if other == 0.0 { 1.0 } else { larger(1.0 - away / other, 0.0) }
}

/// Where a receiver, light frame, lies in the map, texels. `None` behind the light, and where the map ends.
#[inline(always)]
pub fn place_in_map(placed: Vec3, params: &LensParams) -> Option<[f32; 2]> {
    if placed.z > 0.0 {
        let lens = params.lens();
        let at = lens.texels(glam::Vec2::new(placed.x / placed.z, placed.y / placed.z));
        if lens.holds(at) {
            return Some([at.x, at.y]);
        }
    }
    None
}

/// Adds what the plane says of receiver `point` to what others said.
#[inline(always)]
pub fn looked_up(point: IVec3, so_far: Gathered, params: &LensParams, plane: &[Gathered]) -> Gathered {
    let placed = params.place(point);
    let Some([x, y]) = place_in_map(placed, params) else { return so_far };
    let weight = plane_weight(params, 1.0 / placed.z);
    if weight <= 0.0 {
        return so_far;
    }
    so_far.plus(&bilinear(x, y, params, plane), weight)
}

/// The finest level at a place of the map, texels. Texels that nothing reached have no say.
#[inline(always)]
pub fn bilinear(x: f32, y: f32, params: &LensParams, plane: &[Gathered]) -> Gathered {
    let size = params.size as i32;
    // Truncated, which is floored: half a texel is added to what is not negative, and taken away after.
    let (x, y) = (x + 0.5, y + 0.5);
    let (right, down) = (x as i32, y as i32);
    let (part_x, part_y) = (x - right as f32, y - down as f32);
    let mut sum = Gathered::NONE;
    let mut k = 0;
    while k < 4 {
        let (own_x, own_y) = (k % 2, k / 2);
        let (at_x, at_y) = (right + own_x - 1, down + own_y - 1);
        let weight_x = if own_x == 1 { part_x } else { 1.0 - part_x };
        let weight_y = if own_y == 1 { part_y } else { 1.0 - part_y };
        if at_x >= 0 && at_y >= 0 && at_x < size && at_y < size {
            sum = sum.plus(&fetch(plane, (at_y * size + at_x) as usize, Gathered::NONE), weight_x * weight_y);
        }
        k += 1;
    }
    sum.normalised()
}

/// Whether receiver `point` lies before the light, but not in the map.
#[inline(always)]
pub fn is_outside(point: IVec3, params: &LensParams) -> bool {
    let placed = params.place(point);
    placed.z > 0.0 && place_in_map(placed, params).is_none()
}

/// [`visibility`] of a receiver with a facing: as it is of the exact masks, no light reaches a surface from behind.
#[inline(always)]
pub fn seen(point: IVec3, facing: Facing, sum: &Gathered, params: &LensParams) -> f32 {
    if facing.is_away_from(&params.light(), point) { 0.0 } else { visibility(point, sum, params) }
}

/// The fraction of light that receiver `point` sees, of what all planes said: nothing behind the light, all where no map reaches.
#[inline(always)]
pub fn visibility(point: IVec3, sum: &Gathered, params: &LensParams) -> f32 {
    let placed = params.place(point);
    if placed.z <= 0.0 {
        return 0.0;
    }
    let mean = sum.normalised();
    if mean.weight <= 0.0 {
        return 1.0;
    }
    moments::visibility(params.exponent, &mean.moments, params.z(placed.z), params.least_deviation)
}
