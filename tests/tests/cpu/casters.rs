//! Casters on CPU threads: masks, counts, visibility and light are the oracle's, for every word width and instruction set; casters that
//! move need their own part of the index made anew, and no other.

use std::sync::LazyLock;

use umbra4_core::{
    Facing, Jitter,
    emission::{Emission, Weight},
    glam::{IVec3, Vec3},
    tint::{self, Depth},
};
use umbra4_cpu::{CpuExecutor, CpuWord, Isa};
use umbra4_tests::{
    budget,
    caster_inputs::{CasterInputs, caster_of},
    caster_oracle::{Decisions, OracleCaster, OracleSurface, closed, depth},
    caster_scenes::{self, CasterScene, GENERATORS, Generator},
    caster_suite::{CasterSubject, CpuCasters, Expected, check, check_sums, report},
    compare::Compared,
    facings,
    ledger::Ledger,
    meshes::{Mesh, cuboid, icosphere},
    rng::Rng,
    scenes::{EXPONENTS, SampleGrid},
    weights::weights,
};

/// What all kinds of scenes compare together.
static LEDGER: LazyLock<Ledger> = LazyLock::new(|| Ledger::new(GENERATORS.len(), budget::asked() / 2));

fn subjects() -> Vec<CpuCasters> {
    let mut sets = Isa::available().to_vec();
    if !sets.contains(&Isa::Portable) {
        sets.push(Isa::Portable);
    }
    sets.into_iter().map(|isa| CpuCasters::new(2, isa)).collect()
}

/// Compares its part of the bits asked for on scenes of one kind.
fn property(name: &str) {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).expect("a generator has this name");
    let mut rng = Rng::named(0, &format!("casters {name}"));
    let (subjects, mut total, mut decisions, mut round) = (subjects(), Compared::default(), Decisions::default(), 0);
    while total.bits < budget::asked() / 2 / GENERATORS.len() as u64 + 1 {
        let width = rng.pick(&[16, 32, 64]);
        let samples = caster_scenes::grid(&mut rng, width);
        let scene = generator(&mut rng, samples);
        let weights = weights(&mut rng, (samples.rows * samples.columns) as usize);
        let expected = Expected::of(&scene, &weights);
        decisions = decisions.with(expected.decisions);
        for subject in &subjects {
            match check(subject, &scene, EXPONENTS[round % EXPONENTS.len()], &expected, &weights) {
                Ok(compared) => {
                    total.bits += compared.bits;
                    total.blocked += compared.blocked;
                }
                Err(error) => report(subject, &format!("{name}, scene {round}"), &scene, &weights, &error),
            }
        }
        round += 1;
    }
    println!("{name}: {round} scenes, {total:?}, {decisions:?}");
    assert!(total.blocked > 0 && total.blocked < total.bits, "{name}: {total:?} tests nothing");
    let Decisions { cut_out, kept, faced, moved, tinted, on_edge, apart } = decisions;
    let least = [("cut out", cut_out, 100), ("kept", kept, 100), ("apart", apart, 10)];
    let own: &[(&str, u64, u64)] = match name {
        "closed_casters" => &[("faced", faced, 1000), ("moved", moved, 100)],
        "slabs" => &[("moved", moved, 1000)],
        "panes" => &[("tinted", tinted, 1000), ("on edge", on_edge, 100)],
        "cards" => &[("tinted", tinted, 1000), ("on edge", on_edge, 100), ("moved", moved, 100)],
        _ => &[("tinted", tinted, 100)],
    };
    for (what, count, least) in least.iter().chain(own) {
        assert!(count >= least, "{name}: {what}: {count}");
    }
    LEDGER.enter("casters", total);
}

macro_rules! properties {
    ($($name:ident),+ $(,)?) => {
        #[test]
        fn every_generator_is_tried() {
            let generators = GENERATORS.map(|(name, _)| name);
            assert_eq!(generators.as_slice(), &[$(stringify!($name)),+]);
        }

        $(
            #[test]
            fn $name() {
                property(stringify!($name));
            }
        )+
    };
}

properties! {
    dressed_soup, dressed_tiny, dressed_outermost, dressed_slivers, dressed_zero_area, dressed_coarse_grid,
    dressed_in_planes, dressed_across_planes, dressed_full_coverage, dressed_crowd, cards, panes, closed_casters, slabs
}

