//! The ways to ask for masks, visibility and light by casters.

use umbra4_core::{
    LatticeLight, Plan, SceneFacts, Work,
    emission::{Emission, Weight},
    jitter::{Pattern, Regular},
    stage::reduce,
};

use crate::{
    Caster, CasterIndex, CpuExecutor, CpuWord, ExecutorError, Masks, Receivers, Statistics,
    casters::run::{CasterAnswer, CasterRun},
    scatter::Scatter,
};

/// Receivers worked on at once: their masks are kept until all casters have been met.
const BLOCK: u32 = 1 << 14;
/// Depths of a block, where there are tints: bounds its memory.
const BLOCK_DEPTHS: u32 = 1 << 22;

impl CpuExecutor {
    /// Indexes casters for one light. Casters are certified always, whatever the executor's precision, and their index is a hierarchy.
    pub fn index_casters(&self, casters: &[Caster], light: &LatticeLight) -> CasterIndex {
        self.install(|| CasterIndex::new(casters, light))
    }

    /// Indexes one caster again, as it is now, in the place of the `place`-th: the others' parts stay as they are.
    ///
    /// ```
    /// # use umbra4_cpu::{Caster, CpuExecutor, Occluders};
    /// # use umbra4_core::{AreaLight, Bounds, Lattice, Lift, glam::{DVec3, Vec3}};
    /// # let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// # let lamp = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?.snap(&lattice, Lift::NONE)?;
    /// # let mut positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
    /// # let world = Caster::opaque(Occluders::new(&lattice, &positions, &[[0, 1, 2]])?);
    /// let executor = CpuExecutor::new();
    /// let mut hero = Caster::opaque(Occluders::new(&lattice, &positions, &[[0, 1, 2]])?);
    /// let mut index = executor.index_casters(&[world, hero.clone()], &lamp);
    /// for frame in 0..3 {
    ///     positions[2].y = 1.0 + frame as f32;
    ///     hero.move_vertices(&lattice, &positions)?;
    ///     executor.index_caster(&mut index, 1, &hero)?;
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// There is no such place; the index is as it was then.
    pub fn index_caster(&self, index: &mut CasterIndex, place: usize, caster: &Caster) -> Result<(), ExecutorError> {
        let casters = index.len();
        if place >= casters {
            return Err(ExecutorError::NoCaster { place, casters });
        }
        let indexed = self.install(|| index.indexed(caster));
        index.casters[place] = indexed;
        Ok(())
    }

    /// What will run for the receivers of an index: `visibility` tells whether masks are reduced, `light` whether panes matter.
    pub fn caster_plan(&self, index: &CasterIndex, receivers: &Receivers, visibility: bool, light: bool) -> Plan {
        let casters = index.facts(light, !receivers.layers().is_empty());
        let samples = index.light().sample_count().max(1);
        let block = if casters.tinted > 0 { (BLOCK_DEPTHS / samples).clamp(16, BLOCK) } else { BLOCK };
        Plan::new(SceneFacts {
            triangles: index.casters.iter().map(|caster| caster.triangles()).fold(0, u32::saturating_add),
            receivers: receivers.len() as u32,
            facing: !receivers.facings().is_empty(),
            jittered: index.light().jitter.is_some(),
            block,
            visibility,
            work: Work::Casters(casters),
            ..SceneFacts::default()
        })
    }

    /// The masks of all receivers: 1 where any opaque or alpha-tested caster blocks a sample. Tinted ones block none.
    ///
    /// # Errors
    /// The word is too narrow for the light; more masks than memory.
    pub fn caster_masks<W: CpuWord>(
        &self,
        index: &CasterIndex,
        receivers: &Receivers,
    ) -> Result<(Masks<W>, Statistics), ExecutorError> {
        let light = index.light();
        if light.columns > W::BITS {
            return Err(ExecutorError::WordTooNarrow { columns: light.columns, bits: W::BITS });
        }
        let rows = light.rows as usize;
        let too_many = ExecutorError::TooManyWords { receivers: receivers.len(), rows: light.rows };
        let count = receivers.len().checked_mul(rows).ok_or_else(|| too_many.clone())?;
        let mut words = bytemuck::allocation::try_zeroed_vec::<W>(count).map_err(|()| too_many)?;
        let out = Scatter::new(&mut words);
        let plan = self.caster_plan(index, receivers, false, false);
        let statistics = self.run_casters(index, receivers, &plan, |answer| {
            if !answer.lit {
                // SAFETY: every receiver is visited once, and its part is its own.
                let own = unsafe { out.part(answer.receiver * rows, rows) };
                own.iter_mut().zip(answer.rows).for_each(|(word, row)| *word = W::of_row(*row));
            }
        });
        Ok((Masks { rows, words }, statistics))
    }

