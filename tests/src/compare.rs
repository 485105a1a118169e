//! Are two results the same bits? Tolerance 0 for masks; for visibility, one rounding of a float.
//!
//! A comparison of nothing is a failure, unless the caller says that nothing is what it expects.

use thiserror::Error;
use umbra4_core::MaskWord;

/// Whether a comparison of zero elements is what the caller wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Amount {
    /// There must be something to compare.
    Some,
    /// There must be nothing.
    None,
}

/// Largest distance of a visibility from the quotient `lit / samples`: one rounding of the quotient, and one of a
/// subtraction from 1. Neighbouring counts are at least 1/4096 apart, so this still tells every count from the next.
pub const VISIBILITY_TOLERANCE: f32 = f32::EPSILON;

/// What was compared and found equal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Compared {
    /// Bits compared.
    pub bits: u64,
    /// Those of them that are set (blocked).
    pub blocked: u64,
}

/// How two results differ.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Mismatch {
    /// The results have different lengths, or a length that is no multiple of the rows.
    #[error("{expected} elements expected, got {got}")]
    Length {
        /// Elements expected.
        expected: usize,
        /// Elements got.
        got: usize,
    },
    /// There is nothing to compare, though something was expected.
    #[error("nothing to compare")]
    Empty,
    /// There is something, though nothing was expected.
    #[error("nothing was expected, got {got} elements")]
    NotEmpty {
        /// Elements got.
        got: usize,
    },
    /// A bit at or beyond the number of columns is set.
    #[error("receiver {receiver}, row {row}: {word:#x} has bits at or beyond column {columns}")]
    Stray {
        /// Index of the receiver.
        receiver: usize,
        /// Row of the light.
        row: usize,
        /// The row's word.
        word: u64,
        /// Columns of the light.
        columns: u32,
    },
    /// Bits differ.
    #[error(
        "receiver {receiver}, row {row}, column {column}: expected {expected}, got {got}; {differing} of {bits} bits \
         differ, of {receivers} receivers"
    )]
    Bit {
        /// Receiver of the first differing bit.
        receiver: usize,
        /// Its row.
        row: usize,
        /// Its column.
        column: u32,
        /// The bit expected.
        expected: bool,
        /// The bit got.
        got: bool,
        /// How many bits differ in all.
        differing: u64,
        /// How many receivers have a differing bit.
        receivers: usize,
        /// How many bits there are.
        bits: u64,
    },
    /// A sum of light is another.
    #[error("receiver {receiver}: light {got:?}, expected {expected:?}; that of {differing} receivers differs")]
    Light {
        /// Index of the first receiver that differs.
        receiver: usize,
        /// Red, green, blue.
        expected: [u32; 3],
        /// The same as they came.
        got: [u32; 3],
        /// How many receivers differ.
        differing: usize,
    },
    /// A visibility is NaN.
    #[error("receiver {receiver}: visibility is NaN")]
    NotANumber {
        /// Index of the receiver.
        receiver: usize,
    },
    /// A visibility is not that of the expected number of lit samples.
    #[error("receiver {receiver}: {lit} of {samples} samples are lit, but the visibility is {got}")]
    Visibility {
        /// Index of the receiver.
        receiver: usize,
        /// Lit samples expected.
        lit: u32,
        /// Samples of the light.
        samples: u32,
        /// Visibility got.
        got: f32,
    },
}

fn check_amount(amount: Amount, expected: usize, got: usize) -> Result<(), Mismatch> {
    match amount {
        Amount::Some if expected == 0 && got == 0 => Err(Mismatch::Empty),
        Amount::None if got != 0 => Err(Mismatch::NotEmpty { got }),
        _ if expected != got => Err(Mismatch::Length { expected, got }),
        _ => Ok(()),
    }
}

/// The bits of a word of any width, bit j the column j.
pub fn bits_of<W: MaskWord>(word: W) -> u64 {
    // A mask word is little-endian in memory on every target that is tested (PairWord: by contract).
    let mut bytes = [0; 8];
    let word = bytemuck::bytes_of(&word);
    bytes[..word.len()].copy_from_slice(word);
    u64::from_le_bytes(bytes)
}

