//! What the program does, one file a command.

mod info;
mod masks;
mod render;
mod report;
mod scene_info;

use crate::{
    args::{Args, Command, RenderArgs},
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
        Some(Command::Report(args)) => report::run(args),
        Some(Command::Info(args)) => match args.scene_args() {
            None => info::run(),
            Some(args) => scene_info::run(&args),
        },
    }
}
