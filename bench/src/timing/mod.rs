//! Interleaved timing: many subjects, one machine that others use too, and the least time of each.

mod case;
mod least;
mod progress;

pub use case::{Case, Posed};
pub use least::{Budget, Least, Subject, least};
pub use progress::Progress;
