//! Textures of casters: how large, what lies beyond their edges, and how a triangle lies in one. Nearest texels: texel
//! (x, y) covers `x/width ≤ u < (x + 1)/width`, `y/height ≤ v < (y + 1)/height`.
//!
//! Texture coordinates are snapped to multiples of 2^-16, as positions are to the lattice: with them, which texel a light sample
//! is seen through is a question about integers (`texel`).

use glam::UVec4;
#[cfg(not(target_arch = "spirv"))]
use glam::Vec2;
#[cfg(not(target_arch = "spirv"))]
use thiserror::Error;

/// Most texels along an edge.
pub const MOST_TEXELS: u32 = 1 << 14;
/// Largest texture coordinate, in textures, either way.
pub const MOST_COORDINATE: f32 = 16384.0;
/// Texels that a triangle may reach over along an axis: fewer than this.
pub const MOST_SPAN: u32 = 1 << 16;
/// Binary digits of a texture coordinate after the point.
const DIGITS: u32 = 16;

/// What lies beyond a texture's edge, along one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// Its last texel.
    Clamp,
}

/// Size of a texture, and what lies beyond its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextureSize {
    /// Texels along u, in `1..=`[`MOST_TEXELS`].
    pub width: u32,
    /// Texels along v, in `1..=`[`MOST_TEXELS`].
    pub height: u32,
    /// Beyond the edges along u, and along v.
    pub wrap: [Wrap; 2],
}

/// A triangle in a texture: for u and for v, the texel from which it counts, and how far its corners a, b, c lie from that
/// texel's lower edge, in 2^-16 texels.
pub type TexturedTriangle = [u32; 8];

/// Why a texture, or its coordinates, are refused.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum TextureError {
    /// A texture without texels, or with too many.
    #[error("texture {field} is {value}, outside 1..={MOST_TEXELS}")]
    Size {
        /// "width" or "height".
        field: &'static str,
        /// Its value.
        value: u32,
    },
    /// Another number of texels than the size asks for.
    #[error("{count} texels for a texture of {width}×{height}")]
    TexelCount {
        /// Texels given.
        count: usize,
        /// Width of the texture.
        width: u32,
        /// Its height.
        height: u32,
    },
    /// Another number of texture coordinates than vertices; 0 where they are missing.
    #[error("{count} texture coordinates for {vertices} vertices")]
    CoordinateCount {
        /// Coordinates given.
        count: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A texture coordinate is not finite, or too large.
    #[error("texture coordinate {index} has {axis} = {value}, outside −{MOST_COORDINATE}..={MOST_COORDINATE}")]
    Coordinate {
        /// The vertex.
        index: usize,
        /// "u" or "v".
        axis: &'static str,
        /// Its value.
        value: f32,
    },
    /// A triangle reaches over too many texels.
    #[error("triangle {triangle} reaches over {texels} texels along {axis}, {MOST_SPAN} or more")]
    Span {
        /// The triangle.
        triangle: usize,
        /// "u" or "v".
        axis: &'static str,
        /// Texels.
        texels: u64,
    },
    /// The tint of a texel is no fraction.
    #[error("tint {index} has {channel} = {value}, outside 0..=1")]
    Tint {
        /// The texel.
        index: usize,
        /// "red", "green" or "blue".
        channel: &'static str,
        /// Its value.
        value: f32,
    },
}

impl TextureSize {
    /// One texel, all over.
    pub const ONE: Self = Self { width: 1, height: 1, wrap: [Wrap::Repeat; 2] };

    /// Whether there is only one texel to be seen.
    #[inline(always)]
    pub const fn is_one(&self) -> bool {
        self.width == 1 && self.height == 1
    }

    /// As kernels are told.
    #[inline(always)]
    pub(crate) const fn to_words(self) -> [u32; 3] {
        [self.width, self.height, self.wrap[0] as u32 | (self.wrap[1] as u32) << 1]
    }

    /// The inverse, whatever the last word.
    #[inline(always)]
    pub(crate) fn from_words(words: UVec4) -> Self {
        let wrap = |bit: u32| if words.z >> bit & 1 == 1 { Wrap::Clamp } else { Wrap::Repeat };
        Self { width: words.x, height: words.y, wrap: [wrap(0), wrap(1)] }
    }

