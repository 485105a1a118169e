//! A court of large slabs in a wide plain; the joints are real grooves.

use umbra4_core::glam::DVec3;

use super::{builder::Builder, random::Random};

/// Half the width of the plain.
const PLAIN: f64 = 60.0;
/// Slabs each way from the middle.
const SLABS: i32 = 5;
const SLAB: f64 = 1.8;
const JOINT: f64 = 0.025;
/// Height of the slabs' upper side is 0; the plain lies below.
const DEPTH: f64 = 0.05;

pub(super) fn build(builder: &mut Builder) {
    builder.color(0.58, 0.575, 0.56);
    let corners = [(-PLAIN, -PLAIN), (-PLAIN, PLAIN), (PLAIN, PLAIN), (PLAIN, -PLAIN)];
    let plain = corners.map(|(x, z)| builder.vertex(DVec3::new(x, -DEPTH, z)));
    builder.quad(plain);
    let mut random = Random(11);
    for row in -SLABS..SLABS {
        for column in -SLABS..SLABS {
            let tint = random.between(0.94, 1.0) as f32;
            builder.color(0.60 * tint, 0.585 * tint, 0.555 * tint);
            let min = DVec3::new(f64::from(column) * SLAB + JOINT, -DEPTH, f64::from(row) * SLAB + JOINT);
            let max = DVec3::new(f64::from(column + 1) * SLAB - JOINT, 0.0, f64::from(row + 1) * SLAB - JOINT);
            builder.cuboid(min, max);
        }
    }
}
