//! What any executor has to pass, of casters: masks, counts, visibility and light, against their oracle, bit by bit.

use umbra4_core::{
    PairWord,
    emission::{Emission, Weight},
};
use umbra4_cpu::{CpuExecutor, CpuWord, Isa};

use crate::{
    caster_inputs::CasterInputs,
    caster_oracle::{self, Decisions},
    caster_scenes::CasterScene,
    compare::{Amount, Compared, compare_light, compare_masks, compare_visibility, lit_counts},
};

/// Something that computes what casters leave of a light.
pub trait CasterSubject {
    /// What it is called in reports.
    fn name(&self) -> String;
    /// The masks of all receivers, receiver-major, a word per row of the light.
    ///
    /// # Errors
    /// Why it refuses, in words.
    fn masks<W: CpuWord>(&self, inputs: &CasterInputs) -> Result<Vec<W>, String>;
    /// The fraction of lit samples of every receiver.
    ///
    /// # Errors
    /// Why it refuses, in words.
    fn visibility(&self, inputs: &CasterInputs) -> Result<Vec<f32>, String>;
    /// The number of lit samples of every receiver.
    ///
    /// # Errors
    /// Why it refuses, in words.
    fn lit_counts(&self, inputs: &CasterInputs) -> Result<Vec<u32>, String>;
    /// The light of every receiver, of samples with given weights, row by row.
    ///
    /// # Errors
    /// Why it refuses, in words.
    fn light(&self, inputs: &CasterInputs, weights: &[Weight]) -> Result<Vec<[u32; 3]>, String>;
}

/// The executor on CPU threads.
#[derive(Debug)]
pub struct CpuCasters(pub CpuExecutor);

impl CpuCasters {
    /// On `threads` threads, with the given instruction set.
    pub fn new(threads: usize, isa: Isa) -> Self {
        let executor = CpuExecutor::new().with_isa(isa).with_threads(threads).expect("threads can be started");
        assert_eq!(executor.isa(), isa, "the processor has the instruction set that is tested");
        Self(executor)
    }
}

impl CasterSubject for CpuCasters {
    fn name(&self) -> String {
        format!("cpu, {}", self.0.isa())
    }

    fn masks<W: CpuWord>(&self, inputs: &CasterInputs) -> Result<Vec<W>, String> {
        let index = self.0.index_casters(&inputs.casters, &inputs.light);
        let found = self.0.caster_masks::<W>(&index, &inputs.receivers).map_err(|error| error.to_string())?;
        Ok(found.0.into_words())
    }

    fn visibility(&self, inputs: &CasterInputs) -> Result<Vec<f32>, String> {
        let index = self.0.index_casters(&inputs.casters, &inputs.light);
        Ok(self.0.caster_visibility(&index, &inputs.receivers).map_err(|error| error.to_string())?.0)
    }

    fn lit_counts(&self, inputs: &CasterInputs) -> Result<Vec<u32>, String> {
        let index = self.0.index_casters(&inputs.casters, &inputs.light);
        Ok(self.0.caster_lit_counts(&index, &inputs.receivers).map_err(|error| error.to_string())?.0)
    }

    fn light(&self, inputs: &CasterInputs, weights: &[Weight]) -> Result<Vec<[u32; 3]>, String> {
        let index = self.0.index_casters(&inputs.casters, &inputs.light);
        let emission = Emission::new(inputs.light.rows, inputs.light.columns, weights).map_err(|e| e.to_string())?;
        Ok(self.0.caster_light(&index, &inputs.receivers, &emission).map_err(|error| error.to_string())?.0)
    }
}

/// What has to come out of a scene.
#[derive(Clone, Debug)]
pub struct Expected {
    /// Receiver-major, a word per row.
    pub masks: Vec<u64>,
    /// Of every receiver.
    pub light: Vec<[u32; 3]>,
    /// What decided it.
    pub decisions: Decisions,
}

impl Expected {
    /// By the oracle.
    pub fn of(scene: &CasterScene, weights: &[Weight]) -> Self {
        let (seen, decisions) = caster_oracle::seen(&scene.light, &scene.receivers, &scene.casters);
        let light = seen.iter().map(|seen| caster_oracle::light_of(&scene.light, seen, weights)).collect();
        Self { masks: caster_oracle::masks(&seen), light, decisions }
    }

    fn amount(&self) -> Amount {
        if self.light.is_empty() { Amount::None } else { Amount::Some }
    }
}

