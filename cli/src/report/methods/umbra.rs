//! umbra4 at one light resolution; and the reference, which is four lights of it.

use std::time::Instant;

use umbra4_core::{AreaLight, Jitter};

use crate::{
    args::PrecisionArg,
    error::ProgramError,
    executor::{AnyExecutor, Report},
    report::{
        methods::{Family, Method, Run},
        problem::{Problem, quarters},
        tiles::Choice,
    },
};

/// umbra4 on one executor, at one resolution of the light.
pub struct Umbra {
    family: Family,
    side: u32,
    executor: AnyExecutor,
    all: Choice,
}

impl Umbra {
    /// umbra4 with `side` × `side` light samples.
    pub fn new(problem: &Problem, family: Family, side: u32, executor: AnyExecutor) -> Self {
        Self { family, side, executor, all: Choice::everyone(problem.receivers()) }
    }
}

impl Method for Umbra {
    fn family(&self) -> Family {
        self.family
    }

    fn side(&self) -> u32 {
        self.side
    }

    fn choice(&self) -> &Choice {
        &self.all
    }

    fn run(&self, problem: &Problem) -> Result<Vec<Run>, ProgramError> {
        let jitter = if self.family.is_jittered() { Jitter::pattern(0) } else { Jitter::NONE };
        let (visibility, report) = run(problem, problem.light(self.side)?.with_jitter(jitter), &self.executor)?;
        Ok(vec![Run::of_umbra(visibility, 1, report)])
    }
}

/// From the world to visibility; the snap counts.
fn run(problem: &Problem, light: AreaLight, executor: &AnyExecutor) -> Result<(Vec<f32>, Report), ProgramError> {
    let start = Instant::now();
    let snapped = problem.snapped(&light)?;
    let mut report = Report::default();
    report.add_stage("snap", start.elapsed().as_secs_f64());
    let (visibility, stages) = executor.visibility((&snapped.occluders, &snapped.light, &snapped.receivers))?;
    report.add(&stages);
    Ok((visibility, report))
}

/// Samples of the reference, each way.
pub const REFERENCE_SIDE: u32 = 128;

/// 128 × 128 certified samples: more than one light has, so each quarter of the light is a light of 64 × 64.
///
/// # Errors
/// A quarter is too fine for the lattice; the executor's.
pub fn reference(problem: &Problem) -> Result<Run, ProgramError> {
    let executor = AnyExecutor::cpu(PrecisionArg::Exact);
    let (mut visibility, mut report) = (vec![0.0_f32; problem.receivers()], Report::default());
    for quarter in quarters(&problem.scene.light) {
        let (parts, stages) = run(problem, quarter.sampled(REFERENCE_SIDE / 2)?, &executor)?;
        // Multiples of 2^-14 in 0..=1: the sum is exact.
        visibility.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part * 0.25);
        report.add(&stages);
    }
    Ok(Run::of_umbra(visibility, 1, report))
}
