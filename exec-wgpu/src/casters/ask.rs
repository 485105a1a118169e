//! The ways to ask for masks, visibility and light by casters.

use umbra4_core::{
    CasterFacts, LatticeLight, MaskWord, PackedCaster, Plan, Precision, SceneFacts, Work,
    emission::{Emission, Weight},
    kernel::{
        dispatch::{MaskLayout, Reduction},
        resolve::stride,
        weigh::{PackedWeight, packed},
    },
    order::Entry,
    proj4::NODE,
    stage::reduce,
    tint::{Depth, TRANSMITTANCES},
};
use wgpu::Buffer;

use crate::{
    CasterIndex, GpuError, LatticeReceivers, LatticeScene, Statistics, WgpuExecutor,
    casters::{
        index::IndexedCaster,
        run::{Blocks, CasterBuffers, CasterStages},
    },
    checks,
    error::guarded,
    executor::{bounds, words},
    readback::read,
    recorder::Recorder,
    scratch::Scratch,
    stages::{Buffers, SMALLEST_SLICE, block, mask_layout, narrowest, slice},
    submit::submit,
    told::Told,
};

/// Bytes of the depths of a block, at most.
const DEPTH_BYTES: u64 = 64 << 20;

/// What is asked of casters.
#[derive(Clone, Copy, Debug)]
enum Ask<'a> {
    Masks,
    LitCounts,
    Light(&'a [PackedWeight]),
}

/// What came back.
#[derive(Debug, Default)]
struct Answers {
    masks: Vec<u32>,
    lit: Vec<u32>,
    light: Vec<[u32; 3]>,
}

impl WgpuExecutor {
    /// Indexes casters for one light, on the device. Casters are certified always, whatever the executor's precision.
    ///
    /// # Errors
    /// The first caster that is refused, by its place: a surface that is not packed as its kind and texture ask for, panes that are closed
    /// or offset, a buffer that is larger than the device can bind. The device fails.
    pub fn index_casters(&self, casters: &[PackedCaster<'_>], light: &LatticeLight) -> Result<CasterIndex, GpuError> {
        let (casters, _) = self.with_work(|recorder, _| {
            let one = |(place, caster)| {
                IndexedCaster::new(&self.gpu, recorder, light, caster, Scratch::default(), &mut Vec::new())
                    .map_err(|source| GpuError::Caster { place, source: Box::new(source) })
            };
            casters.iter().enumerate().map(one).collect()
        })?;
        Ok(CasterIndex { light: *light, casters })
    }

    /// Indexes one caster again, as it is now, in the place of the `place`-th: the others' parts stay as they are. Returns what it took.
    ///
    /// # Errors
    /// There is no such place; a caster that [`WgpuExecutor::index_casters`] refuses. The index is as it was then, but for a device that failed.
    pub fn index_caster(
        &self,
        index: &mut CasterIndex,
        place: usize,
        caster: &PackedCaster<'_>,
    ) -> Result<Statistics, GpuError> {
        let casters = index.len();
        checks::caster(caster)?;
        let (light, old) = (index.light, index.casters.get_mut(place));
        let old = old.ok_or(GpuError::NoCaster { place, casters })?;
        let scratch = old.take_scratch();
        let mut stages = Vec::new();
        let (new, time) = self
            .with_work(|recorder, _| IndexedCaster::new(&self.gpu, recorder, &light, caster, scratch, &mut stages))?;
        *old = new;
        Ok(Statistics { time, counts: None, stages })
    }

    /// The masks of all receivers, receiver-major, a word a row of the light: 1 where any opaque or alpha-tested caster blocks a
    /// sample. Tinted ones block none. The same bits as the CPU executor's.
    ///
    /// # Errors
    /// The word is too narrow for the light; layers of another number of receivers; a buffer that is larger than the device can bind;
    /// the device fails.
    pub fn caster_masks<'a, W: MaskWord>(
        &self,
        index: &CasterIndex,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<W>, Statistics), GpuError> {
        let LatticeLight { rows, columns, .. } = index.light;
        if columns > W::BITS {
            return Err(GpuError::WordTooNarrow { columns, bits: W::BITS });
        }
        let (answers, statistics) = self.ask_casters(index, receivers.into(), W::BITS, Ask::Masks)?;
        Ok((words(&answers.masks, rows as usize, stride(rows, W::BITS) as usize), statistics))
    }

