//! Microquad soft shadow mapping on a GPU against the CPU executor: the same parameters, texels, pyramid, table, masks and areas, bit by bit.

use std::sync::OnceLock;

use libtest_mimic::Failed;
use umbra4_core::{
    Jitter, LatticeLight,
    glam::{IVec3, Vec3},
};
use umbra4_cpu::{
    CpuExecutor, CpuWord, Occluders, Receivers,
    maps::{
        Technique,
        microquad::{Footprint, HalfSpaces, MicroOccluders, MicroquadError, MicroquadOptions, half_spaces::TableWord},
        stochastic::StochasticOptions,
    },
};
use umbra4_tests::{
    budget,
    compare::bits_of,
    facings,
    gpu::{Check, Test, test},
    ledger::say,
    rng::Rng,
    scenes::{self, GENERATORS, SampleGrid},
    spheres::{lamp, options, spheres},
};
use umbra4_wgpu::{Gpu, GpuError, LatticeReceivers, LatticeScene, Loading, WgpuExecutor};

/// Fewer receivers than most scenes have, so that blocks are tested as well.
const BLOCK: u32 = 75;

/// What is looked at: on the lattice, as both executors take it.
struct Case<'a> {
    occluders: &'a Occluders,
    receivers: &'a Receivers,
    light: LatticeLight,
}

/// Bits compared, and those of them that are set.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    bits: u64,
    blocked: u64,
}

impl Case<'_> {
    fn scene(&self) -> LatticeScene<'_> {
        LatticeScene { vertices: self.occluders.vertices(), triangles: self.occluders.triangles() }
    }

    fn given(&self) -> LatticeReceivers<'_> {
        LatticeReceivers { points: self.receivers.points(), facings: self.receivers.facings(), layers: &[] }
    }

    /// Where the map looks, what it shows, and what goes with it.
    fn map(&self, gpu: &WgpuExecutor, options: &MicroquadOptions) -> Result<(), Failed> {
        let (expected, _) = CpuExecutor::new().shadow_map(options, self.occluders, &self.light, self.receivers)?;
        let (found, _) = gpu.shadow_map(options, &self.scene(), &self.light, self.given())?;
        assert_eq!(found.params(), expected.params());
        assert_eq!(found.receivers_beyond(), expected.receivers_beyond());
        let ([texels, nodes, table], [own_texels, own_nodes, own_table]) =
            (parts(found.buffers()), parts(expected.buffers()));
        assert!(texels == own_texels, "{options:?}: texels");
        assert!(nodes == own_nodes, "{options:?}: nodes");
        assert!(table == own_table, "{options:?}: table");
        Ok(())
    }

    /// Masks, bit by bit.
    fn masks<W: CpuWord + TableWord>(&self, gpu: &WgpuExecutor, options: &MicroquadOptions) -> Result<Tally, Failed> {
        let done = CpuExecutor::new().microquad_masks::<W>(options, self.occluders, &self.light, self.receivers)?;
        let (found, _) = gpu.microquad_masks::<W>(options, &self.scene(), &self.light, self.given())?;
        let (expected, rows) = (done.0.words(), self.light.rows as usize);
        assert_eq!(found.len(), expected.len());
        if let Some(place) = (0..found.len()).find(|&place| found[place] != expected[place]) {
            let (receiver, row) = (place / rows, place % rows);
            let differing = found.iter().zip(expected).filter(|(a, b)| a != b).count();
            let text = format!(
                "{options:?}, {:?}: {differing} of {} rows differ; receiver {receiver}, row {row}: {:x?}, not {:x?}",
                self.light,
                found.len(),
                found[place],
                expected[place]
            );
            return Err(text.into());
        }
        let blocked = expected.iter().map(|word| u64::from(bits_of(*word).count_ones())).sum();
        Ok(Tally { bits: expected.len() as u64 * u64::from(self.light.columns), blocked })
    }

    /// Visibility, by samples or by area: the same bits of floats. No tolerance: sums of areas are made of sealed operations, in the same order.
    fn visibility(&self, gpu: &WgpuExecutor, options: &MicroquadOptions) -> Result<Vec<f32>, Failed> {
        let done = CpuExecutor::new().microquad_visibility(options, self.occluders, &self.light, self.receivers)?;
        let (found, _) = gpu.microquad_visibility(options, &self.scene(), &self.light, self.given())?;
        let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert!(bits(&found) == bits(&done.0), "{options:?}, {:?}: {found:?}, not {:?}", self.light, done.0);
        Ok(found)
    }

    /// All of it.
    fn all<W: CpuWord + TableWord>(&self, gpu: &WgpuExecutor, options: &MicroquadOptions) -> Result<Tally, Failed> {
        self.map(gpu, options)?;
        let seen = self.visibility(gpu, options)?;
        if options.footprint == Footprint::Area {
            // Counted in samples, for the tally.
            let samples = u64::from(self.light.sample_count());
            let blocked = seen.iter().map(|seen| ((1.0 - f64::from(*seen)) * samples as f64) as u64).sum();
            return Ok(Tally { bits: seen.len() as u64 * samples, blocked });
        }
        self.masks::<W>(gpu, options)
    }
}