fn generator(name: &str) -> Generator {
    GENERATORS.iter().find(|(n, _)| *n == name).expect("a generator has this name").1
}

/// What floats cannot tell is redone in integers, often where hits fall on borders, and masks go through every stage.
#[test]
fn nothing_is_compared_in_vain() {
    let mut rng = Rng::named(0, "in vain");
    let executor = CpuExecutor::new();
    for name in ["cards", "panes", "dressed_coarse_grid", "dressed_outermost", "closed_casters", "slabs"] {
        let (mut counts, mut of_light) = (umbra4_core::Counts::default(), umbra4_core::Counts::default());
        for _ in 0..10 {
            let samples = caster_scenes::grid(&mut rng, 64);
            let inputs = generator(name)(&mut rng, samples).inputs(20);
            let weights = weights(&mut rng, (samples.rows * samples.columns) as usize);
            let emission = Emission::new(samples.rows, samples.columns, weights).expect("one is not zero");
            let index = executor.index_casters(&inputs.casters, &inputs.light);
            let (_, statistics) = executor.caster_masks::<u64>(&index, &inputs.receivers).expect("the word is wide");
            counts = counts.plus(statistics.counts);
            let (_, statistics) = executor.caster_light(&index, &inputs.receivers, &emission).expect("sizes agree");
            of_light = of_light.plus(statistics.counts);
        }
        println!("{name}: {counts:?}; with light {of_light:?}");
        assert!(of_light.fallbacks > 0 && of_light.pairs_kept > 0 && of_light.pairs_tested >= of_light.pairs_kept);
        assert!(name == "panes" || counts.fallbacks > 0, "{name}: {counts:?}");
        assert!(matches!(name, "closed_casters" | "slabs") || of_light.pairs_tested > counts.pairs_tested, "{name}");
    }
}

/// The comparisons can fail.
#[test]
fn what_is_wrong_is_noticed() {
    let mut rng = Rng::named(0, "wrong casters");
    let subject = CpuCasters::new(2, Isa::Portable);
    let (scene, weights, expected) = loop {
        let scene = generator("cards")(&mut rng, SampleGrid::regular(5, 7));
        let weights = weights(&mut rng, 35);
        let expected = Expected::of(&scene, &weights);
        if expected.decisions.tinted > 10 && expected.light.iter().any(|light| light.iter().all(|sum| *sum > 0)) {
            break (scene, weights, expected);
        }
    };
    assert!(check(&subject, &scene, 7, &expected, &weights).is_ok());
    for _ in 0..50 {
        let (word, column) = (rng.below(expected.masks.len()), rng.below(7));
        let mut wrong = expected.clone();
        wrong.masks[word] ^= 1 << column;
        let error = check(&subject, &scene, 7, &wrong, &weights).expect_err("a bit is wrong");
        assert!(error.contains(&format!("receiver {}, row {}, column {column}", word / 5, word % 5)), "{error}");
        let error = check_sums(&subject, &scene.inputs(7), &wrong, &weights).expect_err("a sum is wrong");
        assert!(error.contains("lit samples"), "{error}");
        let (receiver, channel) = (rng.below(expected.light.len()), rng.below(3));
        let mut wrong = expected.clone();
        wrong.light[receiver][channel] ^= 1;
        let error = check(&subject, &scene, 7, &wrong, &weights).expect_err("a sum is wrong");
        assert!(error.contains(&format!("receiver {receiver}: light")), "{error}");
    }
    let mut wrong = expected;
    wrong.masks.pop();
    assert!(check(&subject, &scene, 7, &wrong, &weights).is_err());
}

