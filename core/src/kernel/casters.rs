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
        resolve::{DeviceWord, Ordered, STOPPED, is_stopped, load_mask, ordered, store_mask},
        store,
    },
    layers::Layers,
    mask_word::PairWord,
    occluder::Occluder,
    order::{CodeFrame, Entry},
    params::{CasterParams, PassParams},
    proj4::{KeyTile, Keys, NOTHING},
    row_mask::is_full,
    stage::{add_tint, key_triangles, resolve::Group, resolve_cutout},
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
        self.params.receiver(p)
    }

    #[inline(always)]
    fn is_behind(&self, facing: Facing, p: IVec3) -> bool {
        self.params.is_behind(facing, p)
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

/// Index and place of the `id`-th receiver in the order of a block, unless no triangle matters to it.
#[inline(always)]
fn shadowed(id: usize, pass: &PassParams, order: &[Entry], receivers: &[[i32; 3]]) -> Option<(usize, IVec3)> {
    if id >= pass.count as usize {
        return None;
    }
    let Ordered { index, is_settled, point } = ordered(id, pass, order, receivers);
    match point {
        Some(p) if !is_settled => Some((index, p)),
        _ => None,
    }
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
    let Some((index, p)) = shadowed(id, &pass, order, receivers) else { return };
    let (grid, levels) = (params.params.grid(), params.params.levels());
    let mut group = Group::<W>::empty(grid.light.rows);
    group.set(0, p, &fetch(keys, index, NOTHING));
    load_mask(&mut group.masks[0], &pass, grid.light.rows, index, masks);
    if is_full(&group.masks[0], grid.light.columns) {
        return;
    }
    let root = Root { level: pass.level as usize, tile: pass.base };
    let (layout, offset) = (params.layout(), params.casting().offset);
    let mut room = Group::<W>::empty(grid.light.rows);
    resolve_cutout::resolve_among::<f32, W, S>(
        &grid, samples, &levels, root, nodes, occluders, surface, &layout, offset, &mut group, &mut room,
    );
    store_mask(&group.masks[0], &pass, grid.light.rows, index, masks);
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
    let Some((index, p)) = shadowed(id, &pass, order, receivers) else { return };
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
