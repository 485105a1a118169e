//! A logarithmic axis: from values to pixels, and where its ticks are.

/// From `low` to `high`, both positive, over pixels `start` to `end`.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogAxis {
    low: f64,
    high: f64,
    start: f64,
    end: f64,
}

impl LogAxis {
    /// Around all `values` that are finite and positive, with some room on both sides.
    pub(super) fn around(values: impl Iterator<Item = f64>, start: f64, end: f64) -> Self {
        let (mut low, mut high) = (f64::MAX, 0.0_f64);
        for value in values.filter(|value| value.is_finite() && *value > 0.0) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (1.0, 1.0);
        }
        // At least half an octave, so that equal values are a level line.
        let room = (high / low).powf(0.08).max(2.0_f64.sqrt());
        Self { low: low / room, high: high * room, start, end }
    }

    /// The pixel of a value.
    pub(super) fn place(&self, value: f64) -> f64 {
        self.start + (self.end - self.start) * (value / self.low).ln() / (self.high / self.low).ln()
    }

    /// Values with a label: ones, twos and fives of every decade, or fewer where that is too many.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let decades = (self.high / self.low).log10();
        let digits: &[f64] = match decades {
            ..1.0 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
            1.0..3.5 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        self.values(digits)
    }

    /// Values with a fine line: all digits of every decade.
    pub(super) fn fine(&self) -> Vec<f64> {
        self.values(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
    }

    fn values(&self, digits: &[f64]) -> Vec<f64> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let values = decades.flat_map(|decade| digits.iter().map(move |digit| digit * 10.0_f64.powi(decade)));
        values.filter(|value| (self.low..=self.high).contains(value)).collect()
    }
}

/// A number for a label: three digits, and k or M for thousands and millions.
pub(super) fn label(value: f64) -> String {
    let (value, unit) = match value.abs() {
        1e6.. => (value / 1e6, "M"),
        1e4.. => (value / 1e3, "k"),
        _ => (value, ""),
    };
    let decimals = if value == 0.0 { 0 } else { (2 - value.abs().log10().floor() as i32).max(0) as usize };
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_factors_are_equal_lengths() {
        let axis = LogAxis::around([1.0, 100.0].into_iter(), 0.0, 300.0);
        let [a, b, c] = [1.0, 10.0, 100.0].map(|value| axis.place(value));
        assert!((b - a - (c - b)).abs() < 1e-9 && a > 0.0 && c < 300.0);
        assert_eq!(axis.ticks(), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
    }

    #[test]
    fn every_axis_has_ticks() {
        for values in [[1.0, 1.0], [1.0, 1.1], [3.0, 4.0], [1e-3, 1e6], [f64::NAN, 7.0], [0.0, -1.0]] {
            let axis = LogAxis::around(values.into_iter(), 400.0, 0.0);
            assert!((2..=12).contains(&axis.ticks().len()), "{values:?}: {:?}", axis.ticks());
            assert!(axis.ticks().into_iter().all(|value| (0.0..=400.0).contains(&axis.place(value))));
        }
    }

    #[test]
    fn labels_are_short() {
        let labels = [0.05, 0.5, 1.0, 1.5, 20.0, 4096.0, 11_104.0, 202_522.0, 262_144.0, 1_048_576.0].map(label);
        assert_eq!(labels, ["0.05", "0.5", "1", "1.5", "20", "4096", "11.1k", "203k", "262k", "1.05M"]);
    }
}
