//! The processor.

use umbra4_core::{LatticeLight, Punctual, cloud::Cloud, glam::IVec3};
use umbra4_cpu::{Caster, CasterIndex, CpuExecutor, CpuWord, Occluders, Receivers, Statistics, maps::Technique};

use crate::{
    args::PrecisionArg,
    executor::{Answer, Report, Scene},
    light::Weights,
};

/// The processor: calls as of [`super::AnyExecutor`].
pub struct Processor(CpuExecutor);

impl Processor {
    pub(super) fn new(precision: PrecisionArg) -> Self {
        Self(CpuExecutor::new().with_precision(precision.into()))
    }

    pub(super) fn name(&self) -> String {
        format!("cpu, {} threads, {}", rayon::current_num_threads(), self.0.isa())
    }

    pub(super) fn processor(&self) -> &CpuExecutor {
        &self.0
    }

    pub(super) fn masks<W: CpuWord>(&self, (occluders, light, receivers): Scene<'_>) -> Answer<Vec<W>> {
        let (masks, statistics) = self.0.masks::<W>(occluders, light, receivers)?;
        Ok((masks.into_words(), statistics.into()))
    }

    pub(super) fn visibility(&self, (occluders, light, receivers): Scene<'_>) -> Answer<Vec<f32>> {
        let (visibility, statistics) = self.0.visibility(occluders, light, receivers)?;
        Ok((visibility, statistics.into()))
    }

    pub(super) fn visibility_by(
        &self,
        technique: &Technique,
        (occluders, light, receivers): Scene<'_>,
    ) -> Answer<Vec<f32>> {
        let (visibility, statistics) = self.0.visibility_by(technique, occluders, light, receivers)?;
        Ok((visibility, statistics.into()))
    }

    pub(super) fn lit_counts(&self, (occluders, light, receivers): Scene<'_>) -> Answer<Vec<u32>> {
        let (lit, statistics) = self.0.lit_counts(occluders, light, receivers)?;
        Ok((lit, statistics.into()))
    }

    pub(super) fn light(&self, (occluders, light, receivers): Scene<'_>, emission: &Weights) -> Answer<Vec<[u32; 3]>> {
        let (lit, statistics) = self.0.light(occluders, light, receivers, emission)?;
        Ok((lit, statistics.into()))
    }

    pub(super) fn hard_shadows(
        &self,
        occluders: &Occluders,
        light: &Punctual,
        receivers: &Receivers,
    ) -> Answer<Vec<u32>> {
        let (shadows, statistics) = self.0.hard_shadows(occluders, light, receivers)?;
        Ok((shadows.words().to_vec(), statistics.into()))
    }

    pub(super) fn cloud_visibility(
        &self,
        occluders: &Occluders,
        cloud: &Cloud<Vec<IVec3>>,
        receivers: &Receivers,
    ) -> Answer<Vec<f32>> {
        let (visibility, statistics) = self.0.cloud_visibility(occluders, cloud, receivers)?;
        Ok((visibility, statistics.into()))
    }

    pub(super) fn caster_masks<W: CpuWord>(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Answer<Vec<W>> {
        let index = self.0.index_casters(casters, light);
        let (masks, statistics) = self.0.caster_masks::<W>(&index, receivers)?;
        Ok((masks.into_words(), with_index(&index, statistics)))
    }

    pub(super) fn caster_visibility(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Answer<Vec<f32>> {
        let index = self.0.index_casters(casters, light);
        let (visibility, statistics) = self.0.caster_visibility(&index, receivers)?;
        Ok((visibility, with_index(&index, statistics)))
    }

    pub(super) fn caster_light(
        &self,
        casters: &[Caster],
        light: &LatticeLight,
        receivers: &Receivers,
        emission: &Weights,
    ) -> Answer<Vec<[u32; 3]>> {
        let index = self.0.index_casters(casters, light);
        let (lit, statistics) = self.0.caster_light(&index, receivers, emission)?;
        Ok((lit, with_index(&index, statistics)))
    }

    pub(super) fn pairs_per_receiver(&self, (occluders, light, receivers): Scene<'_>) -> Answer<Vec<u32>> {
        let (pairs, statistics) = self.0.pairs_per_receiver(occluders, light, receivers)?;
        Ok((pairs, statistics.into()))
    }
}

impl From<Statistics> for Report {
    fn from(statistics: Statistics) -> Self {
        let stages = statistics.seconds_by_stage.iter().map(|(name, s)| ((*name).to_owned(), *s));
        Self { seconds_by_stage: stages.collect(), counts: statistics.counts }
    }
}

/// What was done for the index and for the receivers.
fn with_index(index: &CasterIndex, statistics: Statistics) -> Report {
    let mut report = Report::from(index.statistics().clone());
    report.add(&statistics.into());
    report
}
