//! How much tests compare: enough by default to catch what they have caught, and as many times more as `UMBRA4_BITS` asks
//! for. (Which planted faults the default still catches is what `.ci/planted-faults` checks.)

/// Bits that a run of the conformance suite compares at least, over all word widths and executors.
pub const BITS: u64 = 40_000_000;

/// The bits asked for: [`BITS`], or what the environment variable `UMBRA4_BITS` says (`1e9`).
///
/// # Panics
/// For what is no number, and for less than one bit.
pub fn asked() -> u64 {
    match std::env::var("UMBRA4_BITS") {
        Err(_) => BITS,
        Ok(text) => {
            let bits: f64 = text.parse().unwrap_or_else(|_| panic!("UMBRA4_BITS={text} is not a number"));
            assert!(bits >= 1.0, "UMBRA4_BITS={text}: nothing would be compared");
            bits as u64
        }
    }
}

/// What is `usual` by default, in bits, scenes or cases: as many times more as the bits that are [`asked`] for are more than
/// [`BITS`], and one at least.
///
/// # Panics
/// When there are more than the type holds.
pub fn of<T: TryInto<u64> + TryFrom<u64>>(usual: T) -> T {
    let Ok(usual) = usual.try_into() else { panic!("a budget is a number of things") };
    T::try_from(scaled(usual, asked())).unwrap_or_else(|_| panic!("UMBRA4_BITS asks for more than can be counted"))
}

fn scaled(usual: u64, asked: u64) -> u64 {
    let all = u128::from(usual) * u128::from(asked) / u128::from(BITS);
    // Something is always compared.
    u64::try_from(all).unwrap_or(u64::MAX).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_as_many_times_more() {
        assert_eq!(scaled(12, BITS), 12);
        assert_eq!(scaled(12, 25 * BITS), 300);
        assert_eq!(scaled(12, BITS / 4), 3);
        assert_eq!((scaled(12, 1), scaled(u64::MAX, u64::MAX)), (1, u64::MAX));
    }
}
