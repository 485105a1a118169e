//! Times every way on one scene, and compares what it gives with the exact masks.

use std::{cell::RefCell, path::Path, time::Instant};

use umbra4_cpu::CpuExecutor;

use super::ways::{Way, ways};
use crate::{
    compare::CompareError,
    contender::ContenderError,
    image_size::ImageSize,
    primary::hits,
    problem::Problem,
    scene::{COURT, PAPER_LIGHT, court, scene},
    timing::{Budget, Progress, Subject, least},
    umbra::snapped,
};

/// What is measured.
pub(super) struct Options<'a> {
    /// Where the models are.
    pub(super) scenes: &'a Path,
    /// Rows and columns of the light.
    pub(super) samples: u32,
    pub(super) threads: usize,
    /// Edge of the image, pixels.
    pub(super) size: u32,
    /// Texels of the maps, each way.
    pub(super) map: u32,
    pub(super) budget: Budget,
}

/// Mean absolute differences from the exact visibility, among receivers that do not face away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Errors {
    pub(super) all: f64,
    /// Among those in penumbrae.
    pub(super) penumbrae: f64,
    /// Among those in full shadow: the light that leaks there.
    pub(super) umbrae: f64,
    /// Among those that see all of the light: what is darkened.
    pub(super) lit: f64,
}

/// One way on one scene.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) name: &'static str,
    /// Of the fastest run.
    pub(super) seconds: f64,
    pub(super) errors: Errors,
}

/// What was measured on a scene.
pub(super) struct Measured {
    pub(super) scene: String,
    /// Receivers that do not face away; those in penumbrae, in full shadow, and fully lit.
    pub(super) receivers: [usize; 4],
    pub(super) lines: Vec<Line>,
}

/// Measures the scene called `name`.
///
/// # Errors
/// An unknown scene; whatever umbra4 refuses.
pub(super) fn measure(name: &str, options: &Options<'_>) -> Result<Measured, CompareError> {
    let scene = match name {
        COURT => court(options.samples)?,
        name => scene(name, options.scenes, options.samples, PAPER_LIGHT)?,
    };
    let all = hits(&scene.model, &scene.camera, ImageSize::square(options.size));
    let problem = Problem::new(&scene, &all, &all)?;
    let executor = CpuExecutor::new().with_threads(options.threads).map_err(ContenderError::from)?;
    let occluders = snapped(&problem).map_err(ContenderError::from)?;
    // Maps leak light through the surface that a receiver lies on: that is no technique's business.
    let receivers = problem.receivers.clone().facing(&problem.normals).map_err(ContenderError::from)?;
    let ways = ways(options.map);
    let given: Vec<RefCell<Vec<f32>>> = ways.iter().map(|_| RefCell::default()).collect();
    let subjects: Vec<Subject<'_>> = ways
        .iter()
        .zip(&given)
        .map(|(Way { name, technique }, given)| {
            let run = || {
                let start = Instant::now();
                let (visibility, _) = executor.visibility_by(technique, &occluders, &problem.light, &receivers)?;
                let seconds = start.elapsed().as_secs_f64();
                *given.borrow_mut() = visibility;
                Ok(seconds)
            };
            Subject { name: (*name).to_owned(), run: Box::new(run) }
        })
        .collect();
    let times = least(&subjects, options.budget, &Progress::new(name))?;
    drop(subjects);
    let given: Vec<Vec<f32>> = given.into_iter().map(RefCell::into_inner).collect();

    let looking: Vec<bool> = receivers
        .points()
        .iter()
        .zip(receivers.facings())
        .map(|(point, facing)| !facing.is_away_from(&problem.light, *point))
        .collect();
    let [exact, ..] = &given[..] else { unreachable!("exact masks come first") };
    let lines = ways.into_iter().zip(times).zip(&given).map(|((way, time), given)| {
        let errors = errors(given, exact, &looking);
        Line { name: way.name, seconds: time.seconds, errors }
    });
    let count = |of: &dyn Fn(f32) -> bool| exact.iter().zip(&looking).filter(|(v, looks)| **looks && of(**v)).count();
    let receivers = [count(&|_| true), count(&is_partly_lit), count(&|v| v == 0.0), count(&|v| v == 1.0)];
    Ok(Measured { scene: name.to_owned(), receivers, lines: lines.collect() })
}

fn is_partly_lit(visibility: f32) -> bool {
    visibility > 0.0 && visibility < 1.0
}

/// `looking`: who counts. What nobody is in is NaN.
fn errors(given: &[f32], exact: &[f32], looking: &[bool]) -> Errors {
    let mean = |of: &dyn Fn(f32) -> bool| {
        let own = given.iter().zip(exact).zip(looking).filter(|((_, exact), looks)| **looks && of(**exact));
        let (sum, count) = own.fold((0.0, 0.0), |(sum, count), ((given, exact), _)| {
            (sum + f64::from((given - exact).abs()), count + 1.0)
        });
        sum / count
    };
    Errors {
        all: mean(&|_| true),
        penumbrae: mean(&is_partly_lit),
        umbrae: mean(&|v| v == 0.0),
        lit: mean(&|v| v == 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_who_looks_and_of_who_is_meant() {
        let (exact, given) = ([0.0, 0.5, 1.0, 1.0, 0.0], [0.25, 0.25, 0.5, 1.0, 1.0]);
        let errors = errors(&given, &exact, &[true, true, true, true, false]);
        assert_eq!(errors, Errors { all: 0.25, penumbrae: 0.25, umbrae: 0.25, lit: 0.25 });
        assert!(super::errors(&given, &exact, &[false; 5]).all.is_nan());
    }
}