#[test]
#[should_panic(expected = "smallest scene that fails")]
fn a_wrong_executor_is_reported_with_its_smallest_scene() {
    /// Forgets layers.
    struct Wrong(CpuCasters);
    impl Wrong {
        fn told(inputs: &CasterInputs) -> CasterInputs {
            let casters = inputs.casters.iter().map(|caster| caster.clone().on_layers(umbra4_core::Layers::ALL));
            CasterInputs { casters: casters.collect(), ..inputs.clone() }
        }
    }
    impl CasterSubject for Wrong {
        fn name(&self) -> String {
            "without layers".into()
        }
        fn masks<W: CpuWord>(&self, inputs: &CasterInputs) -> Result<Vec<W>, String> {
            self.0.masks(&Self::told(inputs))
        }
        fn visibility(&self, inputs: &CasterInputs) -> Result<Vec<f32>, String> {
            self.0.visibility(&Self::told(inputs))
        }
        fn lit_counts(&self, inputs: &CasterInputs) -> Result<Vec<u32>, String> {
            self.0.lit_counts(&Self::told(inputs))
        }
        fn light(&self, inputs: &CasterInputs, weights: &[Weight]) -> Result<Vec<[u32; 3]>, String> {
            self.0.light(&Self::told(inputs), weights)
        }
    }
    let (mut rng, subject) = (Rng::named(0, "forgets layers"), Wrong(CpuCasters::new(1, Isa::Portable)));
    for _ in 0..100 {
        let scene = generator("cards")(&mut rng, SampleGrid::regular(5, 7));
        let weights = weights(&mut rng, 35);
        if let Err(error) = check(&subject, &scene, 7, &Expected::of(&scene, &weights), &weights) {
            report(&subject, "cards", &scene, &weights, &error);
        }
    }
}

#[test]
fn scenes_without_casters_triangles_or_receivers() {
    let (mut rng, executor) = (Rng::named(0, "empty"), CpuExecutor::new());
    let samples = SampleGrid::regular(4, 9);
    let whole = generator("cards")(&mut rng, samples);
    let weights = weights(&mut rng, 36);
    let bare = OracleCaster::opaque(vec![]);
    let no_texture = OracleSurface::Tinted {
        texture: umbra4_tests::caster_oracle::texel::OracleTexture::one([7; 3]),
        coordinates: None,
    };
    for scene in [
        CasterScene { casters: vec![], ..whole.clone() },
        CasterScene { casters: vec![bare.clone(), bare.clone().with_surface(no_texture)], ..whole.clone() },
        CasterScene { casters: vec![OracleCaster { closed: true, ..bare }], ..whole.clone() },
        CasterScene { receivers: vec![], ..whole.clone() },
        CasterScene { receivers: vec![], casters: vec![], ..whole },
    ] {
        let expected = Expected::of(&scene, &weights);
        for subject in subjects() {
            let compared = check(&subject, &scene, 0, &expected, &weights).expect("the same");
            assert_eq!(compared.bits, 4 * 36 * scene.receivers.len() as u64);
        }
        let index = executor.index_casters(&scene.inputs(0).casters, &scene.light);
        assert_eq!((index.len(), index.is_empty()), (scene.casters.len(), scene.casters.is_empty()));
        assert_eq!(index.light(), &scene.light);
    }
}

/// All that a run gives.
fn all_of(
    executor: &CpuExecutor,
    index: &umbra4_cpu::CasterIndex,
    inputs: &CasterInputs,
    weights: &[Weight],
) -> (Vec<u64>, Vec<[u32; 3]>) {
    let emission = Emission::new(inputs.light.rows, inputs.light.columns, weights).expect("one is not zero");
    let masks = executor.caster_masks::<u64>(index, &inputs.receivers).expect("the word is wide").0.into_words();
    (masks, executor.caster_light(index, &inputs.receivers, &emission).expect("sizes agree").0)
}

