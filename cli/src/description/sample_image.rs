//! Pictures with a pixel for every sample of a light: the upper left one is sample (0, 0), at the light's corner.

use std::{fs::File, io, io::BufReader, path::Path};

use image::{ColorType, DynamicImage, ImageDecoder, ImageError, codecs::png::PngDecoder};

use super::Samples;
use crate::{in_file::InFile, srgb};

/// Why a picture of samples is refused.
#[derive(Debug, thiserror::Error)]
pub enum SampleImageError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// It is no PNG.
    #[error("not a PNG: {0}")]
    NotPng(#[from] ImageError),
    /// It has more, or fewer, pixels than the light has samples.
    #[error("a picture of {found} for a light of {called_for}")]
    Size {
        /// Pixels.
        found: Samples,
        /// Samples.
        called_for: Samples,
    },
    /// Its pixels are something else than gray or red, green and blue.
    #[error("pixels are {0:?}: 8 or 16 bits of gray, or of red, green and blue, are called for")]
    Pixels(ColorType),
}

/// What every sample emits: 8 bits are sRGB, 16 bits are linear; white is 1.
pub(super) fn radiance(path: &Path, samples: Samples) -> Result<Vec<[f32; 3]>, InFile<SampleImageError>> {
    let image = read(path, samples).map_err(InFile::at(path))?;
    let decoded: fn(f32) -> f32 =
        if matches!(image.color(), ColorType::L8 | ColorType::Rgb8) { srgb::linear } else { |value| value };
    Ok(image.into_rgb32f().pixels().map(|pixel| pixel.0.map(decoded)).collect())
}

/// Which samples emit: those whose pixel is nearer to white than to black.
pub(super) fn stencil(path: &Path, samples: Samples) -> Result<Vec<bool>, InFile<SampleImageError>> {
    let image = read(path, samples).map_err(InFile::at(path))?;
    Ok(image.into_luma8().pixels().map(|pixel| pixel.0 >= [128]).collect())
}

fn read(path: &Path, called_for: Samples) -> Result<DynamicImage, SampleImageError> {
    let decoder = PngDecoder::new(BufReader::new(File::open(path)?))?;
    let (columns, rows) = decoder.dimensions();
    let found = Samples { rows, columns };
    // Before anything is decoded: a picture may claim any size.
    if found != called_for {
        return Err(SampleImageError::Size { found, called_for });
    }
    match decoder.color_type() {
        ColorType::L8 | ColorType::L16 | ColorType::Rgb8 | ColorType::Rgb16 => Ok(DynamicImage::from_decoder(decoder)?),
        other => Err(SampleImageError::Pixels(other)),
    }
}

#[cfg(test)]
mod tests {
    use image::{ImageBuffer, Luma, Rgb};

    use super::*;

    const TWO: Samples = Samples { rows: 1, columns: 2 };

    fn saved(image: impl Into<DynamicImage>) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("samples.png");
        image.into().save(&path).unwrap();
        (folder, path)
    }

    #[test]
    fn eight_bits_are_decoded_and_sixteen_are_linear() {
        let (_folder, path) = saved(ImageBuffer::from_fn(2, 1, |x, _| Rgb([188_u8, 0, 255 * x as u8])));
        let eight = radiance(&path, TWO).unwrap();
        assert!((eight[0][0] - 0.5029).abs() < 1e-3 && eight[0][1] == 0.0 && eight[1][2] == 1.0, "{eight:?}");
        let (_folder, path) = saved(ImageBuffer::from_fn(2, 1, |x, _| Rgb([32768_u16, 0, 65535 * x as u16])));
        let sixteen = radiance(&path, TWO).unwrap();
        assert!((sixteen[0][0] - 0.5).abs() < 1e-4 && sixteen[1][2] == 1.0, "{sixteen:?}");
    }

    #[test]
    fn white_emits() {
        let (_folder, path) = saved(ImageBuffer::from_fn(2, 1, |x, _| Luma([127 + x as u8])));
        assert_eq!(stencil(&path, TWO).unwrap(), [false, true]);
    }

    #[test]
    fn other_sizes_and_pixels_are_refused() {
        let (_folder, path) = saved(ImageBuffer::from_pixel(3, 1, Luma([255_u8])));
        let message = stencil(&path, TWO).unwrap_err().to_string();
        assert!(message.contains("1 rows × 3 columns for a light of 1 rows × 2 columns"), "{message}");
        let (_folder, path) = saved(ImageBuffer::from_pixel(2, 1, image::Rgba([255_u8; 4])));
        let message = radiance(&path, TWO).unwrap_err().to_string();
        assert!(message.contains("pixels are Rgba8"), "{message}");
        assert!(radiance(Path::new("nowhere.png"), TWO).unwrap_err().to_string().contains("cannot be read"));
    }
}
