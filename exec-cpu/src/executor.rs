//! The executor that users hold: options, and the ways to ask.

use std::{sync::Arc, time::Instant};

use rayon::{ThreadPool, ThreadPoolBuilder};
use thiserror::Error;
use umbra4_core::{
    IndexKind, LatticeLight, Plan, Precision, Punctual, SceneFacts,
    emission::{Emission, Weight},
    jitter::{Pattern, Regular},
    light::MAX_SAMPLES,
    stage::{Stage, reduce},
};
use umbra4_cpu_kernels::Detected;
use umbra4_maps::stochastic::StochasticError;

use crate::{
    CpuWord, HardShadows, Index, Isa, Masks, Occluders, Receivers, SceneError, Statistics,
    hard_shadows::ShadowBits,
    punctual::{Faces, Input, Part, PunctualRun},
    reduction::{LitCount, Pairs, Reduction, Visibility},
    run::{How, Run},
    scatter::Scatter,
};

/// Why a run is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ExecutorError {
    /// The mask word holds fewer columns than the light has.
    #[error("a light of {columns} columns does not fit words of {bits} bits")]
    WordTooNarrow {
        /// Columns of the light.
        columns: u32,
        /// Bits of the word.
        bits: u32,
    },
    /// The thread pool could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
    /// The result would not fit the address space.
    #[error("masks of {receivers} receivers, {rows} words each, do not fit the memory")]
    TooManyWords {
        /// Receivers.
        receivers: usize,
        /// Words of a receiver's mask: a row each, or of a cloud 32 samples.
        rows: u32,
    },
    /// Masks to add to are those of other receivers, or of another light.
    #[error("masks are {words} words, not those of {receivers} receivers with {rows} rows")]
    MaskCount {
        /// Words given.
        words: usize,
        /// Receivers.
        receivers: usize,
        /// Rows of the light.
        rows: u32,
    },
    /// The grid cannot have so many cells.
    #[error("grid {field} is {value}, outside 1..={}", umbra4_core::grid::MAX_CELLS)]
    GridCells {
        /// `cells[0]` (columns) or `cells[1]` (rows).
        field: &'static str,
        /// Its value.
        value: u32,
    },
    /// The paper's grid is the reference for the paper's figures, and takes the paper's samples.
    #[error("the light's samples are jittered: the grid takes regular ones only")]
    JitteredGrid,
    /// The emission is another light's.
    #[error("an emission of {}×{} samples for a light of {}×{}", emission[0], emission[1], light[0], light[1])]
    EmissionSize {
        /// Rows and columns of the emission.
        emission: [u32; 2],
        /// Rows and columns of the light.
        light: [u32; 2],
    },
    /// Receivers' normals are refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Options of microquad soft shadow mapping are refused.
    #[error(transparent)]
    Microquads(#[from] umbra4_maps::microquad::MicroquadError),
    /// Options of a stochastic soft shadow map are refused.
    #[error(transparent)]
    Stochastic(#[from] StochasticError),
    /// The technique gives visibility alone.
    #[error("a stochastic soft shadow map has no masks: ask for visibility")]
    NoMasks,
    /// One of many lights is refused.
    #[error("lights[{index}]: {source}")]
    Light {
        /// Its place among them.
        index: usize,
        /// Why.
        source: Box<ExecutorError>,
    },
    /// There is no such caster.
    #[error("caster {place} of {casters}: there is none")]
    NoCaster {
        /// Its place.
        place: usize,
        /// Casters there are.
        casters: usize,
    },
    /// The lists of the grid's cells would not fit the memory.
    #[error("the cells of the grid hold {entries} {field}, too many for the memory: use fewer cells or receivers")]
    GridTooLarge {
        /// "receivers" or "triangles".
        field: &'static str,
        /// Entries of all cells together.
        entries: usize,
    },
}

/// Receivers worked on at once: bounds the memory of a run, whatever the size of the image.
pub(crate) const BLOCK: u32 = 1 << 18;

/// Runs the stages on CPU threads.
///
/// ```
/// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
/// use umbra4_core::{glam::{DVec3, Vec3}, AreaLight, Bounds, Lattice, Lift};
///
/// let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
/// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?; // X × Z = −Y: shines down
/// let bounds = Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) };
///
/// let lattice = Lattice::covering(bounds)?;
/// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
/// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
/// let light = light.snap(&lattice, Lift::NONE)?;
///
/// let (visibility, _) = CpuExecutor::new().visibility(&occluders, &light, &receivers)?;
/// assert!(visibility[0] < 0.5 && visibility[1] == 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct CpuExecutor {
    pub(crate) precision: Precision,
    pub(crate) isa: Detected,
    index: Index,
    pub(crate) pool: Option<Arc<ThreadPool>>,
}

