//! Kernel `resolve_cloud`: which samples of a cloud one receiver does not see.

use glam::IVec3;

use crate::{
    cloud_extent::CloudExtent,
    cloud_pair::{Pair, Reach},
    edge_plane::ReceiverTile,
    hierarchy::{Root, Walk},
    kernel::{
        fetch,
        resolve::{Ordered, ReceiverCounts, add_counts, ordered, tell_if_stopped},
        store,
    },
    occluder::Occluder,
    order::Entry,
    params::CloudParams,
    precision::PrecisionMode,
    proj4::NODE,
    punctual::{self, Punctual},
    shaft::{BoxTile, Shaft},
    side::{Planes, Sides},
    statistics::Tally,
    view::Offsets,
};

/// Sixteen samples of a cloud.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SampleTile {
    /// Lattice. Places without a sample repeat some point.
    pub samples: [[i32; 3]; NODE],
    /// Middle of the box around them, from the middle of the cloud.
    pub middle: [f32; 3],
    /// Half extents of the box, rounded up.
    pub half: [f32; 3],
}

/// What tells which samples of a cloud a pair blocks, as elements of a buffer: the samples themselves, or words of a table.
pub trait CloudElement: Copy {
    /// Adds what a pair blocks to the mask that begins at `start`, and returns how many samples that are.
    fn mark<P: PrecisionMode>(
        pair: &Pair,
        params: &CloudParams,
        elements: &[Self],
        start: usize,
        masks: &mut [u32],
        fallbacks: &mut Tally,
    ) -> u32;
}

/// Bits of a mask's word that there are samples for: word `k` of a cloud of `samples` samples.
#[inline(always)]
pub(super) fn full(samples: u32, k: u32) -> u32 {
    let first = k * 32;
    if first >= samples {
        0
    } else if samples - first >= 32 {
        u32::MAX
    } else {
        (1 << (samples - first)) - 1
    }
}

/// The `id`-th receiver in the order of a block: what the triangles under one node of the hierarchy block is added to its mask.
/// Those under the first of them start an empty one. `elements` are of the cloud, in the order of the mask's bits. `masks` has one more
/// word, as in [`super::resolve::resolve`]. Receivers that are not there, or face away, see nothing. Returns the receiver's index, and what was done
/// for it.
///
/// No loop has more rounds than the light has samples, and few loops lie in one another: see [`super::resolve::resolve`].
#[inline(always)]
pub fn resolve_cloud<P: PrecisionMode, E: CloudElement>(
    id: usize,
    params: &CloudParams,
    receivers: &[[i32; 3]],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[BoxTile],
    elements: &[E],
    masks: &mut [u32],
) -> (usize, ReceiverCounts) {
    let pass = params.params.pass();
    if id >= pass.count as usize {
        return (usize::MAX, [0; 4]);
    }
    let Ordered { index, is_settled, point } = ordered(id, &pass, order, receivers);
    let (samples, start) = (params.samples(), index * pass.stride as usize);
    let found = if is_settled { None } else { point };
    let (mut lit, mut k) = (0, 0);
    while k < pass.stride {
        let (place, all) = (start + k as usize, full(samples, k));
        let blocked = if pass.base > 0 {
            fetch(masks, place, all)
        } else if found.is_some() {
            0
        } else {
            all
        };
        store(masks, place, blocked);
        lit += (all & !blocked).count_ones();
        k += 1;
    }
    let Some(p) = found else { return (index, [0; 4]) };
    if lit == 0 {
        return (index, [0; 4]);
    }
    let (extent, levels) = (params.extent(), params.params.levels());
    let mut receiver = ReceiverTile::EMPTY;
    receiver.set(0, p);
    let offsets = Offsets::new(&receiver, 1);
    let shaft = Shaft::between([p, p], extent.bounds());
    let root = Root { level: pass.level as usize, tile: pass.base };
    let mut walk = Walk::new::<f32>(&levels, root, nodes, &shaft);
    let (mut counts, mut fallbacks) = ([0; 4], 0);
    while lit > 0 {
        let Some((node, mut bits)) = walk.next::<f32>(nodes, &shaft) else { break };
        while bits != 0 && lit > 0 {
            let place = node as usize * NODE + bits.trailing_zeros() as usize;
            bits &= bits.wrapping_sub(1);
            if place < occluders.len() {
                let occluder = occluders[place];
                counts[0] += 1;
                let sides = Sides::seen_from::<f32, P>(&offsets, &receiver, &occluder, 1, &mut fallbacks);
                let reach = Reach::of::<f32, P>(&extent, &receiver, &occluder, sides);
                if reach.alive != 0 {
                    let pair = Pair {
                        receiver: p,
                        corners: occluder.corners(),
                        flipped: occluder.is_mixed() && sides.negative != 0,
                        cuts: reach.cuts_of(0, occluder.is_mixed()),
                    };
                    let blocked = E::mark::<P>(&pair, params, elements, start, masks, &mut fallbacks);
                    counts[1] += 1;
                    counts[2] += (blocked > 0) as u32;
                    // Those that it blocks were lit.
                    lit = lit.wrapping_sub(blocked);
                }
            }
        }
    }
    tell_if_stopped(pass.rounds, true, masks);
    counts[3] = fallbacks as u32;
    (index, counts)
}

