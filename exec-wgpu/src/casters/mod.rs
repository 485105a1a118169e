//! Casters on the GPU: each with an index of its own on the device, so that one can move while the others stay.

mod ask;
mod index;
mod run;

pub use index::CasterIndex;