fn parts<'a>((texels, nodes, table): (&'a [u32], &'a [umbra4_wgpu::maps::pyramid::Node], &'a [u32])) -> [&'a [u32]; 3] {
    [texels, bytemuck::cast_slice(nodes), table]
}

impl Tally {
    fn plus(&mut self, other: Self) {
        self.bits += other.bits;
        self.blocked += other.blocked;
    }
}

const KINDS: [MicroOccluders; 3] =
    [MicroOccluders::Micropatches, MicroOccluders::Microquads, MicroOccluders::Microtris];

fn footprints() -> [Footprint; 4] {
    let table = Footprint::Table(HalfSpaces { directions: 32, distances: 17 });
    [Footprint::Rows, table, Footprint::Rectangles, Footprint::Area]
}

/// Every kind of micro-occluder with every footprint that it and the light have.
fn combinations(size: u32, light: &LatticeLight) -> Vec<MicroquadOptions> {
    let all = KINDS.into_iter().flat_map(|kind| footprints().map(|footprint| options(size, kind, footprint)));
    all.filter(|options| options.check(light).is_ok()).collect()
}

fn of_word<W: CpuWord + TableWord>(executor: &WgpuExecutor, grids: &[(u32, u32)]) -> Result<(), Failed> {
    let mut tally = Tally::default();
    let lit = spheres(8, 17);
    for &(rows, columns) in grids {
        for jitter in [Jitter::NONE, Jitter::pattern(5)] {
            let light = lamp(&lit, rows, columns, jitter);
            let case = Case { occluders: &lit.occluders, receivers: &lit.receivers, light };
            let options = combinations(64, &light);
            assert_eq!(options.len(), if jitter.is_some() { 6 } else { 11 });
            for options in options {
                tally.plus(case.all::<W>(executor, &options)?);
            }
        }
    }
    assert!(tally.blocked > tally.bits / 50 && tally.blocked < tally.bits / 2, "{tally:?}");
    say(&format!("microquads on a GPU, words of {}: {tally:?}, 0 differ", W::BITS));
    Ok(())
}

fn words_16(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    of_word::<u16>(executor, &[(16, 16), (7, 9)])
}

fn words_32(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    of_word::<u32>(executor, &[(32, 32), (9, 5)])
}

fn words_64(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    of_word::<u64>(executor, &[(64, 64), (3, 40), (8, 8)])
}

/// The suite's scenes, which are made of coincidences.
fn generated(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (_, generator) = GENERATORS.iter().find(|(own, _)| *own == name).ok_or("a generator")?;
    let mut rng = Rng::named(0, &format!("microquads {name}"));
    let mut tally = Tally::default();
    for bits in [16, 32, 64] {
        for round in 0..budget::of(3) {
            let grid = scenes::grid(&mut rng, bits);
            let grid = if round == 1 { grid.jittered(&mut rng) } else { SampleGrid::regular(grid.rows, grid.columns) };
            let inputs = generator(&mut rng, grid).inputs(0);
            let normals = facings::normals(&mut rng, &inputs, &facings::samples(&inputs));
            let facing = inputs.receivers.clone().facing(&normals)?;
            let receivers = if round == 2 { &facing } else { &inputs.receivers };
            let case = Case { occluders: &inputs.occluders, receivers, light: inputs.light };
            for mut options in combinations(32, &inputs.light) {
                options.map.near = [0.5, 0.01][round % 2];
                options.map.widest = 20.0;
                tally.plus(match bits {
                    16 => case.all::<u16>(executor, &options)?,
                    32 => case.all::<u32>(executor, &options)?,
                    _ => case.all::<u64>(executor, &options)?,
                });
            }
        }
    }
    assert!(tally.blocked > 0 && tally.blocked < tally.bits, "{tally:?}");
    say(&format!("microquads on a GPU, {name}: {tally:?}, 0 differ"));
    Ok(())
}

