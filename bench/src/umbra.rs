//! umbra4 itself as a contender.

use std::time::Instant;

use umbra4_cpu::{CpuExecutor, Occluders, Precision};

use crate::{
    contender::{Contender, ContenderError, Run},
    problem::Problem,
    row_word::RowWord,
};

/// umbra4 on the CPU. Its index is built with the masks, so `build` is the snap of the occluders alone.
#[derive(Clone, Copy, Debug)]
pub struct Umbra {
    /// Exact or plain f32.
    pub precision: Precision,
}

impl<W: RowWord> Contender<W> for Umbra {
    fn run(&self, problem: &Problem<'_>, threads: usize, out: &mut [W]) -> Result<Run, ContenderError> {
        let executor = CpuExecutor::new().with_threads(threads)?.with_precision(self.precision);
        let (run, words) = measured_section(&executor, problem)?;
        out.copy_from_slice(&words);
        Ok(run)
    }
}

/// What is timed, as a function of its own, so that a profiler can count this and nothing else.
#[inline(never)]
fn measured_section<W: RowWord>(
    executor: &CpuExecutor,
    problem: &Problem<'_>,
) -> Result<(Run, Vec<W>), ContenderError> {
    let start = Instant::now();
    let occluders = Occluders::new(&problem.lattice, &problem.model.vertices, &problem.model.triangles)?;
    let build = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let (masks, statistics) = executor.masks::<W>(&occluders, &problem.light, &problem.receivers)?;
    let run = Run { build, masks: start.elapsed().as_secs_f64(), counts: Some(statistics.counts) };
    Ok((run, masks.into_words()))
}
