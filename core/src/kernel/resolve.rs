//! Kernel `resolve`: the mask of one receiver.

use crate::{
    hierarchy::Root,
    jitter::Samples,
    kernel::{fetch, point, store},
    mask_word::{MaskWord, PairWord},
    occluder::Occluder,
    order::Entry,
    params::Params,
    precision::PrecisionMode,
    proj4::{KeyTile, Keys, NOTHING},
    row_mask::is_full,
    stage::resolve::{Group, resolve_among},
};

/// A mask word of which a GPU makes words of 32 bits.
pub trait DeviceWord: MaskWord {
    /// Word `k` of a mask in memory. `halves`: rows are stored as words of 16 bits.
    fn stored<const N: usize>(mask: &[Self; N], rows: usize, k: usize, halves: bool) -> u32;
    /// The inverse: puts word `k` into the rows that it holds.
    fn load<const N: usize>(mask: &mut [Self; N], k: usize, halves: bool, word: u32);
}

#[inline(always)]
fn row<W: MaskWord, const N: usize>(mask: &[W; N], rows: usize, row: usize) -> W {
    if row < rows { mask[row % N] } else { W::EMPTY }
}

impl DeviceWord for u32 {
    #[inline(always)]
    fn stored<const N: usize>(mask: &[Self; N], rows: usize, k: usize, halves: bool) -> u32 {
        if halves { row(mask, rows, 2 * k) | row(mask, rows, 2 * k + 1) << 16 } else { row(mask, rows, k) }
    }

    #[inline(always)]
    fn load<const N: usize>(mask: &mut [Self; N], k: usize, halves: bool, word: u32) {
        if halves {
            mask[2 * k % N] = word & 0xffff;
            // Beyond an odd number of rows lie full words.
            let odd = (2 * k + 1) % N;
            mask[odd] = if mask[odd] == 0 { word >> 16 } else { mask[odd] };
        } else {
            mask[k % N] = word;
        }
    }
}

impl DeviceWord for PairWord {
    #[inline(always)]
    fn stored<const N: usize>(mask: &[Self; N], rows: usize, k: usize, _: bool) -> u32 {
        let word = row(mask, rows, k / 2);
        if k & 1 == 0 { word.low } else { word.high }
    }

    #[inline(always)]
    fn load<const N: usize>(mask: &mut [Self; N], k: usize, _: bool, word: u32) {
        let row = k / 2 % N;
        if k & 1 == 0 {
            mask[row].low = word;
        } else {
            mask[row].high = word;
        }
    }
}

/// Words of 32 bits that the mask of one receiver takes, with rows in words of `bits` bits.
pub const fn stride(rows: u32, bits: u32) -> u32 {
    (rows * bits).div_ceil(32)
}

/// What the last word of `masks` is where a driver has stopped a thread; else 0.
pub const STOPPED: u32 = 1;

/// Counts of one receiver: pairs tested, kept, relevant; signs decided in integers.
pub type ReceiverCounts = [u32; 4];

/// The `id`-th receiver in the order of a block: the triangles under one node of the hierarchy are added to its mask.
/// Those under the first of them start an empty one. Returns its index, and what was done for it.
///
/// A driver may stop a thread that runs for too long: lavapipe ends all loops of a thread, and of its neighbours, after 65,535
/// rounds together, silently. So a last loop asks whether loops still run; where they do not, the last word of `masks`, which
/// belongs to no mask, is set.
#[inline(always)]
pub fn resolve<W: DeviceWord, P: PrecisionMode, S: Samples>(
    id: usize,
    params: &Params,
    samples: &S,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    masks: &mut [u32],
) -> (usize, ReceiverCounts) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return (usize::MAX, [0; 4]);
    }
    let (grid, levels) = (params.grid(), params.levels());
    let rows = grid.light.rows as usize;
    let entry = fetch(order, id, Entry { code: Entry::ABSENT, index: 0 });
    let index = entry.index as usize;
    let mut group = Group::<W>::empty(grid.light.rows);
    let own = fetch(keys, index, NOTHING);
    match point(receivers, pass.first as usize + index) {
        Some(p) if entry.code != Entry::ABSENT => group.set(0, p, &own),
        _ => group.set_behind(0, &grid.light),
    }
    let halves = pass.stride < grid.light.rows;
    let mut k = 0;
    if pass.base > 0 {
        while k < pass.stride as usize {
            W::load(&mut group.masks[0], k, halves, fetch(masks, index * pass.stride as usize + k, 0));
            k += 1;
        }
        if is_full(&group.masks[0], grid.light.columns) {
            return (index, [0; 4]);
        }
        k = 0;
    }
    let root = Root { level: pass.level as usize, tile: pass.base };
    resolve_among::<f32, W, P, S>(&grid, samples, &levels, root, nodes, occluders, &mut group);
    while k < pass.stride as usize {
        store(masks, index * pass.stride as usize + k, W::stored(&group.masks[0], rows, k, halves));
        k += 1;
    }
    if rounds_run(pass.rounds) < pass.rounds || k < pass.stride as usize {
        let last = masks.len().wrapping_sub(1);
        store(masks, last, STOPPED);
    }
    let c = group.counts;
    (index, [c.pairs_tested as u32, c.pairs_kept as u32, c.pairs_relevant as u32, c.fallbacks as u32])
}

/// As [`resolve`], and writes the counts.
#[inline(always)]
pub fn resolve_counted<W: DeviceWord, P: PrecisionMode, S: Samples>(
    id: usize,
    params: &Params,
    samples: &S,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    masks: &mut [u32],
    counts: &mut [ReceiverCounts],
) {
    let (index, own) = resolve::<W, P, S>(id, params, samples, receivers, keys, order, occluders, nodes, masks);
    add_counts(params.pass().base, index, own, counts);
}

/// Rounds that a loop of `rounds` rounds runs: fewer where a driver has stopped the thread.
#[inline(always)]
pub fn rounds_run(most: u32) -> u32 {
    let mut rounds = 0;
    while rounds < most {
        rounds += 1;
    }
    rounds
}

/// Adds to the counts of a receiver; the first slice of triangles starts them.
#[inline(always)]
pub(super) fn add_counts(slice: u32, index: usize, own: ReceiverCounts, counts: &mut [ReceiverCounts]) {
    let before = if slice > 0 { fetch(counts, index, [0; 4]) } else { [0; 4] };
    let sums = [before[0] + own[0], before[1] + own[1], before[2] + own[2], before[3] + own[3]];
    store(counts, index, sums);
}
