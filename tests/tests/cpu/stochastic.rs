//! Stochastic soft shadow maps on the CPU, against exact visibility, and against themselves. (Formulas are tested one by one in `maps/tests`.)

use umbra4_core::glam::{DVec3, Vec3};
use umbra4_cpu::{CpuExecutor, ExecutorError, Occluders, Receivers};
use umbra4_maps::stochastic::{Basis, Centers, Footprint, Placement, StochasticError, StochasticOptions};
use umbra4_tests::{
    flicker::{flicker, moved},
    grids::two_grids,
    rng::Rng,
    scene::{Inputs, WorldScene},
    slab::{slab_and_wall, with_receivers_in_the_air},
};

fn small() -> StochasticOptions {
    StochasticOptions { size: 128, ..StochasticOptions::default() }
}

fn shadows(inputs: &Inputs, options: &StochasticOptions) -> Vec<f32> {
    let done = CpuExecutor::new().stochastic_shadows(&inputs.occluders, &inputs.light, &inputs.receivers, options);
    let visibility = done.expect("options are good").visibility;
    assert_eq!(visibility.len(), inputs.receivers.len());
    assert!(visibility.iter().all(|v| (0.0..=1.0).contains(v)), "a fraction, and a number");
    visibility
}

fn exact(inputs: &Inputs) -> Vec<f32> {
    let done = CpuExecutor::new().visibility(&inputs.occluders, &inputs.light, &inputs.receivers);
    done.expect("nothing is wrong").0
}

/// Mean difference.
fn error(a: &[f32], b: &[f32]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / a.len().max(1) as f64
}

#[test]
fn close_to_exact_and_closer_with_more_texels() {
    let inputs = slab_and_wall(48).inputs();
    let expected = exact(&inputs);
    let errors: Vec<f64> = [64, 128, 256]
        .iter()
        .map(|&size| error(&shadows(&inputs, &StochasticOptions { size, ..small() }), &expected))
        .collect();
    println!("mean error by size: {errors:?}");
    assert!(errors[2] < 0.03, "{errors:?}");
    assert!(errors[2] < errors[0], "{errors:?}");
}

#[test]
fn without_occluders_all_is_lit_and_behind_the_light_all_is_dark() {
    let scene = slab_and_wall(16);
    let mut inputs = scene.inputs();
    inputs.occluders = Occluders::default();
    for planes in [1, 4] {
        assert!(shadows(&inputs, &StochasticOptions { planes, ..small() }).iter().all(|v| *v == 1.0));
    }
    let mut above = scene.clone();
    above.receivers.iter_mut().step_by(3).for_each(|p| p.y = 3.5);
    let visibility = shadows(&above.inputs(), &small());
    assert!(visibility.iter().step_by(3).all(|v| *v == 0.0));
    assert!(visibility.iter().any(|v| *v > 0.5));
    above.receivers.iter_mut().for_each(|p| p.y = 3.5);
    assert!(shadows(&above.inputs(), &small()).iter().all(|v| *v == 0.0));
    above.receivers.clear();
    assert!(shadows(&above.inputs(), &small()).is_empty());
}

#[test]
fn every_choice_works_at_every_size() {
    let inputs = with_receivers_in_the_air(slab_and_wall(14), &mut Rng::new(1)).inputs();
    for size in [1, 2, 3, 15, 16, 17, 40] {
        for planes in [1, 2, 7] {
            for coarse_levels in [0, 1, 8] {
                let bases = [Basis::Variance, Basis::Exponential { exponent: 35.0 }];
                for (k, basis) in bases.into_iter().enumerate() {
                    let options = StochasticOptions {
                        size,
                        planes,
                        coarse_levels,
                        basis,
                        placement: [Placement::Depth, Placement::InverseDepth][k],
                        footprint: [Footprint::Ellipse, Footprint::Rectangle][k],
                        centers: [Centers::Texel, Centers::Projected][k],
                        interleaved: k == 0,
                        smoothed: k == 1,
                        widest_raise: [0.0, 65536.0][k],
                        ..StochasticOptions::default()
                    };
                    shadows(&inputs, &options);
                }
            }
        }
    }
}

