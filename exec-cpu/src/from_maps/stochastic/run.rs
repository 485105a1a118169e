//! One run: the stages of the map as rayon jobs, a plane after the other.

use std::time::Instant;

use rayon::prelude::*;
use umbra4_core::{Facing, glam::IVec3};
use umbra4_maps::{
    kernel::stochastic::{
        BOUND_TRIANGLES, FILTER_LEVELS, FIND_RADII, LOOK_UP, REPROJECT, SAMPLE_LIGHT_FIELD,
        tiles::{mark_active, mark_data, mark_looked_at, mark_merged},
    },
    stochastic::{
        closest,
        elementary::Elementary,
        fit::Fit,
        gather::{self, Gathered},
        lookup,
        params::{ACTIVE_TILES, LensParams},
        reproject::{self, END},
        resolve,
        tiles::{self, ACTIVE, DATA, MERGED, TILE},
        trace::{self, Corners, NOTHING, Node},
        tree::Tree,
    },
};

/// Receivers, or texels, that are worth a job.
const PART: usize = 1 << 10;

/// Names of stages, in the order of the data flow.
pub(crate) const STAGES: [&str; 7] =
    ["fit_map", BOUND_TRIANGLES, SAMPLE_LIGHT_FIELD, REPROJECT, FIND_RADII, FILTER_LEVELS, LOOK_UP];

/// What a run is given.
#[derive(Clone, Copy)]
pub(crate) struct Input<'a> {
    pub(crate) vertices: &'a [IVec3],
    pub(crate) triangles: &'a [[u32; 3]],
    /// Triangles along a curve through space.
    pub(crate) order: &'a [u32],
    pub(crate) points: &'a [IVec3],
    /// Of all points, or of none.
    pub(crate) facings: &'a [Facing],
}

/// Seconds by stage.
#[derive(Default)]
pub(crate) struct Clock(pub(crate) [f64; STAGES.len()]);

impl Clock {
    pub(crate) fn time<T>(&mut self, stage: usize, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = work();
        self.0[stage] += start.elapsed().as_secs_f64();
        done
    }
}

/// The depth of every texel's nearest hit: the map itself.
pub(crate) fn sample_light_field(input: &Input<'_>, params: &LensParams, clock: &mut Clock) -> Vec<f32> {
    let Input { vertices, triangles, order, .. } = *input;
    let (placed, tree, nodes) = clock.time(1, || {
        let vertices: &[[i32; 3]] = bytemuck::cast_slice(vertices);
        let corners = |id: &u32| trace::corners(*id as usize, params, vertices, triangles);
        let placed: Vec<Corners> = order.par_iter().with_min_len(PART).map(corners).collect();
        let tree = Tree::new(placed.len() as u32);
        let nodes = nodes(&tree, params, &placed);
        (placed, tree, nodes)
    });
    clock.time(2, || {
        let texels = (params.size * params.size) as usize;
        let nearest = |id| trace::nearest(id, params, &tree, &placed, &nodes);
        (0..texels).into_par_iter().with_min_len(PART).map(nearest).collect()
    })
}

fn nodes(tree: &Tree, params: &LensParams, placed: &[Corners]) -> Vec<Node> {
    let mut nodes = vec![NOTHING; tree.nodes() as usize];
    for level in 0..tree.levels {
        let (below, own) = nodes.split_at_mut(tree.start(level) as usize);
        let own = own[..tree.count(level) as usize].par_iter_mut().with_min_len(PART).enumerate();
        own.for_each(|(id, node)| {
            *node = if level == 0 { trace::leaf(id, params, placed) } else { trace::parent(id, level, tree, below) };
        });
    }
    nodes
}

