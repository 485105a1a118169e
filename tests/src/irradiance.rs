//! Irradiance in f64, sample by sample, from the oracle's masks; and by how much f32 may differ.

use umbra4_core::{
    emission::Weight,
    glam::{DVec3, IVec3, Vec3},
    irradiance::{COSINE_ROUNDINGS, ROUNDINGS},
};

use crate::{facings::samples, scene::Inputs};

/// What a receiver gets, and what it would get if it faced every sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// Red, green and blue.
    pub irradiance: [f64; 3],
    /// The same without the receiver's own cosine.
    pub facing: [f64; 3],
}

impl Expected {
    /// The largest error that is documented for a light of so many rows and columns, a channel each.
    pub fn tolerance(&self, rows: u32, columns: u32) -> [f64; 3] {
        let roundings = f64::from(ROUNDINGS + rows + columns);
        [0, 1, 2].map(|c| {
            let sum = f64::from(COSINE_ROUNDINGS) * self.facing[c] + roundings * self.irradiance[c];
            sum * f64::from(f32::EPSILON) / 2.0 + 1e-30
        })
    }
}

fn exact(v: IVec3) -> [i128; 3] {
    [v.x, v.y, v.z].map(i128::from)
}

/// Of all receivers, by normals of any length.
pub fn expected(inputs: &Inputs, normals: &[Vec3], weights: &[Weight]) -> Vec<Expected> {
    let (light, places, rows) = (&inputs.light, samples(inputs), inputs.light.rows as usize);
    let (u, v) = (exact(light.step_u), exact(light.step_v));
    let axis = [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    let masks = inputs.oracle();
    let of = |((p, normal), mask): ((&IVec3, &Vec3), &[u64])| {
        let normal = normal.as_dvec3() / normal.as_dvec3().length();
        let mut sums = Expected::default();
        for (index, (place, weight)) in places.iter().zip(weights).enumerate() {
            let (row, column) = (index / light.columns as usize, index % light.columns as usize);
            if mask[row] >> column & 1 == 1 {
                continue;
            }
            let (from, to) = (exact(*p), exact(*place));
            let way = [0, 1, 2].map(|k| to[k] - from[k]);
            let squared = way.iter().map(|w| w * w).sum::<i128>() as f64;
            // The light's cosine, times distance and the area of a cell.
            let height = -(0..3).map(|k| axis[k] * way[k]).sum::<i128>() as f64;
            let cosine = normal.dot(DVec3::from(way.map(|w| w as f64))) / squared.sqrt();
            let facing = height.max(0.0) / squared.sqrt() / squared;
            for (c, weight) in weight.iter().enumerate() {
                let part = f64::from(*weight) / 65535.0 * facing;
                sums.facing[c] += part;
                sums.irradiance[c] += part * cosine.max(0.0);
            }
        }
        sums
    };
    inputs.receivers.points().iter().zip(normals).zip(masks.chunks(rows)).map(of).collect()
}

/// Holds results to what is expected. Returns the largest error, in parts of what is allowed, and how many receivers get light.
///
/// # Errors
/// Another number of results; the first that is too far off.
pub fn check(inputs: &Inputs, expected: &[Expected], found: &[[f32; 3]]) -> Result<(f64, usize), String> {
    if expected.len() != found.len() {
        return Err(format!("{} receivers, {} results", expected.len(), found.len()));
    }
    let (mut worst, mut lit) = (0.0_f64, 0);
    for (r, (expected, found)) in expected.iter().zip(found).enumerate() {
        let tolerance = expected.tolerance(inputs.light.rows, inputs.light.columns);
        for c in 0..3 {
            let error = (f64::from(found[c]) - expected.irradiance[c]).abs();
            if error.is_nan() || error > tolerance[c] {
                return Err(format!("receiver {r}: {found:?}, not {expected:?}, {tolerance:?}"));
            }
            worst = worst.max(error / tolerance[c]);
        }
        lit += usize::from(expected.irradiance[1] > 0.0);
    }
    Ok((worst, lit))
}