/// Maps of the smallest size to large ones, and search areas of so many texels that a software driver stops threads.
fn sizes(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let lit = spheres(27, 6);
    let light = lamp(&lit, 64, 64, Jitter::NONE);
    let case = Case { occluders: &lit.occluders, receivers: &lit.receivers, light };
    for (size, footprint) in [(16, Footprint::Rows), (512, Footprint::Rows), (256, Footprint::Area)] {
        let tally = case.all::<u64>(executor, &options(size, MicroOccluders::Microtris, footprint))?;
        assert!(tally.blocked > tally.bits / 50, "{tally:?}");
    }
    case.map(executor, &options(2048, MicroOccluders::Microtris, Footprint::Rows))
}

fn hard(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let lit = spheres(1, 8);
    let light = lamp(&lit, 8, 8, Jitter::NONE);
    let empty = Occluders::new(&lit.lattice, &[], &[])?;
    let nobody = Receivers::raw(&lit.lattice, &[])?;
    // Behind the lamp, in its plane, and nearer than all occluders; and one far to the side.
    let odd = [[0.0, 4.0, 0.0], [0.0, 3.0, 0.0], [0.0, 2.999, 0.0], [7.0, 2.0, 0.0]].map(Vec3::from_array);
    let odd = Receivers::raw(&lit.lattice, &odd)?;
    for options in combinations(16, &light) {
        let seen = |occluders, receivers| Case { occluders, receivers, light }.visibility(executor, &options);
        assert!(seen(&empty, &lit.receivers)?.iter().all(|seen| *seen == 1.0));
        assert!(seen(&lit.occluders, &nobody)?.is_empty());
        assert_eq!(seen(&lit.occluders, &odd)?, [0.0, 0.0, 1.0, 1.0]);
        for (occluders, receivers) in [(&empty, &lit.receivers), (&lit.occluders, &nobody), (&lit.occluders, &odd)] {
            Case { occluders, receivers, light }.all::<u16>(executor, &options)?;
        }
        let map = executor.shadow_map(
            &options,
            &LatticeScene { vertices: lit.occluders.vertices(), triangles: lit.occluders.triangles() },
            &light,
            odd.points(),
        )?;
        assert_eq!(map.0.receivers_beyond(), 1);
    }
    // A single sample.
    let lit = spheres(8, 17);
    let light = lamp(&lit, 1, 1, Jitter::NONE);
    let case = Case { occluders: &lit.occluders, receivers: &lit.receivers, light };
    let mut tally = Tally::default();
    for options in combinations(64, &light) {
        tally.plus(case.all::<u16>(executor, &options)?);
        tally.plus(case.all::<u64>(executor, &options)?);
    }
    assert!(tally.blocked > 0 && tally.blocked < tally.bits, "{tally:?}");
    // Triangles that name vertices which do not exist, and degenerate ones, are not drawn, beside one that is.
    let vertices =
        [[-1.0, 1.5, -1.0], [1.0, 1.5, -1.0], [0.0, 1.5, 1.0]].map(|v| lit.lattice.snap(Vec3::from_array(v)));
    let vertices = [vertices[0]?, vertices[1]?, vertices[2]?];
    let scene =
        |triangles: &'static [[u32; 3]]| (LatticeScene { vertices: &vertices, triangles }, MicroquadOptions::default());
    let (all, options) = scene(&[[0, 0, 1], [0, 1, 9], [0, 1, 2], [u32::MAX, 1, 0]]);
    let (one, _) = scene(&[[0, 1, 2]]);
    let seen = |scene| executor.microquad_visibility(&options, scene, &light, lit.receivers.points());
    let (seen_all, seen_one) = (seen(&all)?.0, seen(&one)?.0);
    assert_eq!(seen_all, seen_one);
    assert!(seen_one.contains(&0.0) && seen_one.contains(&1.0));
    Ok(())
}

