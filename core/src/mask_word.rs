//! Mask words: one row of an occlusion mask.
//!
//! Bit order, stated here once: bit j (bit 0 the least significant) is column j of the light; 1 means blocked. Bits at
//! and beyond the number of columns are always 0.

/// An unsigned word that holds one row of up to [`MaskWord::BITS`] light samples.
pub trait MaskWord: Copy + Eq + Default + Send + Sync + bytemuck::Pod + core::fmt::Debug {
    /// Columns that fit.
    const BITS: u32;
    /// The word without a bit.
    const EMPTY: Self;
    /// The word with all bits.
    const ALL: Self;
    /// The word whose bits `0..end` are set; `end` in `0..=BITS`.
    fn below(end: u32) -> Self;
    /// The word whose columns from `first` on are the lowest of `bits`; `first < BITS`.
    fn columns(first: u32, bits: u32) -> Self;
    /// Bits in either word.
    fn or(self, other: Self) -> Self;
    /// Bits in both words.
    fn and(self, other: Self) -> Self;
    /// Bits in one of both words.
    fn xor(self, other: Self) -> Self;
    /// Bits in `self` that are not in `other`.
    fn without(self, other: Self) -> Self;
    /// Number of bits set.
    fn count(self) -> u32;
    /// Bit `column`; `column < BITS`.
    fn bit(self, column: u32) -> bool;
    /// The lowest column that is set, or [`MaskWord::BITS`] where none is.
    fn lowest(self) -> u32;

    /// The word whose bits `start..end` are set: a half-open column interval, empty where `end <= start`.
    /// Both in `0..=BITS`.
    #[inline(always)]
    fn span(start: u32, end: u32) -> Self {
        Self::below(end).without(Self::below(start))
    }
}

macro_rules! mask_word {
    ($word:ty) => {
        impl MaskWord for $word {
            const BITS: u32 = <$word>::BITS;
            const EMPTY: Self = 0;
            const ALL: Self = <$word>::MAX;

            // A shift by the whole width is no shift in any instruction set, hence the selection.
            #[inline(always)]
            fn below(end: u32) -> Self {
                let bits = if end < Self::BITS { (1 as $word).wrapping_shl(end) } else { 0 };
                bits.wrapping_sub(1)
            }

            #[inline(always)]
            fn columns(first: u32, bits: u32) -> Self {
                (bits as $word).wrapping_shl(first)
            }

            #[inline(always)]
            fn or(self, other: Self) -> Self {
                self | other
            }

            #[inline(always)]
            fn and(self, other: Self) -> Self {
                self & other
            }

            #[inline(always)]
            fn xor(self, other: Self) -> Self {
                self ^ other
            }

            #[inline(always)]
            fn without(self, other: Self) -> Self {
                self & !other
            }

            #[inline(always)]
            fn count(self) -> u32 {
                self.count_ones()
            }

            #[inline(always)]
            fn bit(self, column: u32) -> bool {
                self.wrapping_shr(column) & 1 == 1
            }

            #[inline(always)]
            fn lowest(self) -> u32 {
                self.trailing_zeros()
            }
        }
    };
}

mask_word!(u16);
mask_word!(u32);
mask_word!(u64);

/// 64 columns in two `u32`, for devices without 64-bit integers. In memory it is a little-endian `u64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PairWord {
    /// Columns 0 to 31.
    pub low: u32,
    /// Columns 32 to 63.
    pub high: u32,
}

impl MaskWord for PairWord {
    const BITS: u32 = 64;
    const EMPTY: Self = Self { low: 0, high: 0 };
    const ALL: Self = Self { low: u32::MAX, high: u32::MAX };

    #[inline(always)]
    fn below(end: u32) -> Self {
        let low = if end < 32 { end } else { 32 };
        Self { low: u32::below(low), high: u32::below(end - low) }
    }

    #[inline(always)]
    fn columns(first: u32, bits: u32) -> Self {
        // A shift by a word's width or more is undefined on GPUs.
        let by = first & 31;
        let (shifted, carried) = (bits.wrapping_shl(by), bits.wrapping_shr(1).wrapping_shr(31 - by));
        if first < 32 { Self { low: shifted, high: carried } } else { Self { low: 0, high: shifted } }
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self { low: self.low | other.low, high: self.high | other.high }
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self { low: self.low & other.low, high: self.high & other.high }
    }

    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        Self { low: self.low ^ other.low, high: self.high ^ other.high }
    }

    #[inline(always)]
    fn without(self, other: Self) -> Self {
        Self { low: self.low & !other.low, high: self.high & !other.high }
    }

    #[inline(always)]
    fn count(self) -> u32 {
        self.low.count_ones() + self.high.count_ones()
    }

    #[inline(always)]
    fn bit(self, column: u32) -> bool {
        if column < 32 { self.low.bit(column) } else { self.high.bit(column - 32) }
    }

    #[inline(always)]
    fn lowest(self) -> u32 {
        if self.low != 0 { self.low.lowest() } else { 32 + self.high.lowest() }
    }
}
