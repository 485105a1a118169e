//! The conformance suite: what any executor has to pass, bit by bit, for every word width.
//!
//! A further executor is one line: implement [`Subject`] and name it in [`conformance_suite!`](crate::conformance_suite).

use std::{
    borrow::Cow,
    sync::{LazyLock, OnceLock},
};

use bytemuck::Zeroable;
use umbra4_core::{
    Exact, Lift, Plan, SceneFacts,
    glam::DVec3,
    occluder::Occluder,
    order::Entry,
    proj4::{KeyTile, NOTHING},
    serial::{Buffers, Serial},
    snap::SnapParams,
};
use umbra4_cpu::{Binning, CpuExecutor, CpuWord, GridOptions, Index, Isa, Occluders, Rows};

use crate::{
    compare::{Amount, Compared, Mismatch, bits_of, compare_masks, compare_visibility, lit_counts},
    hard_cases::{Case, Check, GRIDS, HARD_CASES, HardCase},
    ledger::Ledger,
    rng::Rng,
    scene::{Inputs, Scene},
    scenes::{self, EXPONENTS, GENERATORS},
};

/// Something that computes masks.
pub trait Subject {
    /// What it is called in reports.
    fn name(&self) -> String;
    /// Whether it takes jittered samples.
    fn jitters(&self) -> bool {
        true
    }
    /// The masks of all receivers, receiver-major, a word per row of the light.
    ///
    /// # Errors
    /// Why it refuses, in words.
    fn masks<W: CpuWord>(&self, inputs: &Inputs) -> Result<Vec<W>, String>;
    /// The fraction of lit samples of every receiver.
    ///
    /// # Errors
    /// Why it refuses, in words.
    fn visibility(&self, inputs: &Inputs) -> Result<Vec<f32>, String>;
}

/// The executor on CPU threads.
#[derive(Debug)]
pub struct Cpu {
    executor: CpuExecutor,
    name: String,
    grid: bool,
    arranged: bool,
}

impl Cpu {
    /// On `threads` threads, with the given instruction set.
    pub fn new(threads: usize, isa: Isa) -> Self {
        let executor = CpuExecutor::new().with_isa(isa).with_threads(threads).expect("threads can be started");
        assert_eq!(executor.isa(), isa, "the processor has the instruction set that is tested");
        Self { executor, name: format!("cpu, {threads} threads, {isa}"), grid: false, arranged: false }
    }
}

impl Cpu {
    /// As [`Cpu::new`], with the widest instruction set but `place` that this processor has; portable code where it has
    /// no more.
    pub fn nth_isa(threads: usize, place: usize) -> Self {
        Self::new(threads, Isa::available().get(place).copied().unwrap_or(Isa::Portable))
    }
}

impl Cpu {
    /// All triangles one by one.
    #[must_use]
    pub fn by_triangles(self) -> Self {
        Self {
            executor: self.executor.with_index(Index::Hierarchy),
            name: format!("{}, by triangles", self.name),
            ..self
        }
    }

    /// Edges of the silhouette, however many there are.
    #[must_use]
    pub fn by_silhouette(self) -> Self {
        Self {
            executor: self.executor.with_index(Index::Silhouette),
            name: format!("{}, by silhouette", self.name),
            ..self
        }
    }
}

impl Cpu {
    /// Meshes are arranged in another shape, and then moved to where they are.
    #[must_use]
    pub fn arranged(self) -> Self {
        Self { name: format!("{}, arranged", self.name), arranged: true, ..self }
    }

    fn occluders<'a>(&self, inputs: &'a Inputs) -> Result<Cow<'a, Occluders>, String> {
        if !self.arranged {
            return Ok(Cow::Borrowed(&inputs.occluders));
        }
        let lattice = &inputs.lattice;
        let vertices: Vec<DVec3> = inputs.occluders.vertices().iter().map(|&p| lattice.to_world(p)).collect();
        let mut elsewhere = vertices.clone();
        elsewhere.rotate_left(1.min(vertices.len()));
        let occluders = Occluders::from_f64(lattice, &elsewhere, inputs.occluders.triangles());
        let mut occluders = occluders.map_err(|error| error.to_string())?.arranged();
        occluders.move_vertices_f64(lattice, &vertices).map_err(|error| error.to_string())?;
        Ok(Cow::Owned(occluders))
    }
}

impl Cpu {
    /// The paper's grid with all its optimisations, on two threads.
    pub fn grid() -> Self {
        Self::nth_isa(2, 0).with_grid(GridOptions::default())
    }

