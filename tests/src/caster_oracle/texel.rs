//! The texel at a hit, exactly: floors of fractions in big integers.

use dashu_int::{IBig, ops::DivEuclid};

use super::hit::Weights;

/// Texture coordinates of a triangle's corners, in 2^-16 of a texture.
pub type Corners = [[i32; 2]; 3];

/// What lies beyond a texture's border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The same again.
    Repeat,
    /// The texels on the border.
    Clamp,
}

/// A texture: texels row by row, row 0 at v = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct OracleTexture<T> {
    /// Texels of a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// All texels.
    pub texels: Vec<T>,
    /// Beyond the borders along u, and along v.
    pub wrap: [Wrap; 2],
}

/// `⌊U · size⌋` where `U = Σ weight·coordinate / Σ weight`, in 2^-16.
///
/// As seen from the first corner: `U = u_a + (β(u_b − u_a) + γ(u_c − u_a)) / (α + β + γ)`.
pub fn floor(weights: &Weights, [a, b, c]: [i32; 3], size: u32) -> IBig {
    let [alpha, beta, gamma] = weights.map(IBig::from);
    let sum = &alpha + &beta + &gamma;
    assert!(sum > IBig::ZERO, "a hit has a place: {weights:?}");
    let (from_b, from_c) = (i64::from(b) - i64::from(a), i64::from(c) - i64::from(a));
    let above = (IBig::from(a) * &sum + beta * IBig::from(from_b) + gamma * IBig::from(from_c)) * IBig::from(size);
    let below = sum << 16_usize;
    let floor = (&above).div_euclid(&below);
    // What a floor is, whatever a division does with signs.
    assert!(&floor * &below <= above && above < (&floor + IBig::ONE) * &below, "{floor} is not the floor");
    floor
}

/// The texel of a row, or row of texels, numbered as if the texture had no end.
fn wrapped(index: &IBig, size: u32, wrap: Wrap) -> usize {
    let size = IBig::from(size);
    let within = match wrap {
        // However many whole textures there are before it.
        Wrap::Repeat => index - &size * index.div_euclid(&size),
        Wrap::Clamp if *index < IBig::ZERO => IBig::ZERO,
        Wrap::Clamp if *index >= size => size - IBig::ONE,
        Wrap::Clamp => index.clone(),
    };
    usize::try_from(within).expect("a texel lies within its texture")
}

impl<T> OracleTexture<T> {
    /// Of one texel.
    pub fn one(texel: T) -> Self {
        Self { width: 1, height: 1, texels: vec![texel], wrap: [Wrap::Repeat; 2] }
    }

    /// The texel at a hit.
    pub fn at(&self, corners: &Corners, weights: &Weights) -> &T {
        let [column, row] = [(0, self.width), (1, self.height)]
            .map(|(axis, size)| wrapped(&floor(weights, corners.map(|uv| uv[axis]), size), size, self.wrap[axis]));
        &self.texels[row * self.width as usize + column]
    }
}
