//! Frames of jittered light samples, accumulated as an engine does while nothing moves: occluders and receivers are snapped
//! once, and every frame pays for a light of its own and for its index.

use std::time::Instant;

use umbra4_core::{AreaLight, Lattice, Lift, accumulate::Accumulation};
use umbra4_cpu::{Occluders, Receivers};

use crate::{
    error::ProgramError,
    executor::{AnyExecutor, Report},
};

/// A still scene under one light, and what its frames have given so far.
pub struct Frames<'a> {
    executor: &'a AnyExecutor,
    lattice: &'a Lattice,
    light: AreaLight,
    occluders: &'a Occluders,
    receivers: &'a Receivers,
    sums: Accumulation<Vec<u32>>,
    /// Stages and counts of all frames.
    pub report: Report,
}

impl<'a> Frames<'a> {
    /// No frame yet of `light`, whatever its jitter; the rest is snapped.
    pub fn new(
        executor: &'a AnyExecutor,
        lattice: &'a Lattice,
        light: AreaLight,
        occluders: &'a Occluders,
        receivers: &'a Receivers,
    ) -> Self {
        let sums = Accumulation::new(vec![0; receivers.len()]);
        Self { executor, lattice, light, occluders, receivers, sums, report: Report::default() }
    }

    /// Runs one more.
    ///
    /// # Errors
    /// A light too fine for the lattice; the executor's.
    pub fn run(&mut self) -> Result<(), ProgramError> {
        let start = Instant::now();
        let light = self.light.with_jitter(self.sums.next_jitter()).snap(self.lattice, Lift::F32_POSITIONS)?;
        self.report.add_stage("snap", start.elapsed().as_secs_f64());
        let (lit, report) = self.executor.lit_counts((self.occluders, &light, self.receivers))?;
        self.report.add(&report);
        let start = Instant::now();
        self.sums.add(0, &light, &lit)?;
        self.report.add_stage("accumulate", start.elapsed().as_secs_f64());
        Ok(())
    }

    /// The fraction of lit samples of every receiver, over all frames.
    pub fn visibility(&mut self) -> Vec<f32> {
        let start = Instant::now();
        let visibility = self.sums.visibility().collect();
        self.report.add_stage("accumulate", start.elapsed().as_secs_f64());
        visibility
    }
}
