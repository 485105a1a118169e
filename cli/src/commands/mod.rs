//! What the program does, one file a command.

mod info;
mod masks;
mod render;

use rayon::ThreadPoolBuilder;
use umbra4_cpu::CpuExecutor;

use crate::{
    args::{Args, Command, RenderArgs, WorkArgs},
    error::ProgramError,
};

/// Runs what the command line asks for.
///
/// # Errors
/// See [`ProgramError`].
pub fn run(args: &Args) -> Result<(), ProgramError> {
    match &args.command {
        None => render::run(&RenderArgs::without_arguments()),
        Some(Command::Render(args)) => render::run(args),
        Some(Command::Masks(args)) => masks::run(args),
        Some(Command::Info) => info::run(),
    }
}

/// An executor on rayon's global threads, whose number holds for the rest of the program too.
fn executor(work: &WorkArgs) -> Result<CpuExecutor, ProgramError> {
    if let Some(threads) = work.threads {
        let threads = usize::from(threads);
        ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .map_err(|e| ProgramError::Threads { threads, reason: e.to_string() })?;
    }
    Ok(CpuExecutor::new().with_precision(work.precision.into()))
}
