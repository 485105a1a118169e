//! Stochastic soft shadow maps on a GPU, against the processor's.

use libtest_mimic::{Completion, Failed};
use umbra4_core::{
    Facing,
    glam::{DVec3, IVec3, Vec3},
};
use umbra4_cpu::{CpuExecutor, ExecutorError, Occluders};
use umbra4_maps::stochastic::{Basis, Centers, Footprint, Placement, StochasticError, StochasticOptions};
use umbra4_tests::{
    filtered::{Agreement, SHARE, SOFTWARE_SHARE, agree},
    gpu::{Test, scene},
    grids::two_grids,
    ledger::say,
    rng::Rng,
    scene::{Inputs, WorldScene},
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
    slab::{slab_and_wall, with_receivers_in_the_air},
};
use umbra4_wgpu::{Gpu, GpuError, LatticeReceivers, LatticeScene, StochasticShadows, WgpuExecutor};

use crate::conformance::{LOADINGS, refused};

type Check = fn(&WgpuExecutor) -> Result<(), Failed>;

fn receivers(inputs: &Inputs) -> LatticeReceivers<'_> {
    LatticeReceivers { points: inputs.receivers.points(), facings: inputs.receivers.facings(), layers: &[] }
}

/// What the device says, and how it agrees with the processor.
fn compared(
    executor: &WgpuExecutor,
    inputs: &Inputs,
    options: &StochasticOptions,
) -> Result<(StochasticShadows, Agreement), Failed> {
    let expected =
        CpuExecutor::new().stochastic_shadows(&inputs.occluders, &inputs.light, &inputs.receivers, options)?;
    let got = executor.stochastic_shadows(&scene(inputs), &inputs.light, receivers(inputs), options)?;
    let share = if executor.gpu().software { SOFTWARE_SHARE } else { SHARE };
    let agreement =
        agree(&expected.visibility, &got.visibility, share).map_err(|error| format!("{error}: {options:?}"))?;
    if (&expected.planes, expected.outside) != (&got.planes, got.outside) {
        return Err(format!("{:?}, {} outside: {options:?}", got.planes, got.outside).into());
    }
    Ok((got, agreement))
}

/// Compares several runs, of which some have to show penumbrae.
fn all(executor: &WgpuExecutor, name: &str, runs: &[(&Inputs, StochasticOptions)]) -> Result<(), Failed> {
    let (mut sum, mut shaded) = (Agreement::default(), 0);
    for (inputs, options) in runs {
        let (got, agreement) = compared(executor, inputs, options)?;
        shaded += got.visibility.iter().filter(|v| **v > 0.05 && **v < 0.95).count();
        sum = sum.plus(agreement);
    }
    say(&format!("stochastic maps on a GPU, {name}: {} runs, {shaded} in penumbrae, {sum:?}", runs.len()));
    if shaded * 100 < sum.receivers {
        return Err(format!("{shaded} of {} receivers in penumbrae compare nothing", sum.receivers).into());
    }
    Ok(())
}

/// Every value of every option, each with several of the others.
fn options(size: u32) -> Vec<StochasticOptions> {
    let bases =
        [Basis::Variance, Basis::Exponential { exponent: 20.0 }, Basis::Exponential { exponent: 35.0 }].into_iter();
    let of_basis = |(k, basis): (usize, Basis)| {
        (0..6_usize).map(move |round| StochasticOptions {
            size,
            basis,
            planes: [1, 4, 7][(round + k) % 3],
            placement: [Placement::Depth, Placement::InverseDepth, Placement::Receivers][round % 3],
            footprint: [Footprint::Ellipse, Footprint::Rectangle][round % 2],
            centers: [Centers::Texel, Centers::Projected][round / 2 % 2],
            interleaved: round % 2 == 0,
            smoothed: round < 4,
            active_tiles: (round + k) % 2 == 0,
            widest_raise: [2.0, 0.0, 65536.0][(round + k) % 3],
            coarse_levels: [6, 2, 0][round / 2],
            seed: round as u32,
            ..StochasticOptions::default()
        })
    };
    bases.enumerate().flat_map(of_basis).collect()
}

fn every_choice(executor: &WgpuExecutor) -> Result<(), Failed> {
    let inputs = with_receivers_in_the_air(slab_and_wall(40), &mut Rng::new(1)).inputs();
    let runs: Vec<_> = options(96).into_iter().map(|options| (&inputs, options)).collect();
    all(executor, "every choice", &runs)
}

/// Sizes that are no multiple of a tile or a workgroup, and the least.
fn every_size(executor: &WgpuExecutor) -> Result<(), Failed> {
    let inputs = with_receivers_in_the_air(slab_and_wall(20), &mut Rng::new(5)).inputs();
    let runs: Vec<_> = [1, 2, 3, 15, 16, 17, 130]
        .into_iter()
        .map(|size| (&inputs, StochasticOptions { size, planes: 3, ..StochasticOptions::default() }))
        .collect();
    all(executor, "every size", &runs)
}