    /// The paper's Algorithm 1: every receiver in all of its cells, no rejection, one light sample at a time.
    pub fn plain_grid() -> Self {
        Self::nth_isa(2, 0).with_grid(GridOptions {
            cells: [13, 9],
            binning: Binning::AllCells,
            early_rejection: false,
            rows: Rows::Bits,
        })
    }

    fn with_grid(self, options: GridOptions) -> Self {
        let name = format!("{}, {options:?}", self.name);
        Self { executor: self.executor.with_index(Index::Grid(options)), name, grid: true, ..self }
    }
}

impl Subject for Cpu {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn jitters(&self) -> bool {
        !self.grid
    }

    fn masks<W: CpuWord>(&self, inputs: &Inputs) -> Result<Vec<W>, String> {
        let (masks, _) = self
            .executor
            .masks::<W>(self.occluders(inputs)?.as_ref(), &inputs.light, &inputs.receivers)
            .map_err(|error| error.to_string())?;
        Ok(masks.into_words())
    }

    fn visibility(&self, inputs: &Inputs) -> Result<Vec<f32>, String> {
        let (visibility, _) = self
            .executor
            .visibility(self.occluders(inputs)?.as_ref(), &inputs.light, &inputs.receivers)
            .map_err(|error| error.to_string())?;
        Ok(visibility)
    }
}

/// The serial reference executor of core, its buffers allocated here.
#[derive(Clone, Copy, Debug)]
pub struct SerialSubject {
    /// Receivers worked on at once.
    pub block: u32,
}

impl SerialSubject {
    fn run<W: CpuWord>(self, inputs: &Inputs, visibility: bool) -> Result<(Vec<W>, Vec<f32>), String> {
        let (triangles, points) = (inputs.occluders.triangles(), inputs.receivers.points());
        let plan = Plan::new(SceneFacts {
            triangles: triangles.len() as u32,
            receivers: points.len() as u32,
            visibility,
            block: self.block,
            jittered: inputs.light.jitter.is_some(),
            ..SceneFacts::default()
        });
        let mut masks = vec![W::EMPTY; points.len() * inputs.light.rows as usize];
        let mut fractions = vec![f32::NAN; if visibility { points.len() } else { 0 }];
        let buffers = Buffers {
            world_vertices: &[],
            vertices: &mut inputs.occluders.vertices().to_vec(),
            triangles,
            triangle_keys: &mut vec![NOTHING; triangles.len()],
            triangle_order: &mut vec![Entry::zeroed(); triangles.len()],
            occluders: &mut vec![Occluder::zeroed(); triangles.len()],
            nodes: &mut vec![KeyTile::NOTHING; plan.levels().tiles()],
            world_receivers: &[],
            normals: &[],
            receivers: &mut points.to_vec(),
            receiver_keys: &mut vec![NOTHING; points.len()],
            receiver_order: &mut vec![Entry::zeroed(); points.len()],
            masks: &mut masks,
            visibility: &mut fractions,
        };
        // Nothing is snapped in this run.
        let snap = SnapParams { scale: f32::NAN };
        let mut serial = Serial::<W, Exact>::new(&plan, inputs.light, snap, Lift::NONE, buffers);
        plan.run(&mut serial).map_err(|error| error.to_string())?;
        Ok((masks, fractions))
    }
}

impl Subject for SerialSubject {
    fn name(&self) -> String {
        format!("serial, blocks of {}", self.block)
    }

    fn masks<W: CpuWord>(&self, inputs: &Inputs) -> Result<Vec<W>, String> {
        Ok(self.run::<W>(inputs, false)?.0)
    }

    fn visibility(&self, inputs: &Inputs) -> Result<Vec<f32>, String> {
        Ok(self.run::<u64>(inputs, true)?.1)
    }
}

/// Whether visibilities are asked for beside masks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visibility {
    /// Compare them too.
    Compared,
    /// Masks only.
    Left,
}

/// Compares the subject's results on one scene with the oracle's.
///
/// # Errors
/// The first difference, in words.
pub fn check<W: CpuWord>(subject: &impl Subject, inputs: &Inputs, visibility: Visibility) -> Result<Compared, String> {
    Ok(checked::<W>(subject, inputs, &inputs.oracle(), visibility)?.0)
}

/// As [`check`], with what the oracle found. Returns the subject's masks too.
fn checked<W: CpuWord>(
    subject: &impl Subject,
    inputs: &Inputs,
    expected: &[u64],
    visibility: Visibility,
) -> Result<(Compared, Vec<W>), String> {
    let amount = if inputs.receivers.is_empty() { Amount::None } else { Amount::Some };
    let (rows, columns) = (inputs.light.rows, inputs.light.columns);
    let masks = subject.masks::<W>(inputs)?;
    let compared = compare_masks(expected, &masks, rows, columns, amount).map_err(|m: Mismatch| m.to_string())?;
    if visibility == Visibility::Compared {
        let lit = lit_counts(expected, rows, columns);
        compare_visibility(&lit, &subject.visibility(inputs)?, rows * columns, amount).map_err(|m| m.to_string())?;
    }
    Ok((compared, masks))
}

