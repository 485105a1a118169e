//! Measures one scene: all contenders and numbers of samples interleaved.

use std::path::Path;

use crate::{
    compare::CompareError,
    image_size::ImageSize,
    scene::scene,
    timing::{Budget, Case, Progress, Subject, least},
};

/// The contender that all others are compared with.
pub(super) const OURS: &str = "umbra4";

/// What is measured.
pub(super) struct Options<'a> {
    pub(super) scenes: &'a Path,
    /// Contenders beside umbra4.
    pub(super) rivals: &'a [String],
    /// Rows and columns of the light, one number after the other.
    pub(super) samples: &'a [u32],
    /// Threads of umbra4 that are compared with one.
    pub(super) threads: usize,
    /// Edge of the image, pixels.
    pub(super) size: u32,
    /// The diagonal of the light in the paper's units.
    pub(super) light: f64,
    /// At most about so many receivers for the rivals.
    pub(super) rival_receivers: usize,
    /// Chooses them.
    pub(super) seed: u64,
    pub(super) budget: Budget,
}

/// One contender with one number of samples.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Time {
    /// Rows and columns of the light.
    pub(super) samples: u32,
    pub(super) contender: String,
    pub(super) threads: usize,
    /// Least seconds of the whole image, building included.
    pub(super) seconds: f64,
    pub(super) runs: usize,
}

/// One scene.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    pub(super) scene: String,
    pub(super) triangles: usize,
    pub(super) receivers: usize,
    pub(super) times: Vec<Time>,
}

impl Sweep {
    /// Seconds of one contender, where it ran.
    pub(super) fn seconds(&self, samples: u32, contender: &str, threads: usize) -> Option<f64> {
        let same = |time: &&Time| (time.samples, &*time.contender, time.threads) == (samples, contender, threads);
        self.times.iter().find(same).map(|time| time.seconds)
    }

    /// The numbers of samples, in the order they were asked for.
    pub(super) fn samples(&self) -> Vec<u32> {
        let mut samples: Vec<u32> = self.times.iter().map(|time| time.samples).collect();
        samples.dedup();
        samples
    }
}

/// Measures the scene called `name`.
///
/// # Errors
/// An unknown scene or contender; whatever a contender refuses.
pub(super) fn measure(name: &str, options: &Options<'_>) -> Result<Sweep, CompareError> {
    let scene = scene(name, options.scenes, 1, options.light)?;
    let triangles = scene.model.triangles.len();
    let base = Case::new(scene, ImageSize::square(options.size), options.rival_receivers, options.seed);
    let with = |&samples: &u32| base.with(|scene| scene.with_samples(samples));
    let cases = options.samples.iter().map(with).collect::<Result<Vec<_>, _>>()?;
    let posed = cases.iter().map(Case::pose).collect::<Result<Vec<_>, _>>()?;

    let (mut times, mut subjects) = (Vec::new(), Vec::new());
    for (&samples, posed) in options.samples.iter().zip(&posed) {
        let alone = options.rivals.iter().map(|rival| (rival.as_str(), 1));
        let threaded = (options.threads > 1).then_some((OURS, options.threads));
        for (contender, threads) in [(OURS, 1)].into_iter().chain(threaded).chain(alone) {
            let subject = format!("{samples}² samples: {contender}, threads: {threads}");
            subjects.push(Subject { name: subject, run: Box::new(move || posed.seconds(contender, threads)) });
            times.push(Time { samples, contender: contender.to_owned(), threads, seconds: 0.0, runs: 0 });
        }
    }
    let results = least(&subjects, options.budget, &Progress::new(name))?;
    for (time, result) in times.iter_mut().zip(results) {
        (time.seconds, time.runs) = (result.seconds, result.runs);
    }
    let receivers = posed.first().map_or(0, |posed| posed.receivers());
    Ok(Sweep { scene: name.to_owned(), triangles, receivers, times })
}
