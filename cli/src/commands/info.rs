//! `umbra4 info`.

use std::io::{Write, stdout};

use umbra4_core::{IndexKind, Plan, SceneFacts};
use umbra4_cpu::{CpuExecutor, Isa};

use crate::{error::ProgramError, executor};

/// The run that the plan is shown for: what the program renders without arguments.
fn example() -> SceneFacts {
    SceneFacts {
        triangles: 100_000,
        receivers: 512 * 512,
        visibility: true,
        index: IndexKind::Silhouette,
        ..SceneFacts::default()
    }
}

pub(super) fn run() -> Result<(), ProgramError> {
    let mut out = stdout().lock();
    writeln!(out, "umbra4 {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "threads          {}", rayon::current_num_threads())?;
    let available: Vec<String> = Isa::available().iter().map(|isa| format!("{isa:?}")).collect();
    writeln!(out, "instruction sets {} (in use: {:?})", available.join(", "), CpuExecutor::new().isa())?;
    executor::write_adapters(&mut out)?;
    let plan = Plan::new(example());
    writeln!(out, "\nplan for {} triangles and {} receivers:", plan.facts().triangles, plan.facts().receivers)?;
    write!(out, "{plan}")?;
    Ok(())
}