#[test]
fn what_nobody_looks_at_changes_nothing() {
    // Receivers in two corners: most tiles are idle.
    let mut scene = with_receivers_in_the_air(slab_and_wall(40), &mut Rng::new(2));
    scene.receivers.retain(|p| (p.x - p.z).abs() > 2.4);
    let inputs = scene.inputs();
    for (coarse_levels, planes) in [(0, 1), (3, 1), (6, 4)] {
        let options = StochasticOptions { size: 256, coarse_levels, planes, ..StochasticOptions::default() };
        let all = shadows(&inputs, &StochasticOptions { active_tiles: false, ..options });
        assert_eq!(shadows(&inputs, &options), all, "{coarse_levels} coarse levels, {planes} planes");
    }
}

#[test]
fn threads_and_order_change_nothing() {
    let inputs = with_receivers_in_the_air(slab_and_wall(24), &mut Rng::new(3)).inputs();
    let expected = shadows(&inputs, &small());
    for threads in [1, 3] {
        let executor = CpuExecutor::new().with_threads(threads).expect("threads can be had");
        let done = executor.stochastic_shadows(&inputs.occluders, &inputs.light, &inputs.receivers, &small());
        assert_eq!(done.expect("options are good").visibility, expected);
    }
    let arranged = Inputs { occluders: inputs.occluders.clone().arranged(), ..inputs };
    assert_eq!(shadows(&arranged, &small()), expected);
}

#[test]
fn receivers_that_face_away_are_dark() {
    let scene = slab_and_wall(8);
    let inputs = scene.inputs();
    let normals: Vec<Vec3> = (0..64).map(|k| if k % 2 == 0 { Vec3::NEG_Y } else { Vec3::Y }).collect();
    let receivers = Receivers::raw(&inputs.lattice, &scene.receivers).and_then(|r| r.facing(&normals)).expect("good");
    let faced = shadows(&Inputs { receivers, ..inputs.clone() }, &small());
    let plain = shadows(&inputs, &small());
    for (k, (faced, plain)) in faced.iter().zip(&plain).enumerate() {
        assert_eq!(*faced, if k % 2 == 0 { 0.0 } else { *plain });
    }
}

#[test]
fn lights_of_any_shape_cast_their_shadows() {
    for (edge_u, edge_v) in [(DVec3::X * 1.5, DVec3::Z * 0.3), (DVec3::X, DVec3::new(0.7, 0.0, 0.9))] {
        let scene = WorldScene { edge_u, edge_v, ..slab_and_wall(40) };
        let inputs = scene.inputs();
        let found = error(&shadows(&inputs, &StochasticOptions { size: 256, ..small() }), &exact(&inputs));
        assert!(found < 0.04, "{edge_u} × {edge_v}: {found}");
    }
}

/// Where the lower grid's shadow falls changes as the upper grid turns. A map from one point of the light cannot know of it; this one knows in part: a sample of the
/// lower grid still counts as seen from the whole light (section 4.1).
#[test]
fn turning_grids_modulate_the_light_field() {
    let options = StochasticOptions { size: 256, planes: 1, ..StochasticOptions::default() };
    let frames: Vec<(Vec<f32>, Vec<f32>)> = [0.0, 0.3, 0.6]
        .iter()
        .map(|angle| {
            let inputs = two_grids(*angle, 32, 8).inputs();
            (shadows(&inputs, &options), exact(&inputs))
        })
        .collect();
    for (frame, (map, expected)) in frames.iter().enumerate() {
        let found = error(map, expected);
        println!("frame {frame}: mean error {found}");
        assert!(found < 0.06, "frame {frame}: {found}");
    }
    for pair in frames.windows(2) {
        let [(map, expected), (next_map, next_expected)] = pair else { unreachable!("windows of two") };
        // The change from frame to frame is that of the exact masks.
        let (change, wanted): (Vec<f64>, Vec<f64>) = (0..map.len())
            .map(|k| (f64::from(next_map[k] - map[k]), f64::from(next_expected[k] - expected[k])))
            .unzip();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let correlation = dot(&change, &wanted) / (dot(&change, &change) * dot(&wanted, &wanted)).sqrt();
        println!("changes correlate by {correlation}");
        assert!(correlation > 0.25, "{correlation}");
    }
}

