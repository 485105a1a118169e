//! What a surface does to the light that meets it.

use std::sync::Arc;

use umbra4_core::{
    glam::Vec3,
    texture::{TextureSize, Wrap},
};

/// A picture on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture<T> {
    /// Texels each way, one at least, and what lies beyond its edges.
    pub size: TextureSize,
    /// `width · height` texels, row by row; the first row is at v = 0.
    pub texels: Vec<T>,
}

impl<T: Copy> Texture<T> {
    /// The texel at these coordinates; `None` where they are not finite.
    pub fn texel(&self, [u, v]: [f64; 2]) -> Option<T> {
        let TextureSize { width, height, wrap } = self.size;
        let (column, row) = (index(wrap[0], u, width)?, index(wrap[1], v, height)?);
        self.texels.get(row * width as usize + column).copied()
    }
}

fn index(wrap: Wrap, coordinate: f64, size: u32) -> Option<usize> {
    let texel = (coordinate * f64::from(size)).floor();
    let inside = match wrap {
        Wrap::Repeat => texel.rem_euclid(f64::from(size)),
        Wrap::Clamp => texel.clamp(0.0, f64::from(size) - 1.0),
    };
    inside.is_finite().then_some(inside as usize)
}

/// What a surface does to light.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Surface {
    /// It blocks all of it.
    #[default]
    Opaque,
    /// It blocks all of it where a texel's alpha is the threshold at least, and nothing elsewhere.
    Cutout {
        /// The alphas.
        alphas: Arc<Texture<u8>>,
        /// The least that blocks, above 0.
        threshold: u8,
    },
    /// It lets through these fractions, red, green and blue, each `0.0..=1.0`.
    Tinted(Vec3),
    /// The same, texel by texel.
    Stained(Arc<Texture<[f32; 3]>>),
    /// It is not there.
    Absent,
}

impl Surface {
    /// The fractions of red, green and blue that it lets through at these texture coordinates.
    pub fn lets_through(&self, coordinates: [f64; 2]) -> Vec3 {
        match self {
            Self::Opaque => Vec3::ZERO,
            Self::Cutout { alphas, threshold } => match alphas.texel(coordinates) {
                Some(alpha) if alpha < *threshold => Vec3::ONE,
                _ => Vec3::ZERO,
            },
            Self::Tinted(tint) => *tint,
            Self::Stained(tints) => tints.texel(coordinates).map_or(Vec3::ZERO, Vec3::from),
            Self::Absent => Vec3::ONE,
        }
    }

    /// Whether it lets through some of the light and blocks the rest.
    pub fn is_tinted(&self) -> bool {
        matches!(self, Self::Tinted(_) | Self::Stained(_))
    }

    /// Whether another does the same, from the same texture.
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Cutout { alphas, threshold }, Self::Cutout { alphas: others, threshold: other }) => {
                Arc::ptr_eq(alphas, others) && threshold == other
            }
            (Self::Stained(tints), Self::Stained(others)) => Arc::ptr_eq(tints, others),
            (Self::Tinted(tint), Self::Tinted(other)) => tint == other,
            (Self::Opaque, Self::Opaque) | (Self::Absent, Self::Absent) => true,
            _ => false,
        }
    }

    /// Whether texture coordinates have a say in it.
    pub fn is_textured(&self) -> bool {
        matches!(self, Self::Cutout { .. } | Self::Stained(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(wrap: [Wrap; 2]) -> Texture<u8> {
        Texture { size: TextureSize { width: 2, height: 3, wrap }, texels: vec![0, 1, 2, 3, 4, 5] }
    }

    #[test]
    fn borders_belong_to_the_upper_texel() {
        let texture = texture([Wrap::Repeat; 2]);
        assert_eq!(texture.texel([0.0, 0.0]), Some(0));
        assert_eq!(texture.texel([0.5, 0.5]), Some(3));
        assert_eq!(texture.texel([0.499, 0.99]), Some(4));
    }

    #[test]
    fn beyond_the_edge_comes_what_the_axis_says() {
        let [repeated, clamped] = [Wrap::Repeat, Wrap::Clamp].map(|wrap| texture([wrap, Wrap::Clamp]));
        assert_eq!([1.0, -0.25, 7.75].map(|u| repeated.texel([u, 9.0])), [Some(4), Some(5), Some(5)]);
        assert_eq!([1.0, -0.25, 7.75].map(|u| clamped.texel([u, -9.0])), [Some(1), Some(0), Some(1)]);
        assert_eq!(repeated.texel([f64::NAN, 0.0]), None);
        assert_eq!(repeated.texel([0.0, f64::INFINITY]), Some(4));
    }

    #[test]
    fn light_goes_through_holes_and_panes() {
        let alphas = Arc::new(texture([Wrap::Repeat; 2]));
        let cutout = Surface::Cutout { alphas, threshold: 3 };
        assert_eq!(cutout.lets_through([0.0, 0.4]), Vec3::ONE);
        assert_eq!(cutout.lets_through([0.5, 0.4]), Vec3::ZERO);
        let size = TextureSize { width: 1, height: 2, wrap: [Wrap::Clamp; 2] };
        let tints = Texture { size, texels: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };
        assert_eq!(Surface::Stained(Arc::new(tints)).lets_through([0.3, 0.7]), Vec3::Y);
        assert_eq!([Surface::Opaque, Surface::Absent].map(|s| s.lets_through([0.0; 2])), [Vec3::ZERO, Vec3::ONE]);
    }
}
