//! One run for a light without extent: the stages as rayon jobs, in one of its frames after the other.

use std::{
    sync::{Mutex, PoisonError},
    time::Instant,
};

use rayon::prelude::*;
use umbra4_core::{
    Counts, Executor, Pass, Plan, Precision, Punctual,
    glam::IVec3,
    lanes::TILE,
    order::{Entry, code},
    proj4::{Keys, NODE},
    punctual_frame::PunctualFrame,
    stage::{
        Stage,
        resolve_punctual::{PunctualGroup, PunctualScene},
    },
};
use umbra4_cpu_kernels::{Detected, resolve_punctual};

use crate::{
    ExecutorError, Occluders, Receivers, Statistics,
    hard_shadows::ShadowBits,
    hierarchy::build_level_of,
    order::{fitted, ordered, sort},
    triangles::PackedTriangles,
};

/// Groups a job.
const GROUPS_A_JOB: usize = 32;
/// Triangles, or receivers, that are worth a job.
const PART: usize = 1 << 12;

/// What the triangles and receivers of a run are to the light's faces.
pub(crate) struct Faces {
    /// Bit f: the triangle may be seen through face f.
    triangles: Vec<u8>,
    /// Face of every receiver; none where the light itself is.
    receivers: Vec<Option<u8>>,
}

impl Faces {
    pub(crate) fn new(light: &Punctual, scene: &Occluders, receivers: &[IVec3]) -> Self {
        let corners = (0..scene.triangles().len()).into_par_iter().with_min_len(PART);
        Self {
            triangles: corners.map(|id| scene.corners(id).map_or(0, |c| light.faces_of(&c) as u8)).collect(),
            receivers: receivers.par_iter().with_min_len(PART).map(|p| light.face_of(*p).map(|f| f as u8)).collect(),
        }
    }

    /// What is seen through a face. `None` where no receiver is.
    pub(crate) fn part(&self, face: u32) -> Option<Part> {
        let receivers = self.receivers.par_iter().enumerate().with_min_len(PART);
        let receivers = receivers.filter(|(_, of)| of.map(u32::from) == Some(face)).map(|(id, _)| id as u32);
        let receivers: Vec<u32> = receivers.collect();
        if receivers.is_empty() {
            return None;
        }
        let triangles = self.triangles.par_iter().enumerate().with_min_len(PART);
        let triangles = triangles.filter(|(_, faces)| **faces >> face & 1 == 1).map(|(id, _)| id as u32);
        Some(Part { face, triangles: triangles.collect(), receivers })
    }
}

/// What is seen through one face of a light.
pub(crate) struct Part {
    face: u32,
    /// Of a scene, those that may be.
    pub(crate) triangles: Vec<u32>,
    /// Of all receivers, those that are.
    pub(crate) receivers: Vec<u32>,
}

/// What is run on.
pub(crate) struct Input<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) isa: Detected,
    pub(crate) precision: Precision,
    pub(crate) light: Punctual,
    pub(crate) scene: &'a Occluders,
    pub(crate) receivers: &'a Receivers,
    pub(crate) part: &'a Part,
}

/// An executor for one frame of a light.
pub(crate) struct PunctualRun<'a> {
    input: Input<'a>,
    frame: PunctualFrame,
    shadows: &'a ShadowBits,
    order: Vec<Entry>,
    packed: PackedTriangles,
    /// None of those that face away.
    receiver_keys: Vec<Option<Keys>>,
    receiver_order: Vec<Entry>,
    statistics: &'a mut Statistics,
}

impl<'a> PunctualRun<'a> {
    pub(crate) fn new(input: Input<'a>, shadows: &'a ShadowBits, statistics: &'a mut Statistics) -> Self {
        let frame = input.light.frame(input.part.face);
        Self {
            input,
            frame,
            shadows,
            order: Vec::new(),
            packed: PackedTriangles::default(),
            receiver_keys: Vec::new(),
            receiver_order: Vec::new(),
            statistics,
        }
    }

    /// Codes of those that may block something.
    fn key_triangles(&mut self) {
        let Input { light, scene, part, .. } = &self.input;
        let keys = |id: u32| {
            let corners = scene.corners(id as usize)?;
            self.frame.triangle_keys(&corners).filter(|_| light.occluder(corners).is_some())
        };
        let triangles = &part.triangles;
        let codes = fitted(self.frame.light_frame(), triangles.len(), |place| keys(triangles[place]));
        let entry = |id: &u32| Entry { code: keys(*id).map_or(Entry::ABSENT, |keys| code(&codes, &keys)), index: *id };
        self.order = triangles.par_iter().with_min_len(PART).map(entry).collect();
    }