/// A caster moves, through receivers too: its part is made anew, and the index is as good as one made of all.
#[test]
fn one_caster_is_indexed_again_and_the_others_stay() {
    let mut rng = Rng::named(0, "moving casters");
    let (executor, subject) = (CpuExecutor::new(), CpuCasters(CpuExecutor::new()));
    let (mut frames, mut changed) = (0, 0);
    for round in 0..budget::of(120) {
        let (name, build) = rng.pick(&GENERATORS);
        let samples = caster_scenes::grid(&mut rng, 64);
        let scene = build(&mut rng, samples);
        let weights = weights(&mut rng, (samples.rows * samples.columns) as usize);
        let inputs = scene.inputs(EXPONENTS[round % EXPONENTS.len()]);
        let mut index = executor.index_casters(&inputs.casters, &inputs.light);
        let still = all_of(&executor, &index, &inputs, &weights);
        let place = rng.below(scene.casters.len());
        let Some(&[corner, _, _]) = scene.casters[place].triangles.first() else { continue };
        // Half-way to a receiver, to it, and beyond.
        let way = scene.receivers[rng.below(scene.receivers.len())].point - corner;
        let by = if scene.casters[place].closed { rng.point(1 << 18) } else { way / 2 };
        let mut last = still.clone();
        for frame in 1..4 {
            let moved = scene.with_moved(place, by * frame);
            let now = moved.inputs(inputs.lattice.exponent());
            executor.index_caster(&mut index, place, &now.casters[place]).expect("the caster is there");
            let again = all_of(&executor, &index, &now, &weights);
            let fresh = executor.index_casters(&now.casters, &now.light);
            assert!(again == all_of(&executor, &fresh, &now, &weights), "{name}, round {round}, frame {frame}");
            let expected = Expected::of(&moved, &weights);
            if let Err(error) = check(&subject, &moved, 0, &expected, &weights) {
                report(&subject, &format!("{name}, round {round}, frame {frame}"), &moved, &weights, &error);
            }
            assert!(again == (expected.masks, expected.light), "{name}, round {round}, frame {frame}");
            frames += 1;
            changed += usize::from(again != last);
            last = again;
        }
        // Back to where it was.
        executor.index_caster(&mut index, place, &inputs.casters[place]).expect("the caster is there");
        assert!(all_of(&executor, &index, &inputs, &weights) == still, "{name}, round {round}");
        // Another caster in its place, of another kind; the others are what they were.
        let other = OracleCaster { layers: 0b10, ..OracleCaster::opaque(scene.casters[place].triangles.clone()) };
        let mut replaced = scene.clone();
        replaced.casters[place] = other.clone();
        executor.index_caster(&mut index, place, &caster_of(&inputs.lattice, &other, true)).expect("it is there");
        let expected = Expected::of(&replaced, &weights);
        let got = all_of(&executor, &index, &inputs, &weights);
        assert!(got == (expected.masks, expected.light), "{name}, round {round}: another caster");
        let nowhere = executor.index_caster(&mut index, scene.casters.len(), &inputs.casters[0]);
        let error = nowhere.expect_err("there is no such place").to_string();
        assert!(error.contains(&scene.casters.len().to_string()), "{error}");
    }
    assert!(frames > 200 && changed > 80, "{frames} frames, {changed} of them changed something");
}

/// The same caster, moved by its vertices in floats.
#[test]
fn casters_move_by_their_vertices() {
    let mut rng = Rng::named(0, "moving vertices");
    let executor = CpuExecutor::new();
    for round in 0..budget::of(60) {
        let name = rng.pick(&["cards", "panes"]);
        let samples = caster_scenes::grid(&mut rng, 64);
        let scene = generator(name)(&mut rng, samples);
        let weights = weights(&mut rng, (samples.rows * samples.columns) as usize);
        let mut inputs = scene.inputs(EXPONENTS[round % EXPONENTS.len()]);
        let mut index = executor.index_casters(&inputs.casters, &inputs.light);
        let place = rng.below(scene.casters.len());
        let by = rng.point(64) * 512;
        for frame in [1, 2, -1] {
            let moved = scene.with_moved(place, by * frame);
            let at_first = scene.inputs(inputs.lattice.exponent());
            let world = |p: &IVec3| {
                let exact = inputs.lattice.to_world(*p + by * frame);
                assert_eq!(exact.as_vec3().as_dvec3(), exact, "floats hold the coordinates of cards");
                exact.as_vec3()
            };
            let vertices: Vec<Vec3> = at_first.casters[place].occluders().vertices().iter().map(world).collect();
            let lattice = inputs.lattice;
            inputs.casters[place].move_vertices(&lattice, &vertices).expect("vertices are inside");
            executor.index_caster(&mut index, place, &inputs.casters[place]).expect("the caster is there");
            let expected = Expected::of(&moved, &weights);
            let got = all_of(&executor, &index, &inputs, &weights);
            assert!(got == (expected.masks, expected.light), "{name}, round {round}, frame {frame}");
        }
    }
}