/// The smallest part of a failing scene that still fails: one receiver, if one suffices, and few triangles.
pub fn minimise<W: CpuWord>(subject: &impl Subject, inputs: &Inputs) -> Scene {
    let exponent = inputs.lattice.exponent();
    let fails = |scene: &Scene| check::<W>(subject, &scene.inputs(exponent), Visibility::Compared).is_err();
    let mut scene = inputs.scene();
    let alone = scene.receivers.iter().map(|&p| Scene { receivers: vec![p], ..scene.clone() }).find(|s| fails(s));
    scene = alone.unwrap_or(scene);
    let mut chunk = scene.mesh.triangles.len();
    while chunk > 0 {
        let mut from = 0;
        while from < scene.mesh.triangles.len() {
            let mut smaller = scene.clone();
            smaller.mesh.triangles.drain(from..(from + chunk).min(scene.mesh.triangles.len()));
            if fails(&smaller) {
                scene = smaller;
            } else {
                from += chunk;
            }
        }
        chunk /= 2;
    }
    // Vertices that are no longer named only clutter the report.
    let mut mesh = crate::meshes::Mesh::default();
    for t in &scene.mesh.triangles {
        mesh.add_triangle(t.map(|v| scene.mesh.vertices[v as usize]));
    }
    let tidy = Scene { mesh, ..scene.clone() };
    if fails(&tidy) { tidy } else { scene }
}

/// Names the failure and the smallest scene that shows it.
fn report<W: CpuWord>(subject: &impl Subject, what: &str, inputs: &Inputs, error: &str) -> ! {
    let scene = minimise::<W>(subject, inputs);
    let smallest = check::<W>(subject, &scene.inputs(inputs.lattice.exponent()), Visibility::Compared);
    panic!(
        "{}, words of {} bits, {what}: {error}\nsmallest scene that fails: {:?}\n{:?}\nreceivers {:?}\nvertices {:?}\n\
         triangles {:?}",
        subject.name(),
        W::BITS,
        smallest.err(),
        scene.light,
        scene.receivers,
        scene.mesh.vertices,
        scene.mesh.triangles,
    );
}

/// Compares at least `bits` bits on scenes of the generator called `name`.
///
/// # Panics
/// At the first difference.
pub fn property<W: CpuWord>(subject: &impl Subject, word: &str, name: &str, bits: u64, ledger: &Ledger) {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).expect("a generator has this name");
    let mut rng = Rng::named(0, &format!("{} {word} {name}", subject.name()));
    let mut total = Compared::default();
    let mut round = 0;
    // However few bits are asked for: a jittered light among them, and something that is blocked beside something that is not.
    let mixed = |total: &Compared| total.blocked > 0 && total.blocked < total.bits;
    while total.bits < bits || round < 3 || (round < 60 && !mixed(&total)) {
        let mut samples = scenes::grid(&mut rng, W::BITS);
        if subject.jitters() && round % 3 == 2 {
            samples = samples.jittered(&mut rng);
        }
        let scene = generator(&mut rng, samples);
        let inputs = scene.inputs(EXPONENTS[round % EXPONENTS.len()]);
        // Asking for visibility computes everything again: one scene in eight.
        let visibility = if round % 8 == 0 { Visibility::Compared } else { Visibility::Left };
        match check::<W>(subject, &inputs, visibility) {
            Ok(compared) => {
                total.bits += compared.bits;
                total.blocked += compared.blocked;
            }
            Err(error) => report::<W>(subject, &format!("{name}, scene {round}"), &inputs, &error),
        }
        round += 1;
    }
    // A scene generator whose lights are never, or always, blocked would test nothing.
    assert!(mixed(&total), "{name}: {total:?} tests nothing");
    ledger.enter(&format!("{}, {word}", subject.name()), total);
}

/// A hard case on a grid, and what the oracle makes of it: found once for all subjects and words of a process.
struct Known {
    name: &'static str,
    what: String,
    case: Case,
    expected: OnceLock<Vec<u64>>,
}

