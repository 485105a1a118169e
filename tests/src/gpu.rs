//! The executor on a GPU, as a [`Subject`].

use std::sync::Arc;

use libtest_mimic::{Arguments, Failed, Trial};
use umbra4_cpu::CpuWord;
use umbra4_wgpu::{Choice, Gpu, GpuError, LatticeScene, Loading, WgpuExecutor};

use crate::{scene::Inputs, suite::Subject};

/// The executor on a GPU.
#[derive(Debug)]
pub struct Wgpu(WgpuExecutor);

/// The adapter that tests run on, or why there is none; `None` where none has to be there. `UMBRA4_GPU` says which must be:
/// `hardware`, `software`, or a part of its name; without it, the best there is.
///
/// # Errors
/// There is no such adapter.
pub fn required() -> Result<Option<Gpu>, GpuError> {
    let choice = match std::env::var("UMBRA4_GPU").as_deref() {
        Ok("hardware") => Choice::Hardware,
        Ok("software") => Choice::Software,
        Ok(name) => Choice::Named(name.to_owned()),
        Err(_) => {
            return Ok(Gpu::open(&Choice::Hardware).or_else(|_| Gpu::open(&Choice::Software)).ok());
        }
    };
    Gpu::open(&choice).map(Some)
}

/// The adapter that a test binary runs on, said on stdout; and whether its tests are to be skipped, since there is none and
/// none has to be there. Where one has to be, every test fails with the reason.
pub fn announced() -> (Result<Gpu, String>, bool) {
    match required() {
        Ok(Some(gpu)) => {
            println!("tested on: {}", gpu.name);
            (Ok(gpu), false)
        }
        Ok(None) => {
            println!("SKIPPED: there is no adapter that can be used, and UMBRA4_GPU asks for none");
            (Err("there is no adapter".to_owned()), true)
        }
        Err(error) => {
            println!("{error}");
            (Err(error.to_string()), false)
        }
    }
}

/// What is checked of an executor, on scenes of the generator that is named.
pub type Check = fn(&WgpuExecutor, &str) -> Result<(), Failed>;

/// Receivers of a block: fewer than most scenes have, so that blocks are tested as well.
const BLOCK: u32 = 96;

/// Runs checks as the tests of a binary, by their names, each with its generator, on one executor that counts pairs and takes
/// the time of stages.
pub fn run(checks: Vec<(String, Check, &'static str)>) -> ! {
    let arguments = Arguments::from_args();
    let (gpu, missing) = announced();
    let executor = |gpu| WgpuExecutor::new(gpu).with_block(BLOCK).with_counts(true).with_stage_times(true);
    let executor = Arc::new(gpu.map(executor));
    let trials = checks.into_iter().map(|(name, check, generator)| {
        let executor = executor.clone();
        let trial = Trial::test(name, move || check(executor.as_ref().as_ref().map_err(Failed::from)?, generator));
        trial.with_ignored_flag(missing)
    });
    libtest_mimic::run(&arguments, trials.collect()).exit()
}

impl Wgpu {
    /// In blocks of at most `block` receivers, with kernels loaded in a given way.
    ///
    /// # Errors
    /// The device cannot load them so.
    pub fn new(gpu: Gpu, block: u32, loading: Loading) -> Result<Self, GpuError> {
        Ok(Self(WgpuExecutor::new(gpu).with_block(block).with_loading(loading)?))
    }
}

/// The scene as the executor takes it.
pub fn scene(inputs: &Inputs) -> LatticeScene<'_> {
    LatticeScene { vertices: inputs.occluders.vertices(), triangles: inputs.occluders.triangles() }
}

impl Subject for Wgpu {
    fn name(&self) -> String {
        format!("wgpu, {}", self.0.gpu().name)
    }

    fn masks<W: CpuWord>(&self, inputs: &Inputs) -> Result<Vec<W>, String> {
        let done = self.0.masks::<W>(&scene(inputs), &inputs.light, inputs.receivers.points());
        Ok(done.map_err(|error| error.to_string())?.0)
    }

    fn visibility(&self, inputs: &Inputs) -> Result<Vec<f32>, String> {
        let done = self.0.visibility(&scene(inputs), &inputs.light, inputs.receivers.points());
        Ok(done.map_err(|error| error.to_string())?.0)
    }
}