    /// The fraction of lit samples of every receiver, in `0.0..=1.0`, as by [`WgpuExecutor::caster_masks`].
    ///
    /// # Errors
    /// As [`WgpuExecutor::caster_masks`]; the word is chosen to fit the light.
    pub fn caster_visibility<'a>(
        &self,
        index: &CasterIndex,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<f32>, Statistics), GpuError> {
        let samples = index.light.sample_count();
        let (lit, statistics) = self.caster_lit_counts(index, receivers)?;
        Ok((lit.into_iter().map(|lit| reduce::visibility(lit, samples)).collect(), statistics))
    }

    /// The lit samples of every receiver, as by [`WgpuExecutor::caster_masks`].
    ///
    /// # Errors
    /// As [`WgpuExecutor::caster_visibility`].
    pub fn caster_lit_counts<'a>(
        &self,
        index: &CasterIndex,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let bits = narrowest(&index.light.into());
        let (answers, statistics) = self.ask_casters(index, receivers.into(), bits, Ask::LitCounts)?;
        Ok((answers.lit, statistics))
    }

    /// The light that every receiver gets through panes, red, green and blue: sums of the weights of samples that are not blocked, each
    /// seen through what lies before it ([`umbra4_core::tint`]). [`Emission::fraction`] makes fractions of them. The same integers as the
    /// CPU executor's.
    ///
    /// # Errors
    /// As [`WgpuExecutor::caster_visibility`]; an emission of another number of rows or columns than the light's.
    pub fn caster_light<'a, S: AsRef<[Weight]>>(
        &self,
        index: &CasterIndex,
        receivers: impl Into<LatticeReceivers<'a>>,
        emission: &Emission<S>,
    ) -> Result<(Vec<[u32; 3]>, Statistics), GpuError> {
        let size = [index.light.rows, index.light.columns];
        if emission.size() != size {
            return Err(GpuError::EmissionSize { emission: emission.size(), light: size });
        }
        let weights: Vec<PackedWeight> = emission.weights().iter().map(|weight| packed(*weight)).collect();
        let bits = narrowest(&index.light.into());
        let (answers, statistics) = self.ask_casters(index, receivers.into(), bits, Ask::Light(&weights))?;
        Ok((answers.light, statistics))
    }

    /// Runs the stages, and once more with less to do for each thread where a driver stops them.
    fn ask_casters(
        &self,
        index: &CasterIndex,
        receivers: LatticeReceivers<'_>,
        bits: u32,
        ask: Ask<'_>,
    ) -> Result<(Answers, Statistics), GpuError> {
        checks::counts_of(&LatticeScene { vertices: &[], triangles: &[] }, receivers)?;
        let mut slice = slice(self.gpu.software);
        let mut stages = Vec::new();
        let (answers, time) = self.with_work(|recorder, scratch| {
            loop {
                let run = CasterAsk { index, receivers, bits, ask, slice };
                match self.run_casters(&run, recorder, scratch, &mut stages)? {
                    Some(answers) => return Ok(answers),
                    // The driver ended threads before they were done: they get less to do.
                    None if slice > SMALLEST_SLICE => slice = (slice / NODE as u32).max(SMALLEST_SLICE),
                    None => return Err(GpuError::Stopped { adapter: self.gpu.name.clone() }),
                }
            }
        })?;
        Ok((answers, Statistics { time, counts: None, stages }))
    }

    /// `None` where the driver has stopped a thread.
    fn run_casters(
        &self,
        run: &CasterAsk<'_>,
        recorder: &mut Recorder,
        scratch: &mut Scratch,
        stages: &mut Vec<(&'static str, f64)>,
    ) -> Result<Option<Answers>, GpuError> {
        let CasterAsk { index, receivers, bits, ask, slice } = *run;
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let light = &index.light;
        let weights = if let Ask::Light(weights) = ask { Some(weights) } else { None };
        let reduction = if weights.is_some() { Reduction::WeighedLight } else { Reduction::LitCounts };
        let layout = mask_layout(&(*light).into(), bits, Precision::Exact, false, slice);
        let layout = MaskLayout { reduction, ..layout };
        let facts = run.facts(block(&layout, self.block));
        let plan = Plan::new(facts);
        let mut buffers = Buffers::fit(scratch, device, &plan, &layout, 0)?;
        let casters = run.kinds();
        let count = receivers.points.len() as u64;
        let samples = u64::from(light.sample_count());
        let of_block = u64::from(facts.block.min(facts.receivers));
        let mut own = CasterBuffers::default();
        if casters.layered {
            own.layers = Some(scratch.fit::<u32>(device, "layers", count)?);
            own.selected = Some(scratch.fit::<Entry>(device, "selected receivers", of_block)?);
        }
        if casters.tinted > 0 {
            own.depths = Some(scratch.fit::<Depth>(device, "depths of samples", of_block * samples + 1)?);
            own.transmittances = Some(scratch.fit::<u32>(device, "transmittances", TRANSMITTANCES.len() as u64)?);
        }
        if let Some(weights) = weights {
            let of_weights = scratch.fit::<PackedWeight>(device, "weights", weights.len() as u64)?;
            let sums = scratch.fit::<[u32; 3]>(device, "weighed light", count)?;
            buffers.emission = Some([(&of_weights).into(), (&sums).into()]);
        }
        let facings = buffers.facings.as_ref().map(|buffer| (buffer, bytemuck::cast_slice(receivers.facings)));
        let weights_of = buffers.emission.as_ref().and_then(|[weights, _]| weights.buffer()).zip(weights);
        let layers = run.layers();
        guarded(device, "uploads receivers", || {
            queue.write_buffer(&buffers.receivers, 0, bytemuck::cast_slice(receivers.points));
            let words = own.layers.as_ref().map(|buffer| (buffer, bytemuck::cast_slice(&layers)));
            let table = own.transmittances.as_ref().map(|buffer| (buffer, bytemuck::cast_slice(&TRANSMITTANCES)));
            let weights = weights_of.map(|(buffer, weights)| (buffer, bytemuck::cast_slice(weights)));
            for (buffer, bytes) in facings.into_iter().chain(words).chain(table).chain(weights) {
                queue.write_buffer(buffer, 0, bytes);
            }
        })?;
        recorder.restart();
        recorder.clear(&buffers.masks, buffers.stopped());
        let of_casters = index.casters.iter().flat_map(|caster| &caster.bounds);
        let told = Told::area(light, bounds(of_casters.chain(receivers.points)), plan.levels());
        let masks = matches!(ask, Ask::Masks);
        let run = CasterStages {
            gpu: &self.gpu,
            index,
            plan: &plan,
            layout,
            told,
            recorder,
            buffers: &buffers,
            own: &own,
            bits,
            masks,
            stages,
            blocks: Blocks::default(),
        };
        let Blocks { masks, stopped } = run.finish()?;
        recorder.restart();
        if stopped {
            return Ok(None);
        }
        let mut answers = Answers { masks, ..Answers::default() };
        if count > 0 {
            let sums = buffers.emission.as_ref().and_then(|[_, sums]| sums.buffer());
            let word = size_of::<u32>() as u64;
            if let Some(sums) = sums {
                answers.light = self.back(recorder, sums, 3 * word * count)?;
            } else if let Some(lit) = &buffers.lit {
                answers.lit = self.back(recorder, lit, word * count)?;
            }
        }
        Ok(Some(answers))
    }

    /// The first bytes of a buffer.
    fn back<T: bytemuck::Pod>(&self, recorder: &mut Recorder, from: &Buffer, bytes: u64) -> Result<Vec<T>, GpuError> {
        match &submit(&self.gpu, recorder, &[(from, 0, bytes)], &mut Vec::new())?[..] {
            [copy] => read(&self.gpu.device, copy),
            _ => Ok(Vec::new()),
        }
    }
}

