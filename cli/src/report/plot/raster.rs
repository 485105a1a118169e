//! SVG to PNG. The letters come with the program: no system needs to have any.

use std::sync::Arc;

use resvg::{
    tiny_skia::{Pixmap, Transform},
    usvg::{Options, Tree, fontdb::Database},
};

/// Why a drawing cannot be turned into pixels.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// The drawing is not SVG.
    #[error("the plot cannot be drawn: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// The drawing has no size, or one that no memory holds.
    #[error("the plot cannot be drawn: {width}×{height} pixels")]
    Size {
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The pixels cannot be encoded.
    #[error("the plot cannot be encoded: {0}")]
    Png(String),
}

/// What is said of the plot's files.
pub const NOTE: &str = "plot.svg, plot.png";

/// The drawing as a PNG, `scale` pixels a unit.
///
/// # Errors
/// See [`RasterError`].
pub fn png(svg: &str, scale: f32) -> Result<Option<Vec<u8>>, RasterError> {
    let mut fonts = Database::new();
    fonts.load_font_data(notosans::REGULAR_TTF.to_vec());
    fonts.set_sans_serif_family("Noto Sans");
    let tree = Tree::from_str(svg, &Options { fontdb: Arc::new(fonts), ..Options::default() })?;
    let size = tree.size();
    let [width, height] = [size.width(), size.height()].map(|length| (length * scale).ceil() as u32);
    let mut pixels = Pixmap::new(width, height).ok_or(RasterError::Size { width, height })?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map(Some).map_err(|e| RasterError::Png(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_drawn_without_a_system_font() {
        let text = |text: &str| {
            let svg = format!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 20"><text y="15" font-family="Noto Sans">{text}</text></svg>"#
            );
            image::load_from_memory(&png(&svg, 2.0).unwrap().unwrap()).unwrap().into_rgba8()
        };
        let inked = |letters: &str| text(letters).pixels().filter(|p| p.0[3] > 128).count();
        assert!(inked("") == 0 && inked("8×8²÷") > 100);
        assert_eq!(text("").dimensions(), (120, 40));
    }

    #[test]
    fn what_is_no_drawing_is_refused() {
        assert!(matches!(png("<svg", 1.0), Err(RasterError::Svg(_))));
    }
}
