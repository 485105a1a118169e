//! The oracle: masks on lattice coordinates, all pairs, in `i128`. Written apart from core, from the rule itself.
//!
//! Formulation (core has another). Write the sample as seen from the receiver in the corners as seen from it,
//!
//! `L − p = α(a − p) + β(b − p) + γ(c − p)`.
//!
//! The segment from p to L meets the closed triangle strictly before L iff α, β, γ ≥ 0 and α + β + γ > 1; p is off the
//! plane iff `V = det(a−p, b−p, c−p) ≠ 0`. By Cramer's rule `α·V = det(L−p, b−p, c−p)` and so on. All is multiplied by
//! |V|; nothing is divided. Differences of coordinates stay below 2^30, determinants below 6·2^90, their sum below 2^95.

use rayon::prelude::*;
use umbra4_core::{LatticeLight, glam::IVec3};

type Vector = [i128; 3];

fn difference(a: IVec3, b: IVec3) -> Vector {
    [0, 1, 2].map(|k| i128::from(a[k]) - i128::from(b[k]))
}

fn vector(a: IVec3) -> Vector {
    [0, 1, 2].map(|k| i128::from(a[k]))
}

fn cross(u: &Vector, v: &Vector) -> Vector {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

fn dot(u: &Vector, v: &Vector) -> i128 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

/// The determinant with rows u, v, w.
fn det(u: &Vector, v: &Vector, w: &Vector) -> i128 {
    u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])
}

/// True where `p` lies in the light's plane or behind it.
pub fn behind(light: &LatticeLight, p: IVec3) -> bool {
    det(&vector(light.step_u), &vector(light.step_v), &difference(p, light.origin)) <= 0
}

/// Whether the triangle blocks the point `sample` from `p`. The rule, as plainly as it can be put.
pub fn hit(p: IVec3, sample: IVec3, triangle: [IVec3; 3]) -> bool {
    let [a, b, c] = triangle.map(|corner| difference(corner, p));
    let l = difference(sample, p);
    let volume = det(&a, &b, &c);
    let side = volume.signum();
    let (alpha, beta, gamma) = (side * det(&l, &b, &c), side * det(&a, &l, &c), side * det(&a, &b, &l));
    side != 0 && alpha >= 0 && beta >= 0 && gamma >= 0 && alpha + beta + gamma > volume.abs()
}

/// Whether the triangle blocks what is infinitely far away `towards` some direction from `p`: the same with the direction in
/// the place of L − p, of which no multiple is beyond the light. So α + β + γ > 0 is all that is left of the last condition, and
/// follows from the others.
pub fn hit_towards(p: IVec3, towards: IVec3, triangle: [IVec3; 3]) -> bool {
    let [a, b, c] = triangle.map(|corner| difference(corner, p));
    let l = vector(towards);
    let side = det(&a, &b, &c).signum();
    let (alpha, beta, gamma) = (side * det(&l, &b, &c), side * det(&a, &l, &c), side * det(&a, &b, &l));
    side != 0 && alpha >= 0 && beta >= 0 && gamma >= 0 && alpha + beta + gamma > 0
}

/// A light sample. Not [`LatticeLight::sample`], but where jitter, which is input, has it: this file stands on its own.
fn sample(light: &LatticeLight, row: u32, column: u32) -> IVec3 {
    if light.jitter.is_some() {
        return light.sample(row, column);
    }
    let along = |k: usize| light.origin[k] + row as i32 * light.step_v[k] + column as i32 * light.step_u[k];
    IVec3::new(along(0), along(1), along(2))
}

/// One bit of the mask of `p`.
pub fn oracle_bit(light: &LatticeLight, p: IVec3, triangles: &[[IVec3; 3]], row: u32, column: u32) -> bool {
    let sample = sample(light, row, column);
    behind(light, p) || triangles.iter().any(|&t| hit(p, sample, t))
}

/// A condition `origin + row·i + column·j ≥ 0` on sample (i, j).
#[derive(Clone, Copy)]
struct Condition {
    origin: i128,
    row: i128,
    column: i128,
}

impl Condition {
    fn at(&self, row: u32, column: u32) -> i128 {
        self.origin + self.row * i128::from(row) + self.column * i128::from(column)
    }
}

