//! umbra4 on a GPU against a ray tracer on the same GPU: same receivers and light, runs interleaved, least times.

use std::path::PathBuf;

use thiserror::Error;
use umbra4_cpu::Occluders;
use umbra4_wgpu::{Gpu, GpuError, LatticeScene, Loading, Precision, Statistics, WgpuExecutor, wgpu::Features};

use crate::{
    gpu_rival::{Answer, GpuRival, Traced},
    gpu_table::{Differing, Line, RivalFigures},
    image_size::ImageSize,
    primary::{Hit, hits},
    problem::{Problem, ProblemError},
    scene::{Scene, SceneError, scene},
    subset,
};

/// Receivers whose masks are compared, in whole 8×8 image tiles; of the others it is the lit counts.
const MASKS_COMPARED: usize = 16_384;

/// Why a comparison stops.
#[derive(Debug, Error)]
pub enum GpuBenchError {
    /// A scene cannot be set up.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene does not fit the lattice.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// umbra4 refuses the occluders.
    #[error(transparent)]
    Occluders(#[from] umbra4_cpu::SceneError),
    /// The device fails, or does not hold the scene.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The table cannot be written.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

/// What is compared.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where the models are.
    pub scenes: PathBuf,
    /// Names of the scenes.
    pub names: Vec<String>,
    /// Sizes of the image.
    pub sizes: Vec<ImageSize>,
    /// Rows and columns of the light's samples.
    pub samples: Vec<u32>,
    /// Precisions of umbra4.
    pub precisions: Vec<Precision>,
    /// How kernels reach the driver.
    pub loading: Loading,
    /// The diagonal of the light in the paper's units.
    pub light: f64,
    /// Runs of everybody.
    pub repeat: usize,
    /// Whether the rival runs.
    pub rival: bool,
    /// At most about so many receivers for the rival.
    pub rival_receivers: usize,
    /// Chooses the subsets.
    pub seed: u64,
}

/// Runs everything, says on stderr what is going on, and adds a line for every scene, size, number of samples and
/// precision; those done before an error stay.
///
/// # Errors
/// An unknown scene; a device that fails.
pub fn compare(gpu: &Gpu, options: &Options, lines: &mut Vec<Line>) -> Result<(), GpuBenchError> {
    let subjects = options.precisions.iter().map(|&precision| Subject::new(gpu, options.loading, precision));
    let subjects = subjects.collect::<Result<Vec<_>, _>>()?;
    for name in &options.names {
        let Some(&samples) = options.samples.first() else { return Ok(()) };
        let mut scene = scene(name, &options.scenes, samples, options.light)?;
        let rival = if options.rival {
            eprintln!("{name}: building the rival's hierarchy");
            Some(GpuRival::new(gpu, &scene.model, options.loading)?)
        } else {
            None
        };
        for &size in &options.sizes {
            let all = hits(&scene.model, &scene.camera, size);
            for &samples in &options.samples {
                scene = scene.with_samples(samples)?;
                let setting = Setting { name, size, samples, scene: &scene, all: &all, options };
                lines.extend(setting.measure(&subjects, rival.as_ref())?);
            }
        }
    }
    Ok(())
}

/// umbra4 in one precision.
struct Subject {
    precision: Precision,
    /// For the time that the host sees.
    plain: WgpuExecutor,
    /// For the times of stages, where the device has timestamps.
    timed: Option<WgpuExecutor>,
    /// With kernels loaded the other way, where the device can: what wgpu's checks cost.
    other: Option<WgpuExecutor>,
}

impl Subject {
    fn new(gpu: &Gpu, loading: Loading, precision: Precision) -> Result<Self, GpuError> {
        let executor = || WgpuExecutor::new(gpu.clone()).with_precision(precision).with_loading(loading);
        let timed = gpu.device.features().contains(Features::TIMESTAMP_QUERY);
        let other_way = match loading {
            Loading::Checked => Loading::Passthrough,
            Loading::Passthrough => Loading::Checked,
        };
        let other = WgpuExecutor::new(gpu.clone()).with_precision(precision).with_loading(other_way).ok();
        let other = other.map(|executor| executor.with_stage_times(timed));
        let timed = timed.then(|| executor().map(|executor| executor.with_stage_times(true))).transpose()?;
        Ok(Self { precision, plain: executor()?, timed, other })
    }
}

/// What is known of umbra4 in one precision.
struct Measured {
    host: f64,
    /// Of the run whose stages took the least time together.
    stages: Option<Vec<(&'static str, f64)>>,
    /// Least seconds with kernels loaded the other way: of all stages, where they are known.
    other: Option<f64>,
    lit: Vec<u32>,
}

/// Seconds of all stages, or of the host where those are not known.
fn seconds(statistics: &Statistics) -> f64 {
    match &statistics.stages[..] {
        [] => statistics.time.as_secs_f64(),
        stages => stages.iter().map(|(_, seconds)| seconds).sum(),
    }
}

/// Of two runs' stages, those that took less time together.
fn faster(old: Option<Vec<(&'static str, f64)>>, new: Vec<(&'static str, f64)>) -> Vec<(&'static str, f64)> {
    let sum = |stages: &[(&'static str, f64)]| stages.iter().map(|(_, seconds)| seconds).sum::<f64>();
    match old {
        Some(old) if sum(&old) <= sum(&new) => old,
        _ => new,
    }
}

/// One scene, image and light.
struct Setting<'a> {
    name: &'a str,
    size: ImageSize,
    samples: u32,
    scene: &'a Scene,
    all: &'a [Hit],
    options: &'a Options,
}

/// A problem and its occluders on the lattice.
struct Posed<'a> {
    problem: Problem<'a>,
    occluders: Occluders,
}

impl Posed<'_> {
    fn scene(&self) -> LatticeScene<'_> {
        LatticeScene { vertices: self.occluders.vertices(), triangles: self.occluders.triangles() }
    }

