//! Mask words that rays can write: rays come packet by packet, and so do their bits.

use umbra4_cpu::CpuWord;

/// A mask word that is made from bits.
pub trait RowWord: CpuWord {
    /// The word with these bits; those beyond the word are dropped.
    fn from_bits(bits: u64) -> Self;
}

impl RowWord for u16 {
    fn from_bits(bits: u64) -> Self {
        bits as Self
    }
}

impl RowWord for u32 {
    fn from_bits(bits: u64) -> Self {
        bits as Self
    }
}

impl RowWord for u64 {
    fn from_bits(bits: u64) -> Self {
        bits
    }
}
