//! How fast a curve rises.

/// The exponent p of the power law y ~ x^p that fits best (least squares of logarithms); `None` where all x are the same.
pub(super) fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let logarithms = || points.iter().map(|(x, y)| (x.ln(), y.ln()));
    let (x_mean, y_mean) = logarithms().fold((0.0, 0.0), |(x, y), (a, b)| (x + a / n, y + b / n));
    let (above, below) = logarithms().fold((0.0, 0.0), |(above, below), (x, y)| {
        (above + (x - x_mean) * (y - y_mean), below + (x - x_mean) * (x - x_mean))
    });
    (below > 0.0).then(|| above / below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_found() {
        let points = [1.0, 4.0, 16.0, 64.0].map(|x: f64| (x, 3.0 * x.powf(0.6)));
        assert!(exponent(&points).is_some_and(|p| (p - 0.6).abs() < 1e-12));
        assert_eq!(exponent(&[(2.0, 1.0), (2.0, 3.0)]), None);
        assert_eq!(exponent(&[]), None);
    }
}
