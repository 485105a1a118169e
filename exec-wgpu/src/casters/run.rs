//! One run over casters that are indexed on the device.

use umbra4_core::{
    CasterWork, Executor, Pass, Plan,
    hierarchy::Levels,
    jitter::Pattern,
    kernel::{
        Kernel,
        dispatch::{Dispatch, MaskLayout, dispatches, slices},
        resolve::STOPPED,
    },
    params::{JitteredParams, PassParams},
    stage::Stage,
    tint::Depth,
};
use wgpu::Buffer;

use crate::{
    CasterIndex, Gpu, GpuError,
    casters::index::IndexedCaster,
    readback::read,
    recorder::{Recorder, Resource},
    stages::Buffers,
    submit::{Wanted, submit},
    told::Told,
};

/// Buffers of a run that only casters ask for.
#[derive(Debug, Default)]
pub(crate) struct CasterBuffers {
    /// Those of receivers, where there are any.
    pub(crate) layers: Option<Buffer>,
    /// A block's receivers as a caster's layers select them.
    pub(crate) selected: Option<Buffer>,
    /// What panes put before the samples of a block, and one more depth.
    pub(crate) depths: Option<Buffer>,
    /// [`umbra4_core::tint::TRANSMITTANCES`].
    pub(crate) transmittances: Option<Buffer>,
}

/// What came back of the blocks.
#[derive(Debug, Default)]
pub(crate) struct Blocks {
    pub(crate) masks: Vec<u32>,
    /// Whether the driver has stopped a thread.
    pub(crate) stopped: bool,
}

/// An executor for casters and one set of receivers.
pub(crate) struct CasterStages<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) index: &'a CasterIndex,
    pub(crate) plan: &'a Plan,
    pub(crate) layout: MaskLayout,
    pub(crate) told: Told,
    pub(crate) recorder: &'a mut Recorder,
    pub(crate) buffers: &'a Buffers,
    pub(crate) own: &'a CasterBuffers,
    /// Bits of the words that hold rows.
    pub(crate) bits: u32,
    /// Whether masks are asked for.
    pub(crate) masks: bool,
    pub(crate) stages: &'a mut Vec<(&'static str, f64)>,
    pub(crate) blocks: Blocks,
}

