//! Measures all effects on one scene.

use std::{cell::RefCell, path::Path, time::Instant};

use umbra4_cpu::CpuExecutor;

use super::{
    case::{cases, sphere},
    offset_effect, table_error,
};
use crate::{
    compare::CompareError,
    contender::ContenderError,
    image_size::ImageSize,
    primary::hits,
    problem::Problem,
    scene::{PAPER_LIGHT, scene},
    timing::{Budget, Progress, Subject, least},
    umbra::snapped,
};

/// What is measured.
pub(super) struct Options<'a> {
    /// Where the models are.
    pub(super) scenes: &'a Path,
    /// Rows and columns of lights with an area.
    pub(super) samples: u32,
    pub(super) threads: usize,
    /// Edge of the image, pixels.
    pub(super) size: u32,
    pub(super) budget: Budget,
}

/// One effect on one scene.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) effect: &'static str,
    /// Of the fastest run.
    pub(super) seconds: f64,
    /// The stages that ran, in order.
    pub(super) stages: Vec<&'static str>,
}

/// What was measured on a scene.
pub(super) struct Measured {
    pub(super) lines: Vec<Line>,
    /// What the table of planes gets wrong, and what an offset darkens, as Markdown.
    pub(super) errors: String,
}

/// Measures the scene called `name`.
///
/// # Errors
/// An unknown scene; whatever umbra4 refuses.
pub(super) fn measure(name: &str, options: &Options<'_>) -> Result<Measured, CompareError> {
    let scene = scene(name, options.scenes, options.samples, PAPER_LIGHT)?;
    let all = hits(&scene.model, &scene.camera, ImageSize::square(options.size));
    let problem = Problem::new(&scene, &all, &all)?;
    let executor = CpuExecutor::new().with_threads(options.threads).map_err(ContenderError::from)?;
    let occluders = snapped(&problem).map_err(ContenderError::from)?;
    let cases = cases(&scene, &problem, &occluders)?;
    let stages: Vec<RefCell<Vec<&'static str>>> = cases.iter().map(|_| RefCell::default()).collect();
    let subjects: Vec<Subject<'_>> = cases
        .iter()
        .zip(&stages)
        .map(|(case, stages)| {
            let run = || {
                let start = Instant::now();
                let statistics = case.effect.run(&executor, &occluders, &problem)?;
                let seconds = start.elapsed().as_secs_f64();
                *stages.borrow_mut() = statistics.seconds_by_stage.iter().map(|(stage, _)| *stage).collect();
                Ok(seconds)
            };
            Subject { name: case.name.to_owned(), run: Box::new(run) }
        })
        .collect();
    let times = least(&subjects, options.budget, &Progress::new(name))?;
    let lines = cases.iter().zip(&stages).zip(times).map(|((case, stages), time)| Line {
        effect: case.name,
        seconds: time.seconds,
        stages: stages.borrow().clone(),
    });
    let lines = lines.collect();
    let errors =
        table_error::markdown(name, &executor, &occluders, &problem.receivers, &sphere(&scene, &problem, 256)?)?;
    let errors = errors + &offset_effect::markdown(name, &executor, &occluders, &problem)?;
    Ok(Measured { lines, errors })
}
