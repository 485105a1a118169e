//! Casters on a GPU: masks, counts, visibility and light are the oracle's; a caster that moves needs its own part of the index made
//! anew, and no other.

use libtest_mimic::Failed;
use umbra4_core::{
    Layers, PackedCaster, PairWord,
    emission::{Emission, Weight},
    glam::IVec3,
    stage::key_triangles::Casting,
    surface_words::SurfaceKind,
    texture::TextureSize,
};
use umbra4_cpu::CpuWord;
use umbra4_tests::{
    budget,
    caster_inputs::CasterInputs,
    caster_oracle::Decisions,
    caster_scenes::GENERATORS,
    caster_suite::{CasterSubject, Expected, check_masks, check_sums, report},
    compare::Compared,
    gpu::{Check, Test, of_executor},
    ledger::say,
    rng::Rng,
    scenes::{EXPONENTS, SampleGrid},
    weights::weights,
};
use umbra4_wgpu::{CasterIndex, GpuError, LatticeReceivers, WgpuExecutor};

/// One of each way to store rows, and of the ends of each.
const GRIDS: [(u32, u32); 8] = [(16, 16), (5, 31), (32, 32), (1, 1), (17, 33), (7, 13), (9, 64), (16, 16)];

struct GpuCasters<'a>(&'a WgpuExecutor);

impl GpuCasters<'_> {
    fn index(&self, inputs: &CasterInputs) -> Result<CasterIndex, String> {
        let packed: Vec<PackedCaster<'_>> = inputs.casters.iter().map(|caster| caster.packed()).collect();
        self.0.index_casters(&packed, &inputs.light).map_err(|error| error.to_string())
    }
}

fn receivers(inputs: &CasterInputs) -> LatticeReceivers<'_> {
    let own = &inputs.receivers;
    LatticeReceivers { points: own.points(), facings: own.facings(), layers: own.layers() }
}

impl CasterSubject for GpuCasters<'_> {
    fn name(&self) -> String {
        "gpu".to_owned()
    }

    fn masks<W: CpuWord>(&self, inputs: &CasterInputs) -> Result<Vec<W>, String> {
        let found = self.0.caster_masks::<W>(&self.index(inputs)?, receivers(inputs));
        Ok(found.map_err(|error| error.to_string())?.0)
    }

    fn visibility(&self, inputs: &CasterInputs) -> Result<Vec<f32>, String> {
        let found = self.0.caster_visibility(&self.index(inputs)?, receivers(inputs));
        Ok(found.map_err(|error| error.to_string())?.0)
    }

    fn lit_counts(&self, inputs: &CasterInputs) -> Result<Vec<u32>, String> {
        let found = self.0.caster_lit_counts(&self.index(inputs)?, receivers(inputs));
        Ok(found.map_err(|error| error.to_string())?.0)
    }

    fn light(&self, inputs: &CasterInputs, weights: &[Weight]) -> Result<Vec<[u32; 3]>, String> {
        let emission = Emission::new(inputs.light.rows, inputs.light.columns, weights).map_err(|e| e.to_string())?;
        let found = self.0.caster_light(&self.index(inputs)?, receivers(inputs), &emission);
        Ok(found.map_err(|error| error.to_string())?.0)
    }
}

/// Everything about scenes of one kind.
fn property(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).ok_or("no such generator")?;
    let mut rng = Rng::named(1, &format!("casters on a GPU {name}"));
    let subject = GpuCasters(executor);
    let (mut total, mut decisions) = (Compared::default(), Decisions::default());
    for (round, (rows, columns)) in GRIDS.into_iter().cycle().take(budget::of(GRIDS.len())).enumerate() {
        let grid = SampleGrid::regular(rows, columns);
        let grid = if round % 3 == 2 { grid.jittered(&mut rng) } else { grid };
        let scene = generator(&mut rng, grid);
        let inputs = scene.inputs(EXPONENTS[round % EXPONENTS.len()]);
        let weights = weights(&mut rng, (rows * columns) as usize);
        let expected = Expected::of(&scene, &weights);
        decisions = decisions.with(expected.decisions);
        let mut add = |compared: Result<Compared, String>| -> Result<(), Failed> {
            let compared = compared.map_err(|error| format!("{name}, {rows}×{columns}, round {round}: {error}"))?;
            total.bits += compared.bits;
            total.blocked += compared.blocked;
            Ok(())
        };
        match columns {
            1..=16 => add(check_masks::<u16>(&subject, &inputs, &expected))?,
            17..=32 => add(check_masks::<u32>(&subject, &inputs, &expected))?,
            _ => add(check_masks::<PairWord>(&subject, &inputs, &expected))?,
        }
        // Wider than need be.
        if round == 0 {
            add(check_masks::<u64>(&subject, &inputs, &expected))?;
        }
        if let Err(error) = check_sums(&subject, &inputs, &expected, &weights) {
            report(&subject, &format!("{name}, round {round}"), &scene, &weights, &error);
        }
    }
    assert!(total.blocked > 0 && total.blocked < total.bits, "{name}: {total:?} tests nothing");
    say(&format!("casters on a GPU, {name}: {} bits, {} blocked, 0 differ; {decisions:?}", total.bits, total.blocked));
    Ok(())
}

