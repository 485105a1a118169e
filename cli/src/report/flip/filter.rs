//! Separable filters over planes of numbers; beyond the border a plane goes on as its outermost pixels.

use rayon::prelude::*;

/// A plane of numbers, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Numbers a row.
    pub width: usize,
    /// `width` × rows.
    pub values: Vec<f32>,
}

impl Plane {
    /// The plane filtered by `across` along its rows and `down` along its columns; both have an odd number of weights.
    #[must_use]
    pub fn filtered(&self, across: &[f32], down: &[f32]) -> Self {
        let width = self.width.max(1);
        let rows = self.values.len() / width;
        let mut between = vec![0.0; self.values.len()];
        between.par_chunks_mut(width).zip(self.values.par_chunks(width)).for_each(|(out, row)| {
            for (x, out) in out.iter_mut().enumerate() {
                *out = weighted(across, |k| row[clamped(x, k, across.len(), width)]);
            }
        });
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
            for (k, weight) in down.iter().enumerate() {
                let from = clamped(y, k, down.len(), rows) * width;
                for (out, value) in out.iter_mut().zip(&between[from..from + width]) {
                    *out += weight * value;
                }
            }
        });
        Self { width: self.width, values }
    }

    /// The sums of both, element by element.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a += b);
        self
    }
}

fn weighted(weights: &[f32], value: impl Fn(usize) -> f32) -> f32 {
    weights.iter().enumerate().map(|(k, weight)| weight * value(k)).sum()
}

/// Place of weight `k` of `weights` around `center`, within `0..length`.
fn clamped(center: usize, k: usize, weights: usize, length: usize) -> usize {
    (center + k).saturating_sub(weights / 2).min(length - 1)
}

/// `function` at −radius, …, radius.
pub fn sampled(radius: u32, function: impl Fn(f32) -> f32) -> Vec<f32> {
    let radius = radius as i32;
    (-radius..=radius).map(|x| function(x as f32)).collect()
}

/// The weights, scaled so that they sum to 1.
pub fn of_sum_one(weights: Vec<f32>) -> Vec<f32> {
    let sum: f32 = weights.iter().sum();
    weights.into_iter().map(|w| w / sum).collect()
}

/// The weights, the positive ones scaled to sum to 1 and the negative ones to −1.
pub fn balanced(weights: Vec<f32>) -> Vec<f32> {
    let positive: f32 = weights.iter().filter(|w| **w > 0.0).sum();
    let negative: f32 = -weights.iter().filter(|w| **w < 0.0).sum::<f32>();
    weights.into_iter().map(|w| if w > 0.0 { w / positive } else { w / negative }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_plane_stays_what_it_is() {
        let plane = Plane { width: 5, values: vec![0.25; 15] };
        let weights = of_sum_one(vec![1.0, 2.0, 1.0]);
        assert_eq!(plane.filtered(&weights, &weights), plane);
    }

    #[test]
    fn a_point_becomes_the_filter() {
        let mut plane = Plane { width: 5, values: vec![0.0; 25] };
        plane.values[12] = 1.0;
        let filtered = plane.filtered(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]);
        // Weight k looks k − 1 to the right: the point shows up on the left of itself with weight 2.
        assert_eq!(filtered.values[10..15], [0.0, 2.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn sums_of_balanced_weights() {
        let weights = balanced(vec![-3.0, 0.0, 1.0, 2.0]);
        assert_eq!(weights, [-1.0, 0.0, 1.0 / 3.0, 2.0 / 3.0]);
    }
}
