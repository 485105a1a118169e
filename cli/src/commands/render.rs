//! `umbra4 render`, and the program without arguments.

use std::io::{Write, stdout};

use umbra4_core::{
    AreaLight, Bounds, Lattice, Lift,
    glam::{DVec3, Vec3},
};
use umbra4_cpu::{Occluders, Receivers};

use crate::{
    args::{RenderArgs, View},
    builtin::BuiltinScene,
    camera::Camera,
    error::ProgramError,
    executor::AnyExecutor,
    fit, light_file,
    model::{self, Model},
    picture::PictureFormat,
    primary,
    shade::{self, Look},
    stages::Stages,
};

/// Everything that is shown, and how.
struct Scene {
    model: Model,
    colors: Vec<Vec3>,
    camera: Camera,
    light: AreaLight,
    focus: DVec3,
    fade: f64,
}

const STAGES: u64 = 6;
const MOST_PIXELS: u64 = 1 << 27;
const LIGHT_SIZE: f64 = 0.25;
const LIGHT_DISTANCE: f64 = 1.0;

pub(super) fn run(args: &RenderArgs) -> Result<(), ProgramError> {
    let format = PictureFormat::of(&args.output)?;
    let executor = AnyExecutor::new(&args.work)?;
    let (width, height) = args.pixels();
    let fine = |pixels: u32| pixels * args.oversample;
    let pixels = u64::from(fine(width)) * u64::from(fine(height));
    if pixels > MOST_PIXELS {
        return Err(ProgramError::TooManyPixels { pixels, most: MOST_PIXELS });
    }
    let mut stages = Stages::new(STAGES);

    let scene = stages.run("load", || load(args))?;
    let seen =
        stages.run("primary", || primary::visible_surfaces(&scene.model, &scene.camera, fine(width), fine(height)));
    let (occluders, light, receivers) = stages.run("snap", || -> Result<_, ProgramError> {
        let bounds = scene.model.bounds().union(Bounds::of(scene.light.corners()));
        let lattice = Lattice::covering(bounds)?;
        let positions: Vec<Vec3> = seen.seen().map(|hit| hit.position).collect();
        let normals: Vec<Vec3> = seen.seen().map(|hit| hit.normal).collect();
        Ok((
            Occluders::new(&lattice, &scene.model.vertices, &scene.model.triangles)?,
            scene.light.snap(&lattice, Lift::F32_POSITIONS)?,
            Receivers::on_surfaces(&lattice, &positions, &normals, Lift::F32_POSITIONS)?,
        ))
    })?;

    let (mut visibility, mut pairs) = (Vec::new(), Vec::new());
    let statistics = stages.run("shadows", || {
        let statistics;
        if args.view == View::Pairs {
            (pairs, statistics) = executor.pairs_per_receiver((&occluders, &light, &receivers))?;
        } else {
            (visibility, statistics) = executor.visibility((&occluders, &light, &receivers))?;
        }
        Ok::<_, ProgramError>(statistics)
    })?;
    stages.split_last(&statistics);

    let picture = stages.run("shade", || match args.view {
        View::Shaded => {
            let look = Look { colors: &scene.colors, focus: scene.focus, fade: scene.fade };
            shade::shaded(&seen, &visibility, &scene.light, &look)
        }
        View::Visibility => shade::visibility(&seen, &visibility),
        View::Penumbra => shade::penumbra(&seen, &visibility),
        View::Pairs => shade::pairs(&seen, &pairs),
    });
    stages.run("write", || picture.reduced(args.oversample).write(&args.output, format))?;

    let counts = statistics.counts;
    let mut out = stdout().lock();
    let samples = scene.light.rows();
    writeln!(
        out,
        "{} triangles, {} receivers, {samples}×{samples} light samples, {width}×{height} pixels, on {}\n",
        scene.model.triangles.len(),
        receivers.len(),
        executor.name(),
    )?;
    writeln!(out, "{}", stages.table())?;
    writeln!(out, "pairs tested       {:>12}", counts.pairs_tested)?;
    writeln!(out, "pairs kept         {:>12}", counts.pairs_kept)?;
    writeln!(out, "pairs relevant     {:>12}", counts.pairs_relevant)?;
    writeln!(out, "integer fallbacks  {:>12}", counts.fallbacks)?;
    if !visibility.is_empty() {
        let share = |class: fn(f32) -> bool| {
            100.0 * visibility.iter().filter(|v| class(**v)).count() as f64 / visibility.len() as f64
        };
        let (umbra, lit) = (share(|v| v <= 0.0), share(|v| v >= 1.0));
        writeln!(out, "umbra {umbra:.1} %, penumbra {:.1} %, lit {lit:.1} %", 100.0 - umbra - lit)?;
    }
    writeln!(out, "wrote {}", args.output.display())?;
    Ok(())
}

fn load(args: &RenderArgs) -> Result<Scene, ProgramError> {
    // clap lets nothing but 8, 16, 32 and 64 through; whatever else is refused by the light.
    let samples = args.samples.parse().unwrap_or(0);
    let shape = args.light.as_deref().map(light_file::read).transpose()?;
    let Some(path) = &args.model else {
        let BuiltinScene { model, colors, light } = BuiltinScene::new();
        let camera = BuiltinScene::camera(args.camera_from, args.camera_to, args.fov)?;
        let light = shape.unwrap_or(light).sampled(samples)?;
        return Ok(Scene { model, colors, camera, light, focus: BuiltinScene::FOCUS, fade: BuiltinScene::FADE });
    };
    let mut model = model::load(path)?;
    let bounds = model.bounds();
    let camera = fit::camera(bounds, args.camera_from, args.camera_to, args.fov.unwrap_or(fit::FOV))?;
    let fitted =
        || fit::light(bounds, args.light_size.unwrap_or(LIGHT_SIZE), args.light_distance.unwrap_or(LIGHT_DISTANCE));
    let light = shape.unwrap_or_else(fitted).sampled(samples)?;
    if !args.no_ground {
        model.append(&fit::ground(bounds));
    }
    let fade = fit::FADE * fit::diagonal(bounds);
    Ok(Scene { model, colors: Vec::new(), camera, light, focus: bounds.center(), fade })
}