/// One caster moves through receivers: its part is indexed again, and masks are those of a new index.
fn moving(executor: &WgpuExecutor, name: &str) -> Result<(), Failed> {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).ok_or("no such generator")?;
    let mut rng = Rng::named(2, &format!("moving casters on a GPU {name}"));
    let mut scene = generator(&mut rng, SampleGrid::regular(9, 16));
    let mut index = GpuCasters(executor).index(&scene.inputs(0))?;
    let (mut changed, mut before) = (0, Vec::new());
    for frame in 0..4 {
        let place = frame % scene.casters.len();
        scene = scene.with_moved(place, IVec3::new(rng.around(4096), rng.around(4096), rng.around(4096)));
        let inputs = scene.inputs(0);
        executor.index_caster(&mut index, place, &inputs.casters[place].packed())?;
        let (masks, _) = executor.caster_masks::<u16>(&index, receivers(&inputs))?;
        let expected = Expected::of(&scene, &weights(&mut rng, 9 * 16));
        let wanted: Vec<u16> = expected.masks.iter().map(|row| *row as u16).collect();
        if masks != wanted {
            return Err(format!("{name}, frame {frame}: other masks than those of a new index").into());
        }
        changed += usize::from(masks != before);
        before = masks;
    }
    assert!(changed > 1, "{name}: nothing moves");
    Ok(())
}

/// What is refused, and by which name.
fn refusals(executor: &WgpuExecutor, _: &str) -> Result<(), Failed> {
    let vertices = [IVec3::ZERO, IVec3::X * 64, IVec3::Y * 64];
    let plain = PackedCaster {
        vertices: &vertices,
        triangles: &[[0, 1, 2]],
        kind: SurfaceKind::Opaque,
        texture: TextureSize::ONE,
        surface: &[1],
        casting: Default::default(),
        layers: Layers::ALL,
    };
    let light = umbra4_core::LatticeLight {
        origin: IVec3::Z * 4096,
        step_u: IVec3::Y * 64,
        step_v: IVec3::X * 64,
        rows: 4,
        columns: 4,
        jitter: umbra4_core::Jitter::NONE,
    };
    let refused = |caster: PackedCaster<'_>, words: &str| {
        let all = executor.index_casters(&[plain, caster], &light).map(|_| ()).expect_err("it is refused").to_string();
        assert!(all.starts_with("caster 1: ") && all.contains(words), "{all}: no {words}");
        let mut index = executor.index_casters(&[plain], &light).expect("it is fine");
        let one = executor.index_caster(&mut index, 0, &caster).map(|_| ()).expect_err("it is refused").to_string();
        assert!(all == format!("caster 1: {one}"), "{all}, but {one}");
    };
    let size = |width, height| TextureSize { width, height, ..TextureSize::ONE };
    refused(PackedCaster { texture: size(0, 1), ..plain }, "width is 0");
    refused(PackedCaster { surface: &[], ..plain }, "surface.len()");
    refused(PackedCaster { surface: &[0], ..plain }, "surface[0]");
    refused(PackedCaster { texture: size(4, 8), ..plain }, "4×8");
    let pane = PackedCaster { kind: SurfaceKind::Tinted, surface: &[0, 1], ..plain };
    executor.index_casters(&[pane], &light)?;
    refused(PackedCaster { surface: &[1], ..pane }, "surface.len()");
    refused(PackedCaster { casting: Casting { closed: true, offset: 0 }, ..pane }, "casting.closed");
    refused(PackedCaster { casting: Casting { closed: false, offset: 7 }, ..pane }, "casting.offset");
    let mut index = executor.index_casters(&[plain], &light)?;
    assert_eq!(
        executor.index_caster(&mut index, 1, &plain).expect_err("it is refused"),
        GpuError::NoCaster { place: 1, casters: 1 }
    );
    let few = LatticeReceivers { points: &[IVec3::ZERO; 2], facings: &[], layers: &[Layers::ALL] };
    assert_eq!(
        executor.caster_masks::<u16>(&index, few).expect_err("it is refused"),
        GpuError::LayerCount { layers: 1, receivers: 2 }
    );
    // A texture of one texel that is clear cuts all of it out.
    let seen = [IVec3::new(8, 8, -64)];
    for (surface, lit) in [(&[0], 16), (&[1], 0)] {
        let leaf = PackedCaster { kind: SurfaceKind::Cutout, surface, ..plain };
        let leaf = executor.index_casters(&[leaf], &light)?;
        assert_eq!(executor.caster_lit_counts(&leaf, &seen)?.0, [lit]);
    }
    // What was refused has changed nothing.
    assert_eq!(executor.caster_lit_counts(&index, &[IVec3::new(8, 8, -64)])?.0.len(), 1);
    Ok(())
}

pub fn tests() -> Vec<Test> {
    let properties = GENERATORS.map(|(name, _)| (format!("casters_{name}"), property as Check, name));
    let others = [
        ("moving_cards".to_owned(), moving as Check, "cards"),
        ("moving_slabs".to_owned(), moving as Check, "slabs"),
        ("refusals".to_owned(), refusals as Check, "cards"),
    ];
    of_executor(properties.into_iter().chain(others).collect())
}