fn grids(executor: &WgpuExecutor) -> Result<(), Failed> {
    let inputs = [0.0, 0.3, 0.6].map(|angle| two_grids(angle, 40, 8).inputs());
    let variance = StochasticOptions { basis: Basis::Variance, ..StochasticOptions::default() };
    let of = |inputs| {
        [StochasticOptions::default(), variance, StochasticOptions::paper()]
            .map(|options| (inputs, StochasticOptions { size: 192, planes: 2, ..options }))
    };
    all(executor, "two grids", &inputs.iter().flat_map(of).collect::<Vec<_>>())
}

fn lights_of_any_shape(executor: &WgpuExecutor) -> Result<(), Failed> {
    let options = StochasticOptions { size: 128, ..StochasticOptions::default() };
    let inputs = [(DVec3::X * 1.5, DVec3::Z * 0.3), (DVec3::X, DVec3::new(0.7, 0.0, 0.9))]
        .map(|(edge_u, edge_v)| WorldScene { edge_u, edge_v, ..slab_and_wall(40) }.inputs());
    all(executor, "lights of any shape", &inputs.each_ref().map(|inputs| (inputs, options)))
}

/// The scenes that exact masks are tested on: many triangles at random, slivers and fans among them.
fn generated(executor: &WgpuExecutor) -> Result<(), Failed> {
    let options = StochasticOptions { size: 64, planes: 2, reach: 100.0, ..StochasticOptions::default() };
    let mut sum = Agreement::default();
    for (round, (name, generator)) in GENERATORS.iter().enumerate() {
        let mut rng = Rng::named(1, &format!("stochastic {name}"));
        let inputs = generator(&mut rng, SampleGrid::regular(8, 8)).inputs(EXPONENTS[round % EXPONENTS.len()]);
        let (_, agreement) = compared(executor, &inputs, &options).map_err(|e| format!("{name}: {e:?}"))?;
        sum = sum.plus(agreement);
    }
    say(&format!("stochastic maps on a GPU, generated scenes: {sum:?}"));
    Ok(())
}

/// A run does not see what another has left: larger ones before smaller ones, with facings before without.
fn runs_after_one_another(executor: &WgpuExecutor) -> Result<(), Failed> {
    let large = two_grids(0.2, 40, 8).inputs();
    let normals = vec![Vec3::NEG_Y; large.receivers.len()];
    let faced = Inputs { receivers: large.receivers.clone().facing(&normals)?, ..large.clone() };
    let small = slab_and_wall(12).inputs();
    let options = StochasticOptions { size: 128, planes: 3, ..StochasticOptions::default() };
    let (got, _) = compared(executor, &faced, &options)?;
    if got.visibility.iter().any(|v| *v != 0.0) {
        return Err("light from behind".into());
    }
    all(
        executor,
        "runs after one another",
        &[(&large, options), (&small, StochasticOptions { size: 40, planes: 1, ..options }), (&large, options)],
    )?;
    let again = [(); 2].map(|()| compared(executor, &large, &options).map(|(got, _)| got.visibility));
    let [Ok(first), Ok(second)] = again else { return Err("a run fails".into()) };
    // In whatever order threads make lists.
    if first == second { Ok(()) } else { Err("two runs differ".into()) }
}

/// Triangles that name a vertex which does not exist block nothing, though a run before had so many vertices.
fn missing_vertices(executor: &WgpuExecutor) -> Result<(), Failed> {
    let inputs = slab_and_wall(12).inputs();
    let options = StochasticOptions { size: 64, planes: 1, ..StochasticOptions::default() };
    compared(executor, &inputs, &options)?;
    for kept in [0, 2] {
        let scene = LatticeScene { vertices: &inputs.occluders.vertices()[..kept], ..scene(&inputs) };
        let got = executor.stochastic_shadows(&scene, &inputs.light, receivers(&inputs), &options)?;
        if got.visibility.iter().any(|v| *v != 1.0) {
            return Err(format!("{kept} vertices cast a shadow").into());
        }
    }
    Ok(())
}

fn hard_cases(executor: &WgpuExecutor) -> Result<(), Failed> {
    let options = StochasticOptions { size: 48, ..StochasticOptions::default() };
    // No triangles.
    let plain = slab_and_wall(8).inputs();
    let empty = Inputs { occluders: Occluders::default(), ..plain.clone() };
    let (got, _) = compared(executor, &empty, &options)?;
    assert!(got.visibility.iter().all(|v| *v == 1.0));
    // No receivers.
    let nothing: &[IVec3] = &[];
    let got = executor.stochastic_shadows(&scene(&plain), &plain.light, nothing, &options)?;
    assert_eq!(got, StochasticShadows::default());
    // Some behind the light, one outside of the map, some that face away.
    let mut mixed = slab_and_wall(8);
    mixed.receivers.iter_mut().step_by(3).for_each(|p| p.y = 3.5);
    mixed.receivers.push(Vec3::new(4.0, 2.9, 0.0));
    let inputs = mixed.inputs();
    let (got, _) = compared(executor, &inputs, &options)?;
    assert!(got.visibility[..64].iter().step_by(3).all(|v| *v == 0.0));
    assert_eq!((got.visibility[64], got.outside), (1.0, 1));
    let normals: Vec<Vec3> = (0..65).map(|k| if k % 2 == 0 { Vec3::NEG_Y } else { Vec3::Y }).collect();
    let faced = Inputs { receivers: inputs.receivers.clone().facing(&normals)?, ..inputs.clone() };
    let (faced, _) = compared(executor, &faced, &options)?;
    for (k, (faced, plain)) in faced.visibility.iter().zip(&got.visibility).enumerate() {
        assert_eq!(*faced, if k % 2 == 0 { 0.0 } else { *plain });
    }
    // All behind the light, or out of reach.
    mixed.receivers = vec![Vec3::new(0.0, 3.5, 0.0), Vec3::new(3.9, 2.9, 0.0)];
    let (got, _) = compared(executor, &mixed.inputs(), &options)?;
    assert_eq!((got.visibility, got.outside, got.planes), (vec![0.0, 1.0], 1, vec![]));
    // One receiver: planes and depths are a point.
    mixed.receivers = vec![Vec3::new(0.1, 1e-4, 0.2)];
    compared(executor, &mixed.inputs(), &options)?;
    Ok(())
}