/// Receivers that face away from the light get none of it, whatever their layers.
#[test]
fn receivers_that_face_away_are_dark() {
    let mut rng = Rng::named(0, "casters and facing");
    let executor = CpuExecutor::new();
    let (mut away, mut all) = (0, 0);
    for _ in 0..budget::of(60) {
        let (_, build) = rng.pick(&GENERATORS);
        let samples = caster_scenes::grid(&mut rng, 64);
        let scene = build(&mut rng, samples);
        let weights = weights(&mut rng, (samples.rows * samples.columns) as usize);
        let mut inputs = scene.inputs(20);
        let samples_at = umbra4_tests::caster_oracle::samples(&scene.light);
        let normals: Vec<Vec3> = scene
            .receivers
            .iter()
            .map(|receiver| {
                let normal = facings::normal(&mut rng, receiver.point, &samples_at);
                facings::given(&mut rng, normal)
            })
            .collect();
        inputs.receivers = inputs.receivers.facing(&normals).expect("normals point somewhere");
        let mut expected = Expected::of(&scene, &weights);
        let (rows, full) = (scene.light.rows as usize, u64::MAX >> (64 - scene.light.columns));
        for (r, (receiver, normal)) in scene.receivers.iter().zip(&normals).enumerate() {
            all += 1;
            if Facing::of(*normal).is_away_from(&scene.light, receiver.point) {
                away += 1;
                expected.masks[r * rows..(r + 1) * rows].fill(full);
                expected.light[r] = [0; 3];
            }
        }
        let index = executor.index_casters(&inputs.casters, &inputs.light);
        assert_eq!(all_of(&executor, &index, &inputs, &weights), (expected.masks.clone(), expected.light.clone()));
        check_sums(&CpuCasters::new(2, Isa::Portable), &inputs, &expected, &weights).expect("the same");
    }
    assert!(away > 200 && all > 2 * away, "{away} of {all} face away");
}

/// Depths and what they let through, against powers of integers.
#[test]
fn tints_and_transmittances_are_rounded_right() {
    for depth in 0..=u16::MAX {
        let expected = depth::transmittance(depth);
        assert_eq!(tint::transmittance(&tint::TRANSMITTANCES, u32::from(depth)), expected, "{depth}");
    }
    let mut rng = Rng::named(0, "tints of core");
    for _ in 0..budget::of(100_000) {
        let (weight, depths) =
            ([0; 3].map(|_| rng.next_u64() as u16), [0; 3].map(|_| rng.next_u64() as u16 >> rng.below(16)));
        let expected = [0, 1, 2].map(|k| depth::transmitted(weight[k], depths[k]));
        assert_eq!(tint::tinted_weight(weight, Depth::new(depths.map(u32::from))), expected, "{weight:?} {depths:?}");
        let others = [0; 3].map(|_| rng.next_u64() as u16);
        let sum = Depth::new(depths.map(u32::from)).and(Depth::new(others.map(u32::from)));
        assert_eq!(sum.channels(), depth::sum(depths, others).map(u32::from));
    }
    // Any tint, and the floats next to where the depth changes.
    let mut tints: Vec<f32> = (0..100).map(|_| rng.unit().powi(1 + rng.below(9) as i32) as f32).collect();
    for _ in 0..100 {
        let depth = rng.below(65_535) as f64;
        let change = (-(2.0 * depth + 1.0) / 4096.0).exp2() as f32;
        tints.extend([change, change.next_up(), change.next_down()]);
    }
    tints.extend([0.0, -0.0, 1.0, 1.0_f32.next_down(), 0.5, f32::MIN_POSITIVE, f32::from_bits(1)]);
    for tint in tints {
        assert_eq!(tint::depth_of(tint), Some(u32::from(depth::of_tint(tint))), "{tint:e}");
    }
    for depth in 0..=u16::MAX {
        let tint = umbra4_tests::caster_inputs::tint_of(depth);
        assert_eq!(tint::depth_of(tint), Some(u32::from(depth)), "depths come back");
    }
}

fn triangles(mesh: &Mesh) -> Vec<[IVec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|v| mesh.vertices[v as usize])).collect()
}