/// The four conditions under which the triangle blocks sample (i, j) from `p`, or none where it blocks nothing.
fn conditions(light: &LatticeLight, p: IVec3, triangle: [IVec3; 3]) -> Option<[Condition; 4]> {
    let [a, b, c] = triangle.map(|corner| difference(corner, p));
    let (bc, ca, ab) = (cross(&b, &c), cross(&c, &a), cross(&a, &b));
    let volume = dot(&a, &bc);
    if volume == 0 {
        return None;
    }
    let (l, u, v) = (difference(light.origin, p), vector(light.step_u), vector(light.step_v));
    let [alpha, beta, gamma] = [bc, ca, ab].map(|normal| {
        let side = volume.signum();
        Condition { origin: side * dot(&normal, &l), row: side * dot(&normal, &v), column: side * dot(&normal, &u) }
    });
    // In integers, x > |V| is x − |V| − 1 ≥ 0.
    let beyond = Condition {
        origin: alpha.origin + beta.origin + gamma.origin - volume.abs() - 1,
        row: alpha.row + beta.row + gamma.row,
        column: alpha.column + beta.column + gamma.column,
    };
    Some([alpha, beta, gamma, beyond])
}

/// Word with the light's columns set.
fn full_row(light: &LatticeLight) -> u64 {
    u64::MAX >> (64 - light.columns)
}

/// ORs the samples that one triangle blocks from `p` into `rows`.
///
/// The only short cuts: what is linear is negative between two places if it is at both, and ≥ 0 if it is at both.
fn add_triangle(light: &LatticeLight, p: IVec3, triangle: [IVec3; 3], rows: &mut [u64]) {
    let Some(conditions) = conditions(light, p, triangle) else { return };
    let (last_row, last_column) = (light.rows - 1, light.columns - 1);
    let corners = [(0, 0), (0, last_column), (last_row, 0), (last_row, last_column)];
    if conditions.iter().any(|f| corners.iter().all(|&(i, j)| f.at(i, j) < 0)) {
        return;
    }
    for (row, word) in (0..light.rows).zip(rows) {
        let ends = conditions.map(|f| (f.at(row, 0), f.at(row, last_column)));
        if *word == full_row(light) || ends.iter().any(|&(first, last)| first < 0 && last < 0) {
            continue;
        }
        let mut blocked = full_row(light);
        for (f, (first, last)) in conditions.iter().zip(ends) {
            if first >= 0 && last >= 0 {
                continue;
            }
            let mut value = first;
            for column in 0..light.columns {
                if value < 0 {
                    blocked &= !(1 << column);
                }
                value += f.column;
            }
        }
        *word |= blocked;
    }
}

/// Jittered samples, row by row; `None` where they are regular.
fn jittered_samples(light: &LatticeLight) -> Option<Vec<IVec3>> {
    let pairs = (0..light.rows).flat_map(|row| (0..light.columns).map(move |column| (row, column)));
    light.jitter.is_some().then(|| pairs.map(|(row, column)| sample(light, row, column)).collect())
}

/// As [`add_triangle`], sample by sample.
///
/// The only short cut: cells lie in the parallelogram of the light, and what is linear is negative on all of it if it is at its corners.
fn add_to_samples(light: &LatticeLight, samples: &[IVec3], p: IVec3, triangle: [IVec3; 3], rows: &mut [u64]) {
    let Some(conditions) = conditions(light, p, triangle) else { return };
    let corners = [(0, 0), (0, light.columns), (light.rows, 0), (light.rows, light.columns)];
    if conditions.iter().any(|f| corners.iter().all(|&(i, j)| f.at(i, j) < 0)) {
        return;
    }
    for (of_row, word) in samples.chunks(light.columns as usize).zip(rows) {
        for (column, &sample) in of_row.iter().enumerate() {
            *word |= u64::from(*word >> column & 1 == 0 && hit(p, sample, triangle)) << column;
        }
    }
}

/// The mask of one receiver: a word per row, bit j is column j, bits at and beyond the last column 0.
pub fn oracle_mask(light: &LatticeLight, p: IVec3, triangles: &[[IVec3; 3]], rows: &mut [u64]) {
    assert_eq!(rows.len(), light.rows as usize, "one word per row");
    let full = full_row(light);
    if behind(light, p) {
        rows.fill(full);
        return;
    }
    rows.fill(0);
    let samples = jittered_samples(light);
    for &triangle in triangles {
        match &samples {
            None => add_triangle(light, p, triangle, rows),
            Some(samples) => add_to_samples(light, samples, p, triangle, rows),
        }
        if rows.iter().all(|&word| word == full) {
            return;
        }
    }
}

/// The masks of all receivers, receiver-major: `rows` words each.
pub fn oracle_masks(light: &LatticeLight, receivers: &[IVec3], triangles: &[[IVec3; 3]]) -> Vec<u64> {
    let rows = light.rows as usize;
    let mut words = vec![0; rows * receivers.len()];
    words.par_chunks_exact_mut(rows).zip(receivers).for_each(|(mask, &p)| oracle_mask(light, p, triangles, mask));
    words
}
