//! One run over casters that are indexed: the stages as rayon jobs, over the groups of a block of receivers.

use std::{convert::Infallible, time::Instant};

use rayon::prelude::*;
use umbra4_core::{
    CasterWork, Counts, Executor, Pass, Plan, Precision,
    lanes::TILE,
    order::Entry,
    proj4::Keys,
    stage::{Stage, resolve::Group},
    tint::Depth,
};
use umbra4_cpu_kernels::{CasterKernels, Detected, Kernels};

use crate::{CasterIndex, Receivers, Statistics, block, casters::index::IndexedCaster, order::ordered};

/// Groups a job.
const GROUPS_A_JOB: usize = 16;

/// One receiver's result.
pub(crate) struct CasterAnswer<'a> {
    pub(crate) receiver: usize,
    pub(crate) rows: &'a [u64],
    /// What panes put before its samples; nothing where no pane was met.
    pub(crate) depths: &'a [Depth],
    /// No bit is set.
    pub(crate) lit: bool,
}

/// Whoever the masks go to, receiver by receiver.
type CasterVisit<'a> = &'a (dyn Fn(CasterAnswer<'_>) + Sync);

/// What a caster does to a group, with room for masks.
type ShadowWork<'a> = &'a (dyn Fn(&IndexedCaster, &mut Shadowed, &mut Group<u64>) + Sync);

/// Sixteen receivers, their masks, and what panes put before their samples.
struct Shadowed {
    group: Group<u64>,
    /// A depth a sample, lane by lane; empty where no light is asked for.
    depths: Vec<Depth>,
    /// Bit l: lane l's depths are not all clear.
    tinted: u32,
}

/// An executor for casters and one set of receivers. Masks go to `visit` as soon as they are done.
pub(crate) struct CasterRun<'a, S> {
    index: &'a CasterIndex,
    isa: Detected,
    samples: &'a S,
    receivers: &'a Receivers,
    visit: CasterVisit<'a>,
    keys: Vec<Option<Keys>>,
    order: Vec<Entry>,
    /// Of the block, in order.
    groups: Vec<Shadowed>,
    /// Groups that hold receivers.
    filled: usize,
    /// Caster by caster, the lanes of every group that it matters to; empty where all do.
    selected: Vec<Vec<u32>>,
    /// First receiver of the block that is worked on, and not yet handed out.
    block: Option<usize>,
    pub(crate) statistics: Statistics,
}

impl<'a, S: Sync> CasterRun<'a, S>
where
    u64: CasterKernels<S>,
{
    pub(crate) fn new(
        index: &'a CasterIndex,
        isa: Detected,
        samples: &'a S,
        receivers: &'a Receivers,
        visit: CasterVisit<'a>,
    ) -> Self {
        Self {
            index,
            isa,
            samples,
            receivers,
            visit,
            keys: Vec::new(),
            order: Vec::new(),
            groups: Vec::new(),
            filled: 0,
            selected: Vec::new(),
            block: None,
            statistics: Statistics::default(),
        }
    }

    fn key_receivers(&mut self, first: usize, count: usize) {
        block::key(&self.index.grid, &self.receivers.points()[first..][..count], &mut self.keys);
    }

    fn settle_receivers(&mut self, first: usize) {
        block::settle(&self.index.grid.light, self.receivers, first, &mut self.keys);
    }

    /// Puts the receivers in order, and into groups.
    fn order_receivers(&mut self, first: usize) {
        let light = &self.index.grid.light;
        self.order = ordered(&self.index.grid.frame, &self.keys, |keys| *keys);
        self.filled = self.order.len().div_ceil(TILE);
        while self.groups.len() < self.filled {
            self.groups.push(Shadowed { group: Group::empty(light.rows), depths: Vec::new(), tinted: 0 });
        }
        let (points, keys) = (&self.receivers.points()[first..], &self.keys);
        let samples = light.sample_count() as usize;
        let groups = self.groups.par_iter_mut().zip(self.order.par_chunks(TILE)).with_min_len(GROUPS_A_JOB);
        groups.for_each(|(shadowed, entries)| {
            shadowed.group.clear(light.rows);
            for lane in 0..TILE {
                if shadowed.tinted >> lane & 1 == 1 {
                    shadowed.depths[lane * samples..][..samples].fill(Depth::CLEAR);
                }
            }
            shadowed.tinted = 0;
            block::gather(&mut shadowed.group, light, points, keys, entries.iter().map(|entry| entry.index));
        });
    }

    fn select_receivers(&mut self, first: usize) {
        let (order, receivers) = (&self.order, self.receivers);
        let lanes_of = |caster: &IndexedCaster| {
            let lanes = |entries: &[Entry]| {
                let meets = |entry: &Entry| caster.layers.meet(receivers.layers_of(first + entry.index as usize));
                entries.iter().enumerate().fold(0, |lanes, (lane, entry)| lanes | u32::from(meets(entry)) << lane)
            };
            order.chunks(TILE).map(lanes).collect()
        };
        self.selected = self.index.casters.par_iter().map(lanes_of).collect();
    }

    /// Has every caster of a kind work on every group.
    fn shadow(&mut self, kind: CasterWork, work: ShadowWork<'_>) {
        let (casters, selected, rows) = (&self.index.casters, &self.selected, self.index.grid.light.rows);
        let groups = self.groups[..self.filled].par_iter_mut().enumerate().with_min_len(GROUPS_A_JOB);
        let on_group = |room: &mut Box<Group<u64>>, (place, shadowed): (usize, &mut Shadowed)| {
            for (number, caster) in casters.iter().enumerate().filter(|(_, caster)| caster.work() == kind) {
                let wanted = selected.get(number).and_then(|lanes| lanes.get(place)).copied().unwrap_or(u32::MAX);
                let others = shadowed.group.active & !wanted;
                shadowed.group.active &= wanted;
                if shadowed.group.active != 0 {
                    work(caster, shadowed, room);
                }
                shadowed.group.active |= others;
            }
        };
        groups.for_each_init(|| Box::new(Group::empty(rows)), on_group);
    }

    fn resolve(&mut self) {
        let (grid, isa, samples) = (&self.index.grid, self.isa, self.samples);
        self.shadow(CasterWork::Plain, &|caster, shadowed, _| {
            u64::resolve(isa, Precision::Exact, &caster.occlusion(grid), samples, &mut shadowed.group);
        });
    }

    fn resolve_cutout(&mut self) {
        let (grid, isa, samples) = (&self.index.grid, self.isa, self.samples);
        self.shadow(CasterWork::Cutout, &|caster, shadowed, room| {
            u64::resolve_cutout(isa, &caster.cutout(grid), samples, &mut shadowed.group, room);
        });
    }

    fn add_tint(&mut self) {
        let (grid, isa, samples) = (&self.index.grid, self.isa, self.samples);
        let count = grid.light.sample_count() as usize * TILE;
        self.shadow(CasterWork::Tinted, &|caster, shadowed, room| {
            let Shadowed { group, depths, tinted } = shadowed;
            depths.resize(count, Depth::CLEAR);
            u64::add_tint(isa, &caster.tint(grid), samples, group, room, depths, tinted);
        });
    }

    /// Hands out the masks of the block that is done.
    fn hand_out(&mut self) {
        let Some(first) = self.block.take() else { return };
        let light = &self.index.grid.light;
        let (rows, samples, visit) = (light.rows as usize, light.sample_count() as usize, self.visit);
        let groups = self.groups[..self.filled].par_iter().zip(self.order.par_chunks(TILE)).with_min_len(GROUPS_A_JOB);
        let counts = groups.map(|(Shadowed { group, depths, tinted }, entries)| {
            for (lane, entry) in entries.iter().enumerate() {
                let is_tinted = tinted >> lane & 1 == 1;
                visit(CasterAnswer {
                    receiver: first + entry.index as usize,
                    rows: &group.masks[lane][..rows],
                    depths: if is_tinted { &depths[lane * samples..][..samples] } else { &[] },
                    lit: group.shadowed >> lane & 1 == 0,
                });
            }
            group.counts
        });
        self.statistics.counts = self.statistics.counts.plus(counts.reduce(Counts::default, Counts::plus));
    }
}

impl<S: Sync> CasterRun<'_, S>
where
    u64: CasterKernels<S>,
{
    /// Runs the plan.
    pub(crate) fn finish(mut self, plan: &Plan) -> Statistics {
        let Ok(()) = plan.run(&mut self);
        self.timed(Stage::Reduce, Self::hand_out);
        self.statistics.sort();
        self.statistics
    }

    fn timed(&mut self, stage: Stage, work: impl FnOnce(&mut Self)) {
        let start = Instant::now();
        work(self);
        self.statistics.add(stage, start.elapsed());
    }
}

impl<S: Sync> Executor for CasterRun<'_, S>
where
    u64: CasterKernels<S>,
{
    type Error = Infallible;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), Infallible> {
        let (first, count) = (pass.first as usize, pass.count as usize);
        if pass.stage == Stage::KeyReceivers {
            self.timed(Stage::Reduce, Self::hand_out);
            self.block = Some(first);
        }
        let stage: &dyn Fn(&mut Self) = match pass.stage {
            Stage::KeyReceivers => &|run| run.key_receivers(first, count),
            Stage::SettleReceivers => &|run| run.settle_receivers(first),
            Stage::OrderReceivers => &|run| run.order_receivers(first),
            Stage::SelectReceivers => &|run| run.select_receivers(first),
            Stage::Resolve => &Self::resolve,
            Stage::ResolveCutout => &Self::resolve_cutout,
            Stage::AddTint => &Self::add_tint,
            // Masks are reduced by whoever is handed them; casters are indexed.
            _ => return Ok(()),
        };
        self.timed(pass.stage, stage);
        Ok(())
    }
}
