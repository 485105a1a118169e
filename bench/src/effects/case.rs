//! The effects.

use umbra4_core::{
    Jitter, LatticeLight, Lift, Punctual, SphereLight, VolumeLightError,
    cloud::Cloud,
    cloud_table::{CloudTable, TableSize},
    emission::{Emission, Shape, WHOLE, Weight},
    glam::IVec3,
    snap::LIMIT,
};
use umbra4_cpu::{CpuExecutor, Occluders, Receivers, Sides, Source, Statistics};

use super::casters::{CasterCase, caster_cases};
use crate::{
    compare::CompareError,
    contender::ContenderError,
    problem::{Problem, ProblemError},
    scene::Scene,
};

/// Size of the paper's table.
const TABLE: TableSize = TableSize { directions: 64, distances: 64 };

/// What is run.
pub(super) enum Effect {
    /// A light of one call.
    Light(LatticeLight, Sides, Option<Emission<Vec<Weight>>>),
    /// The plain light, and a mesh that was arranged.
    Arranged(Occluders, LatticeLight),
    /// The plain light, and receivers of which some face away.
    Facing(Receivers, LatticeLight),
    Punctual(Punctual),
    /// A volume, exactly.
    Cloud(Cloud<Vec<IVec3>>),
    /// The same by the paper's table.
    Table(Cloud<Vec<IVec3>>, TableSize),
    /// Casters, for receivers that may be on layers.
    Casters(Box<CasterCase>),
}

/// One line of the table.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) effect: Effect,
}

/// The effects on one scene; the first is the plain light that the others are held against.
///
/// # Errors
/// Whatever umbra4 refuses.
pub(super) fn cases(scene: &Scene, problem: &Problem<'_>, occluders: &Occluders) -> Result<Vec<Case>, CompareError> {
    let light = problem.light;
    let (rows, columns) = (light.rows, light.columns);
    let room = || vec![[0; 3]; (rows * columns) as usize];
    let jittered =
        scene.light.with_jitter(Jitter::pattern(0)).snap(&problem.lattice, Lift::NONE).map_err(ProblemError::from)?;
    // A sunset: red below, and brighter there.
    let sky = |k: u32| {
        let height = f32::from((k / columns) as u16) / f32::from(rows as u16);
        [1.0, 1.0 - 0.8 * height, 1.0 - height]
            .map(|channel| (channel * (0.2 + 0.8 * height) * f32::from(WHOLE)) as u16)
    };
    let weights: Vec<Weight> = (0..rows * columns).map(sky).collect();
    let texture = Emission::new(rows, columns, weights).map_err(ContenderError::from)?;
    let disk = Emission::shaped(rows, columns, room(), Shape::Disk).map_err(ContenderError::from)?;
    let middle = light.sample(rows / 2, columns / 2);
    let normal = light.step_u.as_dvec3().cross(light.step_v.as_dvec3()).normalize();
    let towards = (-normal * f64::from(LIMIT)).as_ivec3();
    let nowhere = || ContenderError::NoPoint { samples: rows * columns };
    // Turned away from everything: at the lattice's end, looking out of it.
    let side = IVec3::splat(LIMIT - 1 - 64 * 64);
    let away = LatticeLight {
        origin: side,
        step_u: IVec3::X * 64,
        step_v: IVec3::Y * 64,
        rows,
        columns,
        jitter: Jitter::NONE,
    };
    let facing = problem.receivers.clone().facing(&problem.normals).map_err(ProblemError::from)?;
    let sphere = |samples| sphere(scene, problem, samples);
    let case = |name, effect| Case { name, effect };
    let plain = |light| Effect::Light(light, Sides::Front, None);
    let casters = caster_cases(problem, occluders)?;
    let casters = casters.into_iter().map(|(name, casters)| case(name, Effect::Casters(Box::new(casters))));
    let lights = vec![
        case("a rectangle", plain(light)),
        case("one that reaches nobody", plain(away)),
        case("jittered samples", plain(jittered)),
        case("a coloured texture", Effect::Light(light, Sides::Front, Some(texture))),
        case("a disk", Effect::Light(light, Sides::Front, Some(disk))),
        case("both sides shine", Effect::Light(light, Sides::Both, None)),
        case("a mesh arranged before", Effect::Arranged(occluders.clone().arranged(), light)),
        case("receivers that face some way", Effect::Facing(facing, light)),
        case("a point", Effect::Punctual(Punctual::point(middle).ok_or_else(nowhere)?)),
        case("a direction", Effect::Punctual(Punctual::direction(towards).ok_or_else(nowhere)?)),
        case("a sphere, 256 samples", Effect::Cloud(sphere(256)?)),
        case("… by a table of 64²×64 planes", Effect::Table(sphere(256)?, TABLE)),
        case("a sphere, 1024 samples", Effect::Cloud(sphere(1024)?)),
        case("… by a table of 64²×64 planes", Effect::Table(sphere(1024)?, TABLE)),
    ];
    Ok(lights.into_iter().chain(casters).collect())
}

/// A ball in the light's place, as wide as the light.
///
/// # Errors
/// Whatever umbra4 refuses.
pub(super) fn sphere(
    scene: &Scene,
    problem: &Problem<'_>,
    samples: usize,
) -> Result<Cloud<Vec<IVec3>>, ContenderError> {
    let [corner, along_u, ..] = scene.light.corners();
    let ball = SphereLight { center: scene.light.center(), radius: 0.5 * corner.distance(along_u) };
    Ok(ball.snap(&problem.lattice, vec![IVec3::ZERO; samples])?)
}

impl Effect {
    /// Runs it.
    ///
    /// # Errors
    /// Whatever umbra4 refuses.
    pub(super) fn run(
        &self,
        executor: &CpuExecutor,
        occluders: &Occluders,
        problem: &Problem<'_>,
    ) -> Result<Statistics, ContenderError> {
        let (occluders, source) = match self {
            Self::Table(cloud, size) => return by_table(executor, occluders, problem, cloud, *size),
            Self::Casters(casters) => return casters.run(executor, problem),
            Self::Cloud(cloud) => {
                let cloud = Cloud::new(cloud.samples()).map_err(VolumeLightError::from)?;
                (occluders, cloud.into())
            }
            Self::Light(light, sides, emission) => {
                let emission = emission.as_ref().map(Emission::by_reference);
                (occluders, Source::Area { light: *light, sides: *sides, emission })
            }
            Self::Arranged(arranged, light) => (arranged, (*light).into()),
            Self::Facing(receivers, light) => {
                return Ok(executor.light_of(occluders, &(*light).into(), receivers)?.1);
            }
            Self::Punctual(light) => (occluders, (*light).into()),
        };
        Ok(executor.light_of(occluders, &source, &problem.receivers)?.1)
    }
}

/// By a table that is made anew, as where the light's shape changes.
fn by_table(
    executor: &CpuExecutor,
    occluders: &Occluders,
    problem: &Problem<'_>,
    cloud: &Cloud<Vec<IVec3>>,
    size: TableSize,
) -> Result<Statistics, ContenderError> {
    let room = vec![0; CloudTable::words_of(cloud, size)?];
    let table = CloudTable::new(cloud, size, room)?;
    Ok(executor.cloud_masks_by_table(occluders, &table, &problem.receivers)?.1)
}
