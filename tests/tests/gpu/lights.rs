//! Lights without extent, emissions, irradiance and receivers that face some way on a GPU, against the oracle.

use libtest_mimic::Failed;
use umbra4_core::{
    Facing, Jitter, LatticeLight, Punctual,
    emission::Emission,
    glam::{IVec3, Vec3},
};
use umbra4_cpu::CpuExecutor;
use umbra4_tests::{
    budget, facings,
    gpu::{Check, Test, of_executor, scene},
    hard_shadows::property,
    irradiance,
    ledger::say,
    rng::Rng,
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
    weights::{expected, weights},
};
use umbra4_wgpu::{GpuError, LatticeReceivers, LatticeScene, WgpuExecutor};

/// Scenes of each generator.
const ROUNDS: usize = 3;
/// One of each way to store rows, and of the ends of each.
const GRIDS: [(u32, u32); 6] = [(16, 16), (5, 31), (64, 64), (1, 1), (33, 17), (7, 33)];

/// All of them, as often as the budget has it.
fn grids() -> impl Iterator<Item = (u32, u32)> {
    GRIDS.into_iter().cycle().take(budget::of(GRIDS.len()))
}

fn hard_shadows(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let compared = property(name, budget::of(ROUNDS), |inputs, light| {
        let points = inputs.receivers.points();
        let (words, statistics) = executor.hard_shadows(&scene(inputs), light, points).map_err(|e| e.to_string())?;
        if words.len() != points.len().div_ceil(32) {
            return Err(format!("{} words for {} receivers", words.len(), points.len()));
        }
        let bits: Vec<u16> = (0..points.len()).map(|r| (words[r / 32] >> (r % 32) & 1) as u16).collect();
        let blocked: usize = bits.iter().map(|bit| usize::from(*bit)).sum();
        let counts = statistics.counts.ok_or("counts were asked for")?;
        // Each receiver in shadow has met the one triangle that ended its walk, and no other that blocks.
        if counts.pairs_relevant != blocked as u64 {
            return Err(format!("{blocked} in shadow: {counts:?}"));
        }
        Ok(bits)
    });
    say(&format!("hard shadows on a GPU, {name}: {} bits, {} blocked, 0 differ", compared.bits, compared.blocked));
    Ok(())
}

fn emission(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).ok_or("no such generator")?;
    let mut rng = Rng::named(1, &format!("emission {name}"));
    for (round, (rows, columns)) in grids().enumerate() {
        let grid = SampleGrid::regular(rows, columns);
        let grid = if round % 2 == 1 { grid.jittered(&mut rng) } else { grid };
        let inputs = generator(&mut rng, grid).inputs(EXPONENTS[round % EXPONENTS.len()]);
        let weights = weights(&mut rng, inputs.light.sample_count() as usize);
        let emission = Emission::new(rows, columns, &weights[..])?;
        let (sums, _) = executor.light(&scene(&inputs), &inputs.light, inputs.receivers.points(), &emission)?;
        let sums: Vec<[u64; 3]> = sums.iter().map(|sum| sum.map(u64::from)).collect();
        let wanted = expected(&inputs, &weights);
        if let Some(r) = (0..wanted.len()).find(|&r| sums.get(r) != Some(&wanted[r])) {
            return Err(
                format!("{name}, {rows}×{columns}, receiver {r}: {:?}, not {:?}", sums.get(r), wanted[r]).into()
            );
        }
        assert_eq!(sums.len(), wanted.len());
    }
    Ok(())
}