/// What is asked of which casters for which receivers.
struct CasterAsk<'a> {
    index: &'a CasterIndex,
    receivers: LatticeReceivers<'a>,
    bits: u32,
    ask: Ask<'a>,
    /// Triangles that a dispatch looks at, at most.
    slice: u32,
}

impl CasterAsk<'_> {
    /// What kinds of casters there are.
    fn kinds(&self) -> CasterFacts {
        let casters = self.index.casters.iter().map(|caster| (caster.work, caster.layers));
        CasterFacts::of(casters, matches!(self.ask, Ask::Light(_)), !self.receivers.layers.is_empty())
    }

    fn facts(&self, most: u32) -> SceneFacts {
        let (casters, samples) = (self.kinds(), self.index.light.sample_count().max(1));
        let depths = (DEPTH_BYTES / (size_of::<Depth>() as u64 * u64::from(samples))) as u32;
        SceneFacts {
            receivers: self.receivers.points.len() as u32,
            facing: !self.receivers.facings.is_empty(),
            jittered: self.index.light.jitter.is_some(),
            block: if casters.tinted > 0 { most.min(depths.max(1)) } else { most },
            visibility: !matches!(self.ask, Ask::Masks),
            work: Work::Casters(casters),
            ..SceneFacts::default()
        }
    }

    /// A word a receiver.
    fn layers(&self) -> Vec<u32> {
        match self.receivers.layers {
            [] => vec![u32::MAX; self.receivers.points.len()],
            layers => layers.iter().map(|layers| layers.bits()).collect(),
        }
    }
}
