//! What reaches the receivers of all lights: the one place where lights of every kind meet the library's calls.

use crate::{
    error::ProgramError,
    executor::{AnyExecutor, Report},
    fractions::Fractions,
    light::{AreaSource, Light, Side, Source},
    on_lattice::OnLattice,
};

/// The fractions of every light, in order.
///
/// # Errors
/// A light that cannot be put on the lattice; the executor's.
pub fn fractions<'a>(
    executor: &AnyExecutor,
    lights: &'a [Light],
    scene: &OnLattice,
) -> Result<(Vec<Fractions<'a>>, Report), ProgramError> {
    let mut report = Report::default();
    let all = lights.iter().map(|light| of_light(executor, light, scene, &mut report)).collect::<Result<_, _>>()?;
    Ok((all, report))
}

fn of_light<'a>(
    executor: &AnyExecutor,
    light: &'a Light,
    scene: &OnLattice,
    report: &mut Report,
) -> Result<Fractions<'a>, ProgramError> {
    let area = match &light.source {
        Source::Area(area) => area,
        Source::Hard(hard) => {
            let snapped = light.snap_hard(hard, &scene.lattice)?;
            let (lit, done) = executor.hard_visibility(&scene.occluders, &snapped, &scene.receivers)?;
            report.add(&done);
            return Ok(Fractions::Plain(lit));
        }
        Source::Volume(volume) => {
            let cloud = light.snap_volume(volume, &scene.lattice)?;
            let (lit, done) = executor.cloud_visibility(&scene.occluders, &cloud, &scene.receivers)?;
            report.add(&done);
            return Ok(Fractions::Plain(lit));
        }
    };
    let snap = |side: &Side| light.snap_side(&side.area, &scene.lattice);
    let Some(emission) = &area.front().emission else {
        let lit = both_sides(area, report, |side| executor.visibility(scene.under(&snap(side)?)), |a, b| a + b)?;
        return Ok(Fractions::Plain(lit));
    };
    let weigh = |side: &Side| {
        let emission = side.emission.as_ref().unwrap_or(emission);
        executor.light(scene.under(&snap(side)?), emission)
    };
    let lit = both_sides(area, report, weigh, |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])?;
    Ok(Fractions::Weighted { emission, lit })
}

/// What `run` says of the front, and, where a light has one, of its back. What lies behind a light is not lit by it,
/// so that the sum of both is no more than the whole.
fn both_sides<T: Copy>(
    area: &AreaSource,
    report: &mut Report,
    run: impl Fn(&Side) -> Result<(Vec<T>, Report), ProgramError>,
    add: impl Fn(T, T) -> T,
) -> Result<Vec<T>, ProgramError> {
    let (mut sums, done) = run(area.front())?;
    report.add(&done);
    if let Some(back) = area.back() {
        let (others, done) = run(back)?;
        report.add(&done);
        sums.iter_mut().zip(others).for_each(|(sum, other)| *sum = add(*sum, other));
    }
    Ok(sums)
}
