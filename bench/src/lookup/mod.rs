//! The lookup table that Wang et al. 2016 propose in section 4.3 as future work: the mask of an edge's plane is looked up
//! by its line, instead of being made row by row. Measured against the row loop of `core`, on the same pairs.
//!
//! Seed: the table over Hough parameters of Schwarz and Stamminger 2008, section 3.2. Departures: angle and distance are
//! those of the 1-norm (`cells`), and beside the plain table, whose masks are those of other lines than the ones asked for,
//! there is one that bounds them from both sides (`table`), so that what it leaves open can be decided (`repair`), and
//! the bits are exact.

mod args;
mod cells;
mod edges;
mod fill;
mod isa;
mod markdown;
mod measure;
mod pairs;
mod repair;
mod table;
#[cfg(test)]
mod tests;

pub use args::LookupArgs;
pub use measure::seconds_a_pair;
