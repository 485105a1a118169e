//! What a scene lacks is not run.

use umbra4_core::{IndexKind, LatticeLight, Plan, SceneFacts, glam::IVec3, stage::Stage};
use umbra4_cpu::{CpuExecutor, GridOptions, Index};
use umbra4_tests::{
    rng::Rng,
    scene::Inputs,
    scenes::{GENERATORS, SampleGrid},
};

/// A random scene of which all receivers lie in the light's plane or behind it; or only all but one.
fn behind(rng: &mut Rng, all: bool) -> Inputs {
    let mut scene = GENERATORS[0].1(rng, SampleGrid::regular(8, 8));
    while scene.mesh.triangles.is_empty() {
        scene = GENERATORS[0].1(rng, SampleGrid::regular(8, 8));
    }
    let LatticeLight { origin, step_u, step_v, .. } = scene.light;
    let steps = [IVec3::ZERO, step_u, -step_v, step_u * 2 + step_v];
    scene.receivers = steps.iter().map(|step| origin + *step).collect();
    let before = scene.receivers.clone();
    scene.receivers.extend((0..50).map(|_| rng.point(1 << 20)));
    let light = scene.light;
    scene.receivers.retain(|p| !light.reaches(&[*p]));
    assert!(scene.receivers.len() >= before.len(), "the light's plane is not before it");
    if !all {
        let found = (0..1000).map(|_| rng.point(1 << 28)).find(|p| light.reaches(&[*p]));
        scene.receivers.insert(2, found.expect("half of space lies before a light"));
    }
    scene.inputs(0)
}

#[test]
fn a_light_that_reaches_nobody_costs_nothing() {
    let mut rng = Rng::named(0, "nobody");
    let grid = GridOptions { cells: [8; 2], ..GridOptions::default() };
    for index in [Index::Auto, Index::Hierarchy, Index::Silhouette, Index::Grid(grid)] {
        let executor = CpuExecutor::new().with_index(index);
        for round in 0..10 {
            let inputs = behind(&mut rng, round % 2 == 0);
            let Inputs { light, occluders, receivers, .. } = &inputs;
            let (masks, statistics) = executor.masks::<u16>(occluders, light, receivers).expect("the word fits");
            let masks: Vec<u64> = masks.words().iter().map(|word| u64::from(*word)).collect();
            assert_eq!(masks, inputs.oracle(), "{index:?}");
            let ran = statistics.seconds_by_stage.iter().any(|(stage, _)| stage.contains("triangles"));
            assert_eq!(ran, round % 2 == 1, "{index:?}: {statistics:?}");
        }
    }
}

#[test]
fn plans_say_why() {
    let facts = SceneFacts {
        triangles: 1000,
        receivers: 100,
        visibility: true,
        block: 64,
        index: IndexKind::Silhouette,
        ..SceneFacts::default()
    };
    let reason = |facts: SceneFacts, stage: Stage| Plan::new(facts).reason(stage);
    assert!(reason(facts, Stage::KeyTriangles).0 && !reason(facts, Stage::ResolvePunctual).0);
    let unreached = SceneFacts { reached: false, ..facts };
    for stage in [Stage::KeyTriangles, Stage::OrderTriangles, Stage::FindSilhouette] {
        assert_eq!(reason(unreached, stage), (false, "no receiver lies before the light"));
    }
    let punctual = SceneFacts { punctual: true, ..facts };
    for stage in [Stage::Resolve, Stage::FindSilhouette] {
        assert_eq!(reason(punctual, stage), (false, "the light has no extent: a mask is one bit"));
    }
    assert!(reason(punctual, Stage::ResolvePunctual).0 && reason(punctual, Stage::OrderTriangles).0);
    let cloud = SceneFacts { index: IndexKind::Shafts, ..facts };
    assert_eq!(reason(cloud, Stage::ResolveCloud), (true, "receivers to shadow"));
    let table = SceneFacts { table: true, ..cloud };
    assert_eq!(reason(table, Stage::ResolveCloud), (true, "receivers to shadow, by a table of planes"));
    assert!(Plan::new(table).to_string().contains("+ resolve_cloud    receivers to shadow, by a table of planes\n"));
    assert_eq!(reason(SceneFacts { triangles: 0, ..table }, Stage::ResolveCloud), (false, "no triangles"));
    assert_eq!(reason(facts, Stage::Illuminate), (false, "irradiance is not asked for"));
    let lit = SceneFacts { irradiance: true, ..facts };
    assert_eq!(reason(lit, Stage::Illuminate), (true, "irradiance is asked for"));
    for other in [SceneFacts { punctual: true, ..lit }, SceneFacts { index: IndexKind::Shafts, ..lit }] {
        assert_eq!(reason(other, Stage::Illuminate), (false, "the light has no area"));
    }
    assert_eq!(reason(SceneFacts { arranged: true, ..facts }, Stage::OrderTriangles), (false, "the mesh is arranged"));
}