impl CloudElement for SampleTile {
    #[inline(always)]
    fn mark<P: PrecisionMode>(
        pair: &Pair,
        params: &CloudParams,
        tiles: &[Self],
        start: usize,
        masks: &mut [u32],
        fallbacks: &mut Tally,
    ) -> u32 {
        let (samples, extent) = (params.samples(), params.extent());
        let planes = pair.planes::<f32, P, 4>(&extent.offsets());
        let (mut found, mut tile) = (0, 0);
        while tile * (NODE as u32) < samples && (tile as usize) < tiles.len() {
            let (place, shift) = (start + tile as usize / 2, tile % 2 * NODE as u32);
            let wanted = (full(samples, tile / 2) & !fetch(masks, place, u32::MAX)) >> shift & 0xffff;
            if wanted != 0 {
                let Self { middle, half, .. } = &tiles[tile as usize];
                let (middle, half) = ([middle[0], middle[1], middle[2]], [half[0], half[1], half[2]]);
                let (surely, maybe) = planes.hold_box::<f32>(pair.cuts, &middle, &half);
                let mut blocked = wanted;
                if !surely {
                    blocked = 0;
                    if maybe {
                        blocked = marked::<P>(pair, &extent, &planes, tiles, tile as usize, wanted, fallbacks);
                    }
                }
                if blocked != 0 {
                    found += blocked.count_ones();
                    store(masks, place, fetch(masks, place, 0) | blocked << shift);
                }
            }
            tile += 1;
        }
        found
    }
}

/// Which of the samples in `wanted` of a tile a pair blocks.
#[inline(always)]
fn marked<P: PrecisionMode>(
    pair: &Pair,
    extent: &CloudExtent,
    planes: &Planes<4>,
    tiles: &[SampleTile],
    tile: usize,
    mut wanted: u32,
    fallbacks: &mut Tally,
) -> u32 {
    let (mut blocked, mut unsure) = (0, 0);
    while wanted != 0 {
        let k = wanted.trailing_zeros();
        wanted &= wanted.wrapping_sub(1);
        let away = sample(tiles, tile, k) - extent.middle();
        let (surely, maybe) = planes.hold::<f32>(pair.cuts, &[away.x as f32, away.y as f32, away.z as f32]);
        blocked |= (surely as u32) << k;
        unsure |= ((maybe && !surely) as u32) << k;
    }
    while P::CERTIFIED && unsure != 0 {
        let k = unsure.trailing_zeros();
        unsure &= unsure.wrapping_sub(1);
        *fallbacks += 1;
        let light = Punctual::at_sample(sample(tiles, tile, k));
        blocked |= (punctual::blocks(light, pair.receiver, pair.corners) as u32) << k;
    }
    blocked
}

#[inline(always)]
fn sample(tiles: &[SampleTile], tile: usize, k: u32) -> IVec3 {
    let [x, y, z] = tiles[tile].samples[k as usize % NODE];
    IVec3::new(x, y, z)
}

/// As [`resolve_cloud`], and writes the counts.
#[inline(always)]
pub fn resolve_cloud_counted<P: PrecisionMode, E: CloudElement>(
    id: usize,
    params: &CloudParams,
    receivers: &[[i32; 3]],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[BoxTile],
    elements: &[E],
    masks: &mut [u32],
    counts: &mut [ReceiverCounts],
) {
    let (index, own) = resolve_cloud::<P, E>(id, params, receivers, order, occluders, nodes, elements, masks);
    add_counts(params.params.pass().base, index, own, counts);
}
