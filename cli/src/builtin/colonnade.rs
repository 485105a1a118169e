//! Fluted columns on plinths under an entablature.

use umbra4_core::glam::DVec3;

use super::builder::Builder;

const COLUMNS: usize = 5;
const SPACING: f64 = 1.9;
const PLINTH: f64 = 0.22;
const SHAFT: f64 = 3.4;
const RADIUS: f64 = 0.36;
const FLUTES: f64 = 20.0;
/// Sides of a shaft: eight a flute.
const SIDES: usize = 160;
const RINGS: usize = 18;

pub(super) fn build(builder: &mut Builder) {
    builder.color(0.74, 0.70, 0.63);
    let foot = |i: usize| DVec3::new(-3.7, 0.0, -7.2 + SPACING * i as f64);
    (0..COLUMNS).for_each(|i| column(builder, foot(i)));
    entablature(builder, foot(0), foot(COLUMNS - 1));
}

fn column(builder: &mut Builder, foot: DVec3) {
    slab(builder, foot, 0.54, 0.0, PLINTH);
    let round = |_: f64, _: f64| 1.0;
    let base = foot + DVec3::Y * PLINTH;
    // Two tori with a hollow between them.
    let mut profile = vec![(0.0, 0.0)];
    profile.extend((0..=8).map(|i| bulge(0.46, 0.06, 0.06, i, 8)));
    profile.extend((0..=8).map(|i| bulge(0.40, 0.045, 0.165, i, 8)));
    builder.revolve(base, &profile, 64, round);

    let shaft: Vec<(f64, f64)> = (0..=RINGS)
        .map(|ring| {
            let t = ring as f64 / RINGS as f64;
            // A slight swelling: columns with straight sides look hollow.
            (RADIUS * (1.0 - 0.16 * t.powf(1.6)), SHAFT * t)
        })
        .collect();
    builder.revolve(base + DVec3::Y * 0.2, &shaft, SIDES, |angle, height| {
        // Flutes die away at both ends.
        let end = (height.min(SHAFT - height) / 0.16).clamp(0.0, 1.0);
        1.0 - 0.085 * end * (angle * FLUTES * 0.5).sin().abs()
    });

    let top = base + DVec3::Y * (0.2 + SHAFT);
    let echinus = [
        (0.302, -0.02),
        (0.33, 0.0),
        (0.33, 0.03),
        (0.31, 0.05),
        (0.36, 0.09),
        (0.42, 0.15),
        (0.45, 0.2),
        (0.45, 0.24),
        (0.0, 0.24),
    ];
    builder.revolve(top, &echinus, 64, round);
    slab(builder, top, 0.52, 0.24, 0.38);
}

/// A half circle that bulges outwards: step `i` of `steps`.
fn bulge(radius: f64, thickness: f64, height: f64, i: usize, steps: usize) -> (f64, f64) {
    let angle = (i as f64 / steps as f64 - 0.5) * std::f64::consts::PI;
    (radius + thickness * angle.cos(), height + thickness * angle.sin())
}

fn slab(builder: &mut Builder, center: DVec3, half: f64, bottom: f64, top: f64) {
    builder.cuboid(center + DVec3::new(-half, bottom, -half), center + DVec3::new(half, top, half));
}

fn entablature(builder: &mut Builder, first: DVec3, last: DVec3) {
    let bottom = PLINTH + 0.2 + SHAFT + 0.38;
    let mut course = |half: f64, low: f64, high: f64| {
        let min = first + DVec3::new(-half, bottom + low, -half - 0.1);
        builder.cuboid(min, last + DVec3::new(half, bottom + high, half + 0.1));
    };
    course(0.40, 0.0, 0.34);
    course(0.44, 0.34, 0.40);
    course(0.38, 0.40, 0.66);
    course(0.58, 0.74, 0.86);
    course(0.64, 0.86, 0.94);
    // Dentils under the cornice.
    let length = last.z - first.z + 0.9;
    let count = (length / 0.17) as usize;
    for i in 0..count {
        let z = first.z - 0.45 + length * (i as f64 + 0.5) / count as f64;
        let (low, high) = (bottom + 0.66, bottom + 0.74);
        builder.cuboid(DVec3::new(first.x - 0.5, low, z - 0.045), DVec3::new(first.x + 0.5, high, z + 0.045));
    }
}
