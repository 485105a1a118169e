//! What reaches the receivers of all lights: the one place where lights of every kind meet the library's calls.

use std::borrow::Cow;

use umbra4_core::{
    CasterWork, LatticeLight,
    emission::{Emission, EmissionError},
};
use umbra4_cpu::Caster;

use crate::{
    error::ProgramError,
    executor::{AnyExecutor, Report},
    fractions::Fractions,
    light::{AreaSource, InLight, Light, Side, SnapLightError, Source, Weights},
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
        _ if scene.casters.is_some() => {
            return Err(ProgramError::Casters { with: format!("{} ({})", light.label, light.kind()) });
        }
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
    if let Some(casters) = &scene.casters {
        return by_casters(executor, area, casters, scene, report, snap);
    }
    let Some(emission) = &area.front().emission else {
        let lit = both_sides(area, report, |side| executor.visibility(scene.under(&snap(side)?)), |a, b| a + b)?;
        return Ok(Fractions::Plain(lit));
    };
    let weigh = |side: &Side| {
        let emission = side.emission.as_ref().unwrap_or(emission);
        executor.light(scene.under(&snap(side)?), emission)
    };
    let lit = both_sides(area, report, weigh, plus)?;
    Ok(Fractions::Weighted { emission: Cow::Borrowed(emission), lit })
}

/// The same where parts of the scene are more than opaque. Light of one colour is weighed where panes give it others.
fn by_casters<'a>(
    executor: &AnyExecutor,
    area: &'a AreaSource,
    casters: &[Caster],
    scene: &OnLattice,
    report: &mut Report,
    snap: impl Fn(&Side) -> Result<LatticeLight, InLight<SnapLightError>>,
) -> Result<Fractions<'a>, ProgramError> {
    let emission = match &area.front().emission {
        Some(emission) => Cow::Borrowed(emission),
        None if casters.iter().any(|caster| caster.packed().work() == CasterWork::Tinted) => {
            Cow::Owned(even(area.front())?)
        }
        None => {
            let run = |side: &Side| executor.caster_visibility(casters, &snap(side)?, &scene.receivers);
            return Ok(Fractions::Plain(both_sides(area, report, run, |a, b| a + b)?));
        }
    };
    let weigh = |side: &Side| {
        // Rows of one side are columns of the other.
        let own = match &side.emission {
            Some(own) => Cow::Borrowed(own),
            None => Cow::Owned(even(side)?),
        };
        executor.caster_light(casters, &snap(side)?, &scene.receivers, &own)
    };
    let lit = both_sides(area, report, weigh, plus)?;
    Ok(Fractions::Weighted { emission, lit })
}

/// Weights of a light whose samples all emit the same.
fn even(side: &Side) -> Result<Weights, EmissionError> {
    let (rows, columns) = (side.area.rows(), side.area.columns());
    Emission::new(rows, columns, vec![[u16::MAX; 3]; rows as usize * columns as usize])
}

fn plus(a: [u32; 3], b: [u32; 3]) -> [u32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
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
