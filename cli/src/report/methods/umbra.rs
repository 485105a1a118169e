//! umbra4 at one light resolution; and the reference, which is four lights of it.

use std::time::Instant;

use umbra4_core::Counts;

use crate::{
    args::PrecisionArg,
    error::ProgramError,
    executor::AnyExecutor,
    light_file::LightShape,
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

    fn run(&self, problem: &Problem) -> Result<Run, ProgramError> {
        run(problem, &problem.scene.light, self.side, &self.executor)
    }
}

/// From the world to visibility; the snap counts.
fn run(problem: &Problem, light: &LightShape, side: u32, executor: &AnyExecutor) -> Result<Run, ProgramError> {
    let light = light.sampled(side)?;
    let start = Instant::now();
    let snapped = problem.snapped(&light)?;
    let mut seconds_by_stage = vec![("snap".to_owned(), start.elapsed().as_secs_f64())];
    let (visibility, report) = executor.visibility((&snapped.occluders, &snapped.light, &snapped.receivers))?;
    seconds_by_stage.extend(report.seconds_by_stage);
    Ok(Run { visibility, seconds_by_stage, index_seconds: 0.0, counts: Some(report.counts) })
}

/// Samples of the reference, each way.
pub const REFERENCE_SIDE: u32 = 128;

/// 128 × 128 certified samples: more than one light has, so each quarter of the light is a light of 64 × 64.
///
/// # Errors
/// A quarter is too fine for the lattice; the executor's.
pub fn reference(problem: &Problem) -> Result<Run, ProgramError> {
    let executor = AnyExecutor::cpu(PrecisionArg::Exact);
    let mut visibility = vec![0.0_f32; problem.receivers()];
    let (mut seconds_by_stage, mut counts): (Vec<(String, f64)>, _) = (Vec::new(), Counts::default());
    for quarter in quarters(&problem.scene.light) {
        let run = run(problem, &quarter, REFERENCE_SIDE / 2, &executor)?;
        // Multiples of 2^-14 in 0..=1: the sum is exact.
        visibility.iter_mut().zip(run.visibility).for_each(|(sum, part)| *sum += part * 0.25);
        counts = counts.plus(run.counts.unwrap_or_default());
        for (stage, seconds) in run.seconds_by_stage {
            match seconds_by_stage.iter_mut().find(|(name, _)| *name == stage) {
                Some((_, sum)) => *sum += seconds,
                None => seconds_by_stage.push((stage, seconds)),
            }
        }
    }
    Ok(Run { visibility, seconds_by_stage, index_seconds: 0.0, counts: Some(counts) })
}
