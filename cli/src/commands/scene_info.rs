//! `umbra4 info SCENE`: what would run for every light of a scene.

use std::io::{Write, stdout};

use umbra4_core::Plan;
use umbra4_cpu::CpuExecutor;

use super::render;
use crate::{
    args::{RenderArgs, SceneArgs},
    error::ProgramError,
    executor::AnyExecutor,
    light::{Light, Side, Source},
    on_lattice::OnLattice,
    primary,
    scene::{self, Scene},
};

pub(super) fn run(args: &SceneArgs) -> Result<(), ProgramError> {
    let args = RenderArgs { scene: args.clone(), ..RenderArgs::without_arguments() };
    let (width, height) = args.scene.pixels();
    scene::check_pixels(width, height)?;
    let scene = Scene::load(&args.scene, None)?;
    let lights = render::lights_of(&args, &scene)?;
    let seen = primary::visible_surfaces(&scene.model, &scene.parts, &scene.camera, width, height);
    let on_lattice = OnLattice::new(&scene.model, &scene.parts, &seen, &lights)?;
    let executor = AnyExecutor::cpu(args.work.precision);

    // All plans first: what is refused leaves nothing half said.
    let plans: Vec<_> = lights.iter().map(|light| plans(light, &executor, &on_lattice)).collect::<Result<_, _>>()?;

    let mut out = stdout().lock();
    writeln!(out, "{} triangles", on_lattice.occluders.triangles().len())?;
    writeln!(out, "{} receivers, of {width}×{height} pixels", on_lattice.receivers.len())?;
    for (light, plans) in lights.iter().zip(plans) {
        writeln!(out, "\n{}: {}", light.label, light.kind())?;
        for (side, plan) in plans {
            write!(out, "{side}{plan}")?;
        }
    }
    Ok(())
}

/// The plan of every side of a light, and which side that is where there are two.
fn plans(light: &Light, executor: &AnyExecutor, scene: &OnLattice) -> Result<Vec<(&'static str, Plan)>, ProgramError> {
    match &light.source {
        Source::Area(area) => {
            let names = if area.back().is_some() { ["front\n", "back\n"] } else { [""; 2] };
            let plan = |(name, side): (&'static str, &Side)| {
                let snapped = light.snap_side(&side.area, &scene.lattice)?;
                let plan = match &scene.casters {
                    None => executor.plan(scene.under(&snapped)),
                    Some(casters) => executor.caster_plan(casters, &snapped, &scene.receivers),
                };
                Ok((name, plan))
            };
            names.into_iter().zip(area.sides()).map(plan).collect()
        }
        _ if scene.casters.is_some() => {
            Err(ProgramError::Casters { with: format!("{} ({})", light.label, light.kind()) })
        }
        Source::Volume(volume) => {
            let cloud = light.snap_volume(volume, &scene.lattice)?;
            Ok(vec![("", CpuExecutor::new().cloud_plan(&scene.occluders, &cloud, &scene.receivers, true))])
        }
        Source::Hard(hard) => {
            let snapped = light.snap_hard(hard, &scene.lattice)?;
            Ok(vec![("", CpuExecutor::new().plan_hard_shadows(&scene.occluders, &snapped, &scene.receivers))])
        }
    }
}