    /// The place of a texel, `t` texels beyond the one at which a triangle counts from.
    #[inline(always)]
    pub(crate) fn place(&self, triangle: &TexturedTriangle, [x, y]: [u32; 2]) -> u32 {
        let x = wrapped(triangle[0], x, self.width, self.wrap[0]);
        let y = wrapped(triangle[4], y, self.height, self.wrap[1]);
        y.wrapping_mul(self.width).wrapping_add(x)
    }

    /// Whether a texture may have this size.
    ///
    /// # Errors
    /// The width or height that is refused; another number of texels.
    #[cfg(not(target_arch = "spirv"))]
    pub fn check(&self, texels: usize) -> Result<(), TextureError> {
        for (field, value) in [("width", self.width), ("height", self.height)] {
            if value == 0 || value > MOST_TEXELS {
                return Err(TextureError::Size { field, value });
            }
        }
        let (width, height) = (self.width, self.height);
        let asked = width as usize * height as usize;
        if texels == asked { Ok(()) } else { Err(TextureError::TexelCount { count: texels, width, height }) }
    }

    /// How triangle number `triangle` lies in the texture, from its corners' coordinates.
    ///
    /// # Errors
    /// It reaches over too many texels.
    #[cfg(not(target_arch = "spirv"))]
    pub fn triangle(&self, triangle: usize, corners: [Coordinate; 3]) -> Result<TexturedTriangle, TextureError> {
        let along = |axis: usize, size: u32| {
            let [a, b, c] = corners.map(|corner| i64::from(corner.0[axis]) * i64::from(size));
            // Numbers from the texel of the lowest corner on, so that they are small and positive.
            let first = a.min(b).min(c) >> DIGITS;
            let from = [a, b, c].map(|x| x - (first << DIGITS));
            let most = from[0].max(from[1]).max(from[2]);
            if most >= i64::from(MOST_SPAN) << DIGITS {
                let (axis, texels) = (["u", "v"][axis % 2], (most >> DIGITS) as u64);
                return Err(TextureError::Span { triangle, axis, texels });
            }
            let first = match self.wrap[axis % 2] {
                Wrap::Repeat => first.rem_euclid(i64::from(size.max(1))),
                Wrap::Clamp => first,
            };
            Ok([first as u32, from[0] as u32, from[1] as u32, from[2] as u32])
        };
        let ([x, ax, bx, cx], [y, ay, by, cy]) = (along(0, self.width)?, along(1, self.height)?);
        Ok([x, ax, bx, cx, y, ay, by, cy])
    }
}

/// Texel `t` after texel `first`, which is a signed number.
#[inline(always)]
fn wrapped(first: u32, t: u32, size: u32, wrap: Wrap) -> u32 {
    let texel = first.wrapping_add(t);
    match wrap {
        Wrap::Repeat => {
            if size == 0 {
                0
            } else {
                texel % size
            }
        }
        Wrap::Clamp => {
            if (texel as i32) < 0 {
                0
            } else if texel < size {
                texel
            } else {
                size.wrapping_sub(1)
            }
        }
    }
}

/// A texture coordinate on its lattice: u and v in 2^-16 textures.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coordinate([i32; 2]);

#[cfg(not(target_arch = "spirv"))]
impl Coordinate {
    /// Rounds to the nearest, halves away from zero.
    ///
    /// # Errors
    /// A coordinate that is not finite, or beyond [`MOST_COORDINATE`]; `index` names its vertex.
    pub fn snap(index: usize, coordinate: Vec2) -> Result<Self, TextureError> {
        let along = |axis: &'static str, value: f32| {
            // Compared so that NaN is refused.
            if !(-MOST_COORDINATE..=MOST_COORDINATE).contains(&value) {
                return Err(TextureError::Coordinate { index, axis, value });
            }
            // A product with a power of two is exact, and so is what it is rounded to.
            let scaled = f64::from(value) * f64::from(1 << DIGITS);
            let whole = scaled as i32;
            let rest = scaled - f64::from(whole);
            Ok(whole + i32::from(rest >= 0.5) - i32::from(rest <= -0.5))
        };
        Ok(Self([along("u", coordinate.x)?, along("v", coordinate.y)?]))
    }

    /// u and v, in 2^-16 textures.
    pub const fn units(self) -> [i32; 2] {
        self.0
    }
}

/// Words of 32 bits that hold a bit for every texel.
pub const fn bit_words(texels: usize) -> usize {
    texels.div_ceil(32)
}
