//! What a scene lacks is not run.

use std::convert::Infallible;

use umbra4_core::{
    CasterFacts, CasterWork, Executor, IndexKind, LatticeLight, Layers, Pass, Plan, SceneFacts, Work,
    glam::IVec3,
    stage::{Stage, TABLE},
};
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

/// What a plan hands out, in order.
#[derive(Default)]
struct Passes(Vec<Pass>);

impl Executor for Passes {
    type Error = Infallible;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), Infallible> {
        self.0.push(*pass);
        Ok(())
    }
}

fn passes(plan: &Plan) -> Vec<Pass> {
    let mut passes = Passes::default();
    let Ok(()) = plan.run(&mut passes);
    passes.0
}

#[test]
fn casters_bring_their_own_stages_and_no_others() {
    let special = [Stage::SelectReceivers, Stage::ResolveCutout, Stage::AddTint];
    let whole = SceneFacts { triangles: 1000, receivers: 100, visibility: true, block: 64, ..SceneFacts::default() };
    assert!(passes(&Plan::new(whole)).iter().all(|pass| !special.contains(&pass.stage)));
    for bits in 0..32_u32 {
        let has = |bit: u32| bits >> bit & 1;
        let casters = CasterFacts { plain: has(0), cutout: has(1), tinted: has(2), layered: has(3) == 1 };
        let facts = SceneFacts { work: Work::Casters(casters), visibility: has(4) == 1, ..whole };
        let plan = Plan::new(facts);
        let found = passes(&plan);
        let runs = |stage: Stage| found.iter().any(|pass| pass.stage == stage);
        for (stage, wanted) in [
            (Stage::Resolve, casters.plain > 0),
            (Stage::ResolveCutout, casters.cutout > 0),
            (Stage::AddTint, casters.tinted > 0),
            (Stage::SelectReceivers, casters.layered),
            (Stage::Reduce, facts.visibility),
            (Stage::SettleReceivers, false),
            (Stage::KeyTriangles, false),
        ] {
            assert_eq!(runs(stage), wanted, "{stage:?}, {facts:?}");
        }
        for info in &TABLE {
            assert_eq!(plan.reason(info.stage).0, runs(info.stage), "{:?}, {facts:?}\n{plan}", info.stage);
        }
        // Two blocks, each of which ends with the same stage.
        let last = plan.last_of_block().expect("casters have blocks");
        assert_eq!(found.iter().filter(|pass| pass.stage == last).count(), 2, "{facts:?}");
        assert_eq!(found.last().map(|pass| pass.stage), Some(last), "{facts:?}");
    }
    let index = Plan::new(SceneFacts { work: Work::Index, ..whole });
    let found: Vec<Stage> = passes(&index).iter().map(|pass| pass.stage).collect();
    assert_eq!(found, [Stage::KeyTriangles, Stage::OrderTriangles, Stage::BuildLevel, Stage::BuildLevel]);
    for info in &TABLE {
        assert_eq!(index.reason(info.stage).0, found.contains(&info.stage), "{:?}", info.stage);
    }
}

#[test]
fn what_does_nothing_to_light_is_no_caster() {
    let facts =
        |casters: &[(CasterWork, Layers)], light, layered| CasterFacts::of(casters.iter().copied(), light, layered);
    let clear = (CasterWork::Nothing, Layers::NONE);
    assert_eq!(facts(&[clear], true, true), CasterFacts::default());
    // A pane matters where light is asked for.
    let pane = (CasterWork::Tinted, Layers::ALL);
    assert_eq!(facts(&[pane, clear], false, true), CasterFacts::default());
    assert_eq!(facts(&[pane, clear], true, false), CasterFacts { tinted: 1, ..CasterFacts::default() });
    let (leaf, wall) = ((CasterWork::Cutout, Layers::from_bits(1)), (CasterWork::Plain, Layers::ALL));
    let both = CasterFacts { plain: 1, cutout: 1, ..CasterFacts::default() };
    // Receivers on all layers are met by whatever is on one.
    assert_eq!(facts(&[leaf, wall], false, false), both);
    assert_eq!(facts(&[leaf, wall], false, true), CasterFacts { layered: true, ..both });
    let hidden = (CasterWork::Plain, Layers::NONE);
    assert!(facts(&[hidden], false, false).layered);
}
