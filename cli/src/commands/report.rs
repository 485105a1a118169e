//! `umbra4 report`: what accuracy costs.

use std::io::{Write, stdout};

use crate::{args::ReportArgs, error::ProgramError, report};

pub(super) fn run(args: &ReportArgs) -> Result<(), ProgramError> {
    let table = report::run(args)?;
    let mut out = stdout().lock();
    writeln!(out, "{table}")?;
    writeln!(out, "wrote {}, {}", args.output.join("index.html").display(), report::PLOT_NOTE)?;
    Ok(())
}
