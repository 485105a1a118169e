//! Pictures in linear light (or plain numbers), and their way into files.

use std::path::Path;

use image::{DynamicImage, ImageFormat, Rgb32FImage, RgbImage};
use umbra4_core::glam::Vec3;

use crate::{
    in_file::InFile,
    output::{OutputError, write_whole},
    srgb,
};

/// What the numbers of a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Light: compressed by a film curve and encoded as sRGB for a PNG.
    Light,
    /// Data in 0..=1: a PNG holds them as they are, times 255.
    Data,
}

/// A picture, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` pixels; linear.
    pub pixels: Vec<Vec3>,
    /// What they are.
    pub meaning: Meaning,
}

/// A format for pictures, told by the name of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Eight bits a channel, for the eye.
    Png,
    /// f32, untouched, for further work.
    Exr,
}

impl PictureFormat {
    /// Looks at the extension.
    ///
    /// # Errors
    /// An extension that is neither .png nor .exr.
    pub fn of(path: &Path) -> Result<Self, InFile<OutputError>> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_lowercase).as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(InFile::at(path)(OutputError::UnknownExtension)),
        }
    }
}

impl Picture {
    /// Writes the picture whole, or nothing.
    ///
    /// # Errors
    /// See [`OutputError`].
    pub fn write(&self, path: &Path, format: PictureFormat) -> Result<(), InFile<OutputError>> {
        let (image, format) = match format {
            PictureFormat::Png => (self.encoded().into(), ImageFormat::Png),
            PictureFormat::Exr => (self.linear(), ImageFormat::OpenExr),
        };
        write_whole(path, |writer| Ok(image.write_to(writer, format)?))
    }

    /// The picture at `1/factor` of its size: every pixel the mean of `factor` × `factor`.
    #[must_use]
    pub fn reduced(&self, factor: u32) -> Self {
        let factor = factor.max(1);
        let (width, height) = (self.width / factor, self.height / factor);
        let mean = |i: u32| {
            let (x, y) = (i % width * factor, i / width * factor);
            let at = |k: u32| (y + k / factor) as usize * self.width as usize + (x + k % factor) as usize;
            (0..factor * factor).map(|k| self.pixels[at(k)]).sum::<Vec3>() / (factor * factor) as f32
        };
        Self { width, height, pixels: (0..width * height).map(mean).collect(), meaning: self.meaning }
    }

    fn linear(&self) -> DynamicImage {
        let mut image = Rgb32FImage::new(self.width, self.height);
        for (out, pixel) in image.pixels_mut().zip(&self.pixels) {
            out.0 = pixel.to_array();
        }
        image.into()
    }

    /// The picture as a PNG holds it: eight bits a channel.
    pub fn encoded(&self) -> RgbImage {
        let mut image = RgbImage::new(self.width, self.height);
        for (out, pixel) in image.pixels_mut().zip(&self.pixels) {
            let encoded = match self.meaning {
                Meaning::Light => film(*pixel).to_array().map(srgb::encoded),
                Meaning::Data => pixel.to_array(),
            };
            out.0 = encoded.map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8);
        }
        image
    }
}

/// A film curve: linear in the shadows, a soft shoulder towards white (Narkowicz's fit of the ACES curve).
fn film(light: Vec3) -> Vec3 {
    let x = light.max(Vec3::ZERO) * 0.72;
    (x * (x * 2.51 + 0.03)) / (x * (x * 2.43 + 0.59) + 0.14)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_are_written_as_they_are() {
        let pixels = vec![Vec3::ZERO, Vec3::splat(0.5), Vec3::ONE, Vec3::new(1.0, 0.0, 0.2)];
        let picture = Picture { width: 2, height: 2, pixels, meaning: Meaning::Data };
        assert_eq!(picture.encoded().into_raw(), [0, 0, 0, 128, 128, 128, 255, 255, 255, 255, 0, 51]);
    }

    #[test]
    fn reduction_takes_means() {
        let pixels = (0..8).map(|i| Vec3::splat(i as f32)).collect();
        let picture = Picture { width: 4, height: 2, pixels, meaning: Meaning::Data };
        assert_eq!(picture.reduced(2).pixels, [Vec3::splat(2.5), Vec3::splat(4.5)]);
        assert_eq!(picture.reduced(1), picture);
    }

    #[test]
    fn the_film_curve_rises_and_stays_below_white() {
        let curve: Vec<f32> = (0..100).map(|i| film(Vec3::splat(i as f32 * 0.1)).x).collect();
        assert!(curve.windows(2).all(|pair| pair[0] <= pair[1]) && curve[0] == 0.0 && curve[99] < 1.05);
    }

    #[test]
    fn unknown_extensions_are_refused() {
        assert!(PictureFormat::of(Path::new("a.PNG")).is_ok());
        assert!(PictureFormat::of(Path::new("a.jpg")).is_err());
        assert!(PictureFormat::of(Path::new("a")).is_err());
    }
}