/// Compares masks (receiver-major, `rows` words each) bit by bit.
///
/// # Errors
/// The first difference, and how many there are; a wrong length; nothing to compare; bits beyond the last column.
pub fn compare_masks<W: MaskWord>(
    expected: &[u64],
    got: &[W],
    rows: u32,
    columns: u32,
    amount: Amount,
) -> Result<Compared, Mismatch> {
    check_amount(amount, expected.len(), got.len())?;
    let rows = rows as usize;
    if rows == 0 || !expected.len().is_multiple_of(rows) {
        return Err(Mismatch::Length { expected: expected.len().next_multiple_of(rows.max(1)), got: expected.len() });
    }
    let width = u64::MAX >> (64 - columns);
    let bits = expected.len() as u64 * u64::from(columns);
    let (mut differing, mut receivers, mut last, mut first, mut blocked) = (0, 0, usize::MAX, None, 0);
    for (index, (&want, &word)) in expected.iter().zip(got).enumerate() {
        let (receiver, row, word) = (index / rows, index % rows, bits_of(word));
        for side in [want, word] {
            if side & !width != 0 {
                return Err(Mismatch::Stray { receiver, row, word: side, columns });
            }
        }
        blocked += u64::from(want.count_ones());
        let difference = want ^ word;
        if difference != 0 {
            differing += u64::from(difference.count_ones());
            receivers += usize::from(receiver != last);
            last = receiver;
            first.get_or_insert((receiver, row, difference.trailing_zeros(), want));
        }
    }
    match first {
        None => Ok(Compared { bits, blocked }),
        Some((receiver, row, column, want)) => {
            let expected = want >> column & 1 == 1;
            Err(Mismatch::Bit { receiver, row, column, expected, got: !expected, differing, receivers, bits })
        }
    }
}

/// Compares visibilities with the numbers of lit samples.
///
/// # Errors
/// The first that is NaN, or not the fraction of its lit samples; 0 and 1 must be exact; a wrong length; nothing.
pub fn compare_visibility(lit: &[u32], got: &[f32], samples: u32, amount: Amount) -> Result<(), Mismatch> {
    check_amount(amount, lit.len(), got.len())?;
    for (receiver, (&lit, &got)) in lit.iter().zip(got).enumerate() {
        if got.is_nan() {
            return Err(Mismatch::NotANumber { receiver });
        }
        let want = lit as f32 / samples as f32;
        let ends_are_exact = (got == 0.0) == (lit == 0) && (got == 1.0) == (lit == samples);
        // Written so that a comparison with NaN fails, though there is none here any more.
        let close = (got - want).abs() <= VISIBILITY_TOLERANCE;
        if !close || !ends_are_exact {
            return Err(Mismatch::Visibility { receiver, lit, samples, got });
        }
    }
    Ok(())
}

/// Compares sums of light, integers, of all receivers.
///
/// # Errors
/// The first difference, and how many there are; a wrong length; nothing to compare.
pub fn compare_light(expected: &[[u32; 3]], got: &[[u32; 3]], amount: Amount) -> Result<(), Mismatch> {
    check_amount(amount, expected.len(), got.len())?;
    let mut differing = (0..expected.len()).filter(|&receiver| expected[receiver] != got[receiver]);
    match differing.next() {
        None => Ok(()),
        Some(receiver) => Err(Mismatch::Light {
            receiver,
            expected: expected[receiver],
            got: got[receiver],
            differing: 1 + differing.count(),
        }),
    }
}

/// The number of lit samples of every receiver.
pub fn lit_counts(masks: &[u64], rows: u32, columns: u32) -> Vec<u32> {
    masks
        .chunks_exact(rows as usize)
        .map(|mask| rows * columns - mask.iter().map(|word| word.count_ones()).sum::<u32>())
        .collect()
}
