//! A tree and bushes: branches that fork, with every leaf a folded blade.

use umbra4_core::glam::{DQuat, DVec3};

use super::{builder::Builder, random::Random};

pub(super) const BARK: [f32; 3] = [0.22, 0.15, 0.10];

pub(super) fn build(builder: &mut Builder) {
    let mut random = Random(5);
    let mut twigs = Vec::new();
    let trunk = Branch {
        from: DVec3::new(3.6, -0.05, -3.9),
        direction: DVec3::new(0.05, 1.0, 0.06),
        length: 1.55,
        radius: 0.17,
    };
    builder.color(BARK[0], BARK[1], BARK[2]);
    trunk.grow(builder, &mut random, 6, &mut twigs);
    for (tip, direction) in twigs {
        for _ in 0..17 {
            let at = tip + random.direction() * random.between(0.05, 0.34) - direction * random.between(0.0, 0.25);
            leaf(builder, &mut random, at, 0.125);
        }
    }
    for (center, radius, count) in [
        (DVec3::new(-1.15, 0.0, 4.1), 0.62, 2200),
        (DVec3::new(-2.15, 0.0, 4.5), 0.40, 1100),
        (DVec3::new(5.6, 0.0, -1.6), 0.55, 1700),
    ] {
        bush(builder, &mut random, center, radius, count);
    }
}

/// A branch, or a trunk.
pub(super) struct Branch {
    pub(super) from: DVec3,
    pub(super) direction: DVec3,
    pub(super) length: f64,
    pub(super) radius: f64,
}

impl Branch {
    /// Builds it with all that forks off it, `depth` times; adds the tips and directions of twigs.
    pub(super) fn grow(self, builder: &mut Builder, random: &mut Random, depth: u32, twigs: &mut Vec<(DVec3, DVec3)>) {
        let mut at = self.from;
        let mut direction = self.direction.normalize();
        let thin = self.radius * 0.68;
        for piece in 0..3 {
            // Branches bend a little, and upwards.
            direction = (direction + random.direction() * 0.13 + DVec3::Y * 0.06).normalize();
            let to = at + direction * (self.length / 3.0);
            let radius = |t: i32| self.radius + (thin - self.radius) * f64::from(t) / 3.0;
            builder.tube(at, to, (radius(piece), radius(piece + 1)), [4, 4, 5, 6, 12, 12, 12][depth as usize % 7]);
            at = to;
        }
        if depth <= 1 {
            twigs.push((at, direction));
        }
        if depth == 0 {
            return;
        }
        let forks = if depth > 4 { 4 } else { 3 };
        let (u, v) = direction.any_orthonormal_pair();
        let turn = random.between(0.0, std::f64::consts::TAU);
        for fork in 0..forks {
            let angle = turn + f64::from(fork) / f64::from(forks) * std::f64::consts::TAU + random.between(-0.3, 0.3);
            let spread = random.between(0.42, 0.78);
            let side = u * angle.cos() + v * angle.sin();
            let next = Branch {
                from: at,
                direction: direction * spread.cos() + side * spread.sin(),
                length: self.length * random.between(0.62, 0.80),
                radius: thin * random.between(0.62, 0.78),
            };
            next.grow(builder, random, depth - 1, twigs);
        }
    }
}

fn bush(builder: &mut Builder, random: &mut Random, center: DVec3, radius: f64, count: usize) {
    for _ in 0..count {
        let mut out = random.direction();
        out.y = out.y.abs();
        let reach = radius * random.between(0.55, 1.0);
        leaf(builder, random, center + DVec3::new(out.x, out.y * 1.05 + 0.06, out.z) * reach, 0.11);
    }
    builder.color(BARK[0], BARK[1], BARK[2]);
    for _ in 0..26 {
        let mut out = random.direction();
        out.y = out.y.abs() + 0.2;
        builder.tube(center, center + out * radius * 0.75, (0.014, 0.005), 5);
    }
}

/// Two triangles, folded along the midrib.
fn leaf(builder: &mut Builder, random: &mut Random, at: DVec3, size: f64) {
    let (hue, light) = (random.between(0.0, 1.0) as f32, random.between(0.8, 1.15) as f32);
    builder.color((0.13 + 0.13 * hue) * light, (0.27 + 0.05 * hue) * light, 0.07 * light);
    let turn = DQuat::from_axis_angle(random.direction(), random.between(0.0, 2.2));
    let size = size * random.between(0.75, 1.2);
    let point = |x: f64, y: f64, z: f64| at + turn * (DVec3::new(x, y, z) * size);
    let [base, left, tip, right] =
        [point(0.0, 0.0, 0.0), point(-0.32, 0.12, 0.45), point(0.0, 0.0, 1.0), point(0.32, 0.12, 0.45)]
            .map(|p| builder.vertex(p.max(DVec3::new(f64::MIN, 0.004, f64::MIN))));
    builder.triangle([base, tip, left]);
    builder.triangle([base, right, tip]);
}