impl Default for CpuExecutor {
    fn default() -> Self {
        Self::new()
    }
}

impl CpuExecutor {
    /// An executor on rayon's global threads, exact, with the widest instruction set of the processor.
    pub fn new() -> Self {
        Self { precision: Precision::Exact, isa: Detected::best(), index: Index::Auto, pool: None }
    }

    /// Uses `threads` threads of its own (0: as many as the machine has).
    ///
    /// # Errors
    /// The system refuses the threads.
    pub fn with_threads(mut self, threads: usize) -> Result<Self, ExecutorError> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|e| ExecutorError::Threads { threads, reason: e.to_string() })?;
        self.pool = Some(Arc::new(pool));
        Ok(self)
    }

    /// Chooses the precision. Masks of jittered samples are certified either way.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Chooses the instruction set. One that the processor lacks is not taken: the executor stays as it is.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        if let Some(isa) = isa.detect() {
            self.isa = isa;
        }
        self
    }

    /// Chooses how triangles and receivers are paired: the same masks in another time.
    #[must_use]
    pub fn with_index(mut self, index: Index) -> Self {
        self.index = index;
        self
    }

    /// The instruction set in use.
    pub fn isa(&self) -> Isa {
        self.isa.isa()
    }

    /// What will run for such a scene.
    pub fn plan(&self, occluders: &Occluders, light: &LatticeLight, receivers: &Receivers, visibility: bool) -> Plan {
        Plan::new(SceneFacts {
            jittered: light.jitter.is_some(),
            arranged: occluders.arrangement().is_some(),
            reached: receivers.meet(*light),
            facing: !receivers.facings().is_empty(),
            triangles: occluders.triangles().len() as u32,
            receivers: receivers.len() as u32,
            visibility,
            block: BLOCK,
            index: match self.index {
                Index::Hierarchy => IndexKind::Hierarchy,
                Index::Auto | Index::Silhouette => IndexKind::Silhouette,
                Index::Grid(_) => IndexKind::Grid,
            },
            ..SceneFacts::default()
        })
    }

    /// What will run for a light without extent, in each of its frames that has receivers.
    pub fn plan_hard_shadows(&self, occluders: &Occluders, light: &Punctual, receivers: &Receivers) -> Plan {
        punctual_plan(
            occluders.triangles().len(),
            receivers.len(),
            receivers.meet(*light),
            !receivers.facings().is_empty(),
        )
    }

    /// The masks of all receivers.
    ///
    /// # Errors
    /// The word is too narrow for the light.
    pub fn masks<W: CpuWord>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Masks<W>, Statistics), ExecutorError> {
        let rows = light.rows as usize;
        let too_many = ExecutorError::TooManyWords { receivers: receivers.len(), rows: light.rows };
        let count = receivers.len().checked_mul(rows).ok_or_else(|| too_many.clone())?;
        // The system's zero pages: those of receivers in full light are never touched.
        let mut words = bytemuck::allocation::try_zeroed_vec::<W>(count).map_err(|()| too_many)?;
        let out = Scatter::new(&mut words);
        let statistics = self.run::<W>(occluders, light, receivers, false, |answer| {
            if !answer.lit {
                // SAFETY: every receiver is visited once, and its part is its own.
                unsafe { out.part(answer.receiver * rows, rows) }.copy_from_slice(answer.rows);
            }
        })?;
        Ok((Masks { rows, words }, statistics))
    }

    /// The fraction of lit samples of every receiver, in `0.0..=1.0`. Masks are never stored.
    ///
    /// # Errors
    /// None but those of the thread pool; the word is chosen to fit the light.
    pub fn visibility(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Statistics), ExecutorError> {
        let table: Vec<f32> =
            (0..=light.sample_count()).map(|lit| reduce::visibility(lit, light.sample_count())).collect();
        self.per_receiver(occluders, light, receivers, Visibility { columns: light.columns, table })
    }

    /// The light that every receiver gets, red, green and blue: sums of the weights of lit samples, of which
    /// [`Emission::fraction`] makes fractions. Masks are never stored.
    ///
    /// # Errors
    /// An emission of another number of rows or columns than the light's.
    pub fn light<S: AsRef<[Weight]> + Sync>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        emission: &Emission<S>,
    ) -> Result<(Vec<[u32; 3]>, Statistics), ExecutorError> {
        Self::check_emission(light, emission)?;
        self.per_receiver(occluders, light, receivers, emission)
    }

    pub(crate) fn check_emission<S: AsRef<[Weight]>>(
        light: &LatticeLight,
        emission: &Emission<S>,
    ) -> Result<(), ExecutorError> {
        let (emission, light) = (emission.size(), [light.rows, light.columns]);
        if emission == light { Ok(()) } else { Err(ExecutorError::EmissionSize { emission, light }) }
    }

    /// The lit samples of every receiver, `0..=light.sample_count()`: what [`umbra4_core::accumulate`] adds up over frames.
    ///
    /// # Errors
    /// As [`CpuExecutor::visibility`].
    pub fn lit_counts(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Vec<u32>, Statistics), ExecutorError> {
        self.per_receiver(occluders, light, receivers, LitCount { columns: light.columns })
    }

    /// How many triangles block at least one sample of each receiver; for receivers in full shadow, how many were met
    /// until nothing was left to block. Shows where the work goes.
    ///
    /// # Errors
    /// As [`CpuExecutor::visibility`].
    pub fn pairs_per_receiver(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Vec<u32>, Statistics), ExecutorError> {
        // The silhouette has no pairs to count.
        let one_by_one = match self.index {
            Index::Grid(_) => self.clone(),
            _ => self.clone().with_index(Index::Hierarchy),
        };
        one_by_one.per_receiver(occluders, light, receivers, Pairs)
    }

    /// Hands the mask of every receiver to `visit(receiver, rows)`, once each, from many threads and in any order, and
    /// stores none: memory stays bounded, whatever the number of receivers.
    ///
    /// # Errors
    /// The word is too narrow for the light.
    pub fn visit<W: CpuWord>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        visit: impl Fn(usize, &[W]) + Sync,
    ) -> Result<Statistics, ExecutorError> {
        self.run::<W>(occluders, light, receivers, false, |answer| visit(answer.receiver, answer.rows))
    }

    /// The shadow of a light without extent: which receivers it does not reach.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
    /// use umbra4_core::{DirectionalLight, PointLight, glam::{DVec3, Vec3}, Bounds, Lattice};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
    ///
    /// let executor = CpuExecutor::new();
    /// let lamp = PointLight { position: DVec3::new(0.0, 3.0, 0.0) }.snap(&lattice)?;
    /// let (shadows, _) = executor.hard_shadows(&occluders, &lamp, &receivers)?;
    /// assert_eq!((shadows.is_blocked(0), shadows.is_blocked(1)), (Some(true), Some(false)));
    /// let sun = DirectionalLight { towards: DVec3::new(-3.0, 1.0, 0.0) }.snap()?;
    /// let (shadows, _) = executor.hard_shadows(&occluders, &sun, &receivers)?;
    /// assert_eq!((shadows.is_blocked(0), shadows.is_blocked(1)), (Some(false), Some(true)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// The index is always a hierarchy, whatever [`CpuExecutor::with_index`] chose.
    ///
    /// # Errors
    /// None yet.
    pub fn hard_shadows(
        &self,
        occluders: &Occluders,
        light: &Punctual,
        receivers: &Receivers,
    ) -> Result<(HardShadows, Statistics), ExecutorError> {
        let (shadows, mut statistics) = (ShadowBits::new(receivers.len()), Statistics::default());
        let work = || {
            let start = Instant::now();
            let facing = !receivers.facings().is_empty();
            let faces = Faces::new(light, occluders, receivers.points());
            let parts: Vec<Part> = (0..light.faces()).filter_map(|face| faces.part(face)).collect();
            if !parts.is_empty() {
                statistics.add(Stage::KeyTriangles, start.elapsed());
            }
            parts.iter().try_for_each(|part| {
                let plan = punctual_plan(part.triangles.len(), part.receivers.len(), true, facing);
                let input = Input {
                    plan: &plan,
                    isa: self.isa,
                    precision: self.precision,
                    light: *light,
                    scene: occluders,
                    receivers,
                    part,
                };
                plan.run(&mut PunctualRun::new(input, &shadows, &mut statistics))
            })
        };
        self.install(work)?;
        statistics.sort();
        Ok((shadows.finish(), statistics))
    }

    /// What `reduction` makes of every mask, in the order of the receivers.
    pub(crate) fn per_receiver<R: Reduction>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        reduction: R,
    ) -> Result<(Vec<R::Value>, Statistics), ExecutorError> {
        // The narrowest word that has kernels and holds a row: more rows fit a register.
        match light.columns {
            0..=32 => self.reduced::<u32, R>(occluders, light, receivers, &reduction),
            _ => self.reduced::<u64, R>(occluders, light, receivers, &reduction),
        }
    }

    fn reduced<W: CpuWord, R: Reduction>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        reduction: &R,
    ) -> Result<(Vec<R::Value>, Statistics), ExecutorError> {
        let mut values = vec![R::Value::default(); receivers.len()];
        let out = Scatter::new(&mut values);
        let statistics = self.run::<W>(occluders, light, receivers, true, |answer| {
            // SAFETY: every receiver is visited once, and its element is its own.
            unsafe { out.part(answer.receiver, 1) }.fill(reduction.of(&answer));
        })?;
        Ok((values, statistics))
    }

    fn run<W: CpuWord>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        visibility: bool,
        visit: impl Fn(Answer<'_, W>) + Sync,
    ) -> Result<Statistics, ExecutorError> {
        if light.columns > W::BITS {
            return Err(ExecutorError::WordTooNarrow { columns: light.columns, bits: W::BITS });
        }
        if let Index::Grid(options) = &self.index {
            options.check()?;
            if light.jitter.is_some() {
                return Err(ExecutorError::JitteredGrid);
            }
        }
        let plan = self.plan(occluders, light, receivers, visibility);
        let how = How { plan: &plan, isa: self.isa, precision: self.precision, index: self.index };
        let room = [W::EMPTY; MAX_SAMPLES as usize];
        let work = || {
            if light.jitter.is_some() {
                let visit = |answer: Answer<'_, W::Jittered>| {
                    let mut room = room;
                    visit(answer.with_rows(W::of_jittered(answer.rows, &mut room)));
                };
                let samples = Pattern::of(light);
                Run::<W::Jittered, _>::new(how, occluders, *light, &samples, receivers, &visit).finish()
            } else {
                let visit = |answer: Answer<'_, W::Regular>| {
                    let mut room = room;
                    visit(answer.with_rows(W::of_regular(answer.rows, &mut room)));
                };
                Run::<W::Regular, _>::new(how, occluders, *light, &Regular, receivers, &visit).finish()
            }
        };
        self.install(work)
    }

    /// On this executor's threads.
    pub(crate) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

/// What runs for a light without extent, in one of its frames.
fn punctual_plan(triangles: usize, receivers: usize, reached: bool, facing: bool) -> Plan {
    Plan::new(SceneFacts {
        triangles: triangles as u32,
        receivers: receivers as u32,
        block: BLOCK,
        punctual: true,
        reached,
        facing,
        ..SceneFacts::default()
    })
}

/// Whoever the masks go to, receiver by receiver. Not a type of its own for every caller: runs would be compiled anew for each.
pub(crate) type Visit<'a, W> = &'a (dyn Fn(Answer<'_, W>) + Sync);

/// One receiver's result.
pub(crate) struct Answer<'a, W> {
    pub(crate) receiver: usize,
    pub(crate) rows: &'a [W],
    /// No bit is set.
    pub(crate) lit: bool,
    pub(crate) pairs: u32,
}

impl<W> Answer<'_, W> {
    /// The same with rows in other words.
    fn with_rows<'a, T>(&self, rows: &'a [T]) -> Answer<'a, T> {
        Answer { receiver: self.receiver, rows, lit: self.lit, pairs: self.pairs }
    }
}
