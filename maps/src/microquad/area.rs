//! Areas of footprints, added up: visibility without masks. What overlaps counts twice.
//!
//! Seed: Schwarz, Stamminger 2008, sections 1 to 3: quads are split into two triangles, whose signed areas are added; corners are clamped to
//! the light, which is exact for micropatches only.

use crate::{
    arithmetic::{Arithmetic, greater},
    microquad::{
        hull::doubled_area,
        params::MicroquadParams,
        projection::Point,
        rectangles::{clamped, light},
    },
};

/// The area of a quad on the light, or, with its last corner equal to the first, of a triangle; in cells of samples.
#[inline(always)]
pub fn of_quad(a: Arithmetic, params: &MicroquadParams, corners: [Point; 4]) -> f32 {
    let light = light(params);
    let [p, q, r, s] = [
        clamped(corners[0], light),
        clamped(corners[1], light),
        clamped(corners[2], light),
        clamped(corners[3], light),
    ];
    a.mul(a.add(doubled_area(a, p, q, r), doubled_area(a, p, r, s)).abs(), 0.5)
}

/// The area of a rectangle on the light, in cells of samples.
#[inline(always)]
pub fn of_rectangle(a: Arithmetic, params: &MicroquadParams, [low, high]: [Point; 2]) -> f32 {
    let light = light(params);
    let (low, high) = (clamped(low, light), clamped(high, light));
    a.mul(greater(a.sub(high.x, low.x), 0.0), greater(a.sub(high.y, low.y), 0.0))
}
