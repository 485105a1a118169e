//! `umbra4 render`, and the program without arguments.

mod asked;
mod lights;
mod summary;

use crate::{
    args::{RenderArgs, View},
    error::ProgramError,
    executor::{AnyExecutor, Report},
    fractions::{mean, mean_color},
    on_lattice::OnLattice,
    picture::PictureFormat,
    primary,
    scene::{self, Scene},
    shade,
    stages::Stages,
};
use asked::{Asked, Found};
pub(super) use lights::lights_of;
use summary::Summary;

const STAGES: u64 = 6;

pub(super) fn run(args: &RenderArgs) -> Result<(), ProgramError> {
    let format = PictureFormat::of(&args.output)?;
    let (width, height) = args.scene.pixels();
    let fine = |pixels: u32| pixels * args.oversample;
    scene::check_pixels(fine(width), fine(height))?;
    let mut stages = Stages::new(STAGES);

    let scene = stages.run("load", || Scene::load(&args.scene, args.light_option()))?;
    let lights = lights_of(args, &scene)?;
    let asked = Asked::of(args, &lights)?;
    let executor = AnyExecutor::new(&args.work)?;
    stages.announce(&format!(
        "rendering {}, {} triangles, {width}×{height} pixels, on {}",
        args.scene.name(),
        scene.model.triangles.len(),
        executor.name()
    ))?;
    let seen = stages.run("primary", || {
        primary::visible_surfaces(&scene.model, &scene.parts, &scene.camera, fine(width), fine(height))
    });
    let on_lattice = stages.run("snap", || OnLattice::new(&scene.model, &scene.parts, &seen, &lights))?;
    let (found, Report { counts, .. }) = asked.find(&executor, &on_lattice, &mut stages)?;

    let visibility = match &found {
        Found::Fractions(fractions) => mean(fractions, on_lattice.receivers.len()),
        Found::Pairs(_) => Vec::new(),
    };
    let picture = stages.run("shade", || match (&found, args.view) {
        (Found::Pairs(pairs), _) => shade::pairs(&seen, pairs),
        (Found::Fractions(_), View::Visibility) => shade::visibility(&seen, &visibility),
        (Found::Fractions(fractions), View::Light) => shade::light(&seen, &mean_color(fractions, visibility.len())),
        (Found::Fractions(_), View::Penumbra) => shade::penumbra(&seen, &visibility),
        (Found::Fractions(fractions), View::Shaded | View::Pairs) => {
            shade::shaded(&seen, &lights, fractions, &scene.look())
        }
    });
    stages.run("write", || picture.reduced(args.oversample).write(&args.output, format))?;

    let (triangles, receivers) = (scene.model.triangles.len(), on_lattice.receivers.len());
    let lights = summary::lights(&lights, !scene.lights.is_empty(), asked.frames());
    let on = executor.name();
    let casters = on_lattice.casters.as_deref().map(summary::casters);
    Summary { triangles, receivers, lights, casters, size: (width, height), on, counts, visibility }
        .print(stages, &args.output)
}
