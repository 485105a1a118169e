//! GPUs, through `umbra4-wgpu`.

mod quiet;

use std::{
    io::{self, Write},
    time::Instant,
};

use umbra4_core::{LatticeLight, PackedCaster, Punctual, cloud::Cloud, glam::IVec3};
use umbra4_cpu::{Caster, CpuExecutor, CpuWord, Occluders, Receivers, maps::Technique};
pub use umbra4_wgpu::GpuError;
use umbra4_wgpu::{
    AdapterReport, CasterIndex, Choice, Gpu, LatticeReceivers, LatticeScene, Statistics, WgpuExecutor, adapters,
};

use crate::{
    args::{MachineArgs, PrecisionArg},
    error::ProgramError,
    executor::{Answer, AnyExecutor, Report, Scene, cpu::Processor},
    light::Weights,
};
use quiet::quietly;

/// A GPU: calls as of [`super::AnyExecutor`].
pub struct Graphics {
    gpu: WgpuExecutor,
    /// For plans, which are the processor's.
    cpu: Processor,
}

/// The GPU that the command line names, or the best if there is one; a software driver only by name.
pub(super) fn open(machine: &MachineArgs, precision: PrecisionArg) -> Result<AnyExecutor, GpuError> {
    Ok(on(opened(machine)?, precision))
}

/// Whether the options about GPUs can be followed: they can.
pub(super) fn check(_: &MachineArgs) -> Result<(), GpuError> {
    Ok(())
}

fn on(gpu: Gpu, precision: PrecisionArg) -> AnyExecutor {
    let gpu = WgpuExecutor::new(gpu).with_counts(true).with_stage_times(true).with_precision(precision.into());
    AnyExecutor::Gpu(Box::new(Graphics { gpu, cpu: Processor::new(precision) }))
}

fn opened(machine: &MachineArgs) -> Result<Gpu, GpuError> {
    let choice = machine.adapter.clone().map_or(Choice::Hardware, Choice::Named);
    quietly(|| Gpu::open(&choice))
}

/// Writes a line for every adapter: what it is, and what it lacks if it cannot be used.
///
/// # Errors
/// `out` is closed.
pub fn write_adapters(out: &mut impl Write) -> io::Result<()> {
    let adapters = quietly(adapters);
    if adapters.is_empty() {
        writeln!(out, "GPUs             none")?;
    }
    for AdapterReport { name, driver, backend, hardware, lacks } in adapters {
        let kind = if hardware { "" } else { ", in software" };
        let reasons: Vec<String> = lacks.iter().map(ToString::to_string).collect();
        let said = if reasons.is_empty() { "usable".to_owned() } else { format!("unusable: {}", reasons.join("; ")) };
        writeln!(out, "GPU              {name} ({backend}, {driver}{kind}): {said}")?;
    }
    writeln!(out, "                 (not looked for on GL: the kernels do not compile for it)")
}

/// A GPU for a report, or why there is none.
pub enum Device {
    /// An adapter that is open.
    Open(Gpu),
    /// What the system said.
    Missing(String),
}

impl Device {
    /// The GPU that the command line names, or the best if there is one; a software driver only by name.
    ///
    /// # Errors
    /// The one that is named cannot be opened.
    pub fn open(machine: &MachineArgs) -> Result<Self, ProgramError> {
        match opened(machine) {
            Ok(gpu) => Ok(Self::Open(gpu)),
            Err(error) if machine.adapter.is_none() => Ok(Self::Missing(error.to_string())),
            Err(error) => Err(error.into()),
        }
    }

    /// Its name, or why there is none.
    pub fn name(&self) -> Result<&str, &str> {
        match self {
            Self::Open(gpu) => Ok(&gpu.name),
            Self::Missing(reason) => Err(reason),
        }
    }

    /// An executor on it, if it is there.
    pub fn executor(&self, precision: PrecisionArg) -> Option<AnyExecutor> {
        match self {
            Self::Open(gpu) => Some(on(gpu.clone(), precision)),
            Self::Missing(_) => None,
        }
    }
}

impl Graphics {
    pub(super) fn name(&self) -> String {
        self.gpu.gpu().name.clone()
    }

    pub(super) fn processor(&self) -> &CpuExecutor {
        self.cpu.processor()
    }

    pub(super) fn masks<W: CpuWord>(&self, (occluders, light, receivers): Scene<'_>) -> Answer<Vec<W>> {
        let (masks, statistics) = self.gpu.masks::<W>(&on_lattice(occluders), light, receivers.points())?;
        Ok((masks, statistics.into()))
    }

    pub(super) fn visibility(&self, (occluders, light, receivers): Scene<'_>) -> Answer<Vec<f32>> {
        let (visibility, statistics) = self.gpu.visibility(&on_lattice(occluders), light, receivers.points())?;
        Ok((visibility, statistics.into()))
    }

