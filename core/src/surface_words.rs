//! What a caster's surface is, in words of 32 bits, the same on every executor: how its triangles lie in its texture, eight words each,
//! then the texels.

#[cfg(not(target_arch = "spirv"))]
use crate::texture::bit_words;
use crate::{
    texture::{TextureSize, TexturedTriangle},
    tint::Depth,
};

/// Words of a [`TexturedTriangle`].
const TRIANGLE: usize = 8;
/// Words of a [`Depth`].
const DEPTH: u32 = 2;

/// What the triangles of a caster do to light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SurfaceKind {
    /// Nothing: every texel is clear.
    Clear,
    /// They block it.
    Opaque,
    /// They block it where the texel is opaque: a bit a texel.
    Cutout,
    /// They let through what the texel's [`Depth`] leaves.
    Tinted,
}

/// Where the parts of a surface lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceLayout {
    /// Size of the texture. Of one of a single texel, triangles need not say how they lie in it.
    pub texture: TextureSize,
    /// Word of the first texel.
    pub texels: u32,
}

impl SurfaceLayout {
    /// The surface of a caster with `triangles` triangles.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(texture: TextureSize, triangles: u32) -> Self {
        Self { texture, texels: if texture.is_one() { 0 } else { triangles.saturating_mul(TRIANGLE as u32) } }
    }

    /// Words that a surface takes; `None` where 32 bits cannot count them.
    #[cfg(not(target_arch = "spirv"))]
    pub fn words(&self, kind: SurfaceKind) -> Option<u32> {
        let texels = self.texture.width.checked_mul(self.texture.height)?;
        self.texels.checked_add(match kind {
            SurfaceKind::Clear => 0,
            SurfaceKind::Opaque | SurfaceKind::Cutout => bit_words(texels as usize) as u32,
            SurfaceKind::Tinted => texels.checked_mul(DEPTH)?,
        })
    }

    /// How triangle `index` lies in the texture.
    #[inline(always)]
    pub(crate) fn triangle(&self, surface: &[u32], index: u32) -> TexturedTriangle {
        let first = (index as usize).wrapping_mul(TRIANGLE);
        let (mut out, mut k) = ([0; TRIANGLE], 0);
        while self.texels > 0 && k < TRIANGLE {
            let word = first.wrapping_add(k);
            out[k] = if word < surface.len() { surface[word] } else { 0 };
            k += 1;
        }
        out
    }

    /// Whether a texel is opaque, by its place.
    #[inline(always)]
    pub(crate) fn is_opaque(&self, surface: &[u32], texel: u32) -> bool {
        let word = (self.texels as usize).wrapping_add((texel / 32) as usize);
        word < surface.len() && surface[word] >> (texel % 32) & 1 == 1
    }

    /// The depth of a texel, by its place.
    #[inline(always)]
    pub(crate) fn depth(&self, surface: &[u32], texel: u32) -> Depth {
        let word = (self.texels as usize).wrapping_add(texel.wrapping_mul(DEPTH) as usize);
        if word + 1 < surface.len() { Depth::from_words([surface[word], surface[word + 1]]) } else { Depth::CLEAR }
    }
}
