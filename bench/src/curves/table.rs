//! A curve as Markdown and as CSV.

use std::fmt::Write;

use super::{
    fit::exponent,
    measure::{Measured, Point},
    plan::Quantity,
};

/// One curve: its points, and the one to whose cost all others are ratios.
pub(super) struct Curve {
    pub(super) quantity: Quantity,
    pub(super) points: Vec<Point>,
    /// Index of that point.
    pub(super) reference: usize,
}

impl Curve {
    /// umbra4's seconds at the reference.
    fn unit(&self) -> f64 {
        self.points[self.reference].umbra.seconds
    }

    /// Cost of umbra4 at every point, in units of the reference.
    pub(super) fn umbra(&self) -> Vec<(f64, f64)> {
        self.points.iter().map(|point| (point.x, point.umbra.seconds / self.unit())).collect()
    }

    /// Cost of the fastest rival at every point, in the same units.
    pub(super) fn rival(&self) -> Vec<(f64, f64)> {
        let cost = |point: &Point| Some((point.x, point.rival.as_ref()?.seconds / self.unit()));
        self.points.iter().filter_map(cost).collect()
    }

    /// Names of the rivals that were the fastest somewhere.
    pub(super) fn rival_names(&self) -> String {
        let mut names: Vec<&str> = self.points.iter().filter_map(|p| Some(p.rival.as_ref()?.name.as_str())).collect();
        names.sort_unstable();
        names.dedup();
        names.join(", ")
    }
}

/// All curves, as a reader reads them.
pub(super) fn markdown(curves: &[Curve]) -> String {
    let mut out = String::from(
        "| curve | point | triangles | receivers | samples | umbra4 | fastest rival | rival ÷ umbra4 | which |\n\
         |---|---|--:|--:|--:|--:|--:|--:|---|\n",
    );
    // Writing to a string cannot fail.
    for curve in curves {
        let unit = curve.unit();
        for (index, point) in curve.points.iter().enumerate() {
            let Point { setting, triangles, receivers, umbra, rival, .. } = point;
            let ratio = |seconds: f64| format!("{:.3}", seconds / unit);
            let (cost, over, name) = match rival {
                Some(rival) => (ratio(rival.seconds), format!("{:.1}", rival.seconds / umbra.seconds), &*rival.name),
                None => (String::new(), String::new(), ""),
            };
            let named = if index == curve.reference { " (reference)" } else { "" };
            let _ = writeln!(
                out,
                "| {} | {}{named} | {triangles} | {receivers} | {}×{} | {} | {cost} | {over} | {name} |",
                curve.quantity.name(),
                setting.label,
                setting.rows,
                setting.columns,
                ratio(umbra.seconds),
            );
        }
    }
    out.push_str(
        "\nTimes of the whole image, building included, ÷ umbra4's at the reference of the same curve; exact, one thread, \
         the least of interleaved runs.\n\n",
    );
    for curve in curves {
        let power = |points: &[(f64, f64)]| exponent(points).map_or_else(|| "-".to_owned(), |p| format!("{p:.2}"));
        let _ = writeln!(
            out,
            "- {}: cost grows as its power {}; the rival's as its power {}",
            curve.quantity.name(),
            power(&curve.umbra()),
            power(&curve.rival()),
        );
    }
    out
}

/// One curve, as a program reads it.
pub(super) fn csv(curve: &Curve) -> String {
    let mut out = String::from(
        "curve,point,x,scene,triangles,receivers,rows,columns,light_scale,umbra4_seconds,umbra4_runs,\
         umbra4_over_reference,rival,rival_seconds,rival_runs,rival_over_reference,rival_over_umbra4,is_reference\n",
    );
    let unit = curve.unit();
    for (index, point) in curve.points.iter().enumerate() {
        let Point { setting, x, triangles, receivers, umbra, rival } = point;
        let rival = rival.as_ref().map_or_else(
            || ",,,,".to_owned(),
            |Measured { name, seconds, runs }| {
                format!("{name},{seconds},{runs},{},{}", seconds / unit, seconds / umbra.seconds)
            },
        );
        let _ = writeln!(
            out,
            "{},{},{x},{},{triangles},{receivers},{},{},{},{},{},{},{rival},{}",
            curve.quantity.name(),
            setting.label,
            setting.scene,
            setting.rows,
            setting.columns,
            setting.light,
            umbra.seconds,
            umbra.runs,
            umbra.seconds / unit,
            index == curve.reference,
        );
    }
    out
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::curves::plan::Setting;

    /// A curve whose rival is 20, 10 and 5 times as slow.
    pub(in crate::curves) fn curve(rival: bool) -> Curve {
        let measured = |name: &str, seconds| Measured { name: name.to_owned(), seconds, runs: 3 };
        let point = |i: u32| {
            let (label, scene) = (format!("p{i}"), "tiny".to_owned());
            let setting = Setting { label, scene, size: 64, light: 3.0, rows: 32, columns: 32 };
            let (x, seconds) = (f64::from(4_u32.pow(i)), f64::from(2_u32.pow(i)));
            let rival = rival.then(|| measured("slow", 20.0));
            Point { setting, x, triangles: 7, receivers: 9, umbra: measured("umbra4", seconds), rival }
        };
        Curve { quantity: Quantity::Receivers, points: (0..3).map(point).collect(), reference: 1 }
    }

    #[test]
    fn ratios_are_to_the_reference() {
        let text = markdown(&[curve(true)]);
        assert!(text.contains("| receivers | p0 | 7 | 9 | 32×32 | 0.500 | 10.000 | 20.0 | slow |"), "{text}");
        assert!(
            text.contains("| receivers | p1 (reference) | 7 | 9 | 32×32 | 1.000 | 10.000 | 10.0 | slow |"),
            "{text}"
        );
        assert!(text.contains("as its power 0.50; the rival's as its power 0.00"), "{text}");
        assert_eq!(curve(true).rival_names(), "slow");
    }

    #[test]
    fn every_line_has_all_fields() {
        for rival in [false, true] {
            let text = csv(&curve(rival));
            let fields: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
            assert_eq!(fields, [18; 4], "{text}");
        }
        assert!(curve(false).rival().is_empty() && curve(false).rival_names().is_empty());
    }
}