/// What all receivers see, each of a plane and all planes together; and how many the map does not hold.
pub(crate) fn visibility(
    input: &Input<'_>,
    fit: &Fit,
    params: &LensParams,
    depths: &[f32],
    clock: &mut Clock,
) -> (Vec<f32>, usize) {
    let points = input.points;
    let mut sums = vec![Gathered::NONE; points.len()];
    let mut plane = Plane::new(params);
    for index in 0..fit.planes().len() {
        let params = params.with_plane(fit.planes(), index);
        plane.filter(&params, points, depths, clock);
        clock.time(6, || {
            let receivers = sums.par_iter_mut().zip(points).with_min_len(PART);
            receivers.for_each(|(sum, point)| *sum = lookup::looked_up(*point, *sum, &params, &plane.resolved));
        });
    }
    clock.time(6, || {
        let receivers = sums.par_iter().zip(points).with_min_len(PART).enumerate();
        let facing = |index| input.facings.get(index).copied().unwrap_or(Facing::UNKNOWN);
        let of = receivers.map(|(index, (sum, point))| lookup::seen(*point, facing(index), sum, params)).collect();
        (of, points.par_iter().with_min_len(PART).filter(|point| lookup::is_outside(**point, params)).count())
    })
}

/// A filter plane, with all its levels. Its memory serves one after the other.
pub(crate) struct Plane {
    heads: Vec<u32>,
    next: Vec<u32>,
    samples: Vec<Elementary>,
    found: Vec<f32>,
    tiles: Vec<u32>,
    widest: Vec<f32>,
    gathered: Vec<Gathered>,
    /// The finest level first.
    pub(crate) resolved: Vec<Gathered>,
}

impl Plane {
    pub(crate) fn new(params: &LensParams) -> Self {
        let (texels, all) = ((params.size * params.size) as usize, params.level_start(params.levels) as usize);
        let tiles = tiles::tiles_start(params, params.levels) as usize;
        Self {
            heads: vec![END; texels],
            next: vec![END; texels],
            samples: vec![Elementary::NONE; all],
            found: vec![0.0; texels],
            tiles: vec![0; tiles],
            widest: vec![tiles::NOTHING_KEPT; tiles],
            gathered: vec![Gathered::NONE; all],
            resolved: vec![Gathered::NONE; all],
        }
    }

    /// Makes the plane of `params` out of the map.
    pub(crate) fn filter(&mut self, params: &LensParams, points: &[IVec3], depths: &[f32], clock: &mut Clock) {
        clock.time(3, || {
            self.mark(params, points);
            self.merge(params, depths);
        });
        clock.time(4, || self.find_radii(params));
        clock.time(5, || {
            for level in 0..params.levels {
                self.gather(&params.with_level(level));
            }
            for level in (0..params.levels).rev() {
                self.resolve(&params.with_level(level));
            }
        });
    }

    /// Says what is needed of every tile. There are few: one thread does it.
    fn mark(&mut self, params: &LensParams, points: &[IVec3]) {
        if !params.is(ACTIVE_TILES) {
            return;
        }
        self.tiles.fill(0);
        let (of_receivers, receivers) = (params.with_count(points.len() as u32), bytemuck::cast_slice(points));
        for id in 0..points.len() {
            mark_looked_at(id, &of_receivers, receivers, &mut self.tiles, set);
        }
        self.each_tile(params, 1..params.levels, |id, params, tiles| mark_active(id, params, tiles, set));
        self.each_tile(params, (0..params.levels).rev(), |id, params, tiles| mark_data(id, params, tiles, set));
        self.each_tile(params, 0..1, |id, params, tiles| mark_merged(id, params, tiles, set));
    }

    /// Runs a kernel for all tiles of each level.
    fn each_tile(
        &mut self,
        params: &LensParams,
        levels: impl Iterator<Item = u32>,
        mark: impl Fn(usize, &LensParams, &mut [u32]),
    ) {
        for level in levels {
            let across = tiles::tiles_across(params, level);
            let params = params.with_level(level).with_count(across * across);
            for id in 0..params.count as usize {
                mark(id, &params, &mut self.tiles);
            }
        }
    }

