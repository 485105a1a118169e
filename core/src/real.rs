//! The float in which points are placed in the light's frame: f64 where the processor has it, f32 where it has not.
//! Placed points are handed on in f32; what is lost before that is part of the error bound.

use glam::IVec3;

use crate::edge_plane::LightGrid;

/// A vector of [`Real`].
pub type Axis<R> = [R; 3];

/// A float for placing points.
pub trait Real: Copy {
    /// Roundoffs of a rounded axis' dot product with an integer difference, relative to the sum over absolute values, and
    /// those of the axis alone. Zero where the type is so long that neither is seen in f32.
    const DOT_ERRORS: f32;
    /// See [`Real::DOT_ERRORS`].
    const AXIS_ERRORS: f32;
    /// Largest relative error of `(e × f)·d`, against the sum over absolute values.
    const SIDE_ERROR: f32;
    /// Columns, rows and minus the height: axes of the light's frame.
    fn axes(grid: &LightGrid) -> [Axis<Self>; 3];
    /// Rounds.
    fn from_f32(x: f32) -> Self;
    /// Rounds.
    fn to_f32(self) -> f32;
    /// `axis·d`
    fn dot(axis: &Axis<Self>, d: IVec3) -> Self;
    /// `e × f`
    fn cross(e: IVec3, f: IVec3) -> Axis<Self>;
    /// As [`Real::dot`], of four vectors, axis-major.
    fn dots(axis: &Axis<Self>, d: &[[i32; 4]; 3]) -> [f32; 4];
    /// `self − b·c`
    fn minus(self, b: Self, c: Self) -> Self;
    /// `self + b·c`
    fn plus(self, b: Self, c: Self) -> Self;
    /// `self / b`
    fn over(self, b: Self) -> Self;
}

macro_rules! real {
    ($float:ty, $dot:literal, $axis:literal, $side:expr, $grid:ident => $axes:expr) => {
        impl Real for $float {
            const DOT_ERRORS: f32 = $dot;
            const AXIS_ERRORS: f32 = $axis;
            const SIDE_ERROR: f32 = $side;

            #[inline(always)]
            fn axes($grid: &LightGrid) -> [Axis<Self>; 3] {
                $axes
            }
            #[inline(always)]
            fn from_f32(x: f32) -> Self {
                x as Self
            }
            #[inline(always)]
            fn to_f32(self) -> f32 {
                self as f32
            }
            #[inline(always)]
            fn dot(axis: &Axis<Self>, d: IVec3) -> Self {
                axis[0] * d.x as Self + axis[1] * d.y as Self + axis[2] * d.z as Self
            }
            #[inline(always)]
            fn cross(e: IVec3, f: IVec3) -> Axis<Self> {
                let e = [e.x as Self, e.y as Self, e.z as Self];
                let f = [f.x as Self, f.y as Self, f.z as Self];
                [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
            }
            #[inline(always)]
            fn dots(axis: &Axis<Self>, d: &[[i32; 4]; 3]) -> [f32; 4] {
                let mut out = [0.0; 4];
                let mut c = 0;
                while c < 4 {
                    let sum = axis[0] * d[0][c] as Self + axis[1] * d[1][c] as Self + axis[2] * d[2][c] as Self;
                    out[c] = sum as f32;
                    c += 1;
                }
                out
            }
            #[inline(always)]
            fn minus(self, b: Self, c: Self) -> Self {
                self - b * c
            }
            #[inline(always)]
            fn plus(self, b: Self, c: Self) -> Self {
                self + b * c
            }
            #[inline(always)]
            fn over(self, b: Self) -> Self {
                self / b
            }
        }
    };
}

#[cfg(not(target_arch = "spirv"))]
real!(f64, 0.0, 0.0, 8.0 * f64::EPSILON as f32, grid => grid.long_axes);
real!(f32, 4.0, 3.0, 9.0 * f32::EPSILON, grid => {
    let frame = &grid.frame;
    [frame.along_u.to_array(), frame.along_v.to_array(), (-frame.normal).to_array()]
});