/// Receivers that face some way: the processor's bits, of lights with an area and without.
fn facing(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).ok_or("no such generator")?;
    let mut rng = Rng::named(1, &format!("facing {name}"));
    let (processor, mut away) = (CpuExecutor::new(), 0);
    for (round, (rows, columns)) in grids().enumerate() {
        let grid = SampleGrid::regular(rows, columns);
        let grid = if round % 2 == 1 && rows * columns < 1024 { grid.jittered(&mut rng) } else { grid };
        let inputs = generator(&mut rng, grid).inputs(EXPONENTS[round % EXPONENTS.len()]);
        let normals = facings::normals(&mut rng, &inputs, &facings::samples(&inputs));
        let receivers = inputs.receivers.clone().facing(&normals)?;
        let given = LatticeReceivers { points: receivers.points(), facings: receivers.facings(), layers: &[] };
        let (masks, _) = executor.masks::<u64>(&scene(&inputs), &inputs.light, given)?;
        let (wanted, _) = processor.masks::<u64>(&inputs.occluders, &inputs.light, &receivers)?;
        assert_eq!(masks, wanted.words(), "{name}, {rows}×{columns}");
        for lamp in [Punctual::point(inputs.light.sample(0, 0)), Punctual::direction(rng.point(1 << 12) | IVec3::X)] {
            let lamp = lamp.ok_or("inside")?;
            let (words, _) = executor.hard_shadows(&scene(&inputs), &lamp, given)?;
            let (wanted, _) = processor.hard_shadows(&inputs.occluders, &lamp, &receivers)?;
            assert_eq!(words, wanted.words(), "{name}, {lamp:?}");
        }
        let is_away = |(facing, p): (&Facing, &IVec3)| facing.is_away_from(&inputs.light, *p);
        away += given.facings.iter().zip(given.points).filter(|pair| is_away(*pair)).count();
    }
    assert!(away > 0, "{name}: none faces away");
    Ok(())
}

/// Irradiance: the direct sum's within the documented error, and so the processor's.
fn irradiance(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).ok_or("no such generator")?;
    let mut rng = Rng::named(1, &format!("irradiance {name}"));
    let (mut worst, mut apart, mut lit) = (0.0_f64, 0.0_f64, 0);
    for (round, (rows, columns)) in grids().enumerate() {
        let grid = SampleGrid::regular(rows, columns);
        let grid = if round % 2 == 1 { grid.jittered(&mut rng) } else { grid };
        let inputs = generator(&mut rng, grid).inputs(EXPONENTS[round % EXPONENTS.len()]);
        let normals = facings::normals(&mut rng, &inputs, &facings::samples(&inputs));
        let weights = weights(&mut rng, inputs.light.sample_count() as usize);
        let emission = Emission::new(rows, columns, &weights[..])?;
        let points = inputs.receivers.points();
        let (found, _) = executor.irradiance(&scene(&inputs), &inputs.light, points, &normals, &emission)?;
        let wanted = irradiance::expected(&inputs, &normals, &weights);
        let (error, some) = irradiance::check(&inputs, &wanted, &found).map_err(|e| format!("{name}: {e}"))?;
        (worst, lit) = (worst.max(error), lit + some);
        let processor = CpuExecutor::new();
        let (other, _) =
            processor.irradiance(&inputs.occluders, &inputs.light, &inputs.receivers, &normals, &emission)?;
        for (a, b) in found.iter().flatten().zip(other.iter().flatten()).filter(|(_, b)| **b > 0.0) {
            apart = apart.max((f64::from(*a) / f64::from(*b) - 1.0).abs());
        }
    }
    assert!(lit > 0, "{name}: no receiver gets light");
    say(&format!(
        "irradiance on a GPU, {name}: errors at most {worst:.3} of what is allowed, {apart:.1e} from the processor's"
    ));
    Ok(())
}

