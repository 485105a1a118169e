//! Many lights in one call, lights that shine to both sides, and lights that reach nobody.

use umbra4_core::{
    Jitter, LatticeLight, Punctual,
    cloud::Cloud,
    emission::{Emission, Weight},
    glam::IVec3,
};
use umbra4_cpu::{CpuExecutor, ExecutorError, Lit, Sides, Source, Statistics};
use umbra4_tests::{
    budget, hard_shadows,
    oracle::{hit, oracle_masks},
    rng::Rng,
    scene::{Inputs, REACH},
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
    weights::weights,
};

const GRIDS: [(u32, u32); 4] = [(16, 16), (5, 31), (33, 17), (9, 64)];

/// Of every receiver, the samples that are seen, row by row, from either side: the rule at the light's own samples.
fn seen(inputs: &Inputs, sides: Sides) -> Vec<Vec<bool>> {
    let (light, points, triangles) = (inputs.light, inputs.receivers.points(), inputs.triangles());
    let (rows, columns) = (light.rows as usize, light.columns as usize);
    let bits = |light: &LatticeLight| -> Vec<Vec<bool>> {
        let masks = oracle_masks(light, points, &triangles);
        let mask = |mask: &[u64]| (0..rows * columns).map(|k| mask[k / columns] >> (k % columns) & 1 == 0).collect();
        masks.chunks_exact(rows).map(mask).collect()
    };
    let mut found = bits(&light);
    if sides == Sides::Both {
        for (front, back) in found.iter_mut().zip(bits(&light.back())) {
            for (k, seen) in back.into_iter().enumerate() {
                // The samples are the same, their rows in reverse order.
                let (row, column) = (rows - 1 - k / columns, k % columns);
                front[row * columns + column] |= seen;
            }
        }
    }
    found
}

/// What a receiver sees of a light. Of one that reaches nobody it is nothing, and no list says so.
fn fraction(lit: &Lit, r: usize) -> f32 {
    match lit {
        Lit::Nowhere => 0.0,
        Lit::Fractions(fractions) => fractions[r],
        other => panic!("no fractions: {other:?}"),
    }
}

fn weight(lit: &Lit, r: usize) -> [u32; 3] {
    match lit {
        Lit::Nowhere => [0; 3],
        Lit::Weights(sums) => sums[r],
        other => panic!("no weights: {other:?}"),
    }
}

#[test]
fn the_back_has_the_same_samples() {
    let mut rng = Rng::named(0, "back");
    for round in 0..budget::of(200) {
        let (rows, columns) = (1 + rng.below(64) as u32, 1 + rng.below(64) as u32);
        let jitter = if round % 2 == 0 { Jitter::NONE } else { Jitter::pattern(rng.next_u64() as u32) };
        let step = |v: IVec3| v * 32;
        let light = LatticeLight {
            origin: rng.point(REACH / 4),
            step_u: step(rng.point(1000)),
            step_v: step(rng.point(1000)),
            rows,
            columns,
            jitter,
        };
        let back = light.back();
        assert_eq!((back.back(), back.step_u), (light, light.step_u));
        assert_eq!(back.step_v, -light.step_v);
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            assert_eq!(back.sample(rows - 1 - row, column), light.sample(row, column), "{light:?}");
        }
    }
}

