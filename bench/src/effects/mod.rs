//! What each effect costs: the stages that it adds to those of a plain rectangle, and the time.

mod args;
mod case;
mod casters;
mod measure;
mod offset_effect;
mod table;
mod table_error;

pub use args::EffectsArgs;
