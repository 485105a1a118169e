//! No PNG: the program is built without what draws one. The same names as in `raster.rs`.

/// Nothing can go wrong.
pub use std::convert::Infallible as RasterError;

/// What is said of the plot's files.
pub const NOTE: &str =
    "plot.svg (the feature `plot-png` draws plot.png too: cargo run --release --features plot-png -- report ARGUMENTS)";

/// None.
///
/// # Errors
/// None.
pub fn png(_: &str, _: f32) -> Result<Option<Vec<u8>>, RasterError> {
    Ok(None)
}
