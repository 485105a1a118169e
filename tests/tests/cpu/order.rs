//! The sort that the serial executor uses.

use umbra4_core::order::{Entry, sort};
use umbra4_tests::rng::Rng;

#[test]
fn sorts_as_the_library_does() {
    let mut rng = Rng::new(7);
    for length in 0..200_u32 {
        // Few codes: many entries share one.
        let mut entries: Vec<Entry> = (0..length)
            .map(|index| Entry { code: rng.below(1 + length as usize / 3) as u32, index: length - index })
            .collect();
        let mut expected = entries.clone();
        expected.sort();
        sort(&mut entries);
        assert_eq!(entries, expected);
    }
}
