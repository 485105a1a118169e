//! A grove: trees with tens of thousands of leaves each, so that light comes through in specks.
//!
//! Leaves are cards of one or two triangles, turned at random. Units are metres.

use std::f64::consts::TAU;

use umbra4::model::Model;
use umbra4_core::glam::{DQuat, DVec3};
use umbra4_tests::rng::Rng;

use super::solids::{Solids, between, direction};

const SEED: u64 = 1;
/// Trees along each edge of the grove.
const TREES: usize = 4;
/// Between neighbouring trees.
const SPACING: f64 = 4.2;
/// How often a branch forks between trunk and twig.
const FORKS: u32 = 5;
/// On every twig, and half as many on the branches that bear twigs.
const LEAVES: usize = 60;
/// Length of a leaf.
const LEAF: f64 = 0.13;

/// The trees, without the ground.
pub(super) fn model() -> Model {
    let (mut solids, mut rng) = (Solids::default(), Rng::named(SEED, "foliage"));
    for tree in 0..TREES * TREES {
        let place = |index: usize| (index as f64 - 0.5 * (TREES - 1) as f64) * SPACING;
        let jitter = DVec3::new(rng.real(0.9), 0.0, rng.real(0.9));
        let trunk = Branch {
            from: DVec3::new(place(tree % TREES), 0.0, place(tree / TREES)) + jitter,
            direction: DVec3::new(rng.real(0.08), 1.0, rng.real(0.08)),
            length: between(&mut rng, 1.7, 2.3),
            radius: 0.14,
        };
        trunk.grow(&mut solids, &mut rng, FORKS);
    }
    solids.finish()
}

struct Branch {
    from: DVec3,
    direction: DVec3,
    length: f64,
    radius: f64,
}

impl Branch {
    fn grow(self, solids: &mut Solids, rng: &mut Rng, forks: u32) {
        let direction_here = self.direction.normalize();
        // Branches bend a little, and upwards.
        let bent = (direction_here + direction(rng) * 0.2 + DVec3::Y * 0.1).normalize();
        let middle = self.from + direction_here * (0.5 * self.length);
        let tip = middle + bent * (0.5 * self.length);
        solids.strand(&[self.from, middle, tip], [self.radius, 0.66 * self.radius]);
        let leaves = [LEAVES, LEAVES / 2].get(forks as usize).copied().unwrap_or(0);
        for _ in 0..leaves {
            let on_twig = self.from + (tip - self.from) * between(rng, 0.2, 1.1);
            let beside = direction(rng) * between(rng, 0.02, 0.3);
            leaf(solids, rng, on_twig + beside);
        }
        if forks == 0 {
            return;
        }
        let (u, v) = bent.any_orthonormal_pair();
        let turn = between(rng, 0.0, TAU);
        for fork in 0..3 {
            let angle = turn + f64::from(fork) / 3.0 * TAU + rng.real(0.3);
            let spread = between(rng, 0.4, 0.8);
            let next = Self {
                from: tip,
                direction: bent * spread.cos() + (u * angle.cos() + v * angle.sin()) * spread.sin(),
                length: self.length * between(rng, 0.62, 0.78),
                radius: self.radius * 0.66 * between(rng, 0.65, 0.8),
            };
            next.grow(solids, rng, forks - 1);
        }
    }
}

/// A narrow leaf of one triangle, or a broad one of two, folded along its middle.
fn leaf(solids: &mut Solids, rng: &mut Rng, at: DVec3) {
    let turn = DQuat::from_axis_angle(direction(rng), between(rng, 0.0, TAU));
    let size = LEAF * between(rng, 0.75, 1.25);
    let point = |x: f64, y: f64, z: f64| at + turn * (DVec3::new(x, y, z) * size);
    let (stalk, tip) = (point(0.0, 0.0, 0.0), point(0.0, 0.0, 1.0));
    if rng.one_in(2) {
        solids.triangle([point(-0.2, 0.0, 0.1), point(0.2, 0.0, 0.1), tip]);
    } else {
        solids.triangle([stalk, tip, point(-0.32, 0.12, 0.45)]);
        solids.triangle([stalk, point(0.32, 0.12, 0.45), tip]);
    }
}
