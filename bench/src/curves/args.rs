//! The command `curves`: its arguments, and what it writes.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{
    measure::{Options, Point, measure},
    plan::{Quantity, Setting, settings},
    plot::chart,
    table::{Curve, csv, markdown},
};
use crate::{
    compare::CompareError,
    shared_args::{ImageArgs, RivalArgs, seconds},
    timing::Budget,
};

/// Ray tracers whose fastest is the second line.
const RIVALS: &str = if cfg!(feature = "embree") { "embree8,embree16-square" } else { "obvhs" };

/// Arguments of the command.
#[derive(Args)]
pub struct CurvesArgs {
    /// Folder for a .csv and an .svg a curve; made where it is not there.
    #[arg(short, long)]
    output: PathBuf,
    /// Curves to measure; all of them unless said otherwise.
    #[arg(long, value_enum, value_delimiter = ',')]
    curve: Vec<Quantity>,
    /// The scene of all curves but that over triangles.
    #[arg(long, default_value = "dragon48k")]
    scene: String,
    /// Ray tracers; the fastest at each point is the second line.
    #[arg(long, value_delimiter = ',', default_value = RIVALS)]
    rivals: Vec<String>,
    /// Points to whose cost all others of a curve are ratios, as CURVE=POINT: `samples=32`, `triangles=dragon48k`. The
    /// first point of a curve unless it is named.
    #[arg(long, value_delimiter = ',', value_parser = reference)]
    reference: Vec<(Quantity, String)>,
    /// Rows and columns of the light's samples, where they do not vary.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: u32,
    /// Seconds that every contender is measured for at every point, at least; runs are interleaved, and the least times
    /// count.
    #[arg(long, default_value_t = 3.0, value_parser = seconds)]
    seconds: f64,
    #[command(flatten)]
    image: ImageArgs,
    #[command(flatten)]
    measured: RivalArgs,
}

fn reference(text: &str) -> Result<(Quantity, String), String> {
    let (curve, point) = text.split_once('=').ok_or("expected CURVE=POINT")?;
    Ok((Quantity::from_str(curve, false)?, point.to_owned()))
}

impl CurvesArgs {
    /// Measures all curves, and writes each when it is done.
    ///
    /// # Errors
    /// No such scene, contender or point; a file that cannot be written.
    pub fn run(&self) -> Result<(), CompareError> {
        std::fs::create_dir_all(&self.output)?;
        let base = Setting {
            label: String::new(),
            scene: self.scene.clone(),
            size: self.image.size,
            light: self.measured.light_scale,
            rows: self.samples,
            columns: self.samples,
        };
        let options = Options {
            scenes: &self.image.scenes,
            rivals: &self.rivals,
            rival_receivers: self.measured.rival_receivers,
            seed: self.image.seed,
            budget: Budget { seconds: self.seconds, repeat: self.measured.repeat },
        };
        let all = Quantity::value_variants();
        let wanted = all.iter().copied().filter(|quantity| self.curve.is_empty() || self.curve.contains(quantity));
        // References first: a wrong one is not found out after an hour.
        let plans = wanted.map(|quantity| {
            let settings = settings(quantity, &base);
            Ok((quantity, self.reference_of(quantity, &settings)?, settings))
        });
        let mut curves = Vec::new();
        for (quantity, reference, settings) in plans.collect::<Result<Vec<_>, CompareError>>()? {
            let points: Vec<Point> = measure(quantity, &settings, &options)?;
            let curve = Curve { quantity, points, reference };
            let file = |extension: &str| self.output.join(quantity.name()).with_extension(extension);
            std::fs::write(file("csv"), csv(&curve))?;
            std::fs::write(file("svg"), chart(&curve).svg())?;
            curves.push(curve);
        }
        print!("{}", markdown(&curves));
        Ok(())
    }

    /// Index of the point that the others are ratios to.
    fn reference_of(&self, quantity: Quantity, settings: &[Setting]) -> Result<usize, CompareError> {
        let Some((_, point)) = self.reference.iter().rev().find(|(curve, _)| *curve == quantity) else { return Ok(0) };
        settings.iter().position(|setting| setting.label == *point).ok_or_else(|| CompareError::NoPoint {
            curve: quantity.name(),
            point: point.clone(),
            points: settings.iter().map(|setting| setting.label.as_str()).collect::<Vec<_>>().join(", "),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_are_read() {
        assert_eq!(reference("samples=32"), Ok((Quantity::Samples, "32".to_owned())));
        assert!(reference("samples").is_err() && reference("sample=32").is_err());
    }
}