    pub(super) fn visibility_by(
        &self,
        technique: &Technique,
        (occluders, light, receivers): Scene<'_>,
    ) -> Answer<Vec<f32>> {
        let receivers = LatticeReceivers { points: receivers.points(), facings: receivers.facings(), layers: &[] };
        let (visibility, statistics) = self.gpu.visibility_by(technique, &on_lattice(occluders), light, receivers)?;
        Ok((visibility, statistics.into()))
    }

    pub(super) fn lit_counts(&self, (occluders, light, receivers): Scene<'_>) -> Answer<Vec<u32>> {
        let (lit, statistics) = self.gpu.lit_counts(&on_lattice(occluders), light, receivers.points())?;
        Ok((lit, statistics.into()))
    }

    pub(super) fn light(&self, (occluders, light, receivers): Scene<'_>, emission: &Weights) -> Answer<Vec<[u32; 3]>> {
        let (lit, statistics) = self.gpu.light(&on_lattice(occluders), light, receivers.points(), emission)?;
        Ok((lit, statistics.into()))
    }

    pub(super) fn hard_shadows(
        &self,
        occluders: &Occluders,
        light: &Punctual,
        receivers: &Receivers,
    ) -> Answer<Vec<u32>> {
        let (words, statistics) = self.gpu.hard_shadows(&on_lattice(occluders), light, receivers.points())?;
        Ok((words, statistics.into()))
    }

    pub(super) fn cloud_visibility(
        &self,
        occluders: &Occluders,
        cloud: &Cloud<Vec<IVec3>>,
        receivers: &Receivers,
    ) -> Answer<Vec<f32>> {
        let (visibility, statistics) = self.gpu.cloud_visibility(&on_lattice(occluders), cloud, receivers.points())?;
        Ok((visibility, statistics.into()))
    }

    pub(super) fn caster_masks<W: CpuWord>(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Answer<Vec<W>> {
        let (index, mut report) = self.index(casters, light)?;
        let (masks, statistics) = self.gpu.caster_masks::<W>(&index, with_layers(receivers))?;
        report.add(&statistics.into());
        Ok((masks, report))
    }

    pub(super) fn caster_visibility(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Answer<Vec<f32>> {
        let (index, mut report) = self.index(casters, light)?;
        let (visibility, statistics) = self.gpu.caster_visibility(&index, with_layers(receivers))?;
        report.add(&statistics.into());
        Ok((visibility, report))
    }

    pub(super) fn caster_light(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
        emission: &Weights,
    ) -> Answer<Vec<[u32; 3]>> {
        let (index, mut report) = self.index(casters, light)?;
        let (lit, statistics) = self.gpu.caster_light(&index, with_layers(receivers), emission)?;
        report.add(&statistics.into());
        Ok((lit, report))
    }

    pub(super) fn pairs_per_receiver(&self, (occluders, light, receivers): Scene<'_>) -> Answer<Vec<u32>> {
        let (pairs, statistics) = self.gpu.pairs_per_receiver(&on_lattice(occluders), light, receivers.points())?;
        Ok((pairs, statistics.into()))
    }

    /// Casters, indexed, and how long that took.
    fn index(&self, casters: &[Caster], light: &LatticeLight) -> Answer<CasterIndex> {
        let start = Instant::now();
        let packed: Vec<PackedCaster<'_>> = casters.iter().map(Caster::packed).collect();
        let index = self.gpu.index_casters(&packed, light)?;
        let mut report = Report::default();
        report.add_stage("index_casters", start.elapsed().as_secs_f64());
        Ok((index, report))
    }
}

impl From<Statistics> for Report {
    fn from(statistics: Statistics) -> Self {
        let mut stages: Vec<(String, f64)> =
            statistics.stages.iter().map(|(stage, seconds)| ((*stage).to_owned(), *seconds)).collect();
        // What the host waited for beyond that: uploads, results; or all of it, where the device takes no time.
        let named: f64 = stages.iter().map(|(_, seconds)| seconds).sum();
        let rest = if stages.is_empty() { "gpu" } else { "transfer" };
        stages.push((rest.to_owned(), (statistics.time.as_secs_f64() - named).max(0.0)));
        Self { seconds_by_stage: stages, counts: statistics.counts.unwrap_or_default() }
    }
}

fn with_layers(receivers: &Receivers) -> LatticeReceivers<'_> {
    LatticeReceivers { points: receivers.points(), facings: receivers.facings(), layers: receivers.layers() }
}

fn on_lattice(occluders: &Occluders) -> LatticeScene<'_> {
    LatticeScene { vertices: occluders.vertices(), triangles: occluders.triangles() }
}