/// The same errors as on a processor, before anything is done.
fn bad_options_are_refused(executor: &WgpuExecutor) -> Result<(), Failed> {
    let inputs = slab_and_wall(4).inputs();
    let good = StochasticOptions { size: 32, ..StochasticOptions::default() };
    let bad = [
        StochasticOptions { size: 0, ..good },
        StochasticOptions { size: 4097, ..good },
        StochasticOptions { planes: 0, ..good },
        StochasticOptions { coarse_levels: 9, ..good },
        StochasticOptions { reach: f32::NAN, ..good },
        StochasticOptions { least_radius: 0.0, ..good },
        StochasticOptions { widest_raise: -1.0, ..good },
        StochasticOptions { basis: Basis::Exponential { exponent: 90.0 }, ..good },
    ];
    for options in bad {
        let got = executor.stochastic_shadows(&scene(&inputs), &inputs.light, receivers(&inputs), &options);
        let expected =
            CpuExecutor::new().stochastic_shadows(&inputs.occluders, &inputs.light, &inputs.receivers, &options);
        let (Err(GpuError::Stochastic(got)), Err(ExecutorError::Stochastic(expected))) = (got, expected) else {
            return Err(format!("not refused: {options:?}").into());
        };
        // As texts: a NaN is not equal to itself.
        if got.to_string() != expected.to_string() {
            return Err(format!("{got}, not {expected}").into());
        }
        if !matches!(got, StochasticError::OutOfRange { .. } | StochasticError::Overflow { .. }) {
            return Err(format!("{got:?}").into());
        }
    }
    let few = LatticeReceivers { facings: &[Facing::UNKNOWN; 3], ..receivers(&inputs) };
    match executor.stochastic_shadows(&scene(&inputs), &inputs.light, few, &good) {
        Err(GpuError::FacingCount { facings: 3, receivers: 16 }) => Ok(()),
        other => Err(format!("{other:?}").into()),
    }
}

/// Times of stages, where the device has them.
fn times(executor: &WgpuExecutor) -> Result<(), Failed> {
    let inputs = slab_and_wall(16).inputs();
    let options = StochasticOptions { size: 64, planes: 2, ..StochasticOptions::default() };
    let own = WgpuExecutor::new(executor.gpu().clone()).with_stage_times(true);
    let got = own.stochastic_shadows(&scene(&inputs), &inputs.light, receivers(&inputs), &options)?;
    if own.gpu().device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        let mut names: Vec<&str> = got.statistics.stages.iter().map(|(name, _)| *name).collect();
        names.sort_unstable();
        let mut expected =
            ["bound_triangles", "sample_light_field", "reproject", "find_radii", "filter_levels", "look_up"];
        expected.sort_unstable();
        assert_eq!(names, expected);
    } else {
        say("SKIPPED: times of stages: the device has no timestamps");
    }
    assert!(got.statistics.time.as_nanos() > 0);
    Ok(())
}

const CHECKS: [(&str, Check); 10] = [
    ("every_choice", every_choice),
    ("every_size", every_size),
    ("grids", grids),
    ("lights_of_any_shape", lights_of_any_shape),
    ("generated", generated),
    ("runs_after_one_another", runs_after_one_another),
    ("missing_vertices", missing_vertices),
    ("hard_cases", hard_cases),
    ("bad_options_are_refused", bad_options_are_refused),
    ("times", times),
];

pub fn tests() -> Vec<Test> {
    let mut tests: Vec<Test> = Vec::new();
    for (prefix, loading) in LOADINGS {
        for (name, check) in CHECKS {
            let of_gpu = move |gpu: &Gpu| match WgpuExecutor::new(gpu.clone()).with_loading(loading) {
                Ok(executor) => check(&executor).map(|()| Completion::Completed),
                Err(reason) => refused(gpu, loading, &reason.to_string()),
            };
            tests.push((format!("{prefix}::{name}"), Box::new(of_gpu)));
        }
    }
    tests
}
