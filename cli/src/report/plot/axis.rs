//! A logarithmic axis, and the numbers along it.

use crate::report::numbers::{SMALLEST_PLAIN, power, power_of_ten};

/// A logarithmic axis on a part of the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Least and largest value; both above zero.
    values: (f64, f64),
    /// Where they are drawn.
    ends: (f64, f64),
}

/// A line across the plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Value.
    pub value: f64,
    /// Whether its number is written beside it.
    pub labelled: bool,
}

/// An axis is at least so many times as long as its start.
const SHORTEST: f64 = 10.0;
/// Axes of more decades have numbers at powers of ten only.
const FEW_DECADES: f64 = 2.6;

impl Axis {
    /// An axis that holds all positive ones of `values` and a little more, drawn from `ends.0` to `ends.1`.
    pub fn around(values: impl IntoIterator<Item = f64>, ends: (f64, f64)) -> Self {
        let positive = values.into_iter().filter(|v| *v > 0.0 && v.is_finite());
        let (low, high) = positive.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Self { values: (1.0, SHORTEST), ends };
        }
        let margin = (high / low).powf(0.05).max(1.15);
        let (low, high) = (low / margin, high * margin);
        let lacks = (SHORTEST / (high / low)).max(1.0).sqrt();
        Self { values: (low / lacks, high * lacks), ends }
    }

    /// The same place in the drawing, for values `factor` times as large.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { values: (self.values.0 * factor, self.values.1 * factor), ends: self.ends }
    }

    /// Where `value` is drawn; the start for what is not above zero.
    pub fn at(&self, value: f64) -> f64 {
        let (low, high) = self.values;
        let share = if value > 0.0 { ((value / low).ln() / (high / low).ln()).clamp(0.0, 1.0) } else { 0.0 };
        self.ends.0 + (self.ends.1 - self.ends.0) * share
    }

    /// 1, 2, …, 9 in every decade.
    pub fn ticks(&self) -> Vec<Tick> {
        let (low, high) = self.values;
        let few = (high / low).log10() < FEW_DECADES;
        let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let all = powers.flat_map(|power| (1_u8..10).map(move |digit| (digit, f64::from(digit) * 10_f64.powi(power))));
        all.filter(|(_, value)| (low..=high).contains(value))
            .map(|(digit, value)| Tick { value, labelled: digit == 1 || few && matches!(digit, 2 | 5) })
            .collect()
    }
}

/// The value of a tick as people write it: 2·10⁻⁵, 0.002, 0.5, 20, 3000.
pub fn number(value: f64) -> String {
    if value < SMALLEST_PLAIN {
        let (power, ten) = (power(value), power_of_ten(power(value)));
        let digit = (value / 10_f64.powi(power)).round();
        return if digit > 1.0 { format!("{digit}·{ten}") } else { ten };
    }
    let digits = (-value.abs().max(1e-12).log10()).ceil().max(0.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_between_the_ends() {
        let axis = Axis::around([0.02, 3.0, 0.0, f64::NAN], (100.0, 500.0));
        assert!(axis.at(0.02) > 100.0 && axis.at(3.0) < 500.0 && axis.at(0.02) < axis.at(3.0));
        assert_eq!(axis.at(0.0), 100.0);
        assert!((axis.scaled(7.0).at(7.0 * 0.02) - axis.at(0.02)).abs() < 1e-9);
    }

    #[test]
    fn an_axis_without_values_is_one_all_the_same() {
        let axis = Axis::around([0.0], (0.0, 1.0));
        assert!(axis.ticks().iter().filter(|t| t.labelled).count() >= 2);
        let one = Axis::around([5.0], (0.0, 1.0));
        assert!((one.at(5.0) - 0.5).abs() < 1e-9 && one.ticks().iter().any(|t| t.labelled));
    }

    #[test]
    fn numbers_are_short() {
        let written = [0.000_02, 0.000_01, 0.0001, 0.002, 0.05, 0.5, 1.0, 20.0, 3000.0].map(number);
        assert_eq!(written, ["2·10⁻⁵", "10⁻⁵", "0.0001", "0.002", "0.05", "0.5", "1", "20", "3000"]);
    }
}
