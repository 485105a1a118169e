//! The kernels of stochastic soft shadow maps alone, one id after the other, against the processor's run: the same bits, in whatever order ids run.

use umbra4_core::glam::{DVec3, Vec3};
use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
use umbra4_maps::stochastic::{Basis, Centers, Footprint, Placement, StochasticOptions};
use umbra4_tests::{
    grids::two_grids,
    rng::Rng,
    scene::{Inputs, WorldScene},
    serial_maps::{Ids, visibility},
    slab::{slab_and_wall, with_receivers_in_the_air},
};

const ORDERS: [Ids; 3] = [Ids::Forward, Ids::Backward, Ids::Scattered];

#[track_caller]
fn same(inputs: &Inputs, options: &StochasticOptions, ids: Ids) -> Vec<f32> {
    let done = CpuExecutor::new().stochastic_shadows(&inputs.occluders, &inputs.light, &inputs.receivers, options);
    let expected = done.expect("options are good").visibility;
    let got = visibility(inputs, options, ids).expect("there is something to map");
    assert_eq!(got, expected, "{options:?}, {ids:?}");
    got
}

fn shaded(visibility: &[f32]) -> usize {
    visibility.iter().filter(|v| **v > 0.05 && **v < 0.95).count()
}

#[test]
fn every_choice_gives_the_bits_of_the_processor() {
    let inputs = with_receivers_in_the_air(slab_and_wall(14), &mut Rng::new(1)).inputs();
    let mut round = 0;
    for size in [1, 2, 15, 17, 64] {
        for planes in [1, 3] {
            for coarse_levels in [0, 1, 6] {
                for basis in [Basis::Variance, Basis::Exponential { exponent: 35.0 }] {
                    let options = StochasticOptions {
                        size,
                        planes,
                        coarse_levels,
                        basis,
                        placement: [Placement::Depth, Placement::InverseDepth, Placement::Receivers][round % 3],
                        footprint: [Footprint::Ellipse, Footprint::Rectangle][round % 2],
                        centers: [Centers::Texel, Centers::Projected][round / 2 % 2],
                        interleaved: round % 3 == 0,
                        smoothed: round % 4 == 0,
                        active_tiles: round % 5 != 0,
                        widest_raise: [0.0, 2.0, 65536.0][round / 2 % 3],
                        ..StochasticOptions::default()
                    };
                    let visibility = same(&inputs, &options, ORDERS[round % ORDERS.len()]);
                    assert!(size < 64 || shaded(&visibility) > 10, "there are penumbrae");
                    round += 1;
                }
            }
        }
    }
}

#[test]
fn tiles_that_nobody_looks_at_are_left_out_alike() {
    let mut scene = with_receivers_in_the_air(slab_and_wall(30), &mut Rng::new(2));
    scene.receivers.retain(|p| (p.x - p.z).abs() > 2.4);
    let inputs = scene.inputs();
    for ids in ORDERS {
        same(&inputs, &StochasticOptions { size: 192, coarse_levels: 3, ..StochasticOptions::default() }, ids);
    }
}

#[test]
fn grids_are_the_processor_s() {
    let inputs = two_grids(0.3, 24, 8).inputs();
    let visibility = same(&inputs, &StochasticOptions { size: 96, ..StochasticOptions::default() }, Ids::Scattered);
    assert!(shaded(&visibility) > 100);
}

#[test]
fn without_triangles_all_is_lit() {
    let inputs = Inputs { occluders: Occluders::default(), ..slab_and_wall(8).inputs() };
    let options = StochasticOptions { size: 32, ..StochasticOptions::default() };
    assert!(same(&inputs, &options, Ids::Backward).iter().all(|v| *v == 1.0));
}

/// Behind the light, outside of the map, and facing away.
#[test]
fn receivers_that_the_map_does_not_decide() {
    let mut scene = slab_and_wall(8);
    scene.receivers.iter_mut().step_by(3).for_each(|p| p.y = 3.5);
    scene.receivers.extend([Vec3::new(4.0, 2.9, 0.0), Vec3::new(0.3, 2.99, 0.3)]);
    let inputs = scene.inputs();
    let normals: Vec<Vec3> =
        (0..scene.receivers.len()).map(|k| if k % 2 == 0 { Vec3::NEG_Y } else { Vec3::Y }).collect();
    let receivers = Receivers::raw(&inputs.lattice, &scene.receivers).and_then(|r| r.facing(&normals)).expect("good");
    let faced = Inputs { receivers, ..inputs.clone() };
    let options = StochasticOptions { size: 48, ..StochasticOptions::default() };
    let (plain, faced) = (same(&inputs, &options, Ids::Forward), same(&faced, &options, Ids::Backward));
    for (k, (plain, faced)) in plain.iter().zip(&faced).enumerate() {
        assert_eq!(*faced, if k % 2 == 0 { 0.0 } else { *plain });
        assert!(k >= 64 || k % 3 != 0 || *plain == 0.0, "behind the light");
    }
    assert_eq!(plain[64], 1.0, "outside of the map");
}

/// Where none is within reach, the map has no say.
#[test]
fn nothing_to_map() {
    let scene = WorldScene { receivers: vec![Vec3::new(0.0, 3.5, 0.0), Vec3::new(3.9, 2.9, 0.0)], ..slab_and_wall(1) };
    let inputs = scene.inputs();
    let options = StochasticOptions { size: 16, ..StochasticOptions::default() };
    assert_eq!(visibility(&inputs, &options, Ids::Forward), None);
    let with = |receivers: &Receivers| {
        let done = CpuExecutor::new().stochastic_shadows(&inputs.occluders, &inputs.light, receivers, &options);
        let done = done.expect("options are good");
        (done.visibility, done.outside)
    };
    assert_eq!(with(&inputs.receivers), (vec![0.0, 1.0], 1));
    let away = inputs.receivers.clone().facing(&[Vec3::NEG_Y; 2]).expect("two of two");
    assert_eq!(with(&away), (vec![0.0, 0.0], 1), "no light from behind");
}

/// A jittered light decides alike who faces away.
#[test]
fn jittered_lights() {
    let scene = WorldScene { edge_u: DVec3::X * 1.5, ..slab_and_wall(10) };
    let inputs = scene.inputs();
    let light = scene.light().with_jitter(umbra4_core::Jitter::pattern(5));
    let light = light.snap(&inputs.lattice, umbra4_core::Lift::NONE).expect("the lattice holds it");
    let mut rng = Rng::new(4);
    let normals: Vec<Vec3> =
        (0..100).map(|_| Vec3::new((rng.unit() * 2.0 - 1.0) as f32, (rng.unit() * 2.0 - 1.0) as f32, 0.3)).collect();
    let receivers = inputs.receivers.clone().facing(&normals).expect("one each");
    let inputs = Inputs { light, receivers, ..inputs };
    let options = StochasticOptions { size: 48, ..StochasticOptions::default() };
    let found = same(&inputs, &options, Ids::Scattered);
    let exact = CpuExecutor::new().visibility(&inputs.occluders, &inputs.light, &inputs.receivers).expect("good").0;
    // Who faces away is dark to both.
    let away = inputs.receivers.facings().iter().zip(inputs.receivers.points());
    let away: Vec<bool> = away.map(|(facing, p)| facing.is_away_from(&inputs.light, *p)).collect();
    assert!(away.iter().filter(|away| **away).count() > 10);
    assert!((0..100).all(|k| !away[k] || found[k] == 0.0 && exact[k] == 0.0));
}