/// Which parts of a mesh are closed, and the first open edge, as the oracle finds them.
#[test]
fn closed_parts_are_found() {
    let mut rng = Rng::named(0, "closed parts");
    let (mut whole, mut parts) = (0, [0; 2]);
    let lattice = CasterScene::inputs(&generator("cards")(&mut rng, SampleGrid::regular(1, 1)), 0).lattice;
    for _ in 0..budget::of(600) {
        let mut walls = vec![];
        for _ in 0..1 + rng.below(4) {
            let at = rng.point(3);
            let solid = if rng.one_in(3) {
                icosphere(at * 100, rng.below(2) as u32, |_| 5.0 + rng.unit() * 90.0)
            } else {
                // On a coarse grid: boxes share corners, edges and walls.
                cuboid(at, at + IVec3::ONE + rng.point(1).abs())
            };
            walls.extend(triangles(&solid));
        }
        for _ in 0..rng.below(3) {
            let wall = rng.below(walls.len());
            match rng.below(4) {
                0 => drop(walls.remove(wall)),
                1 => walls[wall].swap(0, 1),
                2 => walls.push(walls[wall]),
                _ => {
                    let [a, b, _] = walls[wall];
                    walls.push([a, a, b]);
                }
            }
        }
        for k in (1..walls.len()).rev() {
            walls.swap(k, rng.below(k + 1));
        }
        let caster = caster_of(&lattice, &OracleCaster::opaque(walls.clone()), rng.one_in(2));
        let mesh = caster.occluders();
        let found = mesh.closed_parts();
        let expected = closed::in_closed_components(&walls);
        assert_eq!(found.triangles(), expected, "{walls:?}");
        assert_eq!(found.all(), expected.iter().all(|closed| *closed));
        expected.iter().for_each(|closed| parts[usize::from(*closed)] += 1);
        let boundary = closed::boundary(&walls);
        let open = walls.iter().enumerate().find_map(|(t, &[a, b, c])| {
            let is_open = |&[a, b]: &[IVec3; 2]| {
                let [a, b] = [a.to_array(), b.to_array()];
                boundary.contains(&[a.min(b), a.max(b)])
            };
            let is_flat = a == b || b == c || c == a;
            [[a, b], [b, c], [c, a]].into_iter().find(is_open).filter(|_| !is_flat).map(|edge| (t, edge))
        });
        let named =
            found.open_edge().map(|edge| (edge.triangle as usize, edge.vertices.map(|v| mesh.vertices()[v as usize])));
        assert_eq!(named, open, "{walls:?}");
        let closed = caster.closed();
        assert_eq!(closed.is_ok(), open.is_none());
        whole += usize::from(closed.is_ok());
    }
    assert!(whole > 100 && parts.iter().all(|count| *count > 1000), "{whole} are closed; triangles: {parts:?}");
}

/// Threads, blocks of receivers, orders of casters: nothing of it shows.
#[test]
fn the_order_of_casters_does_not_matter() {
    let mut rng = Rng::named(0, "orders of casters");
    for _ in 0..budget::of(60) {
        let (_, build) = rng.pick(&GENERATORS);
        let samples = caster_scenes::grid(&mut rng, 64);
        let scene = build(&mut rng, samples);
        let weights = weights(&mut rng, (samples.rows * samples.columns) as usize);
        let run = |scene: &CasterScene, threads: usize| {
            let executor = CpuExecutor::new().with_threads(threads).expect("threads can be started");
            let inputs = scene.inputs(20);
            all_of(&executor, &executor.index_casters(&inputs.casters, &inputs.light), &inputs, &weights)
        };
        let first = run(&scene, 1);
        let mut turned = scene.clone();
        turned.casters.rotate_left(rng.below(scene.casters.len()));
        turned.casters.iter_mut().filter(|caster| !caster.closed).for_each(|caster| {
            caster.triangles.reverse();
            match &mut caster.surface {
                OracleSurface::Cutout { coordinates, .. }
                | OracleSurface::Tinted { coordinates: Some(coordinates), .. } => coordinates.reverse(),
                _ => {}
            }
        });
        assert_eq!(run(&turned, 3), first);
        // As many receivers as fill several blocks, every one more than once.
        let many = CasterScene { receivers: scene.receivers.repeat(1 + 5000 / scene.receivers.len()), ..scene.clone() };
        if many.light.sample_count() <= 64 {
            let (masks, light) = run(&many, 2);
            let copies = many.receivers.len() / scene.receivers.len();
            assert_eq!((masks, light), (first.0.repeat(copies), first.1.repeat(copies)));
        }
    }
}

#[test]
fn jittered_lights_are_among_those_tried() {
    let mut rng = Rng::named(0, "jittered casters");
    let tried: Vec<_> = (0..100).map(|_| caster_scenes::grid(&mut rng, 64)).collect();
    assert!(tried.iter().filter(|samples| samples.jitter != Jitter::NONE).count() > 20);
    for (rows, columns) in [(1, 1), (5, 7), (16, 16), (32, 9), (64, 64)] {
        assert!(tried.iter().any(|samples| (samples.rows, samples.columns) == (rows, columns)), "{rows}×{columns}");
    }
}
