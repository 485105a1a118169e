//! Weights of light samples, and what the oracle's masks make of them.

use umbra4_core::emission::{WHOLE, Weight};

use crate::{rng::Rng, scene::Inputs};

/// Weights of all sizes, many of them zero.
pub fn weights(rng: &mut Rng, count: usize) -> Vec<Weight> {
    let mut weight = || match rng.below(3) {
        0 => 0,
        1 => WHOLE,
        _ => rng.next_u64() as u16,
    };
    let mut weights: Vec<Weight> = (0..count).map(|_| [weight(), weight(), weight()]).collect();
    weights[0][1] = 1;
    weights
}

/// The sums from the oracle's masks, a sample at a time.
pub fn expected(inputs: &Inputs, weights: &[Weight]) -> Vec<[u64; 3]> {
    let (rows, columns) = (inputs.light.rows as usize, inputs.light.columns as usize);
    let sum = |mask: &[u64]| {
        let mut sum = [0; 3];
        for (row, word) in mask.iter().enumerate() {
            for column in (0..columns).filter(|column| word >> column & 1 == 0) {
                for (sum, weight) in sum.iter_mut().zip(weights[row * columns + column]) {
                    *sum += u64::from(weight);
                }
            }
        }
        sum
    };
    inputs.oracle().chunks_exact(rows).map(sum).collect()
}
