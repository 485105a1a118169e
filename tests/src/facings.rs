//! Receivers that face some way: normals where signs are zero, what facing away means, and the masks that follow.

use umbra4_core::{
    Facing,
    glam::{IVec3, Vec3},
};

use crate::{rng::Rng, scene::Inputs};

/// Largest component of a normal: integers, that floats hold exactly, so that an oracle can work on integers.
const SCALE: i32 = 1 << 20;

/// A normal for a receiver at `p` before samples, as integers: to any side, towards a sample or away from it, or (but for
/// rounding) with a sample in the surface's plane.
pub fn normal(rng: &mut Rng, p: IVec3, samples: &[IVec3]) -> IVec3 {
    let fitted = |v: [f64; 3]| {
        let largest = v.into_iter().fold(1.0e-9, |largest: f64, v| largest.max(v.abs()));
        IVec3::from_array(v.map(|v| (v / largest * f64::from(SCALE)).round() as i32))
    };
    let random = rng.point(SCALE);
    let toward = (rng.pick(samples).as_dvec3() - p.as_dvec3()).to_array();
    let n = match rng.below(5) {
        0 => random,
        1 => fitted(toward),
        2 => fitted(toward.map(|v| -v)),
        3 => fitted(umbra4_core::glam::DVec3::from(toward).cross(random.as_dvec3()).to_array()),
        _ => IVec3::from_array(rng.pick(&[[SCALE, 0, 0], [0, -SCALE, 0], [0, 1, SCALE], [-SCALE, SCALE, SCALE]])),
    };
    if n == IVec3::ZERO { IVec3::Y } else { n }
}

/// As an engine hands it over, at any length.
pub fn given(rng: &mut Rng, normal: IVec3) -> Vec3 {
    normal.as_vec3() * 2.0_f32.powi(rng.below(80) as i32 - 60)
}

/// Whether `n·(s − p) ≤ 0` for all samples, in integers.
pub fn sees_none(normal: IVec3, p: IVec3, samples: &[IVec3]) -> bool {
    cosine(normal, p, samples) <= 0.0
}

/// The largest cosine between a normal and the way to a sample; its sign is exact.
pub fn cosine(normal: IVec3, p: IVec3, samples: &[IVec3]) -> f64 {
    let of_one = |s: &IVec3| {
        let along: i128 = (0..3).map(|k| i128::from(normal[k]) * (i128::from(s[k]) - i128::from(p[k]))).sum();
        let length = normal.as_dvec3().length() * (s.as_dvec3() - p.as_dvec3()).length();
        along as f64 / length.max(1.0)
    };
    samples.iter().map(of_one).fold(f64::NEG_INFINITY, f64::max)
}

/// All samples of the light with an area.
pub fn samples(inputs: &Inputs) -> Vec<IVec3> {
    let light = &inputs.light;
    (0..light.rows).flat_map(|row| (0..light.columns).map(move |column| light.sample(row, column))).collect()
}

/// Normals for all receivers of a scene.
pub fn normals(rng: &mut Rng, inputs: &Inputs, samples: &[IVec3]) -> Vec<Vec3> {
    let mut of_one = |p: &IVec3| {
        let normal = normal(rng, *p, samples);
        given(rng, normal)
    };
    inputs.receivers.points().iter().map(&mut of_one).collect()
}

/// What the oracle says, but that all is blocked where `is_away(receiver, facing)`.
pub fn settled(
    mut masks: Vec<u64>,
    full: &[u64],
    facings: &[Facing],
    is_away: impl Fn(usize, Facing) -> bool,
) -> Vec<u64> {
    for ((r, facing), mask) in facings.iter().enumerate().zip(masks.chunks_exact_mut(full.len())) {
        if is_away(r, *facing) {
            mask.copy_from_slice(full);
        }
    }
    masks
}