/// Receivers that face away are dark, as those of the exact system are.
fn facing(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let lit = spheres(1, 4);
    let receivers = Receivers::raw(&lit.lattice, &[Vec3::new(1.5, 0.5, 1.5); 2])?.facing(&[Vec3::Y, Vec3::NEG_Y])?;
    for jitter in [Jitter::NONE, Jitter::pattern(2)] {
        let light = lamp(&lit, 8, 8, jitter);
        let case = Case { occluders: &lit.occluders, receivers: &receivers, light };
        for options in combinations(64, &light) {
            assert_eq!(case.visibility(executor, &options)?, [1.0, 0.0]);
            if options.footprint != Footprint::Area {
                let exact = executor.masks::<u16>(&case.scene(), &light, case.given())?.0;
                let found = executor.microquad_masks::<u16>(&options, &case.scene(), &light, case.given())?.0;
                assert_eq!((&found, exact), (&[[0; 8], [0xff; 8]].concat(), found.clone()));
            }
        }
    }
    // A run whose receivers face somewhere leaves nothing behind for one whose do not.
    let light = lamp(&lit, 8, 8, Jitter::NONE);
    let (points, case) = (receivers.points(), Case { occluders: &lit.occluders, receivers: &receivers, light });
    let seen = executor.microquad_visibility(&MicroquadOptions::default(), &case.scene(), &light, points)?;
    assert_eq!(seen.0, [1.0, 1.0]);
    Ok(())
}

fn added<W: CpuWord + TableWord>(executor: &WgpuExecutor, rows: u32, columns: u32) -> Result<(), Failed> {
    let lit = spheres(8, 15);
    let light = lamp(&lit, rows, columns, Jitter::NONE);
    let case = Case { occluders: &lit.occluders, receivers: &lit.receivers, light };
    let mut rng = Rng::named(3, "masks to add to");
    let exact = executor.masks::<W>(&case.scene(), &light, case.given())?.0;
    let mut word = || W::below(columns).and(W::columns(rng.below(columns as usize) as u32, rng.next_u64() as u32));
    let random: Vec<W> = exact.iter().map(|_| word()).collect();
    let mut gained = false;
    for options in combinations(64, &light).into_iter().filter(|options| options.footprint != Footprint::Area) {
        let alone = executor.microquad_masks::<W>(&options, &case.scene(), &light, case.given())?.0;
        for start in [&exact, &random] {
            let mut sum = start.clone();
            executor.add_microquad_masks(&options, &case.scene(), &light, case.given(), &mut sum)?;
            let both: Vec<W> = start.iter().zip(&alone).map(|(a, b)| a.or(*b)).collect();
            assert!(sum == both, "{options:?}");
            assert!(sum != alone, "{options:?}");
            gained |= *start == exact && sum != exact;
            assert!(*start == exact || sum != *start, "{options:?}");
        }
    }
    assert!(gained, "approximate masks have bits that exact ones have not");
    let mut short = exact[1..].to_vec();
    let refused =
        executor.add_microquad_masks(&MicroquadOptions::default(), &case.scene(), &light, case.given(), &mut short);
    let (words, receivers) = (short.len(), lit.receivers.len());
    assert_eq!(refused, Err(GpuError::MaskCount { words, receivers, rows }));
    Ok(())
}

fn adding(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    added::<u16>(executor, 7, 13)?;
    added::<u32>(executor, 16, 20)?;
    added::<u64>(executor, 9, 50)
}

