//! The sort of triangles and receivers along the curve: the kernels of `umbra4_core::kernel::sort`, digit by digit.

use umbra4_core::{
    kernel::{
        Kernel,
        sort::{BLOCK, CODE_BITS, DIGIT_BITS, DIGITS, level_above, runs},
    },
    params::PassParams,
};
use wgpu::Buffer;

use crate::GpuError;

const PASSES: u32 = CODE_BITS.div_ceil(DIGIT_BITS);

/// Counters that sorting `entries` entries takes, with their sums.
pub(crate) fn counters(entries: u32) -> u64 {
    levels(entries).iter().map(|&length| u64::from(length)).sum()
}

/// Lengths of the levels of sums, the counters first.
fn levels(entries: u32) -> Vec<u32> {
    let mut lengths = vec![runs(entries) * DIGITS as u32];
    while let Some(&length) = lengths.last() {
        match level_above(length) {
            0 => break,
            above => lengths.push(above),
        }
    }
    lengths
}

/// Sorts `count` entries of `order`, with the help of `spare` and `counters`. An even number of digits: the result is in
/// `order` again.
pub(crate) fn sort(
    record: &mut impl FnMut(Kernel, PassParams, &[&Buffer]) -> Result<(), GpuError>,
    count: u32,
    order: &Buffer,
    spare: &Buffer,
    counters: &Buffer,
) -> Result<(), GpuError> {
    const { assert!(PASSES.is_multiple_of(2)) }
    let levels = levels(count);
    let bases: Vec<u32> = levels.iter().scan(0, |sum, &length| Some(std::mem::replace(sum, *sum + length))).collect();
    let (mut from, mut to) = (order, spare);
    for digit in 0..PASSES {
        let shift = digit * DIGIT_BITS;
        let by_run = PassParams { count: runs(count), elements: count, shift, ..PassParams::default() };
        record(Kernel::CountDigits, by_run, &[from, counters])?;
        let blocks = |level: usize| PassParams {
            count: levels[level].div_ceil(BLOCK),
            elements: levels[level],
            base: bases[level],
            ..PassParams::default()
        };
        for level in 0..levels.len() - 1 {
            record(Kernel::SumBlocks, blocks(level), &[counters])?;
        }
        for level in (0..levels.len()).rev() {
            record(Kernel::ScanBlocks, blocks(level), &[counters])?;
        }
        record(Kernel::ScatterDigits, by_run, &[counters, from, to])?;
        (from, to) = (to, from);
    }
    Ok(())
}
