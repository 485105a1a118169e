//! Casters: meshes with what else is known of them (cut out by a texture, tinted, closed, offset, on some layers), each with an
//! index of its own, so that one can move while the others stay.

mod ask;
mod caster;
mod index;
mod run;

pub use caster::{Caster, CasterError};
pub use index::CasterIndex;