/// Temporal noise: how much otherwise neighbouring frames of a slowly moving light differ than exact ones do (figure 18).
#[test]
fn a_moving_light_hardly_flickers() {
    let scene = two_grids(0.3, 32, 16);
    let excess = |size: u32| {
        let frame = |k: u32| {
            let inputs = moved(&scene, k).inputs();
            let options = StochasticOptions { size, planes: 1, ..StochasticOptions::default() };
            (shadows(&inputs, &options), exact(&inputs))
        };
        let frames: Vec<_> = (0..4).map(frame).collect();
        flicker(&frames).noise
    };
    let noise = [64, 256].map(excess);
    println!("noise between frames: {noise:?}");
    assert!(noise.iter().all(|noise| *noise < 0.02), "{noise:?}");
}

/// The failure that the paper names first: at the foot of a wall, where occluder and receiver are at nearly the same depth, shadow is lost.
#[test]
fn contact_shadows_are_lost_and_come_back_with_less_bias() {
    let mut scene = slab_and_wall(8);
    // On the far side of the wall, as seen from the light, from its foot on.
    scene.receivers = (0..40).map(|k| Vec3::new(1.22 + 0.002 * k as f32, 1e-4, 0.0)).collect();
    // A box: its other side too.
    let first = scene.vertices.len() as u32;
    scene.vertices.extend([[1.2, 0.0, -1.0], [1.2, 0.8, -1.0], [1.2, 0.8, 1.0], [1.2, 0.0, 1.0]].map(Vec3::from_array));
    scene.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    scene.receivers.extend([Vec3::new(-2.0, 1e-4, -2.0), Vec3::new(2.0, 0.6, 2.0), Vec3::new(2.0, 1e-4, -2.0)]);
    let inputs = scene.inputs();
    let expected = exact(&inputs);
    assert!(expected[..40].iter().all(|v| *v < 0.5), "in the shadow");
    let leak = |least_deviation: f32| {
        let options = StochasticOptions { size: 256, least_deviation, ..StochasticOptions::default() };
        let found = shadows(&inputs, &options);
        found.iter().zip(&expected).take(40).map(|(found, expected)| f64::from(found - expected)).sum::<f64>() / 40.0
    };
    let leaks = [0.002, 0.5].map(leak);
    println!("light at the foot of a wall: {leaks:?}");
    assert!(leaks[1] > leaks[0] + 0.1, "{leaks:?}");
}

#[test]
fn bad_options_are_refused() {
    let inputs = slab_and_wall(4).inputs();
    let refused = |options: StochasticOptions| {
        let done = CpuExecutor::new().stochastic_shadows(&inputs.occluders, &inputs.light, &inputs.receivers, &options);
        match done.expect_err("refused") {
            ExecutorError::Stochastic(error) => error,
            other => panic!("{other}"),
        }
    };
    let error = refused(StochasticOptions { planes: 0, ..small() });
    assert_eq!(error, StochasticError::OutOfRange { field: "planes", value: 0.0, least: 1.0, most: 64.0 });
    let error = refused(StochasticOptions { size: 0, ..small() });
    assert_eq!(error, StochasticError::OutOfRange { field: "size", value: 0.0, least: 1.0, most: 4096.0 });
    let error = refused(StochasticOptions { basis: Basis::Exponential { exponent: 90.0 }, ..small() });
    assert_eq!(error, StochasticError::Overflow { field: "exponent", value: 90.0, most: 35.0 });
}

/// A receiver that no map holds is taken as lit, and counted.
#[test]
fn receivers_out_of_reach_are_counted() {
    let mut scene = slab_and_wall(8);
    scene.receivers.push(Vec3::new(4.0, 2.9, 0.0));
    let inputs = scene.inputs();
    let done = CpuExecutor::new().stochastic_shadows(&inputs.occluders, &inputs.light, &inputs.receivers, &small());
    let done = done.expect("options are good");
    assert_eq!((done.outside, done.visibility[64]), (1, 1.0));
    assert!(done.statistics.seconds() > 0.0 && !done.planes.is_empty());
    assert!(done.planes.windows(2).all(|pair| pair[0] < pair[1]));
}
