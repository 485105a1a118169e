//! Formats of visibility, and the table of lit counts in each.

use half::f16;
use umbra4_core::{kernel::pack_light::CHANNELS, stage::reduce::visibility};
use wgpu::TextureFormat;

/// Format of a pixel of visibility, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VisibilityFormat {
    /// 8 bits, rounded to the nearest of 255 parts.
    Unorm8,
    /// IEEE half precision, rounded to the nearest.
    Float16,
    /// IEEE single precision.
    Float32,
}

/// Format of a pixel of light: red, green, blue and alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LightFormat {
    /// IEEE half precision.
    Float16,
    /// IEEE single precision.
    Float32,
}

impl LightFormat {
    /// The format of a texture's pixels, where it is one.
    pub(crate) fn of(format: TextureFormat) -> Option<Self> {
        match format {
            TextureFormat::Rgba16Float => Some(Self::Float16),
            TextureFormat::Rgba32Float => Some(Self::Float32),
            _ => None,
        }
    }

    /// Channels of a word of 32 bits.
    pub(crate) fn channels_a_word(self) -> u32 {
        match self {
            Self::Float16 => 2,
            Self::Float32 => 1,
        }
    }

    /// Words of 32 bits of a row of `width` pixels.
    pub(crate) fn words(self, width: u32) -> u32 {
        width * (CHANNELS / self.channels_a_word())
    }
}

impl VisibilityFormat {
    /// The format of a texture's pixels, where it is one.
    pub fn of(format: TextureFormat) -> Option<Self> {
        match format {
            TextureFormat::R8Unorm => Some(Self::Unorm8),
            TextureFormat::R16Float => Some(Self::Float16),
            TextureFormat::R32Float => Some(Self::Float32),
            _ => None,
        }
    }

    /// Pixels of a word of 32 bits.
    pub fn pixels_a_word(self) -> u32 {
        match self {
            Self::Unorm8 => 4,
            Self::Float16 => 2,
            Self::Float32 => 1,
        }
    }

    /// The bits of a pixel with `lit` of `samples` samples lit.
    pub fn bits(self, lit: u32, samples: u32) -> u32 {
        match self {
            Self::Unorm8 => (lit * 255 + samples / 2) / samples.max(1),
            Self::Float16 => u32::from(f16::from_f32(visibility(lit, samples)).to_bits()),
            Self::Float32 => visibility(lit, samples).to_bits(),
        }
    }

    /// The bits for every lit count of a light with `samples` samples.
    pub(crate) fn table(self, samples: u32) -> Vec<u32> {
        (0..=samples).map(|lit| self.bits(lit, samples)).collect()
    }

    /// Words of 32 bits of a row of `width` pixels.
    pub fn words(self, width: u32) -> u32 {
        width.div_ceil(self.pixels_a_word())
    }
}
