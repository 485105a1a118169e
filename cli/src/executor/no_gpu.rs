//! What is said of GPUs where the program is built without them. The same names as in `gpu.rs`.

use std::io::{self, Write};

use crate::{
    args::{MachineArgs, PrecisionArg},
    error::ProgramError,
    executor::AnyExecutor,
};

/// What brings GPUs.
const COMMAND: &str = "cargo run --release --features gpu --";

/// A GPU is asked for, and the program is built without them.
#[derive(Debug, thiserror::Error)]
#[error("{option} needs GPUs, which this program is built without: the feature `gpu` brings them, {COMMAND} ARGUMENTS")]
pub struct GpuError {
    option: &'static str,
}

pub(super) fn open(_: &MachineArgs, _: PrecisionArg) -> Result<AnyExecutor, GpuError> {
    Err(GpuError { option: "--executor gpu" })
}

/// Whether the options about GPUs can be followed.
///
/// # Errors
/// One is given.
pub(super) fn check(machine: &MachineArgs) -> Result<(), GpuError> {
    if machine.adapter.is_some() { Err(GpuError { option: "--adapter" }) } else { Ok(()) }
}

/// Writes that there are none, and how they come.
///
/// # Errors
/// `out` is closed.
pub fn write_adapters(out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "GPUs             left out: the feature `gpu` brings them, {COMMAND} info")
}

/// No GPU for a report.
pub struct Device(());

impl Device {
    /// None.
    ///
    /// # Errors
    /// One is named.
    pub fn open(machine: &MachineArgs) -> Result<Self, ProgramError> {
        check(machine)?;
        Ok(Self(()))
    }

    /// Why there is none.
    pub fn name(&self) -> Result<&str, &str> {
        Err("this program is built without GPUs; the feature `gpu` brings them")
    }

    /// None.
    pub fn executor(&self, _: PrecisionArg) -> Option<AnyExecutor> {
        None
    }
}
