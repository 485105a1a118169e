//! umbra4 itself as a contender.

use std::time::Instant;

use umbra4_core::Punctual;
use umbra4_cpu::{CpuExecutor, Index, Occluders, Precision, SceneError};

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
    precision: Precision,
    index: Index,
    arranged: bool,
}

impl Umbra {
    /// In this precision, with triangles and receivers paired like this.
    pub fn new(precision: Precision, index: Index) -> Self {
        Self { precision, index, arranged: false }
    }

    /// The mesh was arranged before; of it, only the vertices' new places are taken.
    #[must_use]
    pub fn arranged(self) -> Self {
        Self { arranged: true, ..self }
    }
}

impl<W: RowWord> Contender<W> for Umbra {
    fn run(&self, problem: &Problem<'_>, threads: usize, out: &mut [W]) -> Result<Run, ContenderError> {
        let executor = executor(threads)?.with_precision(self.precision).with_index(self.index);
        let (run, words) = if self.arranged {
            let occluders = snapped(problem)?.arranged();
            measured_frame(&executor, problem, occluders)?
        } else {
            measured_section(&executor, problem)?
        };
        out.copy_from_slice(&words);
        Ok(run)
    }
}

fn executor(threads: usize) -> Result<CpuExecutor, ContenderError> {
    match threads {
        CALLING_THREAD => Ok(CpuExecutor::new()),
        threads => Ok(CpuExecutor::new().with_threads(threads)?),
    }
}

/// The occluders of a problem, on its lattice.
///
/// # Errors
/// A vertex outside the lattice.
pub fn snapped(problem: &Problem<'_>) -> Result<Occluders, SceneError> {
    Occluders::new(&problem.lattice, &problem.model.vertices, &problem.model.triangles)
}

/// What is timed, as a function of its own, so that a profiler can count this and nothing else.
#[inline(never)]
fn measured_section<W: RowWord>(
    executor: &CpuExecutor,
    problem: &Problem<'_>,
) -> Result<(Run, Vec<W>), ContenderError> {
    let start = Instant::now();
    let occluders = snapped(problem)?;
    resolved(executor, problem, &occluders, start.elapsed().as_secs_f64())
}

/// The same for a frame of a mesh that is arranged.
fn measured_frame<W: RowWord>(
    executor: &CpuExecutor,
    problem: &Problem<'_>,
    mut occluders: Occluders,
) -> Result<(Run, Vec<W>), ContenderError> {
    let start = Instant::now();
    occluders.move_vertices(&problem.lattice, &problem.model.vertices)?;
    resolved(executor, problem, &occluders, start.elapsed().as_secs_f64())
}

fn resolved<W: RowWord>(
    executor: &CpuExecutor,
    problem: &Problem<'_>,
    occluders: &Occluders,
    build: f64,
) -> Result<(Run, Vec<W>), ContenderError> {
    let start = Instant::now();
    let (masks, statistics) = executor.masks::<W>(occluders, &problem.light, &problem.receivers)?;
    let run = Run { build, masks: start.elapsed().as_secs_f64(), counts: Some(statistics.counts) };
    Ok((run, masks.into_words()))
}

/// umbra4's hard shadows of the light's only sample.
#[derive(Clone, Copy, Debug)]
pub struct PointLamp;

impl<W: RowWord> Contender<W> for PointLamp {
    fn run(&self, problem: &Problem<'_>, threads: usize, out: &mut [W]) -> Result<Run, ContenderError> {
        let samples = problem.light.sample_count();
        if samples != 1 {
            return Err(ContenderError::NoPoint { samples });
        }
        let executor = executor(threads)?;
        let light = Punctual::point(problem.light.sample(0, 0)).ok_or(ContenderError::NoPoint { samples })?;
        let start = Instant::now();
        let occluders = snapped(problem)?;
        let build = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (shadows, statistics) = executor.hard_shadows(&occluders, &light, &problem.receivers)?;
        let run = Run { build, masks: start.elapsed().as_secs_f64(), counts: Some(statistics.counts) };
        // A lamp with an area does not shine behind itself.
        for ((receiver, word), origin) in out.iter_mut().enumerate().zip(&problem.origins) {
            let blocked = problem.behind_light(*origin) || shadows.is_blocked(receiver) == Some(true);
            *word = W::from_bits(u64::from(blocked));
        }
        Ok(run)
    }
}
