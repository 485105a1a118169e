//! A grove: trees and bushes whose leaves are cut out of cards by a texture, before a pale wall, on pale ground.

use std::f64::consts::TAU;

use umbra4_core::glam::{DQuat, DVec3};

use super::{
    Builder, BuiltinScene, View,
    leaf_texture::{self, SPRIGS},
    random::Random,
    tree::{BARK, Branch},
    window,
};

/// Half the width of the plain.
const PLAIN: f64 = 60.0;
/// Cards at every twig.
const CARDS: u32 = 2;

pub(super) fn scene() -> BuiltinScene {
    let mut builder = Builder::default();
    let mut random = Random(23);
    ground(&mut builder);
    let mut twigs = Vec::new();
    builder.color(BARK[0], BARK[1], BARK[2]);
    for (x, z, length, radius) in [(-2.3, -1.7, 1.25, 0.15), (2.0, -2.2, 1.05, 0.12), (0.5, 1.0, 0.62, 0.06)] {
        let trunk = Branch {
            from: DVec3::new(x, -0.05, z),
            direction: DVec3::new(random.between(-0.1, 0.1), 1.0, random.between(-0.1, 0.1)),
            length,
            radius,
        };
        trunk.grow(&mut builder, &mut random, 5, &mut twigs);
    }
    builder.part("leaves", leaf_texture::surface(), |builder| {
        for (tip, direction) in twigs {
            for _ in 0..CARDS {
                let along = (direction + random.direction() * 0.9 + DVec3::Y * 0.15).normalize_or(DVec3::Y);
                let size = random.between(0.22, 0.40);
                let from = tip - direction * random.between(0.0, 0.16);
                leaf(builder, &mut random, from, along, size, 0);
            }
        }
        for (x, z, count) in
            [(-3.6, 0.6, 150), (3.4, 0.1, 170), (-1.3, 2.4, 70), (2.3, 2.3, 60), (-0.4, -3.7, 160), (4.1, -3.6, 140)]
        {
            bush(builder, &mut random, DVec3::new(x, 0.0, z), count);
        }
    });
    let view = View {
        eye: DVec3::new(3.0, 2.6, 8.4),
        target: DVec3::new(-0.1, 1.4, -0.8),
        fov: 42.0,
        focus: DVec3::new(0.0, 1.0, 0.0),
        fade: 17.0,
    };
    let light = window(DVec3::new(-7.5, 12.5, 7.0), DVec3::new(0.0, 0.8, -0.6), 0.9);
    BuiltinScene::of(builder, light, view)
}

/// The plain, and a low wall at the back.
fn ground(builder: &mut Builder) {
    builder.color(0.62, 0.58, 0.50);
    let corners = [(-PLAIN, -PLAIN), (-PLAIN, PLAIN), (PLAIN, PLAIN), (PLAIN, -PLAIN)];
    let plain = corners.map(|(x, z)| builder.vertex(DVec3::new(x, 0.0, z)));
    builder.quad(plain);
    builder.color(0.68, 0.65, 0.60);
    builder.cuboid(DVec3::new(-5.6, 0.0, -4.6), DVec3::new(5.6, 3.0, -4.3));
    builder.color(0.60, 0.57, 0.52);
    builder.cuboid(DVec3::new(-5.75, 3.0, -4.7), DVec3::new(5.75, 3.15, -4.2));
}

/// Broad leaves that stand out of one root.
fn bush(builder: &mut Builder, random: &mut Random, root: DVec3, count: u32) {
    for _ in 0..count {
        let mut out = random.direction();
        out.y = out.y.abs() * 0.9 + 0.35;
        let along = out.normalize_or(DVec3::Y);
        let from = root + along * random.between(0.02, 0.55);
        let (aside, size) = (random.direction() * 0.4, random.between(0.3, 0.45));
        leaf(builder, random, from, (along + aside).normalize_or(DVec3::Y), size, 1);
    }
}

/// A square card with a sprig on it, whose stem begins at `from`.
fn leaf(builder: &mut Builder, random: &mut Random, from: DVec3, along: DVec3, size: f64, sprig: u32) {
    let (hue, light) = (random.between(0.0, 1.0) as f32, random.between(0.8, 1.2) as f32);
    let green = if sprig == 0 { [0.16 + 0.14 * hue, 0.31 + 0.06 * hue, 0.07] } else { [0.10 + 0.07 * hue, 0.27, 0.10] };
    builder.color(green[0] * light, green[1] * light, green[2] * light);
    let across = DQuat::from_axis_angle(along, random.between(0.0, TAU)) * along.any_orthonormal_vector();
    let left = sprig as f32 / SPRIGS as f32;
    let right = left + 1.0 / SPRIGS as f32;
    let mut corner = |side: f64, up: f64, coordinates| {
        // Nothing grows into the ground.
        let at = from + across * (side * size) + along * (up * size);
        builder.textured_vertex(at.max(DVec3::new(f64::MIN, 0.004, f64::MIN)), coordinates)
    };
    let corners = [
        corner(-0.5, 0.0, [left, 1.0]),
        corner(0.5, 0.0, [right, 1.0]),
        corner(0.5, 1.0, [right, 0.0]),
        corner(-0.5, 1.0, [left, 0.0]),
    ];
    builder.quad(corners);
}
