//! Numbers and texts as the page shows them.

use crate::report::{
    curve::Reading,
    numbers::{SMALLEST_PLAIN, power, power_of_ten},
};

/// With three digits that count: 1.23·10⁻⁵, 0.00123, 0.456, 12.3, 4560.
pub fn three_digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { "–".to_owned() };
    }
    let power = power(value.abs());
    if value.abs() < SMALLEST_PLAIN {
        return format!("{:.2}·{}", value / 10_f64.powi(power), power_of_ten(power));
    }
    let digits = (2 - power).clamp(0, 9) as usize;
    format!("{value:.digits$}")
}

/// What to say of a reading, and the class of its cell.
pub fn reading(reading: Reading, show: impl Fn(f64) -> String) -> (String, &'static str) {
    match reading {
        Reading::Measured(value) => (show(value), ""),
        Reading::Beyond(value) => (format!("{}*", show(value)), "beyond"),
        Reading::Never => ("–".to_owned(), "none"),
    }
}

/// Text as HTML holds it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_count() {
        let written = [0.0, 0.000_012_34, 0.001_234, 0.4567, 12.34, 4567.8].map(three_digits);
        assert_eq!(written, ["0", "1.23·10⁻⁵", "0.00123", "0.457", "12.3", "4568"]);
    }

    #[test]
    fn what_is_extrapolated_has_a_mark() {
        assert_eq!(reading(Reading::Beyond(2.0), three_digits), ("2.00*".to_owned(), "beyond"));
        assert_eq!(reading(Reading::Measured(2.0), three_digits).0, "2.00");
    }

    #[test]
    fn markup_in_names_is_text() {
        assert_eq!(escaped("<a> & \"b\""), "&lt;a&gt; &amp; &quot;b&quot;");
    }
}
