//! f32 whose results are the same bits on every processor: what decides a bit of an approximate mask is made of it.
//!
//! A GPU may fuse a product with the sum it goes into, reorder sums, and divide by 2.5 units in the last place off; none of that
//! may happen here, or masks would differ. So every result is *sealed* on a GPU: combined with a word that is zero, but
//! that its compiler does not know (a parameter), so that no operation can be merged with the next. And a reciprocal is
//! corrected in integers until it is the correctly rounded one, which processors give at once. What is left to trust is that
//! sums and products of normal f32 are rounded to nearest, which Vulkan permits GPUs not to do, and all known ones do.
//! Magnitudes stay far from those that are flushed to zero.

/// Sums, products and reciprocals that are the same everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arithmetic {
    /// Zero, though no compiler of kernels can know.
    zero: u32,
}

impl Arithmetic {
    /// `zero` is 0: on a GPU, one that comes out of a buffer.
    #[inline(always)]
    pub const fn new(zero: u32) -> Self {
        Self { zero }
    }

    #[inline(always)]
    fn sealed(self, x: f32) -> f32 {
        // A processor's compiler merges nothing that it is not told to.
        if cfg!(target_arch = "spirv") { f32::from_bits(x.to_bits() ^ self.zero) } else { x }
    }

    /// `a + b`
    #[inline(always)]
    pub fn add(self, a: f32, b: f32) -> f32 {
        self.sealed(a + b)
    }

    /// `a − b`
    #[inline(always)]
    pub fn sub(self, a: f32, b: f32) -> f32 {
        self.sealed(a - b)
    }

    /// `a·b`
    #[inline(always)]
    pub fn mul(self, a: f32, b: f32) -> f32 {
        self.sealed(a * b)
    }

    /// `a·b + c·d`, rounded three times.
    #[inline(always)]
    pub fn sum_of_products(self, a: f32, b: f32, c: f32, d: f32) -> f32 {
        self.add(self.mul(a, b), self.mul(c, d))
    }

    /// `a·b − c·d`, rounded three times: the same, but for its sign, with both products exchanged.
    #[inline(always)]
    pub fn difference_of_products(self, a: f32, b: f32, c: f32, d: f32) -> f32 {
        self.sub(self.mul(a, b), self.mul(c, d))
    }

    /// `1/x`, correctly rounded. `|x|` in `2^-125..2^125`.
    #[inline(always)]
    pub fn reciprocal(self, x: f32) -> f32 {
        if cfg!(target_arch = "spirv") { reciprocal_by_integers(x) } else { 1.0 / x }
    }
}

/// `1/x`, correctly rounded, from a quotient that may be off by four units in the last place. `|x|` in `2^-125..2^125`;
/// other values give some float.
#[inline(always)]
pub fn reciprocal_by_integers(x: f32) -> f32 {
    let bits = x.to_bits();
    let mantissa = bits & 0x007f_ffff | 0x0080_0000;
    // 2^47 / mantissa lies in 2^23..=2^24, where floats are integers. The remainder is small, so that its lowest 32 bits are it.
    let mut quotient = (140_737_488_355_328.0 / mantissa as f32) as u32;
    let mut rest = 0_u32.wrapping_sub(quotient.wrapping_mul(mantissa)) as i32;
    let mut step = 0;
    while step < 4 {
        let below = (rest < 0) as u32;
        let above = (rest >= mantissa as i32) as u32;
        quotient = quotient.wrapping_add(above).wrapping_sub(below);
        rest = rest.wrapping_add((below.wrapping_sub(above).wrapping_mul(mantissa)) as i32);
        step += 1;
    }
    // No tie: the mantissa would have to divide a power of two.
    let up = (rest.wrapping_mul(2) > mantissa as i32) as u32;
    let fraction = quotient.wrapping_add(up).wrapping_sub(0x0080_0000);
    let exponent = 253_u32.wrapping_sub(bits >> 23 & 0xff);
    f32::from_bits(exponent.wrapping_shl(23).wrapping_add(fraction) | bits & 0x8000_0000)
}

/// The lesser; `b` where they do not compare.
#[inline(always)]
pub fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater; `b` where they do not compare.
#[inline(always)]
pub fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The largest integer that is not above `x`, of an `x` that is brought into `low..=high` first (both below 2^23 in size).
#[inline(always)]
pub fn floor_within(x: f32, low: i32, high: i32) -> i32 {
    let x = lesser(greater(x, low as f32), high as f32);
    let whole = x as i32;
    whole - (whole as f32 > x) as i32
}

/// The smallest integer that is not below `x`, of an `x` that is brought into `low..=high` first (both below 2^23 in size).
#[inline(always)]
pub fn ceil_within(x: f32, low: i32, high: i32) -> i32 {
    let x = lesser(greater(x, low as f32), high as f32);
    let whole = x as i32;
    whole + ((whole as f32) < x) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reciprocal_by_integers_is_the_processors() {
        let mut bits = 0x0123_4567_u32;
        let mut compared = 0;
        while compared < 4_000_000 {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let x = f32::from_bits(bits);
            if (f32::from_bits(0x0100_0000)..f32::from_bits(0x7e00_0000)).contains(&x.abs()) {
                assert_eq!(reciprocal_by_integers(x).to_bits(), (1.0 / x).to_bits(), "{x:e}");
                compared += 1;
            }
        }
        for exponent in -120..120 {
            for mantissa in [0x0080_0000_u32, 0x0080_0001, 0x00ff_ffff, 0x00ff_fffe, 0x00b5_04f3, 0x00aa_aaaa] {
                let x = f32::from_bits(((exponent + 127) as u32) << 23 | mantissa & 0x007f_ffff);
                assert_eq!(reciprocal_by_integers(x).to_bits(), (1.0 / x).to_bits(), "{x:e}");
                assert_eq!(reciprocal_by_integers(-x).to_bits(), (-1.0 / x).to_bits(), "{x:e}");
            }
        }
    }

    #[test]
    fn integers_are_rounded_and_kept_within() {
        for (x, floor, ceil) in [(0.0, 0, 0), (0.5, 0, 1), (-0.5, -1, 0), (7.0, 7, 7), (6.999, 6, 7), (-3.0, -3, -3)] {
            assert_eq!((floor_within(x, -8, 8), ceil_within(x, -8, 8)), (floor, ceil), "{x}");
        }
        for x in [f32::MAX, 1e30, f32::INFINITY] {
            assert_eq!((floor_within(x, -8, 8), ceil_within(x, -8, 8)), (8, 8));
            assert_eq!((floor_within(-x, -8, 8), ceil_within(-x, -8, 8)), (-8, -8));
        }
    }
}
