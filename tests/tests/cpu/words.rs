//! The laws of mask words, for every width; `PairWord` is `u64` in two halves.

use proptest::prelude::*;
use umbra4_core::{MaskWord, PairWord};
use umbra4_tests::{budget, compare::bits_of};

/// `0..end` as bits, written without a shift by the whole width.
fn below(end: u32) -> u64 {
    (0..end).fold(0, |bits, j| bits | 1 << j)
}

/// The word with these bits, built from single columns.
fn word<W: MaskWord>(bits: u64) -> W {
    (0..W::BITS).filter(|j| bits >> j & 1 == 1).fold(W::EMPTY, |w, j| w.or(W::span(j, j + 1)))
}

fn spans<W: MaskWord>() {
    for end in 0..=W::BITS {
        assert_eq!(bits_of(W::below(end)), below(end), "below({end})");
        for start in 0..=W::BITS {
            let span = W::span(start, end);
            let expected = if start < end { below(end) & !below(start) } else { 0 };
            assert_eq!(bits_of(span), expected, "span({start}, {end})");
            assert_eq!(span.count(), end.saturating_sub(start));
            assert_eq!(span.lowest(), if start < end { start } else { W::BITS });
            for column in 0..W::BITS {
                assert_eq!(span.bit(column), (start..end).contains(&column), "span({start}, {end}).bit({column})");
            }
        }
    }
    assert_eq!(W::EMPTY, W::default());
    assert_eq!(size_of::<W>() as u32 * 8, W::BITS);
}

fn algebra<W: MaskWord>(a: u64, b: u64) {
    let (a, b) = (a & below(W::BITS), b & below(W::BITS));
    let (v, w) = (word::<W>(a), word::<W>(b));
    assert_eq!((bits_of(v), bits_of(w)), (a, b));
    assert_eq!(bits_of(v.or(w)), a | b);
    assert_eq!(bits_of(v.and(w)), a & b);
    assert_eq!(bits_of(v.without(w)), a & !b);
    assert_eq!(v.count(), a.count_ones());
    assert_eq!(v.lowest(), a.trailing_zeros().min(W::BITS));
    assert_eq!(v == w, a == b);
    for column in 0..W::BITS {
        assert_eq!(v.bit(column), a >> column & 1 == 1);
    }
}

#[test]
fn spans_are_half_open_at_every_end() {
    spans::<u16>();
    spans::<u32>();
    spans::<u64>();
    spans::<PairWord>();
}

/// Ends where shifts go wrong: 0, 1, BITS − 1, BITS; in the halves of a pair, 31, 32, 33.
#[test]
fn the_ends_by_hand() {
    assert_eq!([0, 1, 15, 16].map(u16::below), [0, 1, 0x7fff, 0xffff]);
    assert_eq!([0, 1, 31, 32].map(u32::below), [0, 1, 0x7fff_ffff, 0xffff_ffff]);
    assert_eq!([0, 1, 63, 64].map(u64::below), [0, 1, u64::MAX >> 1, u64::MAX]);
    let pair = |low, high| PairWord { low, high };
    assert_eq!(
        [0, 1, 31, 32, 33, 63, 64].map(PairWord::below),
        [
            pair(0, 0),
            pair(1, 0),
            pair(u32::MAX >> 1, 0),
            pair(u32::MAX, 0),
            pair(u32::MAX, 1),
            pair(u32::MAX, u32::MAX >> 1),
            pair(u32::MAX, u32::MAX)
        ]
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: budget::of(4096), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn words_are_sets(a: u64, b: u64) {
        algebra::<u16>(a, b);
        algebra::<u32>(a, b);
        algebra::<u64>(a, b);
        algebra::<PairWord>(a, b);
        algebra::<PairWord>(a << 32, b >> 32);
    }
}