impl CasterStages<'_> {
    /// Runs the plan.
    pub(crate) fn finish(mut self) -> Result<Blocks, GpuError> {
        let plan = self.plan;
        plan.run(&mut self)?;
        Ok(self.blocks)
    }

    /// What a dispatch over a block is told, for the triangles under each node of one level of a caster.
    fn passes(&self, first: u32, levels: &Levels) -> impl Iterator<Item = PassParams> + use<> {
        let facts = self.plan.facts();
        let pass = PassParams {
            count: facts.block.min(facts.receivers.saturating_sub(first)),
            first,
            stride: self.layout.stride,
            elements: 1,
            rounds: 2,
            ..PassParams::default()
        };
        slices(levels, self.layout.slice).map(move |(level, base)| PassParams { level, base, ..pass })
    }

    /// Masks without a blocker: those of receivers that are settled are full.
    fn start_masks(&mut self, first: u32) -> Result<(), GpuError> {
        let pass = self.passes(first, &Levels::default()).next().unwrap_or_default();
        let pass = PassParams { elements: 0, ..pass };
        let Self { layout, told, recorder, buffers, own, .. } = self;
        if let Some(depths) = &own.depths {
            recorder.clear(depths, 0);
        }
        let bound = [
            (&buffers.receivers).into(),
            (&buffers.receiver_keys).into(),
            (&buffers.receiver_order).into(),
            (&buffers.occluders).into(),
            (&buffers.nodes).into(),
            (&buffers.masks).into(),
        ];
        recorder.set_stage(Stage::Resolve.info().name);
        told.record(recorder, &Dispatch { kernel: layout.resolve, pass, roles: &[] }, &bound)
    }

    /// Has every caster of a kind work on a block.
    fn shadow(&mut self, stage: Stage, work: CasterWork, first: u32) -> Result<(), GpuError> {
        let index = self.index;
        for caster in index.casters.iter().filter(|caster| caster.work == work) {
            let order = self.select(caster, first)?;
            self.recorder.set_stage(stage.info().name);
            let levels = caster.params.params.levels();
            for pass in self.passes(first, &levels) {
                self.meet(caster, &order, work, &pass)?;
            }
        }
        Ok(())
    }

    /// The order in which a caster meets receivers: those that it does not matter to are settled in it.
    fn select(&mut self, caster: &IndexedCaster, first: u32) -> Result<Resource, GpuError> {
        let Self { recorder, buffers, own, plan, .. } = self;
        let order: Resource = (&buffers.receiver_order).into();
        let (Some(layers), Some(selected)) = (&own.layers, &own.selected) else { return Ok(order) };
        let facts = plan.facts();
        let count = facts.block.min(facts.receivers.saturating_sub(first));
        let pass = PassParams { count, first, ..PassParams::default() };
        recorder.set_stage(Stage::SelectReceivers.info().name);
        recorder.add(
            Kernel::SelectReceivers,
            caster.params.with_pass(&pass),
            &[order, layers.into(), selected.into()],
        )?;
        Ok(selected.into())
    }

    fn meet(
        &mut self,
        caster: &IndexedCaster,
        order: &Resource,
        work: CasterWork,
        pass: &PassParams,
    ) -> Result<(), GpuError> {
        let Self { layout, recorder, buffers, own, index, bits, .. } = self;
        let jittered = index.light.jitter.is_some();
        let with = |rest: &[&Buffer]| -> Vec<Resource> {
            let met = [(&buffers.receivers).into(), (&buffers.receiver_keys).into(), order.clone()];
            met.into_iter().chain(rest.iter().map(|buffer| (*buffer).into())).collect()
        };
        let told = caster.params.with_pass(pass);
        let IndexedCaster { occluders, nodes, surface, .. } = caster;
        match (work, &own.depths) {
            (CasterWork::Plain, _) if jittered => {
                let told = JitteredParams { params: told.params, pattern: Pattern::of(&index.light) };
                recorder.add(layout.resolve, told, &with(&[occluders, nodes, &buffers.masks]))
            }
            (CasterWork::Plain, _) => {
                recorder.add(layout.resolve, told.params, &with(&[occluders, nodes, &buffers.masks]))
            }
            (CasterWork::Cutout, _) => {
                let kernel = match (*bits, jittered) {
                    (..=32, false) => Kernel::ResolveCutout32,
                    (..=32, true) => Kernel::ResolveCutout32Jittered,
                    (_, false) => Kernel::ResolveCutout64,
                    (_, true) => Kernel::ResolveCutout64Jittered,
                };
                recorder.add(kernel, told, &with(&[occluders, nodes, surface, &buffers.masks]))
            }
            (CasterWork::Tinted, Some(depths)) => {
                let kernel = if jittered { Kernel::AddTintJittered } else { Kernel::AddTint };
                recorder.add(kernel, told, &with(&[occluders, nodes, surface, depths]))
            }
            (CasterWork::Tinted, None) | (CasterWork::Nothing, _) => Ok(()),
        }
    }

    /// From masks, and depths, to what is asked for.
    fn reduce(&mut self, pass: &Pass) -> Result<(), GpuError> {
        let Self { plan, layout, told, recorder, buffers, own, .. } = self;
        recorder.set_stage(pass.stage.info().name);
        let (Some(depths), Some(table), Some([weights, sums])) = (&own.depths, &own.transmittances, &buffers.emission)
        else {
            return dispatches(plan, layout, pass, &mut |dispatch| {
                let bound: Vec<Resource> = dispatch.roles.iter().map(|role| buffers.of(*role)).collect();
                told.record(recorder, dispatch, &bound)
            });
        };
        let by_id = PassParams { count: pass.count, first: pass.first, stride: layout.stride, ..PassParams::default() };
        let bound = [(&buffers.masks).into(), weights.clone(), depths.into(), table.into(), sums.clone()];
        recorder.add(Kernel::WeighTinted, told.plain(&by_id), &bound)
    }

    /// A block is done: what was recorded goes to the device, and comes back.
    fn end_block(&mut self, first: u32) -> Result<(), GpuError> {
        let Self { gpu, plan, layout, recorder, buffers, own, blocks, stages, .. } = self;
        let facts = plan.facts();
        let count = u64::from(facts.block.min(facts.receivers.saturating_sub(first)));
        let word = size_of::<u32>() as u64;
        let mut wanted: Vec<Wanted<'_>> = vec![(&buffers.masks, buffers.stopped(), word)];
        if let Some(depths) = &own.depths {
            // The last whole one: a buffer that has grown may end with half a depth.
            let depth = size_of::<Depth>() as u64;
            wanted.push((depths, depths.size() / depth * depth - depth, word));
        }
        let flags = wanted.len();
        if self.masks {
            wanted.push((&buffers.masks, 0, count * u64::from(layout.stride) * word));
        }
        let copies = submit(gpu, recorder, &wanted, stages)?;
        recorder.restart();
        for (place, copy) in copies.iter().enumerate() {
            let words = read::<u32>(&gpu.device, copy)?;
            if place < flags {
                blocks.stopped |= words.contains(&STOPPED);
            } else {
                blocks.masks.extend(words);
            }
        }
        Ok(())
    }
}

impl Executor for CasterStages<'_> {
    type Error = GpuError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), GpuError> {
        match pass.stage {
            Stage::Resolve => self.shadow(pass.stage, CasterWork::Plain, pass.first)?,
            Stage::ResolveCutout => self.shadow(pass.stage, CasterWork::Cutout, pass.first)?,
            Stage::AddTint => self.shadow(pass.stage, CasterWork::Tinted, pass.first)?,
            Stage::Reduce => self.reduce(pass)?,
            // Every caster selects receivers for itself, just before it meets them.
            Stage::SelectReceivers => {}
            _ => {
                let Self { plan, layout, told, recorder, buffers, .. } = self;
                recorder.set_stage(pass.stage.info().name);
                dispatches(plan, layout, pass, &mut |dispatch| {
                    let bound: Vec<Resource> = dispatch.roles.iter().map(|role| buffers.of(*role)).collect();
                    told.record(recorder, dispatch, &bound)
                })?;
                if pass.stage == Stage::OrderReceivers {
                    self.start_masks(pass.first)?;
                }
            }
        }
        if Some(pass.stage) == self.plan.last_of_block() { self.end_block(pass.first) } else { Ok(()) }
    }
}
