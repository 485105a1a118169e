//! A flight of round steps.

use umbra4_core::glam::DVec3;

use super::builder::Builder;

pub(super) const CENTER: DVec3 = DVec3::new(1.3, 0.0, 0.8);
pub(super) const STEPS: usize = 4;
pub(super) const RISE: f64 = 0.16;
const TREAD: f64 = 0.26;
const TOP: f64 = 0.62;

pub(super) fn build(builder: &mut Builder) {
    builder.color(0.66, 0.64, 0.60);
    let mut profile = Vec::new();
    for step in 0..STEPS {
        let radius = TOP + TREAD * (STEPS - 1 - step) as f64;
        profile.push((radius, RISE * step as f64));
        profile.push((radius, RISE * (step + 1) as f64));
    }
    profile.push((0.0, RISE * STEPS as f64));
    builder.revolve(CENTER, &profile, 128, |_, _| 1.0);
}
