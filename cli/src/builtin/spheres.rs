//! Balls that rest on the ground and on the steps: shadows that touch what casts them.

use umbra4_core::glam::DVec3;

use super::{builder::Builder, steps};

pub(super) fn build(builder: &mut Builder) {
    builder.color(0.78, 0.77, 0.74);
    let top = steps::RISE * steps::STEPS as f64;
    builder.sphere(steps::CENTER + DVec3::Y * (top + 0.52), 0.52, 48);
    builder.color(0.72, 0.52, 0.22);
    builder.sphere(DVec3::new(0.1, 0.30, 4.6), 0.30, 32);
    builder.color(0.20, 0.33, 0.46);
    builder.sphere(DVec3::new(0.95, 0.17, 5.1), 0.17, 24);
    builder.color(0.70, 0.30, 0.22);
    builder.sphere(DVec3::new(3.1, 0.22, 4.3), 0.22, 24);
}
