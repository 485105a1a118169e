//! All tests that need a device, in one binary, on one device: each binary that is linked takes its time, and so does each
//! device that compiles kernels. `UMBRA4_GPU` says which adapter must be there, see [`umbra4_tests::gpu::required`].

mod casters;
mod clouds;
mod conformance;
mod engine;
mod lights;
mod microquads;
#[path = "../../../exec-wgpu/examples/engine/renderer.rs"]
mod renderer;
#[path = "../../../exec-wgpu/examples/engine/scene.rs"]
mod scene;
mod stages;
mod stochastic;

use libtest_mimic::Arguments;
use umbra4_tests::gpu::{Missing, shared, trials};

fn main() {
    let arguments = Arguments::from_args();
    if !arguments.list {
        match shared() {
            Ok(gpu) => println!("tested on: {}", gpu.name),
            Err(Missing::Any(reason)) => println!("SKIPPED: {reason}; and UMBRA4_GPU asks for none"),
            Err(Missing::Demanded(reason)) => println!("{reason}"),
        }
    }
    let modules = [
        ("casters", casters::tests()),
        ("clouds", clouds::tests()),
        ("conformance", conformance::tests()),
        ("engine", engine::tests()),
        ("lights", lights::tests()),
        ("microquads", microquads::tests()),
        ("stages", stages::tests()),
        ("stochastic", stochastic::tests()),
    ];
    // In turn: those of a module wait for one another where they share an executor, and while a driver compiles its kernels.
    let mut trials: Vec<_> =
        modules.into_iter().flat_map(|(module, tests)| trials(module, tests).into_iter().enumerate()).collect();
    trials.sort_by_key(|(place, _)| *place);
    let trials = trials.into_iter().map(|(_, trial)| trial).chain([engine::of_gl()]);
    libtest_mimic::run(&arguments, trials.collect()).exit();
}
