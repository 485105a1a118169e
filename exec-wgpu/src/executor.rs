//! The executor that users hold: options, and the ways to ask.

use std::{
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use umbra4_core::{
    AnyLight, Counts, LatticeLight, MaskWord, Plan, Precision, Punctual, SceneFacts,
    emission::{Emission, Weight},
    glam::{IVec3, Vec3},
    irradiance::{PackedSample, samples, unit},
    kernel::{
        dispatch::{MaskLayout, Reduction},
        resolve::{ReceiverCounts, stride},
        weigh::{PackedWeight, packed},
    },
    light::MAX_SAMPLES,
    proj4::NODE,
    stage::reduce,
};

use crate::{
    Gpu, GpuError, LatticeReceivers, LatticeScene, Loading, Statistics, checks,
    host::{Asked, Host, Illuminated, Results},
    light_run::{LightRun, RunLight, faces_with, meet},
    recorder::Recorder,
    scratch::Scratch,
    stages::{BLOCK, Buffers, SMALLEST_SLICE, block, mask_layout, narrowest, slice},
    timing::Timing,
    usable,
};

/// Samples of a light, at most.
const MOST_SAMPLES: u64 = MAX_SAMPLES as u64 * MAX_SAMPLES as u64;

/// Runs the stages on a GPU.
///
/// ```no_run
/// use umbra4_core::{glam::{DVec3, Vec3}, AreaLight, Bounds, Lattice, Lift};
/// use umbra4_wgpu::{Choice, Gpu, LatticeScene, WgpuExecutor};
///
/// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?; // X × Z = −Y: shines down
/// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
/// let corners = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
/// let vertices = [lattice.snap(corners[0])?, lattice.snap(corners[1])?, lattice.snap(corners[2])?];
/// let receivers = [lattice.snap(Vec3::ZERO)?, lattice.snap(Vec3::new(3.0, 0.0, 0.0))?];
///
/// let executor = WgpuExecutor::new(Gpu::open(&Choice::Hardware)?);
/// let scene = LatticeScene { vertices: &vertices, triangles: &[[0, 1, 2]] };
/// let (visibility, _) = executor.visibility(&scene, &light.snap(&lattice, Lift::NONE)?, &receivers)?;
/// assert!(visibility[0] < 0.5 && visibility[1] == 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct WgpuExecutor {
    pub(crate) gpu: Gpu,
    pub(crate) precision: Precision,
    loading: Loading,
    pub(crate) counted: bool,
    timed: bool,
    pub(crate) block: u32,
    work: Mutex<Option<Work>>,
}

/// What is kept from run to run.
#[derive(Debug)]
struct Work {
    recorder: Recorder,
    scratch: Scratch,
}

impl WgpuExecutor {
    /// An exact executor. Kernels are compiled when they are first needed.
    pub fn new(gpu: Gpu) -> Self {
        Self {
            gpu,
            precision: Precision::Exact,
            loading: Loading::Checked,
            counted: false,
            timed: false,
            block: BLOCK,
            work: Mutex::default(),
        }
    }

    /// Chooses the precision.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Works on at most `receivers` receivers at once, at least on one: bounds the memory on the device. (The masks of a light
    /// without extent, a word each, are those of all receivers nevertheless, as are the counts, if there are any.)
    #[must_use]
    pub fn with_block(mut self, receivers: u32) -> Self {
        self.block = receivers.max(1);
        self
    }

    /// Counts pairs and fallbacks as well, which takes a little longer.
    #[must_use]
    pub fn with_counts(mut self, counted: bool) -> Self {
        self.counted = counted;
        self
    }

    /// Takes the time of every stage on the device, where it has timestamps. Stages no longer overlap then.
    #[must_use]
    pub fn with_stage_times(mut self, timed: bool) -> Self {
        self.timed = timed;
        self.work = Mutex::default();
        self
    }