fn refusals(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let lit = spheres(1, 2);
    let light = lamp(&lit, 8, 20, Jitter::NONE);
    let case = Case { occluders: &lit.occluders, receivers: &lit.receivers, light };
    let seen = |options: &MicroquadOptions, light| {
        executor.microquad_visibility(options, &case.scene(), light, case.given()).map(|_| ())
    };
    let bad = options(100, MicroOccluders::Microtris, Footprint::Rows);
    assert_eq!(seen(&bad, &light), Err(GpuError::Microquads(MicroquadError::MapSize { value: 100 })));
    assert_eq!(
        executor.shadow_map(&bad, &case.scene(), &light, case.given()).map(|_| ()),
        Err(GpuError::Microquads(MicroquadError::MapSize { value: 100 }))
    );
    let bad = options(64, MicroOccluders::Microtris, Footprint::Rectangles);
    assert_eq!(seen(&bad, &light), Err(GpuError::Microquads(MicroquadError::TrisAsRectangles)));
    let jittered = lamp(&lit, 8, 20, Jitter::pattern(0));
    let error = MicroquadError::JitteredSamples { footprint: "Rows" };
    assert_eq!(seen(&MicroquadOptions::default(), &jittered), Err(GpuError::Microquads(error)));
    let masks = |options: &MicroquadOptions| {
        executor.microquad_masks::<u16>(options, &case.scene(), &light, case.given()).map(|_| ())
    };
    assert_eq!(masks(&MicroquadOptions::default()), Err(GpuError::WordTooNarrow { columns: 20, bits: 16 }));
    let areas = options(64, MicroOccluders::Microtris, Footprint::Area);
    let masks = executor.microquad_masks::<u32>(&areas, &case.scene(), &light, case.given());
    assert_eq!(masks.map(|_| ()), Err(GpuError::Microquads(MicroquadError::NoMasks)));
    let few = LatticeReceivers { points: &[IVec3::ZERO; 2], facings: &case.given().facings[..0], layers: &[] };
    let few = LatticeReceivers { facings: &[umbra4_core::Facing::UNKNOWN], ..few };
    let refused = executor.microquad_visibility(&MicroquadOptions::default(), &case.scene(), &light, few);
    assert_eq!(refused.map(|_| ()), Err(GpuError::FacingCount { facings: 1, receivers: 2 }));
    Ok(())
}

/// One switch; raw kernels; and what is told of the stages.
fn switch(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let lit = spheres(3, 16);
    let light = lamp(&lit, 32, 32, Jitter::NONE);
    let case = Case { occluders: &lit.occluders, receivers: &lit.receivers, light };
    let options = MicroquadOptions::default();
    let exact = executor.masks_by::<u32>(&Technique::Exact, &case.scene(), &light, case.given())?.0;
    assert_eq!(exact, executor.masks::<u32>(&case.scene(), &light, case.given())?.0);
    let technique = Technique::Microquads(options);
    let (masks, _) = executor.masks_by::<u32>(&technique, &case.scene(), &light, case.given())?;
    assert_eq!(masks, executor.microquad_masks::<u32>(&options, &case.scene(), &light, case.given())?.0);
    assert_ne!(masks, exact, "it is an approximation");
    let (seen, statistics) = executor.visibility_by(&technique, &case.scene(), &light, case.given())?;
    assert_eq!(seen, case.visibility(executor, &options)?);
    let stages: Vec<&str> = statistics.stages.iter().map(|(stage, _)| *stage).collect();
    assert!(stages.is_empty() || stages == ["draw_map", "build_pyramid", "gather", "reduce"], "{stages:?}");
    let stochastic = Technique::Stochastic(StochasticOptions::default());
    let refused = executor.masks_by::<u32>(&stochastic, &case.scene(), &light, case.given());
    assert_eq!(refused.map(|_| ()), Err(GpuError::NoMasks));
    let raw = WgpuExecutor::new(executor.gpu().clone()).with_loading(Loading::Passthrough);
    match raw {
        Ok(raw) => {
            for options in combinations(64, &light) {
                case.all::<u32>(&raw, &options)?;
            }
        }
        Err(reason) => println!("SKIPPED: passthrough: {reason}"),
    }
    Ok(())
}

pub fn tests() -> Vec<Test> {
    static EXECUTOR: OnceLock<WgpuExecutor> = OnceLock::new();
    let checks: [(&str, Check); 9] = [
        ("words_16", words_16),
        ("words_32", words_32),
        ("words_64", words_64),
        ("sizes", sizes),
        ("hard", hard),
        ("facing", facing),
        ("adding", adding),
        ("refusals", refusals),
        ("switch", switch),
    ];
    let mut checks: Vec<(String, Check, &str)> = checks.map(|(name, check)| (name.to_owned(), check, "")).to_vec();
    for (name, _) in GENERATORS {
        checks.push((format!("generated::{name}"), generated, name));
    }
    let of_gpu =
        |gpu: &Gpu| EXECUTOR.get_or_init(|| WgpuExecutor::new(gpu.clone()).with_block(BLOCK).with_stage_times(true));
    checks.into_iter().map(|(name, check, generator)| test(name, move |gpu| check(of_gpu(gpu), generator))).collect()
}
