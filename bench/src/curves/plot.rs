//! A curve as a plot.

use super::{measure::Point, plan::Quantity, table::Curve};
use crate::svg::{Chart, Line, Tick};

/// The plot.
pub(super) fn chart(curve: &Curve) -> Chart {
    let reference = &curve.points[curve.reference];
    let mut lines = vec![Line { name: "umbra4, exact".to_owned(), points: curve.umbra() }];
    let rival = curve.rival();
    if !rival.is_empty() {
        lines.push(Line { name: curve.rival_names(), points: rival });
    }
    let tick = |point: &Point| {
        let setting = &point.setting;
        let text = match curve.quantity {
            Quantity::Samples => format!("{}²", setting.rows),
            _ => String::new(),
        };
        Tick { x: point.x, text }
    };
    Chart {
        title: format!("Cost against {}", curve.quantity.title()),
        setting: setting(curve),
        x: curve.quantity.axis().to_owned(),
        y: format!("time ÷ umbra4's at {}", curve.quantity.spelled_out(&reference.setting.label)),
        ticks: curve.points.iter().map(tick).collect(),
        lines,
    }
}

/// What is the same at all points.
fn setting(curve: &Curve) -> String {
    let setting = &curve.points[curve.reference].setting;
    let scene = format!("{}, ", setting.scene);
    let size = format!("{}² pixels, ", setting.size);
    let samples = format!("{}×{} samples, ", setting.rows, setting.columns);
    let light = format!("light {}/58, ", setting.light);
    let parts = match curve.quantity {
        Quantity::Triangles => [size, samples, light].concat(),
        Quantity::Receivers => [scene, samples, light].concat(),
        Quantity::Light => [scene, size, samples].concat(),
        Quantity::Samples | Quantity::Rows => [scene, size, light].concat(),
    };
    format!("{parts}one thread, building included")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::table::tests::curve;

    #[test]
    fn a_line_a_contender_and_a_tick_a_point() {
        let with = chart(&curve(true));
        assert_eq!((with.lines.len(), with.ticks.len(), with.y.as_str()), (2, 3, "time ÷ umbra4's at p1² pixels"));
        assert_eq!(with.setting, "tiny, 32×32 samples, light 3/58, one thread, building included");
        assert_eq!(chart(&curve(false)).lines.len(), 1);
    }
}