    fn order_triangles(&mut self) {
        sort(&mut self.order);
        self.order.truncate(self.order.partition_point(|entry| entry.code != Entry::ABSENT));
        let (leaves, Input { plan, light, scene, .. }) = (self.order.par_chunks(NODE), &self.input);
        self.packed = PackedTriangles::of(self.order.len(), plan.levels(), None, leaves, |entries, mut leaf| {
            for (lane, entry) in entries.iter().enumerate() {
                let corners = scene.corners(entry.index as usize);
                let keys = corners.and_then(|corners| self.frame.triangle_keys(&corners));
                let occluder = corners.and_then(|corners| light.occluder(corners));
                if let (Some(keys), Some(occluder)) = (keys, occluder) {
                    leaf.put(lane, &keys, occluder);
                }
            }
        });
        self.order = Vec::new();
    }

    fn key_receivers(&mut self, first: usize, count: usize) {
        let Input { receivers, part, .. } = &self.input;
        let (points, ids) = (receivers.points(), part.receivers[first..first + count].par_iter());
        ids.map(|id| Some(self.frame.receiver_keys(points[*id as usize]))).collect_into_vec(&mut self.receiver_keys);
    }

    fn settle_receivers(&mut self, first: usize, count: usize) {
        let Input { light, receivers, part, .. } = &self.input;
        let ids = part.receivers[first..first + count].par_iter();
        self.receiver_keys.par_iter_mut().zip(ids).for_each(|(keys, id)| {
            let index = *id as usize;
            if receivers.facing_of(index).is_away_from_punctual(*light, receivers.points()[index]) {
                self.shadows.set(index);
                *keys = None;
            }
        });
    }

    fn resolve(&mut self, first: usize) {
        let Input { plan, isa, precision, light, receivers, part, .. } = &self.input;
        let points = receivers.points();
        let scene = PunctualScene {
            light: *light,
            levels: plan.levels(),
            nodes: &self.packed.nodes,
            occluders: &self.packed.occluders,
        };
        let total = Mutex::new(Counts::default());
        self.receiver_order.par_chunks(TILE * GROUPS_A_JOB).for_each(|job| {
            let mut counts = Counts::default();
            for entries in job.chunks(TILE) {
                let mut group = PunctualGroup::default();
                let id = |entry: &Entry| part.receivers[first + entry.index as usize] as usize;
                for (lane, entry) in entries.iter().enumerate() {
                    if let Some(keys) = &self.receiver_keys[entry.index as usize] {
                        group.set(lane, points[id(entry)], keys);
                    }
                }
                resolve_punctual(*isa, *precision, &scene, &mut group);
                counts = counts.plus(group.counts);
                for (lane, entry) in entries.iter().enumerate() {
                    if group.shadowed >> lane & 1 == 1 {
                        self.shadows.set(id(entry));
                    }
                }
            }
            let mut total = total.lock().unwrap_or_else(PoisonError::into_inner);
            *total = total.plus(counts);
        });
        let found = total.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.statistics.counts = self.statistics.counts.plus(found);
    }
}

impl Executor for PunctualRun<'_> {
    type Error = ExecutorError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), ExecutorError> {
        let start = Instant::now();
        let (first, count) = (pass.first as usize, pass.count as usize);
        match pass.stage {
            Stage::KeyTriangles => self.key_triangles(),
            Stage::OrderTriangles => self.order_triangles(),
            Stage::BuildLevel => build_level_of(self.input.plan.levels(), &mut self.packed.nodes, first),
            Stage::KeyReceivers => self.key_receivers(first, count),
            Stage::SettleReceivers => self.settle_receivers(first, count),
            Stage::OrderReceivers => {
                let frame = self.frame.light_frame();
                self.receiver_order = ordered(frame, &self.receiver_keys, |keys| *keys);
            }
            Stage::ResolvePunctual => self.resolve(first),
            // No plan of a light without extent holds another.
            _ => return Ok(()),
        }
        self.statistics.add(pass.stage, start.elapsed());
        Ok(())
    }
}
