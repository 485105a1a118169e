//! The circle of confusion (eq. 6): the half-extents of the penumbra that a sample casts on a plane, in texels of the map.
//!
//! With tangents for texels, m(d_r) is `scale/d_r`, the light's half-extents are 1, and `m·|d_r − d_k|/d_k = scale·|1/d_k − 1/d_r|`: linear
//! in inverse depth. What a sample keeps is the larger of its two half-extents; the light's shape gives the other.

use glam::Vec2;

use crate::stochastic::{
    float::{larger, within},
    params::LensParams,
};

/// The larger half-extent, texels, of a sample at inverse depth `sample` on a plane at inverse depth `plane`. `scale` is
/// [`LensParams::widest_scale`].
#[inline(always)]
pub fn radius(scale: f32, sample: f32, plane: f32) -> f32 {
    scale * (sample - plane).abs()
}

/// Both half-extents of a sample with the larger one `radius`, finest texels; on a level whose texels are `texel` wide they are at least the
/// least radius of that level.
#[inline(always)]
pub fn half_extents(params: &LensParams, radius: f32, texel: f32) -> Vec2 {
    let least = params.least_radius * texel;
    Vec2::new(larger(radius * params.aspect[0], least), larger(radius * params.aspect[1], least))
}

/// Whether a place `x`, `y` away from its middle lies in a sample's footprint.
#[inline(always)]
pub fn covers(rectangular: bool, half: Vec2, x: f32, y: f32) -> bool {
    if rectangular {
        x.abs() < half.x && y.abs() < half.y
    } else {
        let (x, y) = (x * half.y, y * half.x);
        let limit = half.x * half.y;
        x * x + y * y < limit * limit
    }
}

/// The share of a texel `texel` wide, whose middle lies `x`, `y` away from that of a footprint, that the footprint covers. Of an ellipse, as in the
/// paper, all or nothing, by the texel's middle. Of a rectangle, its area: otherwise coarse levels would make penumbrae wider or narrower by a coarse texel.
#[inline(always)]
pub fn coverage(rectangular: bool, half: Vec2, x: f32, y: f32, texel: f32) -> f32 {
    if rectangular {
        let (x, y) = ((half.x - x.abs()) / texel + 0.5, (half.y - y.abs()) / texel + 0.5);
        within(x, 0.0, 1.0) * within(y, 0.0, 1.0)
    } else if covers(false, half, x, y) {
        1.0
    } else {
        0.0
    }
}
