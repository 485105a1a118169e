//! umbra4 with few jittered samples a frame, accumulated: what an engine pays while nothing moves.

use std::time::Instant;

use crate::{
    args::PrecisionArg,
    error::ProgramError,
    executor::AnyExecutor,
    frames::Frames,
    report::{
        methods::{Family, Method, Run},
        problem::Problem,
        tiles::Choice,
    },
};

/// Samples a frame, each way.
const SIDE: u32 = 8;
/// As many as one light of 64 × 64 has samples.
const FRAMES: u32 = 64;

/// Certified masks on the processor, frame after frame.
pub struct OverFrames {
    executor: AnyExecutor,
    all: Choice,
}

impl OverFrames {
    /// Of all receivers.
    pub fn new(problem: &Problem) -> Self {
        Self { executor: AnyExecutor::cpu(PrecisionArg::Exact), all: Choice::everyone(problem.receivers()) }
    }
}

impl Method for OverFrames {
    fn family(&self) -> Family {
        Family::CpuFrames
    }

    fn side(&self) -> u32 {
        SIDE
    }

    fn frames(&self) -> u32 {
        FRAMES
    }

    fn choice(&self) -> &Choice {
        &self.all
    }

    /// What it has after 2, 4, 8, … frames. After the first it is the method of one.
    fn run(&self, problem: &Problem) -> Result<Vec<Run>, ProgramError> {
        let start = Instant::now();
        let (occluders, receivers) = (problem.occluders()?, problem.on_lattice()?);
        let snapped = start.elapsed().as_secs_f64();
        let mut frames = Frames::new(&self.executor, &problem.lattice, problem.light(SIDE)?, &occluders, &receivers);
        frames.report.add_stage("snap", snapped);
        let mut runs = Vec::new();
        for count in 1..=FRAMES {
            frames.run()?;
            if count > 1 && count.is_power_of_two() {
                runs.push(Run::of_umbra(frames.visibility(), count, frames.report.clone()));
            }
        }
        Ok(runs)
    }
}