    /// Lit samples of every receiver.
    fn lit(&self, executor: &WgpuExecutor) -> Result<(Vec<u32>, Statistics), GpuError> {
        let Problem { light, receivers, .. } = &self.problem;
        let (visibility, statistics) = executor.visibility(&self.scene(), light, receivers.points())?;
        let samples = light.sample_count() as f32;
        Ok((visibility.iter().map(|share| (share * samples).round() as u32).collect(), statistics))
    }

    /// Masks in words of 32 bits.
    fn masks(&self, executor: &WgpuExecutor) -> Result<Vec<u32>, GpuError> {
        let (scene, Problem { light, receivers, .. }) = (self.scene(), &self.problem);
        Ok(match light.columns {
            ..=32 => executor.masks::<u32>(&scene, light, receivers.points())?.0,
            _ => bytemuck::cast_slice(&executor.masks::<u64>(&scene, light, receivers.points())?.0).to_vec(),
        })
    }
}

impl<'a> Setting<'a> {
    fn pose(&self, chosen: &[usize]) -> Result<Posed<'a>, GpuBenchError> {
        let hits: Vec<Hit> = chosen.iter().map(|&index| self.all[index]).collect();
        let problem = Problem::new(self.scene, self.all, &hits)?;
        let occluders = Occluders::new(&problem.lattice, &problem.model.vertices, &problem.model.triangles)?;
        Ok(Posed { problem, occluders })
    }

    /// Hits that the rival is measured on, tile after tile.
    fn of_rival(&self) -> Vec<usize> {
        let wanted = self.options.rival_receivers;
        if wanted < self.all.len() {
            subset::tiles(self.all, wanted, self.options.seed)
        } else {
            subset::in_tile_order(self.all)
        }
    }

    fn measure(&self, subjects: &[Subject], rival: Option<&GpuRival>) -> Result<Vec<Line>, GpuBenchError> {
        let ours = self.pose(&Vec::from_iter(0..self.all.len()))?;
        let rival_indices = self.of_rival();
        let theirs = self.pose(&rival_indices)?;
        let nothing = |_: &Subject| Measured { host: f64::MAX, stages: None, other: None, lit: Vec::new() };
        let mut measured: Vec<Measured> = subjects.iter().map(nothing).collect();
        let mut traced: Option<Traced> = None;
        let repeat = self.options.repeat.max(1);
        for run in 1..=repeat {
            for (subject, measured) in subjects.iter().zip(&mut measured) {
                self.say(&format!("umbra4, {:?}", subject.precision), run, repeat);
                let (lit, statistics) = ours.lit(&subject.plain)?;
                measured.host = measured.host.min(statistics.time.as_secs_f64());
                measured.lit = lit;
                if let Some(timed) = &subject.timed {
                    let (_, statistics) = ours.lit(timed)?;
                    let old = measured.stages.take();
                    measured.stages = Some(faster(old, statistics.stages));
                }
                if let Some(other) = &subject.other {
                    let (_, statistics) = ours.lit(other)?;
                    let least = measured.other.unwrap_or(f64::MAX);
                    measured.other = Some(seconds(&statistics).min(least));
                }
            }
            if let Some(rival) = rival {
                self.say("rival", run, repeat);
                let Traced { words, seconds } = rival.trace(Answer::Lit, &theirs.problem)?;
                let least = traced.map_or(f64::MAX, |old| old.seconds);
                traced = Some(Traced { words, seconds: seconds.min(least) });
            }
        }
        let differing = match rival {
            Some(rival) => self.differing_masks(subjects, rival, &rival_indices)?,
            None => Vec::new(),
        };
        let lines = subjects.iter().zip(measured).enumerate().map(|(index, (subject, measured))| {
            let figures = rival.zip(traced.as_ref()).zip(differing.get(index)).map(|((rival, traced), &masks)| {
                let ours = rival_indices.iter().map(|&index| measured.lit[index]);
                RivalFigures {
                    build_seconds: rival.build_seconds,
                    seconds: traced.seconds * self.all.len() as f64 / rival_indices.len().max(1) as f64,
                    receivers: rival_indices.len(),
                    lit: Differing::of_counts(ours, &traced.words, self.samples * self.samples),
                    masks,
                }
            });
            Line {
                scene: self.name.to_owned(),
                triangles: self.scene.model.triangles.len(),
                size: self.size,
                receivers: self.all.len(),
                samples: self.samples,
                precision: subject.precision,
                host_seconds: measured.host,
                stages: measured.stages.unwrap_or_default(),
                loading: self.options.loading,
                other_loading_seconds: measured.other,
                rival: figures,
            }
        });
        Ok(lines.collect())
    }

    /// Bits of masks that differ from the rival's, for every subject, on some of the rival's receivers.
    fn differing_masks(
        &self,
        subjects: &[Subject],
        rival: &GpuRival,
        indices: &[usize],
    ) -> Result<Vec<Differing>, GpuBenchError> {
        let hits: Vec<Hit> = indices.iter().map(|&index| self.all[index]).collect();
        let chosen = subset::tiles(&hits, MASKS_COMPARED, self.options.seed);
        let posed = self.pose(&chosen.iter().map(|&index| indices[index]).collect::<Vec<_>>())?;
        let theirs = rival.trace(Answer::Masks, &posed.problem)?.words;
        let bits = chosen.len() as u64 * u64::from(self.samples * self.samples);
        let of_subject = |subject: &Subject| Ok(Differing::of_masks(&posed.masks(&subject.plain)?, &theirs, bits));
        subjects.iter().map(of_subject).collect()
    }

    fn say(&self, what: &str, run: usize, runs: usize) {
        let Self { name, size, samples, .. } = self;
        eprintln!("{name}, {size}, {samples}² samples: {what}, run {run} of {runs}");
    }
}
