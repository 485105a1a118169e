//! Kernel `resolve`: the mask of one receiver.

use glam::IVec3;

use crate::{
    hierarchy::Root,
    jitter::Samples,
    kernel::{fetch, point, store},
    mask_word::{MaskWord, PairWord},
    occluder::Occluder,
    order::Entry,
    params::{Params, PassParams},
    precision::PrecisionMode,
    proj4::{KeyTile, Keys, NOTHING},
    row_mask::{MaskRows, is_full},
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

/// The `id`-th receiver in the order of a block: the triangles under one node of the hierarchy are added to its mask, or, with
/// `elements` 0, to an empty one. Returns its index, and what was done for it.
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
    let Ordered { index, is_settled, point } = ordered(id, &pass, order, receivers);
    let mut group = Group::<W>::empty(grid.light.rows);
    let own = fetch(keys, index, NOTHING);
    match point {
        Some(p) if !is_settled => group.set(0, p, &own),
        _ => group.set_behind(0, &grid.light),
    }
    if pass.elements > 0 {
        // One that no triangle matters to has its mask, whatever that is.
        if is_settled {
            return (index, [0; 4]);
        }
        load_mask(&mut group.masks[0], &pass, grid.light.rows, index, masks);
        if is_full(&group.masks[0], grid.light.columns) {
            return (index, [0; 4]);
        }
    }
    let root = Root { level: pass.level as usize, tile: pass.base };
    resolve_among::<f32, W, P, S>(&grid, samples, &levels, root, nodes, occluders, &mut group);
    store_mask(&group.masks[0], &pass, grid.light.rows, index, masks);
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
    add_counts(params.pass().elements, index, own, counts);
}

/// Reads the mask of a receiver, by its index in the block.
#[inline(always)]
pub(super) fn load_mask<W: DeviceWord>(
    mask: &mut MaskRows<W>,
    pass: &PassParams,
    rows: u32,
    index: usize,
    masks: &[u32],
) {
    let mut k = 0;
    while k < pass.stride as usize {
        W::load(mask, k, pass.stride < rows, fetch(masks, index * pass.stride as usize + k, 0));
        k += 1;
    }
}

/// Writes the mask of a receiver, by its index in the block; and tells if a driver has stopped the thread.
#[inline(always)]
pub(super) fn store_mask<W: DeviceWord>(
    mask: &MaskRows<W>,
    pass: &PassParams,
    rows: u32,
    index: usize,
    masks: &mut [u32],
) {
    let mut k = 0;
    while k < pass.stride as usize {
        store(masks, index * pass.stride as usize + k, W::stored(mask, rows as usize, k, pass.stride < rows));
        k += 1;
    }
    tell_if_stopped(pass.rounds, k >= pass.stride as usize, masks);
}

/// A receiver, by its place in the order of a block.
#[derive(Clone, Copy)]
pub(super) struct Ordered {
    /// Its index in the block.
    pub(super) index: usize,
    /// Whether it came last in the order: no triangle matters to it.
    pub(super) is_settled: bool,
    /// Where it is, if it is there.
    pub(super) point: Option<IVec3>,
}

/// The `id`-th receiver in the order of a block.
#[inline(always)]
pub(super) fn ordered(id: usize, pass: &PassParams, order: &[Entry], receivers: &[[i32; 3]]) -> Ordered {
    let Entry { code, index } = fetch(order, id, Entry { code: Entry::ABSENT, index: 0 });
    let index = index as usize;
    Ordered { index, is_settled: code == Entry::ABSENT, point: point(receivers, pass.first as usize + index) }
}

/// Has the last word of `words` say so if a driver has stopped the thread: it left something undone, or a loop of `rounds` rounds
/// runs fewer. `rounds` must come out of a buffer, or no compiler leaves the loop as it is.
#[inline(always)]
pub fn tell_if_stopped(rounds: u32, is_done: bool, words: &mut [u32]) {
    if is_stopped(rounds) || !is_done {
        let last = words.len().wrapping_sub(1);
        store(words, last, STOPPED);
    }
}

/// Whether a driver has stopped the thread's loops: one of `rounds` rounds, which must come out of a buffer, runs fewer.
#[inline(always)]
pub fn is_stopped(rounds: u32) -> bool {
    let mut run = 0;
    while run < rounds {
        run += 1;
    }
    run < rounds
}

/// Adds to the counts of a receiver; with `slice` 0, they start.
#[inline(always)]
pub(super) fn add_counts(slice: u32, index: usize, own: ReceiverCounts, counts: &mut [ReceiverCounts]) {
    let before = if slice > 0 { fetch(counts, index, [0; 4]) } else { [0; 4] };
    let sums = [before[0] + own[0], before[1] + own[1], before[2] + own[2], before[3] + own[3]];
    store(counts, index, sums);
}