/// Compares a subject's masks with the oracle's.
///
/// # Errors
/// The first difference, in words.
pub fn check_masks<W: CpuWord>(
    subject: &impl CasterSubject,
    inputs: &CasterInputs,
    expected: &Expected,
) -> Result<Compared, String> {
    let masks = subject.masks::<W>(inputs)?;
    let compared = compare_masks(&expected.masks, &masks, inputs.light.rows, inputs.light.columns, expected.amount());
    compared.map_err(|mismatch| format!("words of {} bits: {mismatch}", W::BITS))
}

/// Compares masks in words of all widths that hold the light's columns.
///
/// # Errors
/// The first difference, in words.
pub fn check_all_widths(
    subject: &impl CasterSubject,
    inputs: &CasterInputs,
    expected: &Expected,
) -> Result<Compared, String> {
    fn add<W: CpuWord>(
        subject: &impl CasterSubject,
        inputs: &CasterInputs,
        expected: &Expected,
        total: &mut Compared,
    ) -> Result<(), String> {
        if inputs.light.columns <= W::BITS {
            let compared = check_masks::<W>(subject, inputs, expected)?;
            total.bits += compared.bits;
            total.blocked += compared.blocked;
        }
        Ok(())
    }
    let mut total = Compared::default();
    add::<u16>(subject, inputs, expected, &mut total)?;
    add::<u32>(subject, inputs, expected, &mut total)?;
    add::<u64>(subject, inputs, expected, &mut total)?;
    add::<PairWord>(subject, inputs, expected, &mut total)?;
    Ok(total)
}

/// Compares all that a subject makes of a scene, on a lattice of step `2^-exponent`.
///
/// # Errors
/// The first difference, in words.
pub fn check(
    subject: &impl CasterSubject,
    scene: &CasterScene,
    exponent: i32,
    expected: &Expected,
    weights: &[Weight],
) -> Result<Compared, String> {
    let inputs = scene.inputs(exponent);
    let compared = check_all_widths(subject, &inputs, expected)?;
    check_sums(subject, &inputs, expected, weights)?;
    Ok(compared)
}

/// Names the failure and the smallest scene that shows it.
///
/// # Panics
/// Always.
pub fn report(subject: &impl CasterSubject, what: &str, scene: &CasterScene, weights: &[Weight], error: &str) -> ! {
    let check = |scene: &CasterScene| check(subject, scene, 0, &Expected::of(scene, weights), weights);
    let scene = minimise(scene, |scene| check(scene).is_err());
    panic!("{}, {what}: {error}\nsmallest scene that fails: {:?}\n{scene:?}", subject.name(), check(&scene).err());
}

/// Compares what a subject makes of masks and depths with what the oracle does.
///
/// # Errors
/// The first difference, in words.
pub fn check_sums(
    subject: &impl CasterSubject,
    inputs: &CasterInputs,
    expected: &Expected,
    weights: &[Weight],
) -> Result<(), String> {
    let (rows, columns, amount) = (inputs.light.rows, inputs.light.columns, expected.amount());
    let lit = lit_counts(&expected.masks, rows, columns);
    let counted = subject.lit_counts(inputs)?;
    if counted != lit {
        return Err(format!("lit samples: {counted:?}, expected {lit:?}"));
    }
    let visibility = subject.visibility(inputs)?;
    compare_visibility(&lit, &visibility, rows * columns, amount).map_err(|mismatch| mismatch.to_string())?;
    compare_light(&expected.light, &subject.light(inputs, weights)?, amount).map_err(|mismatch| mismatch.to_string())
}

/// The smallest part of a failing scene that still fails: one receiver, if one suffices, and few casters of few triangles.
#[must_use]
pub fn minimise(scene: &CasterScene, fails: impl Fn(&CasterScene) -> bool) -> CasterScene {
    let mut scene = scene.clone();
    let alone = scene.receivers.iter().map(|&receiver| CasterScene { receivers: vec![receiver], ..scene.clone() });
    let alone = alone.into_iter().find(|smaller| fails(smaller));
    scene = alone.unwrap_or(scene);
    for caster in (0..scene.casters.len()).rev() {
        let mut smaller = scene.clone();
        smaller.casters.remove(caster);
        if fails(&smaller) {
            scene = smaller;
        }
    }
    for caster in 0..scene.casters.len() {
        // A mesh that has to be closed stays whole.
        let mut chunk = if scene.casters[caster].closed { 0 } else { scene.casters[caster].triangles.len() };
        while chunk > 0 {
            let mut from = 0;
            while from < scene.casters[caster].triangles.len() {
                let mut smaller = scene.clone();
                let to = (from + chunk).min(smaller.casters[caster].triangles.len());
                smaller.casters[caster].remove(from..to);
                if fails(&smaller) {
                    scene = smaller;
                } else {
                    from += chunk;
                }
            }
            chunk /= 2;
        }
    }
    scene
}