    /// The fraction of lit samples of every receiver, in `0.0..=1.0`, as by [`CpuExecutor::caster_masks`].
    ///
    /// # Errors
    /// None yet.
    pub fn caster_visibility(
        &self,
        index: &CasterIndex,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Statistics), ExecutorError> {
        let samples = index.light().sample_count();
        let (lit, statistics) = self.caster_lit_counts(index, receivers)?;
        Ok((lit.into_iter().map(|lit| reduce::visibility(lit, samples)).collect(), statistics))
    }

    /// The lit samples of every receiver, `0..=light.sample_count()`, as by [`CpuExecutor::caster_masks`].
    ///
    /// # Errors
    /// None yet.
    pub fn caster_lit_counts(
        &self,
        index: &CasterIndex,
        receivers: &Receivers,
    ) -> Result<(Vec<u32>, Statistics), ExecutorError> {
        Ok(self.of_casters(index, receivers, false, CasterLitCount { columns: index.light().columns }))
    }

    /// The light that every receiver gets through panes, red, green and blue: sums of the weights of samples that are not blocked, each
    /// seen through what lies before it ([`umbra4_core::tint`]). [`Emission::fraction`] makes fractions of them. Integers: the same on
    /// every executor.
    ///
    /// # Errors
    /// An emission of another number of rows or columns than the light's.
    pub fn caster_light<E: AsRef<[Weight]> + Sync>(
        &self,
        index: &CasterIndex,
        receivers: &Receivers,
        emission: &Emission<E>,
    ) -> Result<(Vec<[u32; 3]>, Statistics), ExecutorError> {
        Self::check_emission(index.light(), emission)?;
        Ok(self.of_casters(index, receivers, true, Through(emission)))
    }

    /// What `reduction` makes of every answer, in the order of the receivers.
    fn of_casters<R: CasterReduction>(
        &self,
        index: &CasterIndex,
        receivers: &Receivers,
        light: bool,
        reduction: R,
    ) -> (Vec<R::Value>, Statistics) {
        let mut values = vec![R::Value::default(); receivers.len()];
        let out = Scatter::new(&mut values);
        let plan = self.caster_plan(index, receivers, true, light);
        // SAFETY: every receiver is visited once, and its element is its own.
        let place = |receiver: usize, value: R::Value| unsafe { out.part(receiver, 1) }.fill(value);
        let statistics = self.run_casters(index, receivers, &plan, |answer| {
            place(answer.receiver, reduction.of(&answer));
        });
        (values, statistics)
    }

    fn run_casters(
        &self,
        index: &CasterIndex,
        receivers: &Receivers,
        plan: &Plan,
        visit: impl Fn(CasterAnswer<'_>) + Sync,
    ) -> Statistics {
        let light = index.light();
        self.install(|| {
            if light.jitter.is_some() {
                let samples = Pattern::of(light);
                CasterRun::new(index, self.isa, &samples, receivers, &visit).finish(plan)
            } else {
                CasterRun::new(index, self.isa, &Regular, receivers, &visit).finish(plan)
            }
        })
    }
}

/// From what casters leave of a light to a value.
trait CasterReduction: Sync {
    type Value: Copy + Default + Send;

    fn of(&self, answer: &CasterAnswer<'_>) -> Self::Value;
}

/// Lit samples.
struct CasterLitCount {
    columns: u32,
}

impl CasterReduction for CasterLitCount {
    type Value = u32;

    fn of(&self, answer: &CasterAnswer<'_>) -> u32 {
        if answer.lit { answer.rows.len() as u32 * self.columns } else { reduce::lit_count(answer.rows, self.columns) }
    }
}

/// Weights of lit samples, seen through panes.
struct Through<'a, E>(&'a Emission<E>);

impl<E: AsRef<[Weight]> + Sync> CasterReduction for Through<'_, E> {
    type Value = [u32; 3];

    fn of(&self, answer: &CasterAnswer<'_>) -> [u32; 3] {
        match (answer.lit, answer.depths.is_empty()) {
            (true, true) => self.0.total(),
            (false, true) => self.0.lit(answer.rows),
            _ => self.0.lit_through(answer.rows, answer.depths),
        }
    }
}
