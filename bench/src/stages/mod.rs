//! Where umbra4's time goes, stage by stage, and how far it is from its floor: the pairs that matter, and nothing but the rows
//! that they fill.

mod args;
mod measure;
mod table;

pub use args::StagesArgs;
