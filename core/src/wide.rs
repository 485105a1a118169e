//! 96-bit signed integers, in two representations: `i128` where the processor has it, three `u32` limbs where it has
//! not (GPUs). The predicates of `exact` are written once over [`WideInt`]; tests hold the two against each other.
//!
//! All operations wrap modulo `2^96` (limbs) or `2^128`. Every determinant of lattice coordinates fits 94 bits with
//! its sign, so the final value is right whatever its intermediate sums were.

/// The few operations that a determinant needs.
pub trait WideInt: Copy {
    /// What holds a 2×2 determinant: 63 bits.
    type Area: Copy;
    /// Zero.
    const ZERO: Self;
    /// `a·b − c·d`, exactly; all below 2^31 in magnitude.
    fn area(a: i32, b: i32, c: i32, d: i32) -> Self::Area;
    /// `area·b`.
    fn scaled(area: Self::Area, b: i32) -> Self;
    /// `a·b`, exactly.
    fn product(a: i32, b: i32) -> Self;
    /// `self·b`.
    fn times(self, b: i32) -> Self;
    /// `self + other`.
    fn plus(self, other: Self) -> Self;
    /// `self − other`.
    fn minus(self, other: Self) -> Self;
    /// −1, 0 or 1.
    fn sign(self) -> i32;
    /// Bits of the magnitude: 0 for zero.
    fn bits(self) -> u32;
    /// The magnitude divided by `2^down`, rounded down; the largest `u32` where that is more. `down` in `-31..96`.
    fn shifted(self, down: i32) -> u32;
    /// The magnitude, below 2^96, in words: the least significant first.
    fn magnitude_words(self) -> [u32; 3];
}

#[cfg(not(target_arch = "spirv"))]
impl WideInt for i128 {
    /// Half the width: a product with an i32 is then one instruction.
    type Area = i64;
    const ZERO: Self = 0;

    #[inline(always)]
    fn area(a: i32, b: i32, c: i32, d: i32) -> i64 {
        (i64::from(a) * i64::from(b)).wrapping_sub(i64::from(c) * i64::from(d))
    }

    #[inline(always)]
    fn scaled(area: i64, b: i32) -> Self {
        Self::from(area) * Self::from(b)
    }

    #[inline(always)]
    fn product(a: i32, b: i32) -> Self {
        Self::from(i64::from(a) * i64::from(b))
    }

    #[inline(always)]
    fn times(self, b: i32) -> Self {
        self.wrapping_mul(Self::from(b))
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }

    #[inline(always)]
    fn sign(self) -> i32 {
        self.signum() as i32
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        Self::BITS - self.unsigned_abs().leading_zeros()
    }

    #[inline(always)]
    fn shifted(self, down: i32) -> u32 {
        let magnitude = self.unsigned_abs();
        if self.bits() as i32 - down > 32 {
            u32::MAX
        } else if down < 0 {
            (magnitude as u32).wrapping_shl(down.unsigned_abs())
        } else {
            magnitude.wrapping_shr(down.unsigned_abs()) as u32
        }
    }

    #[inline(always)]
    fn magnitude_words(self) -> [u32; 3] {
        let magnitude = self.unsigned_abs();
        [magnitude as u32, (magnitude >> 32) as u32, (magnitude >> 64) as u32]
    }
}

/// Three `u32` limbs, least significant first, two's complement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limbs {
    low: u32,
    mid: u32,
    high: u32,
}

/// `a·b` as (low, high) words, from 16-bit halves: no 64-bit integer is needed.
#[inline(always)]
pub(crate) const fn multiply(a: u32, b: u32) -> (u32, u32) {
    let (a0, a1, b0, b1) = (a & 0xffff, a >> 16, b & 0xffff, b >> 16);
    let low = a0 * b0;
    // Neither sum overflows: 0xffff² + 2·0xffff = 2^32 − 1.
    let mid = a1 * b0 + (low >> 16);
    let mid2 = a0 * b1 + (mid & 0xffff);
    ((mid2 << 16) | (low & 0xffff), a1 * b1 + (mid >> 16) + (mid2 >> 16))
}

