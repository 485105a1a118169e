//! Kernels of a sort by code, stable: a digit at a time, counting, scanning, scattering. No list has a fixed size, and
//! no thread waits for another.
//!
//! Entries are taken in runs of [`RUN`], one a thread. Counters are digit-major, so that their running sums are the places
//! where each run's entries of each digit go. Sums are taken in blocks of [`BLOCK`], level by level, each level's in the
//! same array behind the one below.

use crate::{
    kernel::{fetch, store},
    order::Entry,
    params::Params,
};

/// Bits of a digit.
pub const DIGIT_BITS: u32 = 5;
/// Values of a digit.
pub const DIGITS: usize = 1 << DIGIT_BITS;
/// Bits that are sorted by: those of a code. ([`Entry::ABSENT`] has them all set.)
pub const CODE_BITS: u32 = 30;
/// Entries that a thread counts.
pub const RUN: u32 = 32;
/// Counters that a thread adds up.
pub const BLOCK: u32 = 64;

/// Runs of `entries` entries.
pub const fn runs(entries: u32) -> u32 {
    entries.div_ceil(RUN)
}

/// Length of the level of sums above one of `length`; none above a level of one block.
pub const fn level_above(length: u32) -> u32 {
    if length <= BLOCK { 0 } else { length.div_ceil(BLOCK) }
}

#[inline(always)]
fn digit(entry: Entry, shift: u32) -> usize {
    (entry.code >> shift) as usize % DIGITS
}

/// Counts the digits of run `id`. `elements` is the number of entries, `count` that of runs.
#[inline(always)]
pub fn count_digits(id: usize, params: &Params, entries: &[Entry], counters: &mut [u32]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut counts = [0_u32; DIGITS];
    let (first, end) = (id as u32 * RUN, pass.elements);
    let mut k = 0;
    while k < RUN && first + k < end {
        counts[digit(fetch(entries, (first + k) as usize, Entry::default()), pass.shift)] += 1;
        k += 1;
    }
    let mut d = 0;
    while d < DIGITS {
        store(counters, d * pass.count as usize + id, counts[d]);
        d += 1;
    }
}

/// Adds up block `id` of the level of `elements` counters from `base` on; the sum goes to the level above.
#[inline(always)]
pub fn sum_blocks(id: usize, params: &Params, counters: &mut [u32]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let (first, mut sum, mut k) = (id as u32 * BLOCK, 0, 0);
    while k < BLOCK && first + k < pass.elements {
        sum += fetch(counters, (pass.base + first + k) as usize, 0);
        k += 1;
    }
    store(counters, (pass.base + pass.elements) as usize + id, sum);
}

/// Puts the sum of all that comes before in the place of every counter of block `id` of a level. The level above is done.
#[inline(always)]
pub fn scan_blocks(id: usize, params: &Params, counters: &mut [u32]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut sum = if id == 0 { 0 } else { fetch(counters, (pass.base + pass.elements) as usize + id, 0) };
    let (first, mut k) = (id as u32 * BLOCK, 0);
    while k < BLOCK && first + k < pass.elements {
        let place = (pass.base + first + k) as usize;
        let own = fetch(counters, place, 0);
        store(counters, place, sum);
        sum += own;
        k += 1;
    }
}

/// Moves the entries of run `id` to their places.
#[inline(always)]
pub fn scatter_digits(id: usize, params: &Params, counters: &[u32], entries: &[Entry], sorted: &mut [Entry]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut places = [0_u32; DIGITS];
    let mut d = 0;
    while d < DIGITS {
        places[d] = fetch(counters, d * pass.count as usize + id, 0);
        d += 1;
    }
    let (first, mut k) = (id as u32 * RUN, 0);
    while k < RUN && first + k < pass.elements {
        let entry = fetch(entries, (first + k) as usize, Entry::default());
        let d = digit(entry, pass.shift);
        store(sorted, places[d] as usize, entry);
        places[d] += 1;
        k += 1;
    }
}
