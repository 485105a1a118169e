//! Where the work is done: on the processor, or on a GPU. The bits are the same.

use umbra4_core::{Counts, LatticeLight, Plan, Punctual, cloud::Cloud, glam::IVec3};
use umbra4_cpu::{CpuExecutor, CpuWord, Occluders, Receivers, maps::Technique};
use umbra4_wgpu::{Choice, Gpu, LatticeReceivers, LatticeScene, WgpuExecutor};

use crate::{
    args::{ExecutorArg, MachineArgs, PrecisionArg, WorkArgs},
    error::ProgramError,
    light::Weights,
};

/// What is asked about.
pub type Scene<'a> = (&'a Occluders, &'a LatticeLight, &'a Receivers);

/// An executor of either kind.
pub enum AnyExecutor {
    /// On rayon's threads.
    Cpu(CpuExecutor),
    /// On a GPU; the other is for plans, which are the processor's.
    Gpu(Box<WgpuExecutor>, CpuExecutor),
}

/// What a run did, whoever ran it.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Names of stages, and their seconds.
    pub seconds_by_stage: Vec<(String, f64)>,
    /// Pairs and fallbacks.
    pub counts: Counts,
}

impl Report {
    /// All stages.
    pub fn seconds(&self) -> f64 {
        self.seconds_by_stage.iter().map(|(_, seconds)| seconds).sum()
    }

    /// Adds the seconds of a stage, to its own if it has been there before.
    pub fn add_stage(&mut self, stage: &str, seconds: f64) {
        match self.seconds_by_stage.iter_mut().find(|(name, _)| name == stage) {
            Some((_, sum)) => *sum += seconds,
            None => self.seconds_by_stage.push((stage.to_owned(), seconds)),
        }
    }

    /// Adds another run, stage by stage.
    pub fn add(&mut self, other: &Self) {
        other.seconds_by_stage.iter().for_each(|(stage, seconds)| self.add_stage(stage, *seconds));
        self.counts = self.counts.plus(other.counts);
    }
}

impl From<umbra4_cpu::Statistics> for Report {
    fn from(statistics: umbra4_cpu::Statistics) -> Self {
        let stages = statistics.seconds_by_stage.iter().map(|(name, s)| ((*name).to_owned(), *s));
        Self { seconds_by_stage: stages.collect(), counts: statistics.counts }
    }
}

impl From<umbra4_wgpu::Statistics> for Report {
    fn from(statistics: umbra4_wgpu::Statistics) -> Self {
        let mut stages: Vec<(String, f64)> =
            statistics.stages.iter().map(|(stage, seconds)| ((*stage).to_owned(), *seconds)).collect();
        // What the host waited for beyond that: uploads, results; or all of it, where the device takes no time.
        let named: f64 = stages.iter().map(|(_, seconds)| seconds).sum();
        let rest = if stages.is_empty() { "gpu" } else { "transfer" };
        stages.push((rest.to_owned(), (statistics.time.as_secs_f64() - named).max(0.0)));
        Self { seconds_by_stage: stages, counts: statistics.counts.unwrap_or_default() }
    }
}

impl AnyExecutor {
    /// The one that the command line asks for. Threads of the processor are rayon's global ones: their number holds for the
    /// rest of the program too.
    ///
    /// # Errors
    /// The system refuses the threads; there is no such adapter.
    pub fn new(work: &WorkArgs) -> Result<Self, ProgramError> {
        use_threads(&work.machine)?;
        let choice = choice(&work.machine);
        Ok(match work.executor {
            ExecutorArg::Cpu => Self::cpu(work.precision),
            ExecutorArg::Gpu => Self::gpu(Gpu::open(&choice)?, work.precision),
            ExecutorArg::Auto => {
                Gpu::open(&choice).map_or_else(|_| Self::cpu(work.precision), |gpu| Self::gpu(gpu, work.precision))
            }
        })
    }

