//! Measures the stages of umbra4 on one scene.

use std::{cell::RefCell, path::Path, time::Instant};

use umbra4_core::Counts;
use umbra4_cpu::{CpuExecutor, Index, Occluders};

use crate::{
    compare::CompareError,
    contender::ContenderError,
    image_size::ImageSize,
    lookup::seconds_a_pair,
    primary::hits,
    problem::Problem,
    row_word::RowWord,
    scene::{PAPER_LIGHT, scene},
    subset,
    timing::{Budget, Progress, Subject, least},
    umbra::snapped,
};

/// Receivers on which the rows alone are measured.
const FLOOR_RECEIVERS: usize = 2048;

/// What is measured.
pub(super) struct Options<'a> {
    /// Where the models are.
    pub(super) scenes: &'a Path,
    /// Rows and columns of the light.
    pub(super) samples: u32,
    pub(super) threads: usize,
    /// Edge of the image, pixels.
    pub(super) size: u32,
    /// Chooses the receivers of the floor.
    pub(super) seed: u64,
    pub(super) budget: Budget,
}

/// A run: the fastest.
#[derive(Clone, Debug, Default)]
pub(super) struct Times {
    /// From the coordinates that are given to the last mask.
    pub(super) seconds: f64,
    pub(super) by_stage: Vec<(&'static str, f64)>,
    pub(super) counts: Counts,
}

impl Times {
    /// Seconds of some stages together.
    pub(super) fn of(&self, stages: &[&str]) -> f64 {
        self.by_stage.iter().filter(|(name, _)| stages.contains(name)).map(|(_, seconds)| seconds).sum()
    }
}

/// One way to run on one scene.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) scene: String,
    /// How the mesh comes.
    pub(super) mesh: &'static str,
    pub(super) receivers: usize,
    pub(super) times: Times,
    /// Pairs of a receiver and a triangle that blocks a sample of it; of receivers in full shadow, those met until then.
    pub(super) relevant: u64,
    /// Seconds of the rows of those pairs, on one thread.
    pub(super) floor: f64,
}

/// Measures the scene called `name`: with its index made anew, and with the mesh arranged before.
///
/// # Errors
/// An unknown scene; whatever umbra4 refuses.
pub(super) fn measure<W: RowWord>(name: &str, options: &Options<'_>) -> Result<Vec<Line>, CompareError> {
    let scene = scene(name, options.scenes, options.samples, PAPER_LIGHT)?;
    let all = hits(&scene.model, &scene.camera, ImageSize::square(options.size));
    let problem = Problem::new(&scene, &all, &all)?;
    let executor = CpuExecutor::new().with_threads(options.threads).map_err(ContenderError::from)?;

    let snap = || snapped(&problem);
    let arranged = RefCell::new(snap().map_err(ContenderError::from)?.arranged());
    let run = |fastest: &RefCell<Times>, arranged: Option<&RefCell<Occluders>>| {
        let start = Instant::now();
        let resolved = match arranged {
            None => executor.masks::<W>(&snap()?, &problem.light, &problem.receivers),
            Some(occluders) => {
                occluders.borrow_mut().move_vertices(&problem.lattice, &problem.model.vertices)?;
                executor.masks::<W>(&occluders.borrow(), &problem.light, &problem.receivers)
            }
        };
        let (masks, statistics) = resolved?;
        let seconds = start.elapsed().as_secs_f64();
        drop(masks);
        let mut fastest = fastest.borrow_mut();
        if fastest.by_stage.is_empty() || seconds < fastest.seconds {
            *fastest = Times { seconds, by_stage: statistics.seconds_by_stage, counts: statistics.counts };
        }
        Ok(seconds)
    };
    let (anew, again) = (RefCell::default(), RefCell::default());
    let subjects = [
        Subject { name: "anew".to_owned(), run: Box::new(|| run(&anew, None)) },
        Subject { name: "arranged".to_owned(), run: Box::new(|| run(&again, Some(&arranged))) },
    ];
    least(&subjects, options.budget, &Progress::new(name))?;
    drop(subjects);

    let one_by_one = executor.with_index(Index::Hierarchy);
    let occluders = snap().map_err(ContenderError::from)?;
    let (_, statistics) =
        one_by_one.masks::<W>(&occluders, &problem.light, &problem.receivers).map_err(ContenderError::from)?;
    let relevant = statistics.counts.pairs_relevant;
    let some: Vec<_> = subset::tiles(&all, FLOOR_RECEIVERS, options.seed).into_iter().map(|i| all[i]).collect();
    let floor = relevant as f64 * seconds_a_pair::<W>(&Problem::new(&scene, &all, &some)?, options.budget)?;
    let line = |mesh, times: RefCell<Times>| Line {
        scene: name.to_owned(),
        mesh,
        receivers: all.len(),
        times: times.into_inner(),
        relevant,
        floor,
    };
    Ok(vec![line("anew", anew), line("arranged", again)])
}
