//! One f32 coordinate → lattice: the snap as kernels do it.
//!
//! Why it is the same everywhere: `2^k` is a normal number for k in −98..=100, so `y = x·2^k` is exact (or too small to
//! matter, where a processor flushes denormals); `t = trunc y` is exact; `y − t` is exact; the last step is a comparison
//! with ½. No result depends on a rounding mode.

use glam::{IVec3, Vec3};

/// Lattice coordinates lie strictly between `-LIMIT` and `LIMIT`: differences fit 31 bits, determinants 94.
pub const LIMIT: i32 = 1 << 29;

/// What a kernel needs to snap f32 points.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SnapParams {
    /// `2^k`, a normal f32.
    pub scale: f32,
}

/// Whether a float is neither NaN nor infinite, told by exponent bits.
#[inline]
pub fn is_finite(x: f32) -> bool {
    const EXPONENT: u32 = 0x7f80_0000;
    x.to_bits() & EXPONENT != EXPONENT
}

/// One coordinate of the f32 snap; `None` where it is NaN, infinite or out of range.
#[inline]
pub fn snap_coordinate(params: &SnapParams, x: f32) -> Option<i32> {
    if !is_finite(x) {
        return None;
    }
    let y = x * params.scale;
    // Above 2^29 − ½ (a bit pattern, so that an overflow to infinity is caught too) the point is out of range.
    if y.to_bits() & 0x7fff_ffff >= ((LIMIT as f32) - 0.5).to_bits() {
        return None;
    }
    let t = y as i32;
    let rest = y - t as f32;
    Some(if rest >= 0.5 {
        t + 1
    } else if rest <= -0.5 {
        t - 1
    } else {
        t
    })
}

/// One point; `None` where a coordinate is NaN, infinite or out of range.
#[inline]
pub fn snap_point(params: &SnapParams, p: Vec3) -> Option<IVec3> {
    Some(IVec3::new(snap_coordinate(params, p.x)?, snap_coordinate(params, p.y)?, snap_coordinate(params, p.z)?))
}
