//! The program: parses, runs, and turns any error into one line and exit code 2.

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};
use umbra4::{args::Args, commands, error::one_line};

const FAILURE: u8 = 2;

fn main() -> ExitCode {
    let args = match Args::command().try_get_matches().and_then(|matches| Args::from_arg_matches(&matches)) {
        Ok(args) => args,
        // --help and --version are no errors.
        Err(e) if !e.use_stderr() => {
            let _ = e.print();
            return ExitCode::SUCCESS;
        }
        Err(e) => return fail(usage(&e)),
    };
    match commands::run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => fail(format!("error: {e}")),
    }
}

fn fail(message: String) -> ExitCode {
    eprintln!("{}", one_line(message));
    ExitCode::from(FAILURE)
}

/// The part of clap's message that says what is wrong; the rest is in --help.
fn usage(error: &clap::Error) -> String {
    let text = error.render().to_string();
    text.split("\n\nUsage:").next().and_then(|t| t.split("\n\nFor more information").next()).unwrap_or(&text).to_owned()
}
