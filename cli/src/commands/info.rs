//! `umbra4 info`.

use std::io::{Write, stdout};

use umbra4_core::{IndexKind, Plan, SceneFacts};
use umbra4_cpu::{CpuExecutor, Isa};

use crate::error::ProgramError;

/// Receivers worked on at once.
pub(super) const BLOCK: u32 = 1 << 18;

/// The run that the plan is shown for: what the program renders without arguments.
const EXAMPLE: SceneFacts = SceneFacts {
    jittered: false,
    arranged: false,
    reached: true,
    punctual: false,
    new_vertices: 0,
    triangles: 100_000,
    receivers: 512 * 512,
    world_receivers: false,
    visibility: true,
    block: BLOCK,
    index: IndexKind::Silhouette,
};

pub(super) fn run() -> Result<(), ProgramError> {
    let mut out = stdout().lock();
    writeln!(out, "umbra4 {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "threads          {}", rayon::current_num_threads())?;
    let available: Vec<String> = Isa::available().iter().map(|isa| format!("{isa:?}")).collect();
    writeln!(out, "instruction sets {} (in use: {:?})", available.join(", "), CpuExecutor::new().isa())?;
    let adapters = umbra4_wgpu::adapters();
    if adapters.is_empty() {
        writeln!(out, "GPUs             none")?;
    }
    for adapter in adapters {
        let kind = if adapter.hardware { "" } else { ", in software" };
        let lacks = if adapter.lacks.is_empty() { "usable".to_owned() } else { adapter.lacks.join("; ") };
        writeln!(out, "GPU              {} ({}, {}{kind}): {lacks}", adapter.name, adapter.backend, adapter.driver)?;
    }
    writeln!(out, "\nplan for {} triangles and {} receivers:", EXAMPLE.triangles, EXAMPLE.receivers)?;
    write!(out, "{}", Plan::new(EXAMPLE))?;
    Ok(())
}