    /// Brings every sample to where its ray crosses the plane.
    fn merge(&mut self, params: &LensParams, depths: &[f32]) {
        let Self { heads, next, samples, tiles, .. } = self;
        if params.moves() {
            let landings: Vec<u32> =
                (0..depths.len()).into_par_iter().with_min_len(PART).map(|id| reproject::landing(id, params)).collect();
            heads.fill(END);
            for (id, landing) in landings.iter().enumerate() {
                if let Some(head) = heads.get_mut(*landing as usize) {
                    next[id] = std::mem::replace(head, id as u32);
                }
            }
        }
        let (heads, next) = (&*heads, &*next);
        fill(samples, params, tiles, MERGED, Elementary::NONE, |id, _| {
            reproject::on_plane(id, params, heads, next, depths)
        });
    }

    /// Raises radii, and makes the coarser levels.
    fn find_radii(&mut self, params: &LensParams) {
        let Self { samples, found, tiles, widest, .. } = self;
        if params.widest_raise > 0.0 {
            fill(found, params, tiles, MERGED, 0.0, |id, _| closest::closest(id, params, samples));
            let raised: Vec<f32> = (0..found.len())
                .into_par_iter()
                .with_min_len(PART)
                .map(|id| closest::filtered_with(id, params, tiles, samples, found))
                .collect();
            samples.iter_mut().zip(raised).for_each(|(sample, radius)| sample.radius = radius);
        }
        for level in 1..params.levels {
            let (params, above) = (params.with_level(level - 1), params.with_level(level));
            let (finer, own) = samples.split_at_mut(params.level_start(level) as usize);
            fill(own, &above, tiles, DATA, Elementary::NONE, |id, _| gather::coarser(id, &params, finer));
        }
        for level in 0..params.levels {
            let params = params.with_level(level);
            let (start, end) = (tiles::tiles_start(&params, level), tiles::tiles_start(&params, level + 1));
            let own = widest[start as usize..end as usize].par_iter_mut().enumerate();
            own.for_each(|(id, widest)| *widest = tiles::widest(id, &params, samples));
        }
    }

    fn gather(&mut self, params: &LensParams) {
        let Self { samples, tiles, widest, gathered, .. } = self;
        let (samples, widest) = (&*samples, &*widest);
        let own = &mut gathered[params.level_start(params.level) as usize..];
        fill(own, params, tiles, ACTIVE, Gathered::NONE, |id, tile| tiles::gathered(id, tile, params, widest, samples));
    }

    fn resolve(&mut self, params: &LensParams) {
        let Self { tiles, gathered, resolved, .. } = self;
        let above = params.level_start(params.level + 1) as usize;
        let (own, coarser) = resolved.split_at_mut(above);
        let own = &mut own[params.level_start(params.level) as usize..];
        let (coarser, start) = (&*coarser, above as u32);
        fill(own, params, tiles, ACTIVE, Gathered::NONE, |id, _| {
            resolve::resolved(id, params, gathered, coarser, start)
        });
    }
}

fn set(tile: &mut u32, bits: u32) {
    *tile |= bits;
}

/// `of(texel, tile)` for all texels of the level in tiles that have `bit`, and `absent` for the others. `out` begins with the level.
fn fill<T: Copy + Send + Sync>(
    out: &mut [T],
    params: &LensParams,
    tiles: &[u32],
    bit: u32,
    absent: T,
    of: impl Fn(usize, usize) -> T + Sync,
) {
    let (level, size) = (params.level, params.level_size(params.level) as usize);
    let (start, across) = (tiles::tiles_start(params, level) as usize, tiles::tiles_across(params, level) as usize);
    let rows = out[..size * size].par_chunks_mut(size * TILE as usize).enumerate();
    rows.for_each(|(tile_row, texels)| {
        for tile_column in 0..across {
            let tile = tile_row * across + tile_column;
            let needed = tiles::has((start + tile) as u32, bit, params, tiles);
            let columns = tile_column * TILE as usize..((tile_column + 1) * TILE as usize).min(size);
            for (row, texels) in texels.chunks_mut(size).enumerate() {
                let first = (tile_row * TILE as usize + row) * size;
                for column in columns.clone() {
                    texels[column] = if needed { of(first + column, tile) } else { absent };
                }
            }
        }
    });
}
