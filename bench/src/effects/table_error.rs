//! What the table of planes gets wrong: masks of a sphere by tables of several sizes, against exact ones.

use std::fmt::Write;

use umbra4_core::{
    cloud::Cloud,
    cloud_table::{CloudTable, TableSize},
    glam::IVec3,
};
use umbra4_cpu::{CpuExecutor, Occluders, Receivers};

use crate::contender::ContenderError;

/// Directions on a side of the square, and distances.
const SIZES: [u32; 3] = [32, 64, 128];

/// Masks against exact masks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Error {
    /// Share of bits that differ.
    bits: f64,
    /// Mean difference of visibility.
    mean: f64,
    /// The same, of receivers that see a part of the light.
    penumbra: f64,
    worst: f64,
}

/// A line a size of the table.
///
/// # Errors
/// Whatever umbra4 refuses.
pub(super) fn markdown(
    scene: &str,
    executor: &CpuExecutor,
    occluders: &Occluders,
    receivers: &Receivers,
    cloud: &Cloud<Vec<IVec3>>,
) -> Result<String, ContenderError> {
    let (exact, _) = executor.cloud_masks(occluders, cloud, receivers)?;
    let mut out = format!(
        "\n| {scene}, {} samples: directions × distances | table, MB | bits that differ | mean error of visibility | in \
         penumbrae | worst |\n|---|--:|--:|--:|--:|--:|\n",
        cloud.samples().len()
    );
    for side in SIZES {
        let size = TableSize { directions: side, distances: side };
        let words = CloudTable::words_of(cloud, size)?;
        let table = CloudTable::new(cloud, size, vec![0; words])?;
        let (masks, _) = executor.cloud_masks_by_table(occluders, &table, receivers)?;
        let error = Error::between(exact.words(), masks.words(), cloud.words(), cloud.samples().len());
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "| {side}² × {side} | {:.0} | {:.3} % | {:.4} | {:.4} | {:.3} |",
            words as f64 * 4e-6,
            100.0 * error.bits,
            error.mean,
            error.penumbra,
            error.worst
        );
    }
    Ok(out)
}

impl Error {
    /// Of masks of `words` words, `samples` bits each.
    fn between(exact: &[u32], other: &[u32], words: usize, samples: usize) -> Self {
        let count = |bits: u32| bits.count_ones() as usize;
        let (mut error, mut receivers, mut partly) = (Self::default(), 0, 0);
        for (exact, other) in exact.chunks_exact(words).zip(other.chunks_exact(words)) {
            let differing: usize = exact.iter().zip(other).map(|(a, b)| count(a ^ b)).sum();
            let [blocked, found] = [exact, other].map(|mask| mask.iter().map(|word| count(*word)).sum::<usize>());
            let apart = blocked.abs_diff(found) as f64 / samples as f64;
            error.bits += differing as f64 / samples as f64;
            error.mean += apart;
            error.worst = error.worst.max(apart);
            if blocked > 0 && blocked < samples {
                error.penumbra += apart;
                partly += 1;
            }
            receivers += 1;
        }
        let mean = |sum: f64, of: usize| sum / of.max(1) as f64;
        let (bits, all) = (mean(error.bits, receivers), mean(error.mean, receivers));
        Self { bits, mean: all, penumbra: mean(error.penumbra, partly), worst: error.worst }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_counted() {
        let exact = [0b1100, 0, 0b1111, 0];
        let other = [0b1010, 0, 0b0111, 0];
        let error = Error::between(&exact, &other, 2, 4);
        assert_eq!(error, Error { bits: 3.0 / 8.0, mean: 0.125, penumbra: 0.0, worst: 0.25 });
        assert_eq!(Error::between(&exact, &exact, 2, 4), Error::default());
    }
}
