//! Peak memory: what a visibility needs beyond the scene that the caller has anyway.
//!
//! A process of its own, started for each case, is handed the scene ready made, notes its peak, computes, and notes it
//! again: nothing that was needed to make the scene hides in the difference.

mod args;
mod child;
mod exchange;
mod resident;

pub use args::{CHILD, MemoryArgs};
pub use child::ChildArgs;