fn refusals(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).ok_or("no such generator")?;
    let inputs = generator(&mut Rng::named(0, "refusals"), SampleGrid::regular(4, 8)).inputs(0);
    let other = Emission::new(8, 4, [[1; 3]; 32])?;
    let refused = executor.light(&scene(&inputs), &inputs.light, inputs.receivers.points(), &other);
    assert!(matches!(refused, Err(GpuError::EmissionSize { emission: [8, 4], light: [4, 8] })), "{refused:?}");
    let (points, own) = (inputs.receivers.points(), Emission::new(4, 8, [[1; 3]; 32])?);
    let mut normals = vec![Vec3::Y; points.len()];
    let refused = executor.irradiance(&scene(&inputs), &inputs.light, points, &normals, &other);
    assert!(matches!(refused, Err(GpuError::EmissionSize { .. })), "{refused:?}");
    normals[0].y = f32::NAN;
    let refused = executor.irradiance(&scene(&inputs), &inputs.light, points, &normals, &own);
    assert!(matches!(refused, Err(GpuError::Normal { index: 0, .. })), "{refused:?}");
    normals.push(Vec3::Y);
    let refused = executor.irradiance(&scene(&inputs), &inputs.light, points, &normals, &own);
    assert!(matches!(refused, Err(GpuError::NormalCount { .. })), "{refused:?}");
    let few = LatticeReceivers { points: inputs.receivers.points(), facings: &[Facing::UNKNOWN], layers: &[] };
    let refused = executor.lit_counts(&scene(&inputs), &inputs.light, few);
    assert!(matches!(refused, Err(GpuError::FacingCount { facings: 1, .. })), "{refused:?}");
    // A light that reaches none: behind it all is dark, and no triangle is looked at.
    let back = LatticeLight { step_u: IVec3::X * 64, step_v: IVec3::Y * 64, origin: IVec3::ZERO, ..inputs.light };
    let behind = [IVec3::new(0, 0, -9), IVec3::new(5, 5, -1), IVec3::ZERO];
    let all = LatticeScene { vertices: &[IVec3::ZERO, IVec3::X * 99, IVec3::Z * 99], triangles: &[[0, 1, 2]; 40] };
    let (lit, statistics) = executor.lit_counts(&all, &back, &behind)?;
    assert_eq!(lit, [0; 3]);
    assert_eq!(statistics.counts.map(|counts| counts.pairs_tested), Some(0));
    let ran: Vec<&str> = statistics.stages.iter().map(|(stage, _)| *stage).collect();
    assert!(!ran.contains(&"key_triangles") && !ran.contains(&"order_triangles"), "{ran:?}");
    Ok(())
}

/// Triangles that name a vertex which does not exist block nothing, though runs before had so many, and left them on the device.
fn missing_vertices(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let at = |x, z| IVec3::new(x, 0, z);
    let vertices = [at(-9000, -9000), at(9000, -9000), at(9000, 9000), at(-9000, 9000)];
    let light = LatticeLight {
        origin: IVec3::new(-100, 4000, -100),
        step_u: IVec3::X * 20,
        step_v: IVec3::Z * 20, // X × Z = −Y: shines down
        rows: 11,
        columns: 11,
        jitter: Jitter::NONE,
    };
    let towards = Punctual::direction(IVec3::Y).ok_or("a direction")?;
    let receivers = [at(100, 200) - IVec3::Y * 2000, at(-100, -300) - IVec3::Y * 2000];
    for (kept, lit) in [(4, 0), (3, 121), (2, 121), (0, 121)] {
        let scene = LatticeScene { vertices: &vertices[..kept], triangles: &[[0, 1, 3], [1, 2, 3]] };
        assert_eq!(executor.lit_counts(&scene, &light, &receivers)?.0, [lit; 2], "{kept} vertices");
        let (words, _) = executor.hard_shadows(&scene, &towards, &receivers)?;
        assert_eq!(words, [if kept == 4 { 3 } else { 0 }], "{kept} vertices");
    }
    Ok(())
}

pub fn tests() -> Vec<Test> {
    let mut checks: Vec<(String, Check, &str)> = vec![
        ("refusals".to_owned(), refusals, GENERATORS[0].0),
        ("missing_vertices".to_owned(), missing_vertices, GENERATORS[0].0),
    ];
    for (name, _) in GENERATORS {
        checks.push((format!("hard_shadows::{name}"), hard_shadows, name));
        checks.push((format!("emission::{name}"), emission, name));
        checks.push((format!("facing::{name}"), facing, name));
        checks.push((format!("irradiance::{name}"), irradiance, name));
    }
    of_executor(checks)
}