impl Limbs {
    /// From its limbs, least significant first.
    #[inline(always)]
    pub const fn from_words([low, mid, high]: [u32; 3]) -> Self {
        Self { low, mid, high }
    }

    /// Its limbs, least significant first.
    #[inline(always)]
    pub const fn words(self) -> [u32; 3] {
        [self.low, self.mid, self.high]
    }

    #[inline(always)]
    fn negate(self) -> Self {
        Self::ZERO.minus(self)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        if (self.high as i32) < 0 { self.negate() } else { self }
    }

    #[inline(always)]
    fn times_magnitude(self, b: u32) -> Self {
        let (low, carry0) = multiply(self.low, b);
        let (mid, carry1) = multiply(self.mid, b);
        let mid_sum = mid.wrapping_add(carry0);
        let carry = (mid_sum < mid) as u32;
        Self { low, mid: mid_sum, high: self.high.wrapping_mul(b).wrapping_add(carry1).wrapping_add(carry) }
    }
}

impl WideInt for Limbs {
    type Area = Self;
    const ZERO: Self = Self { low: 0, mid: 0, high: 0 };

    #[inline(always)]
    fn area(a: i32, b: i32, c: i32, d: i32) -> Self {
        Self::product(a, b).minus(Self::product(c, d))
    }

    #[inline(always)]
    fn scaled(area: Self, b: i32) -> Self {
        area.times(b)
    }

    #[inline(always)]
    fn product(a: i32, b: i32) -> Self {
        let extend = (a >> 31) as u32;
        Self { low: a as u32, mid: extend, high: extend }.times(b)
    }

    #[inline(always)]
    fn times(self, b: i32) -> Self {
        let product = self.times_magnitude(b.unsigned_abs());
        if b < 0 { product.negate() } else { product }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let low = self.low.wrapping_add(other.low);
        let carry = (low < self.low) as u32;
        let mid0 = self.mid.wrapping_add(other.mid);
        let mid = mid0.wrapping_add(carry);
        let carry = (mid0 < self.mid) as u32 + (mid < mid0) as u32;
        Self { low, mid, high: self.high.wrapping_add(other.high).wrapping_add(carry) }
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        let low = self.low.wrapping_sub(other.low);
        let borrow = (self.low < other.low) as u32;
        let mid0 = self.mid.wrapping_sub(other.mid);
        let mid = mid0.wrapping_sub(borrow);
        let borrow = (self.mid < other.mid) as u32 + (mid0 < borrow) as u32;
        Self { low, mid, high: self.high.wrapping_sub(other.high).wrapping_sub(borrow) }
    }

    #[inline(always)]
    fn sign(self) -> i32 {
        if (self.high as i32) < 0 { -1 } else { (self.low | self.mid | self.high != 0) as i32 }
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        let Self { low, mid, high } = self.magnitude();
        if high != 0 {
            96 - high.leading_zeros()
        } else if mid != 0 {
            64 - mid.leading_zeros()
        } else {
            32 - low.leading_zeros()
        }
    }

    #[inline(always)]
    fn shifted(self, down: i32) -> u32 {
        let Self { low, mid, high } = self.magnitude();
        if self.bits() as i32 - down > 32 {
            return u32::MAX;
        }
        if down < 0 {
            return low << (-down & 31);
        }
        // The two limbs that the result lies in.
        let (lower, upper) = if down < 32 {
            (low, mid)
        } else if down < 64 {
            (mid, high)
        } else {
            (high, 0)
        };
        let bit = down as u32 & 31;
        // In two steps, since no word can be shifted by 32.
        lower >> bit | upper << 1 << (31 - bit)
    }

    #[inline(always)]
    fn magnitude_words(self) -> [u32; 3] {
        self.magnitude().words()
    }
}

/// The representation that this target uses.
#[cfg(not(target_arch = "spirv"))]
pub type Wide = i128;
/// The representation that this target uses.
#[cfg(target_arch = "spirv")]
pub type Wide = Limbs;