    /// On the processor.
    pub fn cpu(precision: PrecisionArg) -> Self {
        Self::Cpu(processor(precision))
    }

    /// On a GPU.
    pub fn gpu(gpu: Gpu, precision: PrecisionArg) -> Self {
        let executor = WgpuExecutor::new(gpu).with_counts(true).with_stage_times(true);
        Self::Gpu(Box::new(executor.with_precision(precision.into())), processor(precision))
    }

    /// What it runs on.
    pub fn name(&self) -> String {
        match self {
            Self::Cpu(cpu) => format!("cpu, {} threads, {}", rayon::current_num_threads(), cpu.isa()),
            Self::Gpu(gpu, _) => gpu.gpu().name.clone(),
        }
    }

    /// The masks of all receivers, receiver-major.
    ///
    /// # Errors
    /// The executor's.
    pub fn masks<W: CpuWord>(&self, scene: Scene<'_>) -> Result<(Vec<W>, Report), ProgramError> {
        let (occluders, light, receivers) = scene;
        match self {
            Self::Cpu(cpu) => {
                let (masks, statistics) = cpu.masks::<W>(occluders, light, receivers)?;
                Ok((masks.into_words(), statistics.into()))
            }
            Self::Gpu(gpu, _) => {
                let (masks, statistics) = gpu.masks::<W>(&on_lattice(occluders), light, receivers.points())?;
                Ok((masks, statistics.into()))
            }
        }
    }

    /// The fraction of lit samples of every receiver.
    ///
    /// # Errors
    /// The executor's.
    pub fn visibility(&self, scene: Scene<'_>) -> Result<(Vec<f32>, Report), ProgramError> {
        let (occluders, light, receivers) = scene;
        match self {
            Self::Cpu(cpu) => {
                let (visibility, statistics) = cpu.visibility(occluders, light, receivers)?;
                Ok((visibility, statistics.into()))
            }
            Self::Gpu(gpu, _) => {
                let (visibility, statistics) = gpu.visibility(&on_lattice(occluders), light, receivers.points())?;
                Ok((visibility, statistics.into()))
            }
        }
    }

    /// The fraction of the light that every receiver sees, by a technique. Receivers keep their facings.
    ///
    /// # Errors
    /// The executor's.
    pub fn visibility_by(&self, technique: &Technique, scene: Scene<'_>) -> Result<(Vec<f32>, Report), ProgramError> {
        let (occluders, light, receivers) = scene;
        match self {
            Self::Cpu(cpu) => {
                let (visibility, statistics) = cpu.visibility_by(technique, occluders, light, receivers)?;
                Ok((visibility, statistics.into()))
            }
            Self::Gpu(gpu, _) => {
                let receivers =
                    LatticeReceivers { points: receivers.points(), facings: receivers.facings(), layers: &[] };
                let (visibility, statistics) =
                    gpu.visibility_by(technique, &on_lattice(occluders), light, receivers)?;
                Ok((visibility, statistics.into()))
            }
        }
    }

    /// The lit samples of every receiver.
    ///
    /// # Errors
    /// The executor's.
    pub fn lit_counts(&self, scene: Scene<'_>) -> Result<(Vec<u32>, Report), ProgramError> {
        let (occluders, light, receivers) = scene;
        match self {
            Self::Cpu(cpu) => {
                let (lit, statistics) = cpu.lit_counts(occluders, light, receivers)?;
                Ok((lit, statistics.into()))
            }
            Self::Gpu(gpu, _) => {
                let (lit, statistics) = gpu.lit_counts(&on_lattice(occluders), light, receivers.points())?;
                Ok((lit, statistics.into()))
            }
        }
    }

    /// What the processor would run for the fraction of lit samples.
    pub fn plan(&self, scene: Scene<'_>) -> Plan {
        let (occluders, light, receivers) = scene;
        self.processor().plan(occluders, light, receivers, true)
    }

    /// The processor, which has all stages.
    fn processor(&self) -> &CpuExecutor {
        match self {
            Self::Cpu(cpu) | Self::Gpu(_, cpu) => cpu,
        }
    }

