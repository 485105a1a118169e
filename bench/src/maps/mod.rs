//! What shadow maps give and take, against exact masks of the same light: the claims of Schwarz and Stamminger 2008 and of Liktor
//! et al. 2015, measured again.

mod args;
mod measure;
mod table;
mod ways;

pub use args::MapsArgs;
