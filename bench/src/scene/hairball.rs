//! A ball of hair: thousands of thin curved strands around a sphere.
//!
//! A strand is a tube of three sides that starts anywhere on the ball and winds around it. The ball's radius is one.

use std::f64::consts::TAU;

use umbra4::model::Model;
use umbra4_core::glam::{DQuat, DVec3};
use umbra4_tests::rng::Rng;

use super::solids::{Solids, between, direction};

const SEED: u64 = 1;
const STRANDS: usize = 2_700;
/// Straight pieces of a strand.
const PIECES: usize = 32;
/// Radius of a strand at its beginning and at its end: so thin that some of the light comes through.
const RADII: [f64; 2] = [0.0018, 0.0008];
/// Lowest and highest distance of strands from the centre.
const SHELL: [f64; 2] = [0.6, 1.0];

/// The ball, without the ground.
pub(super) fn model() -> Model {
    let (mut solids, mut rng) = (Solids::default(), Rng::named(SEED, "hairball"));
    for _ in 0..STRANDS {
        solids.strand(&strand(&mut rng), RADII);
    }
    solids.finish()
}

/// Points along a strand: around an axis that itself turns slowly, in and out between the shell's radii.
fn strand(rng: &mut Rng) -> [DVec3; PIECES + 1] {
    let mut at = direction(rng);
    let mut axis = at.cross(direction(rng)).normalize_or(DVec3::Y);
    let (step, bend) = (between(rng, 0.04, 0.1), rng.real(0.08));
    let (phase, waves) = (between(rng, 0.0, TAU), between(rng, 0.5, 2.0));
    std::array::from_fn(|index| {
        at = DQuat::from_axis_angle(axis, step) * at;
        axis = DQuat::from_axis_angle(at, bend) * axis;
        let wave = (phase + waves * TAU * index as f64 / PIECES as f64).sin();
        at * (0.5 * (SHELL[0] + SHELL[1]) + 0.5 * (SHELL[1] - SHELL[0]) * wave)
    })
}
