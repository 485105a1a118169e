//! The mask words that users ask for. Kernels take long to compile, so that words share some: what is computed in a wider
//! word is narrowed.

use umbra4_core::{
    MaskWord, PairWord,
    jitter::{Pattern, Regular},
};
use umbra4_cpu_kernels::Kernels;

/// A mask word of this executor: `u16`, `u32`, `u64`, and the pair of `u32` that GPUs use.
pub trait CpuWord: MaskWord {
    /// The word that masks of regular samples are computed in.
    #[doc(hidden)]
    type Regular: Kernels<Regular>;
    /// The word that masks of jittered samples are computed in.
    #[doc(hidden)]
    type Jittered: Kernels<Pattern>;
    /// Rows as they are handed out; `room` is as long.
    #[doc(hidden)]
    fn of_regular<'a>(rows: &'a [Self::Regular], room: &'a mut [Self]) -> &'a [Self];
    /// Rows as they are handed out; `room` is as long.
    #[doc(hidden)]
    fn of_jittered<'a>(rows: &'a [Self::Jittered], room: &'a mut [Self]) -> &'a [Self];
    /// Of a row of casters' masks, which are computed in words of 64 bits. A row has no bits beyond the light's columns.
    #[doc(hidden)]
    fn of_row(row: u64) -> Self;
}

/// Rows in words of another type.
fn converted<'a, K: Copy, W>(rows: &[K], room: &'a mut [W], convert: impl Fn(K) -> W) -> &'a [W] {
    for (word, row) in room.iter_mut().zip(rows) {
        *word = convert(*row);
    }
    &room[..rows.len().min(room.len())]
}

fn pair(word: u64) -> PairWord {
    PairWord { low: word as u32, high: (word >> 32) as u32 }
}

impl CpuWord for u16 {
    type Regular = u32;
    type Jittered = u32;

    // A row has no bits beyond the light's columns.
    fn of_regular<'a>(rows: &'a [u32], room: &'a mut [Self]) -> &'a [Self] {
        converted(rows, room, |row| row as Self)
    }

    fn of_jittered<'a>(rows: &'a [u32], room: &'a mut [Self]) -> &'a [Self] {
        converted(rows, room, |row| row as Self)
    }

    fn of_row(row: u64) -> Self {
        row as Self
    }
}

macro_rules! own_kernels {
    ($($word:ty),*) => {
        $(
            impl CpuWord for $word {
                type Regular = Self;
                type Jittered = Self;

                fn of_regular<'a>(rows: &'a [Self], _: &'a mut [Self]) -> &'a [Self] {
                    rows
                }

                fn of_jittered<'a>(rows: &'a [Self], _: &'a mut [Self]) -> &'a [Self] {
                    rows
                }

                fn of_row(row: u64) -> Self {
                    row as Self
                }
            }
        )*
    };
}

own_kernels!(u32, u64);

impl CpuWord for PairWord {
    type Regular = u64;
    type Jittered = u64;

    fn of_regular<'a>(rows: &'a [u64], room: &'a mut [Self]) -> &'a [Self] {
        converted(rows, room, pair)
    }

    fn of_jittered<'a>(rows: &'a [u64], room: &'a mut [Self]) -> &'a [Self] {
        converted(rows, room, pair)
    }

    fn of_row(row: u64) -> Self {
        pair(row)
    }
}
