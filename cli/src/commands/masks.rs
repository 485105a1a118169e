//! `umbra4 masks`: the interface for scripts and for checking.

use std::{
    io::{Write, stdout},
    path::Path,
};

use serde_json::json;
use umbra4_core::{Jitter, Lift, glam::IVec3};
use umbra4_cpu::{Caster, CpuWord, Occluders, Receivers};

use crate::{
    args::MasksArgs,
    array_file,
    bounds::lattice_around,
    casters,
    error::ProgramError,
    executor::{AnyExecutor, Report, Scene},
    in_file::InFile,
    light_file,
    model::{self, FileLights, Furnished, ModelError},
    output::{Prepared, prepare},
};

pub(super) fn run(args: &MasksArgs) -> Result<(), ProgramError> {
    let executor = AnyExecutor::new(&args.work)?;
    let jitter = args.jitter.map_or(Jitter::NONE, Jitter::pattern);
    let light = light_file::read(&args.light)?.sampled(args.samples)?.with_jitter(jitter);
    let Furnished { model, parts, .. } = model::load_furnished_f64(&args.model, FileLights::PassedOver)?;
    parts.check().map_err(|e| InFile::at(&args.model)(ModelError::from(e)))?;
    let points = array_file::read_points(&args.receivers)?;

    let lattice = lattice_around(model.vertices.iter().chain(&points), &light)?;
    let light = light.snap(&lattice, Lift::NONE)?;
    let occluders = Occluders::from_f64(&lattice, &model.vertices, &model.triangles)?;
    let receivers = Receivers::raw_f64(&lattice, &points)?;

    let casters = if parts.is_plain() {
        None
    } else {
        if args.lattice_out.is_some() {
            // Triangles are not all that the answer hangs on.
            return Err(ProgramError::Casters { with: "--lattice-out".to_owned() });
        }
        casters::casters(&model::rounded(model).map_err(InFile::at(&args.model))?, &parts, &lattice)?
    };

    let scene = (&occluders, &light, &receivers);
    let casters = casters.as_deref();
    let (masks, report) = match args.samples {
        0..=16 => write_masks::<u16>(&executor, scene, casters, &args.output),
        17..=32 => write_masks::<u32>(&executor, scene, casters, &args.output),
        _ => write_masks::<u64>(&executor, scene, casters, &args.output),
    }?;
    let lattice = args.lattice_out.as_deref().map(|path| write_lattice(scene, path)).transpose()?;
    masks.publish()?;
    lattice.map(Prepared::publish).transpose()?;
    if args.stats {
        writeln!(stdout().lock(), "{}", statistics_json(&report))?;
    }
    Ok(())
}

fn write_masks<W: CpuWord + npyz::AutoSerialize>(
    executor: &AnyExecutor,
    scene: Scene<'_>,
    casters: Option<&[Caster]>,
    path: &Path,
) -> Result<(Prepared, Report), ProgramError> {
    let (masks, report) = match casters {
        None => executor.masks::<W>(scene)?,
        Some(casters) => executor.caster_masks::<W>(casters, scene.1, scene.2)?,
    };
    let shape = [scene.2.len() as u64, u64::from(scene.1.rows)];
    let prepared = prepare(path, |writer| Ok(array_file::write_array(writer, &shape, masks)?))?;
    Ok((prepared, report))
}

fn write_lattice((occluders, light, receivers): Scene<'_>, path: &Path) -> Result<Prepared, ProgramError> {
    let corners: Vec<IVec3> = (0..occluders.triangles().len()).filter_map(|t| occluders.corners(t)).flatten().collect();
    let counts = [receivers.len() as u64, occluders.triangles().len() as u64];
    let [rows, columns] = [light.rows, light.columns];
    let samples: Vec<IVec3> = (0..rows * columns).map(|k| light.sample(k / columns, k % columns)).collect();
    let grid = [rows.into(), columns.into(), 3];
    let arrays: [(&str, &[u64], &[IVec3]); 6] = [
        ("receivers", &[counts[0], 3], receivers.points()),
        ("triangles", &[counts[1], 3, 3], &corners),
        ("origin", &[3], &[light.origin]),
        ("step_u", &[3], &[light.step_u]),
        ("step_v", &[3], &[light.step_v]),
        ("samples", &grid, &samples),
    ];
    // Regular samples follow from the steps.
    let arrays = if light.jitter.is_some() { &arrays[..] } else { &arrays[..5] };
    Ok(prepare(path, |writer| Ok(array_file::write_lattice_points(writer, arrays)?))?)
}

/// Seconds are those of index and masks: files and their parsing are not in them.
fn statistics_json(report: &Report) -> serde_json::Value {
    let by_stage: serde_json::Map<String, serde_json::Value> =
        report.seconds_by_stage.iter().map(|(name, seconds)| (name.clone(), json!(seconds))).collect();
    let counts = report.counts;
    json!({
        "seconds": report.seconds(),
        "seconds_by_stage": by_stage,
        "pairs_tested": counts.pairs_tested,
        "pairs_kept": counts.pairs_kept,
        "pairs_relevant": counts.pairs_relevant,
        "fallbacks": counts.fallbacks,
    })
}
