//! Executors: places where stages run.

use crate::plan::Pass;

/// Runs passes over buffers of its own. The pipeline is written once over this trait ([`crate::plan::Plan::run`]); what
/// an executor brings is memory, threads and, where it has them, wider lanes.
///
/// Two executors given the same input hand out the same masks, lit counts and visibility, bit for bit.
pub trait Executor {
    /// What can go wrong while a pass runs.
    type Error;

    /// Runs one pass: its stage, for every id in `0..pass.count`. Passes come in the order of the data flow, and each
    /// sees what those before it wrote.
    ///
    /// # Errors
    /// Whatever the executor's device reports.
    fn dispatch(&mut self, pass: &Pass) -> Result<(), Self::Error>;
}
