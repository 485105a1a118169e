//! `umbra4 render`, and the program without arguments.

use std::io::{Write, stdout};

use umbra4_core::{Bounds, Jitter, Lattice, Lift, glam::Vec3};
use umbra4_cpu::{Occluders, Receivers};

use crate::{
    args::{ExecutorArg, RenderArgs, View},
    error::ProgramError,
    executor::AnyExecutor,
    frames::Frames,
    hard_light::HardLight,
    picture::PictureFormat,
    primary,
    scene::{self, Scene},
    shade::{self, Emitter},
    stages::Stages,
};

const STAGES: u64 = 6;

pub(super) fn run(args: &RenderArgs) -> Result<(), ProgramError> {
    let format = PictureFormat::of(&args.output)?;
    let executor = executor_for(args)?;
    let (width, height) = args.scene.pixels();
    let fine = |pixels: u32| pixels * args.oversample;
    scene::check_pixels(fine(width), fine(height))?;
    // How often each receiver is met is a matter of one frame.
    let frames = args.jitter.map(|frames| if args.view == View::Pairs { 1 } else { frames });
    let mut stages = Stages::new(STAGES);

    let scene = stages.run("load", || Scene::load(&args.scene))?;
    // clap lets nothing but 8, 16, 32 and 64 through; whatever else is refused by the light.
    let area = scene.light.sampled(args.samples.parse().unwrap_or(0))?;
    let area = area.with_jitter(frames.map_or(Jitter::NONE, |_| Jitter::pattern(0)));
    let emitter = args.hard_light().map_or(Emitter::Area(area), Emitter::Hard);
    let seen =
        stages.run("primary", || primary::visible_surfaces(&scene.model, &scene.camera, fine(width), fine(height)));
    let (occluders, receivers, lattice) = stages.run("snap", || -> Result<_, ProgramError> {
        let light = match &emitter {
            Emitter::Area(area) => Some(Bounds::of(area.corners())),
            Emitter::Hard(light) => light.bounds(),
        };
        let bounds = light.into_iter().fold(scene.model.bounds(), Bounds::union);
        let lattice = Lattice::covering(bounds)?;
        let positions: Vec<Vec3> = seen.seen().map(|hit| hit.position).collect();
        let normals: Vec<Vec3> = seen.seen().map(|hit| hit.normal).collect();
        Ok((
            Occluders::new(&lattice, &scene.model.vertices, &scene.model.triangles)?,
            Receivers::on_surfaces(&lattice, &positions, &normals, Lift::F32_POSITIONS)?,
            lattice,
        ))
    })?;

    let (mut visibility, mut pairs) = (Vec::new(), Vec::new());
    let (runs, statistics) = match (&emitter, frames) {
        (Emitter::Hard(light), _) => {
            let light = light.snap(&lattice)?;
            let statistics;
            (visibility, statistics) =
                stages.run("shadows", || executor.hard_visibility(&occluders, &light, &receivers))?;
            (1, statistics)
        }
        (Emitter::Area(area), Some(count)) if args.view != View::Pairs => {
            let mut frames = Frames::new(&executor, &lattice, *area, &occluders, &receivers);
            stages.expect(u64::from(count) - 1);
            for frame in 1..=count {
                stages.run(&format!("frame {frame} of {count}"), || frames.run())?;
            }
            visibility = frames.visibility();
            (count as usize, frames.report)
        }
        (Emitter::Area(area), _) => {
            let light = area.snap(&lattice, Lift::F32_POSITIONS)?;
            let snapped = (&occluders, &light, &receivers);
            let statistics;
            if args.view == View::Pairs {
                (pairs, statistics) = stages.run("shadows", || executor.pairs_per_receiver(snapped))?;
            } else {
                (visibility, statistics) = stages.run("shadows", || executor.visibility(snapped))?;
            }
            (1, statistics)
        }
    };
    stages.split_last(runs, &statistics);

    let picture = stages.run("shade", || match args.view {
        View::Shaded => shade::shaded(&seen, &visibility, &emitter, &scene.look()),
        View::Visibility => shade::visibility(&seen, &visibility),
        View::Penumbra => shade::penumbra(&seen, &visibility),
        View::Pairs => shade::pairs(&seen, &pairs),
    });
    stages.run("write", || picture.reduced(args.oversample).write(&args.output, format))?;

    let counts = statistics.counts;
    let mut out = stdout().lock();
    writeln!(
        out,
        "{} triangles, {} receivers, {}, {width}×{height} pixels, on {}\n",
        scene.model.triangles.len(),
        receivers.len(),
        match &emitter {
            Emitter::Area(area) => samples(area.rows(), frames),
            Emitter::Hard(HardLight::Sun(_)) => "the sun".to_owned(),
            Emitter::Hard(HardLight::Lamp(_)) => "a lamp without extent".to_owned(),
        },
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

/// The executor that is asked for: lights without extent are the processor's.
fn executor_for(args: &RenderArgs) -> Result<AnyExecutor, ProgramError> {
    let mut work = args.work.clone();
    if args.hard_light().is_some() {
        let refused = match work.executor {
            _ if args.view == View::Pairs => Some("--view pairs"),
            ExecutorArg::Gpu => Some("--executor gpu"),
            ExecutorArg::Auto | ExecutorArg::Cpu => None,
        };
        if let Some(option) = refused {
            return Err(ProgramError::AreaOnly { option });
        }
        work.executor = ExecutorArg::Cpu;
    }
    AnyExecutor::new(&work)
}

/// Samples, and frames of jittered ones.
fn samples(side: u32, frames: Option<u32>) -> String {
    match frames {
        None => format!("{side}×{side} light samples"),
        Some(1) => format!("{side}×{side} jittered light samples, 1 frame"),
        Some(frames) => format!("{side}×{side} jittered light samples, {frames} frames"),
    }
}
