//! Small numbers, as people write them.

/// Below it numbers are written with a power of ten.
pub const SMALLEST_PLAIN: f64 = 0.99e-4;

/// 10 to a power, with the power raised.
pub fn power_of_ten(power: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = power.unsigned_abs().to_string();
    let raised: String = digits.bytes().map(|digit| RAISED[usize::from(digit - b'0')]).collect();
    format!("10{}{raised}", if power < 0 { "⁻" } else { "" })
}

/// The power of ten that a number above zero begins with.
pub fn power(value: f64) -> i32 {
    // What is but a rounding below a power of ten is that power.
    (value.log10() + 1e-9).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_raised() {
        assert_eq!([power_of_ten(-5), power_of_ten(12)], ["10⁻⁵", "10¹²"]);
        assert_eq!([1e-5, 9.9e-5, 1e-4, 20.0].map(power), [-5, -5, -4, 1]);
    }
}
