//! Kernels of casters: their triangles' keys, which receivers they matter to, what they cut out of the light and what they tint.
//!
//! What casters block is added to masks that are there already; the first pass over a block, over no triangle, makes them.

use crate::{
    facing::Facing,
    hierarchy::Root,
    jitter::Samples,
    kernel::{
        fetch,
        light_params::LightParams,
        resolve::{DeviceWord, Ordered, STOPPED, is_stopped, ordered, tell_if_stopped},
        store,
    },
    layers::Layers,
    mask_word::PairWord,
    occluder::Occluder,
    order::{CodeFrame, Entry},
    params::{CasterParams, PassParams},
    proj4::{KeyTile, Keys, NOTHING},
    row_mask::is_full,
    stage::{add_tint, key_receivers, key_triangles, resolve::Group, resolve_cutout},
    tint::Depth,
};
use glam::IVec3;

impl LightParams for CasterParams {
    #[inline(always)]
    fn pass(&self) -> PassParams {
        self.params.pass()
    }

    #[inline(always)]
    fn codes(&self) -> CodeFrame {
        self.params.codes()
    }

    #[inline(always)]
    fn triangle(&self, corners: [IVec3; 3]) -> Option<(Keys, Occluder)> {
        key_triangles::keys_of_caster(&self.params.grid(), corners, self.casting())
    }

    #[inline(always)]
    fn receiver(&self, p: IVec3) -> Option<Keys> {
        key_receivers::keys_of(&self.params.frame(), &self.params.light(), p)
    }

    #[inline(always)]
    fn is_behind(&self, facing: Facing, p: IVec3) -> bool {
        facing.is_away_from(&self.params.light(), p)
    }
}

/// The `id`-th receiver in the order of a block, in an order of its caster's own: one that the caster does not matter to, since they have
/// no layer in common, is settled. `layers` holds a word for each receiver of all blocks.
#[inline(always)]
pub fn select_receivers(id: usize, params: &CasterParams, order: &[Entry], layers: &[u32], selected: &mut [Entry]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut entry = fetch(order, id, Entry { code: Entry::ABSENT, index: u32::MAX });
    let own = Layers::from_bits(fetch(layers, (pass.first as usize).wrapping_add(entry.index as usize), 0));
    if !own.meet(params.layers()) {
        entry.code = Entry::ABSENT;
    }
    store(selected, id, entry);
}

/// The `id`-th receiver in the order of a block: what an alpha-tested caster, or one with an offset, blocks is added to its mask. See
/// [`super::resolve::resolve`] for the triangles under one node, and for threads that are stopped.
#[inline(always)]
pub fn resolve_cutout<W: DeviceWord, S: Samples>(
    id: usize,
    params: &CasterParams,
    samples: &S,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    surface: &[u32],
    masks: &mut [u32],
) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let Ordered { index, is_settled, point } = ordered(id, &pass, order, receivers);
    let Some(p) = point else { return };
    if is_settled {
        return;
    }
    let (grid, levels) = (params.params.grid(), params.params.levels());
    let rows = grid.light.rows as usize;
    let mut group = Group::<W>::empty(grid.light.rows);
    group.set(0, p, &fetch(keys, index, NOTHING));
    let halves = pass.stride < grid.light.rows;
    let mut k = 0;
    while k < pass.stride as usize {
        W::load(&mut group.masks[0], k, halves, fetch(masks, index * pass.stride as usize + k, 0));
        k += 1;
    }
    if is_full(&group.masks[0], grid.light.columns) {
        return;
    }
    let root = Root { level: pass.level as usize, tile: pass.base };
    let (layout, offset) = (params.layout(), params.casting().offset);
    let mut room = Group::<W>::empty(grid.light.rows);
    resolve_cutout::resolve_among::<f32, W, S>(
        &grid, samples, &levels, root, nodes, occluders, surface, &layout, offset, &mut group, &mut room,
    );
    k = 0;
    while k < pass.stride as usize {
        store(masks, index * pass.stride as usize + k, W::stored(&group.masks[0], rows, k, halves));
        k += 1;
    }
    tell_if_stopped(pass.rounds, k >= pass.stride as usize, masks);
}

/// The `id`-th receiver in the order of a block: what a tinted caster puts before its light samples is added to their depths. `depths`
/// holds those of a block, receiver by receiver, and one that tells whether a thread was stopped.
#[inline(always)]
pub fn add_tint<S: Samples>(
    id: usize,
    params: &CasterParams,
    samples: &S,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    surface: &[u32],
    depths: &mut [Depth],
) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let Ordered { index, is_settled, point } = ordered(id, &pass, order, receivers);
    let Some(p) = point else { return };
    if is_settled {
        return;
    }
    let (grid, levels) = (params.params.grid(), params.params.levels());
    let mut group = Group::<PairWord>::empty(grid.light.rows);
    group.set(0, p, &fetch(keys, index, NOTHING));
    let mut room = Group::<PairWord>::empty(grid.light.rows);
    let root = Root { level: pass.level as usize, tile: pass.base };
    let first = index * grid.light.sample_count() as usize;
    add_tint::add_among::<f32, PairWord, S>(
        &grid,
        samples,
        &levels,
        root,
        nodes,
        occluders,
        surface,
        &params.layout(),
        &mut group,
        &mut room,
        depths,
        first,
    );
    if is_stopped(pass.rounds) {
        let last = depths.len().wrapping_sub(1);
        store(depths, last, Depth::from_words([STOPPED, 0]));
    }
}
