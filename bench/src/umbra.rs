//! umbra4 itself as a contender.

use std::time::Instant;

use umbra4_cpu::{CpuExecutor, Index, Occluders, Precision};

use crate::{
    contender::{Contender, ContenderError, Run},
    problem::Problem,
    row_word::RowWord,
};

/// A number of threads that stands for the thread that calls, where [`bind_calling_thread`] made it rayon's only one.
pub const CALLING_THREAD: usize = 0;

/// Makes the calling thread rayon's only one: a profiler that counts one function and what it calls does not follow work
/// to other threads.
///
/// # Errors
/// Rayon has threads already.
pub fn bind_calling_thread() -> Result<(), rayon::ThreadPoolBuildError> {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global()
}

/// umbra4 on the CPU. Its index is built with the masks, so `build` is the snap of the occluders alone.
#[derive(Clone, Copy, Debug)]
pub struct Umbra {
    /// Exact or plain f32.
    pub precision: Precision,
    /// How triangles and receivers are paired.
    pub index: Index,
}

impl<W: RowWord> Contender<W> for Umbra {
    fn run(&self, problem: &Problem<'_>, threads: usize, out: &mut [W]) -> Result<Run, ContenderError> {
        let executor = CpuExecutor::new().with_precision(self.precision).with_index(self.index);
        let executor = match threads {
            CALLING_THREAD => executor,
            threads => executor.with_threads(threads)?,
        };
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
