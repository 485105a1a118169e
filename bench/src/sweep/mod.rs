//! Everybody on several numbers of samples in one run: how far ahead umbra4 is, what more samples cost, and what a second
//! thread saves.

mod args;
mod measure;
mod table;

pub use args::SweepArgs;
