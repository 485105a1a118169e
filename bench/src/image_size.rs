//! Sizes of images.

use std::{fmt, str::FromStr};

use thiserror::Error;

/// Most pixels along an edge.
const MOST: u32 = 8192;

/// A text that is no size of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("expected WIDTHxHEIGHT in pixels, each in 1..={MOST}")]
pub struct NoImageSize;

/// Pixels of an image along its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageSize {
    /// Pixels of a row.
    pub width: u32,
    /// Pixels of a column.
    pub height: u32,
}

impl ImageSize {
    /// A square image.
    pub fn square(edge: u32) -> Self {
        Self { width: edge, height: edge }
    }
}

impl fmt::Display for ImageSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl FromStr for ImageSize {
    type Err = NoImageSize;

    fn from_str(text: &str) -> Result<Self, NoImageSize> {
        let edge = |text: &str| text.parse().ok().filter(|edge| (1..=MOST).contains(edge)).ok_or(NoImageSize);
        let (width, height) = text.split_once('x').ok_or(NoImageSize)?;
        Ok(Self { width: edge(width)?, height: edge(height)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_written() {
        for text in ["1x1", "1920x1080", "8192x8192"] {
            assert_eq!(text.parse::<ImageSize>().map(|size| size.to_string()).as_deref(), Ok(text));
        }
        for text in ["", "8", "8x", "x8", "0x8", "8x8193", "8x8x8", "-1x8"] {
            assert_eq!(text.parse::<ImageSize>(), Err(NoImageSize), "{text}");
        }
    }
}
