//! A family's curve of error over time, read at a given time or a given error: piecewise straight on logarithmic axes.

/// What one method of the family took, and gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// Seconds before any sample is taken: those of the index.
    pub index: f64,
    /// Seconds after that; they grow with the number of samples.
    pub work: f64,
    /// Mean error.
    pub error: f64,
}

impl Knot {
    fn seconds(&self) -> f64 {
        self.index + self.work
    }
}

/// A value read from a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Between measured methods.
    Measured(f64),
    /// Beyond them: the curve goes on, as steep as it is from end to end.
    Beyond(f64),
    /// The curve does not get there: the index alone takes longer, or it does not fall.
    Never,
}

/// A family's methods, by rising seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve(Vec<Knot>);

/// Errors that differ by less than this share are the same.
const SAME: f64 = 0.01;

impl Curve {
    /// The curve through `knots`. Methods without error or without work have no place on logarithmic axes and are left out.
    pub fn through(knots: impl IntoIterator<Item = Knot>) -> Self {
        let mut knots: Vec<Knot> = knots.into_iter().filter(|k| k.error > 0.0 && k.work > 0.0).collect();
        knots.sort_by(|a, b| a.seconds().total_cmp(&b.seconds()));
        Self(knots)
    }

    /// The error that so many seconds buy.
    pub fn error_at(&self, seconds: f64) -> Reading {
        let inside = self.0.windows(2).find(|pair| (pair[0].seconds()..=pair[1].seconds()).contains(&seconds));
        if let Some([a, b]) = inside {
            return Reading::Measured(straight((a.seconds(), a.error), (b.seconds(), b.error), seconds));
        }
        self.beyond(
            |first| seconds < first.seconds(),
            |end, other| {
                let work = seconds - end.index;
                (work > 0.0).then(|| straight((end.work, end.error), (other.work, other.error), work))
            },
        )
    }

    /// The seconds that so small an error takes.
    pub fn seconds_at(&self, error: f64) -> Reading {
        // The same samples may differ in a few bits: that is no extrapolation.
        if let Some(knot) = self.0.iter().find(|knot| (knot.error / error - 1.0).abs() < SAME) {
            return Reading::Measured(knot.seconds());
        }
        let inside = self.0.windows(2).find(|pair| (pair[1].error..=pair[0].error).contains(&error));
        if let Some([a, b]) = inside {
            return Reading::Measured(straight((a.error, a.seconds()), (b.error, b.seconds()), error));
        }
        self.beyond(
            |first| error > first.error,
            |end, other| Some(end.index + straight((end.error, end.work), (other.error, other.work), error)),
        )
    }

    /// What `value` says of the end of the curve that `before` asks for, and of the other end: pieces near an end are too
    /// short to tell how steep it is.
    fn beyond(&self, before: impl Fn(&Knot) -> bool, value: impl Fn(&Knot, &Knot) -> Option<f64>) -> Reading {
        let [first, .., last] = &self.0[..] else { return Reading::Never };
        let (end, other) = if before(first) { (first, last) } else { (last, first) };
        let falls = first.work < last.work && first.error > last.error;
        match value(end, other) {
            Some(value) if falls && value.is_finite() => Reading::Beyond(value),
            _ => Reading::Never,
        }
    }
}

/// Where the line through two points on logarithmic axes is at `x`.
fn straight((x0, y0): (f64, f64), (x1, y1): (f64, f64), x: f64) -> f64 {
    if x0 == x1 { y0.min(y1) } else { y0 * (y1 / y0).powf((x / x0).ln() / (x1 / x0).ln()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// error = 1 ÷ √work, with an index of 1 s.
    fn rays() -> Curve {
        Curve::through([64.0, 4.0, 16.0].map(|work: f64| Knot { index: 1.0, work, error: work.powf(-0.5) }))
    }

    fn value(reading: Reading) -> f64 {
        match reading {
            Reading::Measured(value) | Reading::Beyond(value) => value,
            Reading::Never => f64::NAN,
        }
    }

    #[test]
    fn measured_methods_are_met() {
        for (seconds, error) in [(5.0, 0.5), (17.0, 0.25), (65.0, 0.125)] {
            assert!(matches!(rays().error_at(seconds), Reading::Measured(e) if (e - error).abs() < 1e-9));
            assert!(matches!(rays().seconds_at(error), Reading::Measured(s) if (s - seconds).abs() < 1e-9));
        }
    }

    #[test]
    fn between_them_it_is_straight_on_logarithmic_axes() {
        let middle = (5.0_f64 * 17.0).sqrt();
        assert!((value(rays().error_at(middle)) - (0.5_f64 * 0.25).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn beyond_them_only_the_work_grows() {
        assert!(matches!(rays().seconds_at(1.0 / 16.0), Reading::Beyond(s) if (s - 257.0).abs() < 1e-6));
        assert!(matches!(rays().error_at(257.0), Reading::Beyond(e) if (e - 1.0 / 16.0).abs() < 1e-9));
        assert!(matches!(rays().error_at(2.0), Reading::Beyond(e) if (e - 1.0).abs() < 1e-9));
        assert_eq!(rays().error_at(0.9), Reading::Never);
    }

    #[test]
    fn a_curve_that_does_not_fall_is_not_continued() {
        let flat = Curve::through([1.0, 2.0].map(|work| Knot { index: 0.0, work, error: 0.1 }));
        assert_eq!(flat.seconds_at(0.01), Reading::Never);
        assert_eq!(Curve::through([Knot { index: 0.0, work: 1.0, error: 0.0 }]).error_at(1.0), Reading::Never);
    }
}
