//! Where the work is done: on the processor, or on a GPU. The bits are the same.
//!
//! GPUs come with the feature `gpu`; all that is said of them without it is in `no_gpu.rs`.

mod cpu;
#[cfg(feature = "gpu")]
mod gpu;
#[cfg(not(feature = "gpu"))]
#[path = "no_gpu.rs"]
mod gpu;

use umbra4_core::{Counts, LatticeLight, Plan, Punctual, cloud::Cloud, glam::IVec3};
use umbra4_cpu::{Caster, CpuExecutor, CpuWord, Occluders, Receivers, maps::Technique};

use crate::{
    args::{ExecutorArg, MachineArgs, PrecisionArg, WorkArgs},
    error::ProgramError,
    light::Weights,
};
use cpu::Processor;
pub use gpu::{Device, GpuError, write_adapters};

/// What is asked about.
pub type Scene<'a> = (&'a Occluders, &'a LatticeLight, &'a Receivers);

/// What was found, and what was done for it.
type Answer<T> = Result<(T, Report), ProgramError>;

/// An executor of either kind.
pub enum AnyExecutor {
    /// On rayon's threads.
    Cpu(Processor),
    /// On a GPU.
    #[cfg(feature = "gpu")]
    Gpu(Box<gpu::Graphics>),
}

/// Asks whichever executor there is: all of them have the same calls.
macro_rules! ask {
    ($any:expr, $executor:ident => $answer:expr) => {
        match $any {
            AnyExecutor::Cpu($executor) => $answer,
            #[cfg(feature = "gpu")]
            AnyExecutor::Gpu($executor) => $answer,
        }
    };
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

impl AnyExecutor {
    /// The one that the command line asks for. Threads of the processor are rayon's global ones: their number holds for the
    /// rest of the program too.
    ///
    /// # Errors
    /// The system refuses the threads; there is no such adapter; the program is built without GPUs, and one is asked for.
    pub fn new(work: &WorkArgs) -> Result<Self, ProgramError> {
        use_threads(&work.machine)?;
        let WorkArgs { executor, machine, precision } = work;
        match executor {
            ExecutorArg::Cpu => {
                gpu::check(machine)?;
                Ok(Self::cpu(*precision))
            }
            ExecutorArg::Gpu => Ok(gpu::open(machine, *precision)?),
            ExecutorArg::Auto => {
                gpu::check(machine)?;
                Ok(gpu::open(machine, *precision).unwrap_or_else(|_| Self::cpu(*precision)))
            }
        }
    }

    /// On the processor.
    pub fn cpu(precision: PrecisionArg) -> Self {
        Self::Cpu(Processor::new(precision))
    }

    /// What it runs on.
    pub fn name(&self) -> String {
        ask!(self, executor => executor.name())
    }

    /// The processor, which has all stages.
    fn processor(&self) -> &CpuExecutor {
        ask!(self, executor => executor.processor())
    }

    /// The masks of all receivers, receiver-major.
    ///
    /// # Errors
    /// The executor's.
    pub fn masks<W: CpuWord>(&self, scene: Scene<'_>) -> Answer<Vec<W>> {
        ask!(self, executor => executor.masks(scene))
    }

    /// The fraction of lit samples of every receiver.
    ///
    /// # Errors
    /// The executor's.
    pub fn visibility(&self, scene: Scene<'_>) -> Answer<Vec<f32>> {
        ask!(self, executor => executor.visibility(scene))
    }

    /// The fraction of the light that every receiver sees, by a technique. Receivers keep their facings.
    ///
    /// # Errors
    /// The executor's.
    pub fn visibility_by(&self, technique: &Technique, scene: Scene<'_>) -> Answer<Vec<f32>> {
        ask!(self, executor => executor.visibility_by(technique, scene))
    }

    /// The lit samples of every receiver.
    ///
    /// # Errors
    /// The executor's.
    pub fn lit_counts(&self, scene: Scene<'_>) -> Answer<Vec<u32>> {
        ask!(self, executor => executor.lit_counts(scene))
    }

    /// What the processor would run for the fraction of lit samples.
    pub fn plan(&self, scene: Scene<'_>) -> Plan {
        let (occluders, light, receivers) = scene;
        self.processor().plan(occluders, light, receivers, true)
    }

    /// Sums of the weights of the lit samples of every receiver.
    ///
    /// # Errors
    /// The executor's.
    pub fn light(&self, scene: Scene<'_>, emission: &Weights) -> Answer<Vec<[u32; 3]>> {
        ask!(self, executor => executor.light(scene, emission))
    }

    /// Which receivers a light without extent reaches: 1 where it does, 0 where it is blocked.
    ///
    /// # Errors
    /// The executor's.
    pub fn hard_visibility(&self, occluders: &Occluders, light: &Punctual, receivers: &Receivers) -> Answer<Vec<f32>> {
        let (words, report) = ask!(self, executor => executor.hard_shadows(occluders, light, receivers))?;
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
    ) -> Answer<Vec<f32>> {
        ask!(self, executor => executor.cloud_visibility(occluders, cloud, receivers))
    }

    /// The masks of all receivers, receiver-major, by casters that block samples. Tinted ones block none.
    ///
    /// # Errors
    /// The executor's.
    pub fn caster_masks<W: CpuWord>(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Answer<Vec<W>> {
        ask!(self, executor => executor.caster_masks(casters, light, receivers))
    }

    /// The fraction of lit samples of every receiver, by casters that block them.
    ///
    /// # Errors
    /// The executor's.
    pub fn caster_visibility(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Answer<Vec<f32>> {
        ask!(self, executor => executor.caster_visibility(casters, light, receivers))
    }

    /// Sums of the weights of the lit samples of every receiver, as casters let them through.
    ///
    /// # Errors
    /// The executor's.
    pub fn caster_light(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
        emission: &Weights,
    ) -> Answer<Vec<[u32; 3]>> {
        ask!(self, executor => executor.caster_light(casters, light, receivers, emission))
    }

    /// What the processor would run for the light that comes through casters.
    pub fn caster_plan(&self, casters: &[Caster], light: &LatticeLight, receivers: &Receivers) -> Plan {
        let cpu = self.processor();
        cpu.caster_plan(&cpu.index_casters(casters, light), receivers, true, true)
    }

    /// How many triangles block something from each receiver.
    ///
    /// # Errors
    /// The executor's.
    pub fn pairs_per_receiver(&self, scene: Scene<'_>) -> Answer<Vec<u32>> {
        ask!(self, executor => executor.pairs_per_receiver(scene))
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
