//! Where a texel lies on the light, as a receiver sees it.
//!
//! Seed: Schwarz, Stamminger 2008, section 1 (back-projection). With inverse depths it is short: a receiver at place `τ` of
//! the map and inverse depth `ι` sees a texel at place `t` and inverse depth `κ > ι`, on the light's plane, at
//! `(t − τ)/(κ − ι)` from the light's centre, but for the scale of each axis.

use umbra4_core::glam::IVec3;

use crate::{arithmetic::Arithmetic, microquad::params::MicroquadParams};

/// A place on the light: columns and rows of samples from sample (0, 0).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Columns.
    pub x: f32,
    /// Rows.
    pub y: f32,
}

/// A receiver on the map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Viewer {
    /// Where it lies on the map, in texels from the centre of texel (0, 0).
    pub x: f32,
    /// See `x`.
    pub y: f32,
    /// Its inverse depth.
    pub inverse: f32,
    /// What a texel's inverse depth has to exceed to occlude anything.
    pub threshold: f32,
}

/// Depth in near distances below which nothing can stand between a receiver and the light: that of the nearest occluder.
const NEAREST: f32 = 1.0;

impl Viewer {
    /// The receiver at a lattice point; one so near that nothing is drawn before it has a threshold above all.
    #[inline(always)]
    pub fn new(a: Arithmetic, params: &MicroquadParams, p: IVec3) -> Self {
        let at = params.frame.place(a, p);
        if at.z > NEAREST {
            let inverse = a.reciprocal(at.z);
            let (x, y) = (a.sub(a.mul(at.x, inverse), 0.5), a.sub(a.mul(at.y, inverse), 0.5));
            Self { x, y, inverse, threshold: a.mul(inverse, params.bias.x) }
        } else {
            Self { x: 0.0, y: 0.0, inverse: 1.0, threshold: 2.0 }
        }
    }

    /// Where a place of the map lies on the light: `x` and `y` in texels from the centre of texel (0, 0), `inverse` above the
    /// threshold.
    #[inline(always)]
    pub fn project(&self, a: Arithmetic, params: &MicroquadParams, x: f32, y: f32, inverse: f32) -> Point {
        let scale = a.reciprocal(a.sub(inverse, self.inverse));
        let (along, across) = (a.mul(params.samples.z, scale), a.mul(params.samples.w, scale));
        Point {
            x: a.add(a.mul(a.sub(x, self.x), along), params.samples.x),
            y: a.add(a.mul(a.sub(y, self.y), across), params.samples.y),
        }
    }
}