#[test]
fn each_light_of_a_call_is_exact() {
    let executor = CpuExecutor::new().with_threads(2).expect("threads can be started");
    let (mut receivers, mut partly, mut from_behind) = (0, 0, 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("lights {name}"));
        for (round, (rows, columns)) in GRIDS.into_iter().enumerate() {
            let grid = SampleGrid::regular(rows, columns);
            let grid = if round % 2 == 1 { grid.jittered(&mut rng) } else { grid };
            let mut scene = generator(&mut rng, grid);
            // As many receivers behind the light as before it: mirrored in its middle.
            let middle = scene.light.sample(rows / 2, columns / 2);
            let mirrored = scene
                .receivers
                .iter()
                .map(|p| (middle - (p - middle) / 2).clamp(-IVec3::splat(REACH), IVec3::splat(REACH)));
            scene.receivers = scene.receivers.iter().copied().chain(mirrored.collect::<Vec<_>>()).collect();
            let inputs = scene.inputs(EXPONENTS[round]);
            let weights: Vec<Weight> = weights(&mut rng, (rows * columns) as usize);
            let emission = Emission::new(rows, columns, &weights[..]).expect("weights are fine");
            let (light, lamp) = (inputs.light, Punctual::point(rng.point(REACH)).expect("inside"));
            let cloud: Vec<IVec3> = (0..1 + rng.below(70)).map(|_| rng.point(REACH)).collect();
            let lights = [
                light.into(),
                lamp.into(),
                Source::Area { light, sides: Sides::Both, emission: None },
                Source::Area { light, sides: Sides::Front, emission: Some(emission) },
                Source::Area { light, sides: Sides::Both, emission: Some(emission) },
                Source::Cloud(Cloud::new(&cloud[..]).expect("inside")),
            ];
            let found = executor.lights(&inputs.occluders, &lights, &inputs.receivers).expect("nothing is refused");
            assert_eq!(found.len(), lights.len());
            let (front, both) = (seen(&inputs, Sides::Front), seen(&inputs, Sides::Both));
            let (points, triangles) = (inputs.receivers.points(), inputs.triangles());
            let blocked = hard_shadows::oracle(lamp, points, &triangles);
            let of = |seen: &[bool]| seen.iter().filter(|seen| **seen).count() as f32 / seen.len() as f32;
            let sum = |seen: &[bool]| {
                let lit = seen.iter().zip(&weights).filter(|(seen, _)| **seen);
                lit.fold([0_u32; 3], |sum, (_, w)| [0, 1, 2].map(|c| sum[c] + u32::from(w[c])))
            };
            for r in 0..inputs.receivers.len() {
                let what = format!("{name}, scene {round}, receiver {r}");
                assert_eq!(fraction(&found[0].0, r), of(&front[r]), "{what}");
                assert_eq!(fraction(&found[1].0, r), 1.0 - blocked[r] as f32, "{what}");
                assert_eq!(fraction(&found[2].0, r), of(&both[r]), "{what}");
                let of_cloud = cloud.iter().map(|sample| !triangles.iter().any(|t| hit(points[r], *sample, *t)));
                assert_eq!(fraction(&found[5].0, r), of(&of_cloud.collect::<Vec<_>>()), "{what}");
                for (lit, seen) in [(&found[3].0, &front[r]), (&found[4].0, &both[r])] {
                    assert_eq!(weight(lit, r), sum(seen), "{what}");
                }
                partly += usize::from((0.01..0.99).contains(&of(&both[r])));
                from_behind += usize::from(of(&both[r]) > of(&front[r]));
            }
            receivers += inputs.receivers.len();
        }
    }
    assert!(partly > receivers / 10 && from_behind > receivers / 10, "{partly}, {from_behind} of {receivers}");
}

#[test]
fn a_light_that_reaches_nobody_costs_nothing() {
    let inputs = GENERATORS[0].1(&mut Rng::named(0, "nobody"), SampleGrid::regular(4, 8)).inputs(0);
    let executor = CpuExecutor::new();
    // Far away, and looking away.
    let receivers = inputs.receivers.points();
    let side = |light: &LatticeLight| light.reaches(receivers);
    let away =
        LatticeLight { origin: IVec3::new(0, REACH, 0), step_u: IVec3::Z * 64, step_v: IVec3::X * 64, ..inputs.light };
    let away = if side(&away) { away.back() } else { away };
    assert!(!side(&away), "some receiver lies higher than the lattice");
    let both = Source::Area { light: away, sides: Sides::Both, emission: None };
    let found = executor.lights(&inputs.occluders, &[away.into(), both], &inputs.receivers).expect("fine");
    assert_eq!(found[0], (Lit::Nowhere, Statistics::default()));
    // Its other side has work, as much as alone.
    let (alone, statistics) = executor.visibility(&inputs.occluders, &away.back(), &inputs.receivers).expect("fine");
    assert_eq!(found[1].0, Lit::Fractions(alone));
    assert_eq!(found[1].1.counts, statistics.counts);
    assert_eq!(executor.lights(&inputs.occluders, &[], &inputs.receivers), Ok(Vec::new()));
}

#[test]
fn the_light_that_is_refused_is_named() {
    let inputs = GENERATORS[0].1(&mut Rng::named(0, "named"), SampleGrid::regular(4, 8)).inputs(0);
    let weights = [[1; 3]; 32];
    let emission = Emission::new(8, 4, &weights[..]).expect("weights are fine");
    let other = Source::Area { light: inputs.light, sides: Sides::Both, emission: Some(emission) };
    let lights = [inputs.light.into(), inputs.light.into(), other];
    let error = CpuExecutor::new().lights(&inputs.occluders, &lights, &inputs.receivers).expect_err("refused");
    let source = ExecutorError::EmissionSize { emission: [8, 4], light: [4, 8] };
    assert_eq!(error, ExecutorError::Light { index: 2, source: Box::new(source) });
    assert!(error.to_string().starts_with("lights[2]: an emission of 8×4"), "{error}");
}
