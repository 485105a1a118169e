//! One run: the stages as rayon jobs, over the buffers of this run.

use std::{sync::Mutex, time::Instant};

use rayon::prelude::*;
use umbra4_core::{
    Counts, Executor, IndexKind, LatticeLight, Pass, Plan, Precision,
    corner::corner_light,
    edge_plane::LightGrid,
    frame::LightFrame,
    lanes::TILE,
    occluder::Occluder,
    order::Entry,
    proj4::Keys,
    stage::{
        Stage,
        resolve::{Group, Occlusion},
        resolve_silhouette::SilhouetteRoom,
    },
};
use umbra4_cpu_kernels::{Detected, Kernels};

use crate::{
    ExecutorError, Index, Occluders, Receivers, Statistics, block,
    executor::{Answer, Visit},
    grid::{Cells, CellsInput},
    hierarchy::build_level_of,
    open_sides::MOST_TRIANGLES,
    order::ordered,
    silhouette::{Silhouette, is_worthwhile},
    triangles::{KeyedTriangles, PackedTriangles},
};

/// Groups a job: enough to pay for the job, few enough to share the work evenly.
const GROUPS_A_JOB: usize = 16;

/// What an executor's options come to.
#[derive(Clone, Copy)]
pub(crate) struct How<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) isa: Detected,
    pub(crate) precision: Precision,
    pub(crate) index: Index,
}

/// An executor for one light and one set of receivers. Masks go to `visit` as soon as they are done; reducing them is
/// the visitor's, so that they need not be stored.
pub(crate) struct Run<'a, W, S> {
    how: How<'a>,
    samples: &'a S,
    occluders: &'a Occluders,
    receivers: &'a Receivers,
    visit: Visit<'a, W>,
    grid: LightGrid,
    keyed: KeyedTriangles,
    packed: PackedTriangles,
    /// Frame of the light of the first sample, where masks go by the silhouette.
    corner: Option<LightFrame>,
    receiver_keys: Vec<Option<Keys>>,
    receiver_order: Vec<Entry>,
    /// All triangles, by index: of the grid.
    for_cells: Vec<Option<(Keys, Occluder)>>,
    cells: Cells,
    silhouette: Option<Silhouette>,
    statistics: Statistics,
}

impl<'a, W: Kernels<S>, S: Sync> Run<'a, W, S> {
    pub(crate) fn new(
        how: How<'a>,
        occluders: &'a Occluders,
        light: LatticeLight,
        samples: &'a S,
        receivers: &'a Receivers,
        visit: Visit<'a, W>,
    ) -> Self {
        Self {
            how,
            samples,
            occluders,
            receivers,
            visit,
            grid: LightGrid::new(light),
            keyed: KeyedTriangles::default(),
            packed: PackedTriangles::default(),
            corner: None,
            receiver_keys: Vec::new(),
            receiver_order: Vec::new(),
            for_cells: Vec::new(),
            cells: Cells::default(),
            silhouette: None,
            statistics: Statistics::default(),
        }
    }

    /// Runs the plan.
    pub(crate) fn finish(mut self) -> Result<Statistics, ExecutorError> {
        let plan = self.how.plan;
        plan.run(&mut self)?;
        Ok(self.statistics)
    }

    fn key_triangles(&mut self) {
        let (grid, scene, facts) = (&self.grid, self.occluders, self.how.plan.facts());
        self.keyed = KeyedTriangles::of_vertices(grid, scene);
        if facts.index == IndexKind::Grid {
            self.for_cells = std::mem::take(&mut self.keyed).by_index(grid, scene);
            return;
        }
        let has_edges = facts.index == IndexKind::Silhouette && scene.triangles().len() <= MOST_TRIANGLES;
        let corner = has_edges.then(|| LightFrame::new(&corner_light(&grid.light)));
        if let Some(arrangement) = scene.arrangement() {
            self.packed = self.keyed.pack_in_place(grid, scene, self.how.plan.levels(), corner.as_ref());
            self.keyed.open_sides = corner.map(|_| arrangement.neighbours.open(&self.keyed.facings));
        } else {
            self.keyed.code(grid, scene);
        }
        let keyed = &self.keyed;
        self.corner = corner.filter(|_| self.how.index != Index::Auto || is_worthwhile(grid, scene, keyed));
        if facts.arranged && self.corner.is_none() {
            (self.keyed, self.packed.corner_nodes) = Default::default();
        }
    }

    fn order_triangles(&mut self) {
        let levels = self.how.plan.levels();
        self.packed = self.keyed.pack(&self.grid, self.occluders, levels, self.corner.as_ref());
        if self.corner.is_none() {
            self.keyed = KeyedTriangles::default();
        }
    }

    fn find_silhouette(&mut self) {
        if let Some(corner) = self.corner {
            let (levels, facing) = (self.how.plan.levels(), std::mem::take(&mut self.packed.corner_nodes));
            let mut keyed = std::mem::take(&mut self.keyed);
            self.silhouette = Some(Silhouette::find(&self.grid, self.occluders, &mut keyed, levels, corner, facing));
        }
    }