    /// Chooses how kernels reach the driver: the same bits in another time.
    ///
    /// # Errors
    /// The device cannot load them so.
    pub fn with_loading(mut self, loading: Loading) -> Result<Self, GpuError> {
        loading.check(&self.gpu.device)?;
        self.loading = loading;
        self.work = Mutex::default();
        Ok(self)
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The masks of all receivers, receiver-major, a word per row of the light.
    ///
    /// # Errors
    /// The word is too narrow for the light; a buffer is larger than the device can bind; the device fails.
    pub fn masks<'a, W: MaskWord>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<W>, Statistics), GpuError> {
        let ask = Asked { masks: true, counts: self.counted, ..Asked::default() };
        let (results, statistics) = self.run(scene, &(*light).into(), receivers.into(), W::BITS, ask)?;
        Ok((words(&results.masks, light.rows as usize, stride(light.rows, W::BITS) as usize), statistics))
    }

    /// The fraction of lit samples of every receiver, in `0.0..=1.0`. Masks do not leave the device.
    ///
    /// # Errors
    /// As [`WgpuExecutor::masks`]; the word is chosen to fit the light.
    pub fn visibility<'a>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<f32>, Statistics), GpuError> {
        let (lit, statistics) = self.lit_counts(scene, light, receivers)?;
        let samples = light.sample_count();
        Ok((lit.iter().map(|&lit| reduce::visibility(lit, samples)).collect(), statistics))
    }

    /// The lit samples of every receiver, `0..=light.sample_count()`: what [`umbra4_core::accumulate`] adds up over frames.
    ///
    /// # Errors
    /// As [`WgpuExecutor::visibility`].
    pub fn lit_counts<'a>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let ask = Asked { counts: self.counted, visibility: true, ..Asked::default() };
        let light = (*light).into();
        let (results, statistics) = self.run(scene, &light, receivers.into(), narrowest(&light), ask)?;
        Ok((results.lit, statistics))
    }

    /// The light that every receiver gets, red, green and blue: sums of the weights of lit samples, of which
    /// [`Emission::fraction`] makes fractions. Masks do not leave the device.
    ///
    /// # Errors
    /// As [`WgpuExecutor::visibility`]; an emission of another number of rows or columns than the light's.
    pub fn light<'a, S: AsRef<[Weight]>>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
        emission: &Emission<S>,
    ) -> Result<(Vec<[u32; 3]>, Statistics), GpuError> {
        let size = [light.rows, light.columns];
        if emission.size() != size {
            return Err(GpuError::EmissionSize { emission: emission.size(), light: size });
        }
        let weights: Vec<PackedWeight> = emission.weights().iter().map(|weight| packed(*weight)).collect();
        let ask = Asked { counts: self.counted, visibility: true, weights: Some(&weights), ..Asked::default() };
        let light = (*light).into();
        let (results, statistics) = self.run(scene, &light, receivers.into(), narrowest(&light), ask)?;
        Ok((results.weighed, statistics))
    }

    /// The irradiance of every receiver, red, green and blue, of a Lambertian surface with the given normal (of any length): see
    /// [`umbra4_core::irradiance`] for the formula and its error. Masks do not leave the device.
    ///
    /// # Errors
    /// As [`WgpuExecutor::light`]; another number of normals than receivers; the first normal that is zero or not finite.
    pub fn irradiance<'a, S: AsRef<[Weight]>>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
        normals: &[Vec3],
        emission: &Emission<S>,
    ) -> Result<(Vec<[f32; 3]>, Statistics), GpuError> {
        let (receivers, size) = (receivers.into(), [light.rows, light.columns]);
        if emission.size() != size {
            return Err(GpuError::EmissionSize { emission: emission.size(), light: size });
        }
        if normals.len() != receivers.points.len() {
            return Err(GpuError::NormalCount { normals: normals.len(), receivers: receivers.points.len() });
        }
        let of = |(index, normal): (usize, &Vec3)| unit(*normal).ok_or(GpuError::Normal { index, normal: *normal });
        let normals: Vec<Vec3> = normals.iter().enumerate().map(of).collect::<Result<_, _>>()?;
        let samples: Vec<PackedSample> = samples(light, emission).collect();
        let irradiance = Some(Illuminated { normals: &normals, samples: &samples });
        let ask = Asked { counts: self.counted, irradiance, ..Asked::default() };
        let light = (*light).into();
        let (results, statistics) = self.run(scene, &light, receivers, narrowest(&light), ask)?;
        Ok((results.irradiance, statistics))
    }

    /// The shadow of a light without extent, a bit a receiver, 1 where the light does not reach it: bit n of word w is receiver
    /// 32·w + n; bits beyond the last receiver are 0.
    ///
    /// # Errors
    /// As [`WgpuExecutor::visibility`].
    pub fn hard_shadows<'a>(
        &self,
        scene: &LatticeScene<'_>,
        light: &Punctual,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let ask = Asked { counts: self.counted, visibility: true, ..Asked::default() };
        let light = (*light).into();
        let (results, statistics) = self.run(scene, &light, receivers.into(), narrowest(&light), ask)?;
        let word = |lit: &[u32]| lit.iter().rev().fold(0, |word, lit| word << 1 | u32::from(*lit == 0));
        Ok((results.lit.chunks(32).map(word).collect(), statistics))
    }

    /// How many triangles block at least one sample of each receiver; for receivers in full shadow, how many were met
    /// until nothing was left to block. Shows where the work goes.
    ///
    /// # Errors
    /// As [`WgpuExecutor::visibility`].
    pub fn pairs_per_receiver<'a>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let ask = Asked { counts: true, ..Asked::default() };
        let light = (*light).into();
        let (results, statistics) = self.run(scene, &light, receivers.into(), narrowest(&light), ask)?;
        Ok((results.counts.iter().map(|[_, _, relevant, _]| *relevant).collect(), statistics))
    }

    /// With rows in words of `bits` bits.
    fn run(
        &self,
        scene: &LatticeScene<'_>,
        light: &AnyLight,
        receivers: LatticeReceivers<'_>,
        bits: u32,
        asked: Asked<'_>,
    ) -> Result<(Results, Statistics), GpuError> {
        if let AnyLight::Area(LatticeLight { columns, .. }) = *light
            && columns > bits
        {
            return Err(GpuError::WordTooNarrow { columns, bits });
        }
        let LatticeReceivers { points, .. } = receivers;
        checks::counts_of(scene, receivers)?;
        let reduction = if asked.weights.is_some() { Reduction::WeighedLight } else { Reduction::LitCounts };
        let layout = mask_layout(light, bits, self.precision, asked.counts, slice(self.gpu.software));
        let layout = MaskLayout { reduction, ..layout };
        let faces = faces_with(light, points);
        // To a receiver where a point is, no triangle matters: it lies in none of its frames.
        let reached = faces != 0 && meet(light, receivers);
        let nothing = LatticeScene { vertices: &[], triangles: &[] };
        let scene = if reached { scene } else { &nothing };
        let facts = SceneFacts {
            triangles: scene.triangles.len() as u32,
            receivers: points.len() as u32,
            visibility: asked.visibility,
            block: block(&layout, self.block),
            jittered: matches!(light, AnyLight::Area(light) if light.jitter.is_some()),
            reached,
            facing: !receivers.facings.is_empty(),
            punctual: matches!(light, AnyLight::Punctual(_)),
            irradiance: asked.irradiance.is_some(),
            ..SceneFacts::default()
        };
        let bounds = bounds(scene.vertices.iter().chain(points));
        let run = LightRun { light: RunLight::Any(*light), faces: faces.max(1), facts, layout, bounds };
        self.run_light(run, scene, receivers, asked)
    }

    /// Runs the stages for a light, and once more with less to do for each thread where a driver stops them.
    pub(crate) fn run_light(
        &self,
        mut run: LightRun<'_>,
        scene: &LatticeScene<'_>,
        receivers: LatticeReceivers<'_>,
        asked: Asked<'_>,
    ) -> Result<(Results, Statistics), GpuError> {
        let device = &self.gpu.device;
        let plan = Plan::new(run.facts);
        let (results, time) = self.with_work(|recorder, scratch| {
            loop {
                let mut buffers = Buffers::fit(scratch, device, &plan, &run.layout, scene.vertices.len() as u32)?;
                if asked.weights.is_some() {
                    let weights = scratch.fit::<PackedWeight>(device, "weights", MOST_SAMPLES)?;
                    let sums = scratch.fit::<[u32; 3]>(device, "weighed light", receivers.points.len() as u64)?;
                    buffers.emission = Some([(&weights).into(), (&sums).into()]);
                }
                if let Some(Illuminated { normals, samples }) = asked.irradiance {
                    buffers.irradiance = Some([
                        scratch.fit::<[f32; 3]>(device, "normals", normals.len() as u64)?,
                        scratch.fit::<PackedSample>(device, "samples of the light", samples.len() as u64)?,
                        scratch.fit::<[f32; 3]>(device, "irradiance", normals.len() as u64)?,
                    ]);
                }
                if let Some(words) = asked.planes {
                    buffers.planes = Some(scratch.fit::<u32>(device, "table of planes", words.len() as u64)?);
                }
                let mut host = Host::new(&self.gpu, asked, run.layout.stride);
                host.upload(&buffers, scene, receivers)?;
                recorder.restart();
                recorder.clear(&buffers.masks, buffers.stopped());
                run.record(recorder, &buffers, &mut host)?;
                let results = host.finish(recorder, &buffers)?;
                match results.stopped {
                    false => return Ok(results),
                    // The driver ended threads before they were done: they get less to do.
                    true if run.layout.slice > SMALLEST_SLICE => {
                        run.layout.slice = (run.layout.slice / NODE as u32).max(SMALLEST_SLICE);
                    }
                    true => return Err(GpuError::Stopped { adapter: self.gpu.name.clone() }),
                }
            }
        })?;
        let counts = asked.counts.then(|| sum(&results.counts));
        let stages = results.stages.clone();
        Ok((results, Statistics { time, counts, stages }))
    }

    /// Does something with what is kept from run to run; and how long it took, but for kernels that had to be compiled.
    pub(crate) fn with_work<T>(
        &self,
        run: impl FnOnce(&mut Recorder, &mut Scratch) -> Result<T, GpuError>,
    ) -> Result<(T, Duration), GpuError> {
        let device = &self.gpu.device;
        let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        let Work { recorder, scratch } = match &mut *work {
            Some(work) => work,
            None => {
                // Whoever made the device: the rule is the same.
                usable::check(&device.adapter_info(), &device.limits())?;
                let timing = if self.timed { Timing::new(device)? } else { None };
                let recorder = Recorder::new(device, self.loading, timing);
                work.insert(Work { recorder, scratch: Scratch::default() })
            }
        };
        let compiling = recorder.pipelines().time();
        let start = Instant::now();
        let done = run(recorder, scratch)?;
        Ok((done, start.elapsed().saturating_sub(recorder.pipelines().time() - compiling)))
    }
}

/// The box around points.
pub(crate) fn bounds<'a>(points: impl Iterator<Item = &'a IVec3>) -> [IVec3; 2] {
    points.fold([IVec3::MAX, IVec3::MIN], |[low, high], p| [low.min(*p), high.max(*p)])
}

/// The words of all masks: each receiver's start at a word of 32 bits.
pub(crate) fn words<W: MaskWord>(masks: &[u32], rows: usize, stride: usize) -> Vec<W> {
    let mut out = Vec::with_capacity(masks.len() / stride.max(1) * rows);
    for mask in masks.chunks_exact(stride) {
        // On a big-endian host the halves of words would have to be swapped; wgpu runs on none.
        out.extend_from_slice(&bytemuck::pod_collect_to_vec::<u32, W>(mask)[..rows]);
    }
    out
}

fn sum(receivers: &[ReceiverCounts]) -> Counts {
    let mut counts = Counts::default();
    for [tested, kept, relevant, fallbacks] in receivers {
        counts = counts.plus(Counts {
            pairs_tested: u64::from(*tested),
            pairs_kept: u64::from(*kept),
            pairs_relevant: u64::from(*relevant),
            fallbacks: u64::from(*fallbacks),
            ..Counts::default()
        });
    }
    counts
}