static KNOWN: LazyLock<Vec<Known>> = LazyLock::new(|| {
    let grids = HARD_CASES.iter().flat_map(|case| GRIDS.map(|grid| (case, grid)));
    let known = |(&(name, build), (rows, columns)): (&(&'static str, HardCase), (u32, u32))| {
        build(rows, columns).into_iter().enumerate().map(move |(k, case)| {
            let what = format!("{name}, case {k}, {rows}×{columns}");
            Known { name, what, case, expected: OnceLock::new() }
        })
    };
    grids.flat_map(known).collect()
});

/// Runs the catalogue of hard cases on every sample grid that the word holds; of each case, only one grid in `every`, where all of
/// them are run for another word that the executor computes alike.
///
/// # Panics
/// At the first difference from the oracle, or from what a case states.
pub fn hard_cases<W: CpuWord>(subject: &impl Subject, word: &str, every: usize, ledger: &Ledger) {
    let mut total = Compared::default();
    // Executors choose the word for visibility themselves: once is enough, with a word for which every case is run.
    let visibility = if word == "pair" { Visibility::Compared } else { Visibility::Left };
    for &(name, _) in HARD_CASES {
        let mut run = 0;
        // A light that is wider than the word is the error tests' business.
        let fits = |known: &&Known| known.name == name && known.case.inputs.light.columns <= W::BITS;
        for Known { what, case, expected, .. } in KNOWN.iter().filter(fits).step_by(every) {
            let expected = expected.get_or_init(|| case.inputs.oracle());
            match checked::<W>(subject, &case.inputs, expected, visibility) {
                Ok((compared, masks)) => {
                    total.bits += compared.bits;
                    total.blocked += compared.blocked;
                    let masks: Vec<u64> = masks.into_iter().map(bits_of).collect();
                    if let Err(error) = case.check.holds(&masks, &case.inputs.light) {
                        panic!("{}, {word}, {what}: {error}", subject.name());
                    }
                    run += usize::from(case.check != Check::NoMasks || masks.is_empty());
                }
                Err(error) => report::<W>(subject, what, &case.inputs, &error),
            }
        }
        assert!(
            run > 0 || (name == "light_64x64" && W::BITS < 64),
            "{name} has not run with words of {} bits",
            W::BITS
        );
    }
    ledger.enter(&format!("{}, {word}", subject.name()), total);
}

/// Instantiates the suite, for every word width, for each executor named:
/// `conformance_suite! { module => expression of a Subject, … }`.
#[macro_export]
macro_rules! conformance_suite {
    ($($module:ident => $subject:expr),+ $(,)?) => {
        $crate::conformance_suite! { @properties [$($module => $subject),+]
            soup, tiny, outermost, slivers, zero_area, coarse_grid, in_planes, closed_meshes, across_planes, interior,
            crowd, full_coverage
        }
    };
    (@properties $modules:tt $($property:ident),+) => {
        #[test]
        fn every_generator_is_instantiated() {
            let generators = $crate::scenes::GENERATORS.map(|(name, _)| name);
            assert_eq!(generators.as_slice(), &[$(stringify!($property)),+]);
        }

        const PROPERTIES: usize = [$(stringify!($property)),+].len();
        $crate::conformance_suite! { @subjects $modules [$($property),+] }
    };
    (@subjects [$($module:ident => $subject:expr),+] $properties:tt) => {
        const SUBJECTS: usize = [$(stringify!($module)),+].len();
        const WORDS: usize = 4;
        static LEDGER: std::sync::LazyLock<$crate::ledger::Ledger> = std::sync::LazyLock::new(|| {
            $crate::ledger::Ledger::new(SUBJECTS * WORDS * (PROPERTIES + 1), $crate::budget::asked())
        });
        $(
            mod $module {
                $crate::conformance_suite! { @word u16, u16, $subject, $properties }
                $crate::conformance_suite! { @word u32, u32, $subject, $properties }
                $crate::conformance_suite! { @word u64, u64, $subject, $properties }
                $crate::conformance_suite! { @word pair, umbra4_core::PairWord, $subject, $properties }
            }
        )+
    };
    (@word $name:ident, $word:ty, $subject:expr, [$($property:ident),+]) => {
        mod $name {
            #[test]
            fn hard_cases() {
                $crate::suite::hard_cases::<$word>(&$subject, stringify!($name), 1, &super::super::LEDGER);
            }
            $(
                #[test]
                fn $property() {
                    let tests = (super::super::SUBJECTS * super::super::WORDS * super::super::PROPERTIES) as u64;
                    $crate::suite::property::<$word>(
                        &$subject,
                        stringify!($name),
                        stringify!($property),
                        $crate::budget::asked().div_ceil(tests),
                        &super::super::LEDGER,
                    );
                }
            )+
        }
    };
}
