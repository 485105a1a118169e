//! One run for a cloud: the stages as rayon jobs.

use std::{
    sync::{Mutex, PoisonError},
    time::Instant,
};

use rayon::prelude::*;
use umbra4_core::{
    Counts, Executor, Pass, Plan, Precision,
    cloud::CloudMask,
    cloud_tiles::CloudTiles,
    glam::IVec3,
    lanes::TILE,
    stage::{
        Stage,
        resolve_cloud::{CloudGroup, CloudScene},
    },
};
use umbra4_cpu_kernels::{CloudKernels, Detected};
use umbra4_maps::curve::Curve;

use crate::{
    ExecutorError, Occluders, Receivers, Statistics,
    cloud_triangles::{self, CloudTriangles},
    morton::{along, curve_through},
};

/// Groups a job.
const GROUPS_A_JOB: usize = 16;

/// What is run on.
#[derive(Clone, Copy)]
pub(crate) struct CloudInput<'a, T> {
    pub(crate) plan: &'a Plan,
    pub(crate) isa: Detected,
    pub(crate) precision: Precision,
    pub(crate) cloud: &'a CloudTiles<'a>,
    pub(crate) test: &'a T,
    pub(crate) scene: &'a Occluders,
    pub(crate) receivers: &'a Receivers,
    /// A box around the cloud and all points.
    pub(crate) extent: [IVec3; 2],
}

/// Whoever is handed every receiver, its mask, and how many samples it sees.
type CloudVisit<'a> = &'a (dyn Fn(usize, &CloudMask, u32) + Sync);

/// An executor for one cloud. `visit` is handed every receiver, its mask, and how many samples it sees.
pub(crate) struct CloudRun<'a, T> {
    input: CloudInput<'a, T>,
    visit: CloudVisit<'a>,
    order: Vec<u32>,
    triangles: CloudTriangles,
    curve: Curve,
    /// Of a block, those that face away.
    settled: Vec<bool>,
    receiver_order: Vec<u32>,
    statistics: Statistics,
}

impl<'a, T: CloudKernels> CloudRun<'a, T> {
    pub(crate) fn new(input: CloudInput<'a, T>, visit: CloudVisit<'a>) -> Self {
        Self {
            input,
            visit,
            order: Vec::new(),
            triangles: CloudTriangles::default(),
            curve: curve_through(&[], 1),
            settled: Vec::new(),
            receiver_order: Vec::new(),
            statistics: Statistics::default(),
        }
    }

    /// Runs the plan.
    pub(crate) fn finish(mut self) -> Result<Statistics, ExecutorError> {
        let plan = self.input.plan;
        plan.run(&mut self)?;
        Ok(self.statistics)
    }

    fn pack(&mut self, order: Option<&[u32]>) {
        let CloudInput { plan, cloud, scene, extent, .. } = self.input;
        self.triangles = CloudTriangles::pack(scene, cloud, order, plan.levels(), extent);
    }

    fn key_triangles(&mut self) {
        if self.input.plan.facts().arranged {
            self.pack(None);
        } else {
            self.order = cloud_triangles::order(self.input.scene);
        }
    }

    fn order_triangles(&mut self) {
        let order = std::mem::take(&mut self.order);
        self.pack(Some(&order));
    }

    /// Receivers that face away see nothing.
    fn settle_receivers(&mut self, first: usize, count: usize) {
        let CloudInput { cloud, receivers, .. } = self.input;
        let settled = (first..first + count).into_par_iter().map(|index| {
            let is_away =
                receivers.facing_of(index).is_away_from_box(cloud.extent().bounds(), receivers.points()[index]);
            if is_away {
                (self.visit)(index, cloud.full(), 0);
            }
            is_away
        });
        self.settled = settled.collect();
    }

    fn order_receivers(&mut self, first: usize, count: usize) {
        let (points, curve) = (&self.input.receivers.points()[first..first + count], self.curve);
        self.receiver_order = along(count, |index| curve.place([points[index]]));
        let settled = std::mem::take(&mut self.settled);
        if !settled.is_empty() {
            self.receiver_order.retain(|index| !settled[*index as usize]);
        }
    }

    fn resolve(&mut self, first: usize) {
        let CloudInput { plan, isa, precision, cloud, test, receivers, .. } = self.input;
        let points = receivers.points();
        let CloudTriangles { occluders, nodes } = &self.triangles;
        let scene = CloudScene { cloud, test, levels: plan.levels(), nodes, occluders };
        let total = Mutex::new(Counts::default());
        self.receiver_order.par_chunks(TILE * GROUPS_A_JOB).for_each(|job| {
            let mut counts = Counts::default();
            for indices in job.chunks(TILE) {
                let mut group = CloudGroup::default();
                for (lane, index) in indices.iter().enumerate() {
                    group.set(lane, points[first + *index as usize], cloud.len());
                }
                T::resolve(isa, precision, &scene, &mut group);
                counts = counts.plus(group.counts);
                for (lane, index) in indices.iter().enumerate() {
                    (self.visit)(first + *index as usize, &group.masks[lane], group.lit[lane]);
                }
            }
            let mut total = total.lock().unwrap_or_else(PoisonError::into_inner);
            *total = total.plus(counts);
        });
        let found = total.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.statistics.counts = self.statistics.counts.plus(found);
    }
}

impl<T: CloudKernels> Executor for CloudRun<'_, T> {
    type Error = ExecutorError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), ExecutorError> {
        let start = Instant::now();
        let (first, count) = (pass.first as usize, pass.count as usize);
        match pass.stage {
            Stage::KeyTriangles => self.key_triangles(),
            Stage::OrderTriangles => self.order_triangles(),
            Stage::BuildLevel => self.triangles.build_level(self.input.plan.levels(), first),
            Stage::KeyReceivers => self.curve = curve_through(&self.input.receivers.points()[first..first + count], 1),
            Stage::SettleReceivers => self.settle_receivers(first, count),
            Stage::OrderReceivers => self.order_receivers(first, count),
            Stage::ResolveCloud => self.resolve(first),
            // The visitor reduces; no plan of a cloud holds another.
            _ => return Ok(()),
        }
        self.statistics.add(pass.stage, start.elapsed());
        Ok(())
    }
}
