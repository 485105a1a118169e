//! Measures the points of one curve, all of them interleaved.

use std::path::Path;

use super::plan::{Quantity, Setting};
use crate::{
    compare::CompareError,
    image_size::ImageSize,
    scene::{Scene, scene},
    timing::{Budget, Case, Least, Posed, Progress, Subject, least},
};

/// How a curve is measured.
pub(super) struct Options<'a> {
    pub(super) scenes: &'a Path,
    /// Ray tracers, of which the fastest counts.
    pub(super) rivals: &'a [String],
    /// At most about so many receivers for the rivals.
    pub(super) rival_receivers: usize,
    /// Chooses them.
    pub(super) seed: u64,
    pub(super) budget: Budget,
}

/// Seconds for the masks of all receivers, building included.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Measured {
    /// The contender.
    pub(super) name: String,
    pub(super) seconds: f64,
    pub(super) runs: usize,
}

/// One point.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) setting: Setting,
    /// Where it lies on the x axis.
    pub(super) x: f64,
    pub(super) triangles: usize,
    pub(super) receivers: usize,
    pub(super) umbra: Measured,
    /// The fastest rival; `None` where none was asked for.
    pub(super) rival: Option<Measured>,
}

/// Measures all points; umbra4 is exact, and everybody has one thread.
///
/// # Errors
/// An unknown scene or contender; whatever a contender refuses.
pub(super) fn measure(
    quantity: Quantity,
    settings: &[Setting],
    options: &Options<'_>,
) -> Result<Vec<Point>, CompareError> {
    let cases = cases(settings, options)?;
    let posed = cases.iter().map(Case::pose).collect::<Result<Vec<_>, _>>()?;
    let contenders: Vec<&str> = [OURS].into_iter().chain(options.rivals.iter().map(String::as_str)).collect();
    let mut subjects = Vec::new();
    for (setting, posed) in settings.iter().zip(&posed) {
        for &contender in &contenders {
            let name = format!("{}: {contender}", setting.label);
            subjects.push(Subject { name, run: Box::new(move || posed.seconds(contender, 1)) });
        }
    }
    let results = least(&subjects, options.budget, &Progress::new(quantity.name()))?;
    let of_points = results.chunks_exact(contenders.len());
    let points = settings.iter().zip(&posed).zip(of_points);
    Ok(points.map(|((setting, posed), results)| point(quantity, setting, posed, &contenders, results)).collect())
}

/// The contender whose cost the curve is about.
const OURS: &str = "umbra4";

/// Cases of all settings; of neighbours that differ in the light alone, receivers are found once.
fn cases(settings: &[Setting], options: &Options<'_>) -> Result<Vec<Case>, CompareError> {
    let mut cases: Vec<Case> = Vec::new();
    for (index, setting) in settings.iter().enumerate() {
        let light = |scene: Scene| scene.with_light_scale(setting.light)?.with_grid(setting.rows, setting.columns);
        let before = index.checked_sub(1).map(|before| (&settings[before], &cases[before]));
        let case = match before {
            Some((before, case)) if before.scene == setting.scene && before.size == setting.size => case.with(light)?,
            _ => {
                let scene = light(scene(&setting.scene, options.scenes, setting.rows, setting.light)?)?;
                Case::new(scene, ImageSize::square(setting.size), options.rival_receivers, options.seed)
            }
        };
        cases.push(case);
    }
    Ok(cases)
}

fn point(quantity: Quantity, setting: &Setting, posed: &Posed<'_>, contenders: &[&str], results: &[Least]) -> Point {
    let (triangles, receivers) = (posed.triangles(), posed.receivers());
    let x = match quantity {
        Quantity::Triangles => triangles as f64,
        Quantity::Receivers => receivers as f64,
        Quantity::Light => setting.light,
        Quantity::Samples => f64::from(setting.rows * setting.columns),
        Quantity::Rows => f64::from(setting.rows),
    };
    let mut measured = contenders.iter().zip(results).map(|(&name, &Least { seconds, runs })| Measured {
        name: name.to_owned(),
        seconds,
        runs,
    });
    let umbra = measured.next().unwrap_or_else(|| unreachable!("umbra4 is the first contender"));
    let rival = measured.min_by(|a, b| f64::total_cmp(&a.seconds, &b.seconds));
    Point { setting: setting.clone(), x, triangles, receivers, umbra, rival }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::scene::tiny;

    #[test]
    fn the_fastest_rival_counts() {
        let case = Case::new(tiny(8), ImageSize::square(16), 64, 1);
        let posed = case.pose().unwrap();
        let setting = Setting { label: String::new(), scene: String::new(), size: 16, light: 3.0, rows: 8, columns: 8 };
        let results = [3.0, 2.0, 1.0, 4.0].map(|seconds| Least { seconds, runs: 1 });
        let point = point(Quantity::Samples, &setting, &posed, &["umbra4", "a", "b", "c"], &results);
        assert_eq!((point.x, point.umbra.seconds, point.rival.unwrap().name.as_str()), (64.0, 3.0, "b"));
    }
}