    fn build_level(&mut self, level: usize) {
        build_level_of(self.how.plan.levels(), &mut self.packed.nodes, level);
    }

    fn key_receivers(&mut self, first: usize, count: usize) {
        block::key(&self.grid, &self.receivers.points()[first..][..count], &mut self.receiver_keys);
    }

    fn resolve(&mut self, first: usize) {
        let scene = Occlusion {
            grid: &self.grid,
            levels: self.how.plan.levels(),
            nodes: &self.packed.nodes,
            occluders: &self.packed.occluders,
        };
        let silhouette = self.silhouette.as_ref().map(|silhouette| silhouette.scene(scene));
        let light = &self.grid.light;
        let (How { isa, precision, .. }, samples, visit) = (self.how, self.samples, self.visit);
        let (points, keys) = (&self.receivers.points()[first..], &self.receiver_keys);
        let total = Mutex::new(Counts::default());
        let empty = Group::<W>::empty(light.rows);
        self.receiver_order.par_chunks(TILE * GROUPS_A_JOB).for_each_init(
            || (Box::new(empty.clone()), Box::<SilhouetteRoom<W>>::default()),
            |(group, room), job| {
                let mut counts = Counts::default();
                for entries in job.chunks(TILE) {
                    group.clear(light.rows);
                    block::gather(group, light, points, keys, entries.iter().map(|entry| entry.index));
                    match &silhouette {
                        Some(scene) => W::resolve_silhouette(isa, precision, scene, samples, group, room),
                        None => W::resolve(isa, precision, &scene, samples, group),
                    }
                    counts = counts.plus(group.counts);
                    for (lane, entry) in entries.iter().enumerate() {
                        visit(Answer {
                            receiver: first + entry.index as usize,
                            rows: &group.masks[lane][..light.rows as usize],
                            lit: group.shadowed >> lane & 1 == 0,
                            pairs: group.relevant[lane],
                        });
                    }
                }
                let mut total = total.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                *total = total.plus(counts);
            },
        );
        let found = total.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        self.statistics.counts = self.statistics.counts.plus(found);
    }
}

impl<W: Kernels<S>, S: Sync> Run<'_, W, S> {
    /// The stages of the grid, for the block of `count` receivers from `first`.
    fn run_cells(&mut self, stage: Stage, first: usize) -> Result<(), ExecutorError> {
        let Index::Grid(options) = self.how.index else { return Ok(()) };
        let input = CellsInput {
            options,
            isa: self.how.isa,
            precision: self.how.precision,
            light: &self.grid,
            triangles: &self.for_cells,
            points: &self.receivers.points()[first..][..self.receiver_keys.len()],
            keys: &self.receiver_keys,
            first,
        };
        match stage {
            Stage::DefineFrame => self.cells.define_frame(&input),
            Stage::BinReceivers => self.statistics.receiver_entries += self.cells.bin_receivers(&input)?,
            Stage::BinTriangles => self.statistics.triangle_entries += self.cells.bin_triangles(&input)?,
            _ => {
                let counts = self.cells.resolve::<W, S>(&input, self.visit);
                self.statistics.counts = self.statistics.counts.plus(counts);
            }
        }
        Ok(())
    }
}

impl<W: Kernels<S>, S: Sync> Executor for Run<'_, W, S> {
    type Error = ExecutorError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), ExecutorError> {
        let start = Instant::now();
        let (first, count) = (pass.first as usize, pass.count as usize);
        match pass.stage {
            // The scene and the receivers are snapped when they are made, and the visitor reduces.
            // Lights without extent, clouds, and casters have runs of their own.
            Stage::SnapVertices
            | Stage::SnapReceivers
            | Stage::Reduce
            | Stage::SelectReceivers
            | Stage::ResolveCutout
            | Stage::AddTint
            | Stage::Illuminate
            | Stage::ResolvePunctual
            | Stage::ResolveCloud => return Ok(()),
            Stage::KeyTriangles => self.key_triangles(),
            Stage::OrderTriangles => self.order_triangles(),
            Stage::BuildLevel => self.build_level(first),
            Stage::FindSilhouette => self.find_silhouette(),
            Stage::KeyReceivers => self.key_receivers(first, count),
            Stage::SettleReceivers => block::settle(&self.grid.light, self.receivers, first, &mut self.receiver_keys),
            Stage::OrderReceivers => self.receiver_order = ordered(&self.grid.frame, &self.receiver_keys, |keys| *keys),
            Stage::Resolve => self.resolve(first),
            Stage::DefineFrame | Stage::BinReceivers | Stage::BinTriangles | Stage::ResolveCells => {
                self.run_cells(pass.stage, first)?;
            }
        }
        self.statistics.add(pass.stage, start.elapsed());
        Ok(())
    }
}
