//! What umbra4 costs against what it costs it: curves over triangles, receivers, the light's size and its samples.
//!
//! Every curve is measured in one interleaved run, and its points are ratios to one of them: the machine's own speed does
//! not matter. The second line of each plot is the fastest ray tracer of those asked for, at every point anew.

mod args;
mod fit;
mod measure;
mod plan;
mod plot;
mod table;

pub use args::CurvesArgs;
