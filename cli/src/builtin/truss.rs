//! An arch made of a space truss: three chords, braced.

use std::f64::consts::{PI, TAU};

use umbra4_core::glam::DVec3;

use super::builder::Builder;

const BAYS: usize = 30;
const SPAN: f64 = 2.7;
const RISE: f64 = 4.3;
const DEPTH: f64 = 0.34;

pub(super) fn build(builder: &mut Builder) {
    builder.color(0.50, 0.16, 0.10);
    let chords: Vec<[DVec3; 3]> = (0..=BAYS).map(|bay| section(bay as f64 / BAYS as f64)).collect();
    for (bay, pair) in chords.windows(2).enumerate() {
        let [here, next] = [pair[0], pair[1]];
        for k in 0..3 {
            let l = (k + 1) % 3;
            builder.tube(here[k], next[k], (0.045, 0.045), 10);
            builder.tube(here[k], here[l], (0.022, 0.022), 8);
            // Diagonals turn about, as they do in a real one.
            let (from, to) = if (bay + k) % 2 == 0 { (here[k], next[l]) } else { (here[l], next[k]) };
            builder.tube(from, to, (0.022, 0.022), 8);
        }
    }
    builder.color(0.40, 0.39, 0.37);
    for end in [0.0, 1.0] {
        let foot = center(end);
        builder.cuboid(foot + DVec3::new(-0.5, -0.05, -0.5), foot + DVec3::new(0.5, 0.16, 0.5));
    }
}

/// The arch's axis, from one foot to the other; it stands across the court, turned a little.
fn center(t: f64) -> DVec3 {
    let angle = PI * t;
    let (across, up) = (-SPAN * angle.cos(), RISE * angle.sin());
    DVec3::new(1.3 + across * 0.8, up, 0.8 + across * 0.6)
}

/// The three chords' points at `t` in 0..=1.
fn section(t: f64) -> [DVec3; 3] {
    let along = (center((t + 1e-3).min(1.0)) - center((t - 1e-3).max(0.0))).normalize();
    let side = along.cross(DVec3::new(-0.6, 0.0, 0.8)).normalize();
    let out = side.cross(along);
    // Slimmer at the feet.
    let depth = DEPTH * (0.45 + 0.55 * (PI * t).sin());
    std::array::from_fn(|k| {
        let angle = k as f64 / 3.0 * TAU;
        center(t) + (side * angle.cos() + out * angle.sin()) * depth
    })
}
