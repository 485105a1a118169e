//! The executor on a GPU, as a [`Subject`]; and the adapter that tests run on.

use std::sync::{LazyLock, OnceLock};

use libtest_mimic::{Completion, Failed, Trial};
use thiserror::Error;
use umbra4_cpu::CpuWord;
use umbra4_wgpu::{Choice, Gpu, GpuError, LatticeScene, Loading, WgpuExecutor};

use crate::{scene::Inputs, suite::Subject};

/// The executor on a GPU.
#[derive(Debug)]
pub struct Wgpu(WgpuExecutor);

/// Why there is nothing to test on.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Missing {
    /// The adapter that `UMBRA4_GPU` asks for cannot be opened: tests fail.
    #[error("{0}")]
    Demanded(String),
    /// `UMBRA4_GPU` asks for none, and none can be opened: tests are ignored.
    #[error("{0}")]
    Any(String),
}

/// Opens the adapter that tests run on. `UMBRA4_GPU` says which one must be there: `hardware`, `software`, or a part of its
/// name; without it, the best there is.
///
/// # Errors
/// There is no such adapter, or none at all.
pub fn required() -> Result<Gpu, Missing> {
    let choice = match std::env::var("UMBRA4_GPU").as_deref() {
        Ok("hardware") => Choice::Hardware,
        Ok("software") => Choice::Software,
        Ok(name) => Choice::Named(name.to_owned()),
        Err(_) => {
            return Gpu::open(&Choice::Hardware).or_else(|no_hardware| {
                Gpu::open(&Choice::Software)
                    .map_err(|no_software| Missing::Any(format!("{no_hardware}; {no_software}")))
            });
        }
    };
    Gpu::open(&choice).map_err(|error| Missing::Demanded(error.to_string()))
}

/// The adapter that tests of a process share.
pub fn shared() -> &'static Result<Gpu, Missing> {
    static SHARED: LazyLock<Result<Gpu, Missing>> = LazyLock::new(required);
    &SHARED
}

/// A test of what a device does, by its name. It may find that the device cannot do what is tested.
pub type Test = (String, Box<dyn FnOnce(&Gpu) -> Result<Completion, Failed> + Send>);

/// A test that any device can be put to.
pub fn test(name: impl Into<String>, check: impl FnOnce(&Gpu) -> Result<(), Failed> + Send + 'static) -> Test {
    (name.into(), Box::new(move |gpu| check(gpu).map(|()| Completion::Completed)))
}

/// Tests of a module as those of a binary: where there is no adapter they are ignored, with what is missing as the reason,
/// and where one has to be they fail with it.
pub fn trials(module: &str, tests: Vec<Test>) -> Vec<Trial> {
    let trial = |(name, check): Test| {
        Trial::ignorable_test(format!("{module}::{name}"), move || match shared() {
            Ok(gpu) => check(gpu),
            Err(Missing::Any(reason)) => Ok(Completion::ignored_with(reason)),
            Err(Missing::Demanded(reason)) => Err(Failed::from(reason)),
        })
    };
    tests.into_iter().map(trial).collect()
}

/// What is checked of an executor, on scenes of the generator that is named.
pub type Check = fn(&WgpuExecutor, &str) -> Result<(), Failed>;

/// Receivers of a block: fewer than most scenes have, so that blocks are tested as well.
const BLOCK: u32 = 96;

/// Checks by their names, each with its generator, on the one executor of the process that counts pairs and takes the time
/// of stages.
pub fn of_executor(checks: Vec<(String, Check, &'static str)>) -> Vec<Test> {
    static EXECUTOR: OnceLock<WgpuExecutor> = OnceLock::new();
    let of_gpu = |gpu: &Gpu| {
        EXECUTOR
            .get_or_init(|| WgpuExecutor::new(gpu.clone()).with_block(BLOCK).with_counts(true).with_stage_times(true))
    };
    checks.into_iter().map(|(name, check, generator)| test(name, move |gpu| check(of_gpu(gpu), generator))).collect()
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