    /// Sums of the weights of the lit samples of every receiver.
    ///
    /// # Errors
    /// The executor's.
    pub fn light(&self, scene: Scene<'_>, emission: &Weights) -> Result<(Vec<[u32; 3]>, Report), ProgramError> {
        let (occluders, light, receivers) = scene;
        match self {
            Self::Cpu(cpu) => {
                let (lit, statistics) = cpu.light(occluders, light, receivers, emission)?;
                Ok((lit, statistics.into()))
            }
            Self::Gpu(gpu, _) => {
                let (lit, statistics) = gpu.light(&on_lattice(occluders), light, receivers.points(), emission)?;
                Ok((lit, statistics.into()))
            }
        }
    }

    /// Which receivers a light without extent reaches: 1 where it does, 0 where it is blocked.
    ///
    /// # Errors
    /// The executor's.
    pub fn hard_visibility(
        &self,
        occluders: &Occluders,
        light: &Punctual,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Report), ProgramError> {
        let (words, report) = match self {
            Self::Cpu(cpu) => {
                let (shadows, statistics) = cpu.hard_shadows(occluders, light, receivers)?;
                (shadows.words().to_vec(), statistics.into())
            }
            Self::Gpu(gpu, _) => {
                let (words, statistics) = gpu.hard_shadows(&on_lattice(occluders), light, receivers.points())?;
                (words, statistics.into())
            }
        };
        let bits = words.iter().flat_map(|word| (0..u32::BITS).map(move |bit| word >> bit & 1));
        Ok((bits.map(|blocked| 1.0 - blocked as f32).take(receivers.len()).collect(), report))
    }

    /// The fraction of a volume's samples that every receiver sees.
    ///
    /// # Errors
    /// The executor's.
    pub fn cloud_visibility(
        &self,
        occluders: &Occluders,
        cloud: &Cloud<Vec<IVec3>>,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Report), ProgramError> {
        match self {
            Self::Cpu(cpu) => {
                let (visibility, statistics) = cpu.cloud_visibility(occluders, cloud, receivers)?;
                Ok((visibility, statistics.into()))
            }
            Self::Gpu(gpu, _) => {
                let (visibility, statistics) =
                    gpu.cloud_visibility(&on_lattice(occluders), cloud, receivers.points())?;
                Ok((visibility, statistics.into()))
            }
        }
    }

    /// How many triangles block something from each receiver.
    ///
    /// # Errors
    /// The executor's.
    pub fn pairs_per_receiver(&self, scene: Scene<'_>) -> Result<(Vec<u32>, Report), ProgramError> {
        let (occluders, light, receivers) = scene;
        match self {
            Self::Cpu(cpu) => {
                let (pairs, statistics) = cpu.pairs_per_receiver(occluders, light, receivers)?;
                Ok((pairs, statistics.into()))
            }
            Self::Gpu(gpu, _) => {
                let (pairs, statistics) = gpu.pairs_per_receiver(&on_lattice(occluders), light, receivers.points())?;
                Ok((pairs, statistics.into()))
            }
        }
    }
}

/// Makes rayon's global threads as many as the command line asks for.
///
/// # Errors
/// The system refuses the threads.
pub fn use_threads(machine: &MachineArgs) -> Result<(), ProgramError> {
    let Some(threads) = machine.threads.map(usize::from) else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|e| ProgramError::Threads { threads, reason: e.to_string() })
}

/// The adapter that the command line asks for.
pub fn choice(machine: &MachineArgs) -> Choice {
    machine.adapter.clone().map_or(Choice::Hardware, Choice::Named)
}

fn processor(precision: PrecisionArg) -> CpuExecutor {
    CpuExecutor::new().with_precision(precision.into())
}

fn on_lattice(occluders: &Occluders) -> LatticeScene<'_> {
    LatticeScene { vertices: occluders.vertices(), triangles: occluders.triangles() }
}
