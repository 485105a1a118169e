//! What a picture was made of, in words and numbers.

use std::{
    io::{Write, stdout},
    path::Path,
};

use umbra4_core::{CasterWork, Counts};
use umbra4_cpu::Caster;

use crate::{
    error::ProgramError,
    light::{HardLight, Light, Source},
    stages::Stages,
};

/// What is printed of a run.
pub struct Summary {
    /// Triangles, the ground's included.
    pub triangles: usize,
    /// Receivers.
    pub receivers: usize,
    /// The lights.
    pub lights: String,
    /// The casters, where parts of the scene are more than opaque.
    pub casters: Option<String>,
    /// Width and height of the picture.
    pub size: (u32, u32),
    /// What the shadows were found on.
    pub on: String,
    /// Pairs and fallbacks.
    pub counts: Counts,
    /// The fraction that is lit, of every receiver; empty where that was not asked.
    pub visibility: Vec<f32>,
}

impl Summary {
    /// Prints it, with the times of all stages and where the picture is.
    ///
    /// # Errors
    /// Standard output is closed.
    pub fn print(&self, stages: Stages, output: &Path) -> Result<(), ProgramError> {
        let Self { triangles, receivers, lights, casters, size: (width, height), on, counts, visibility } = self;
        let table = stages.table();
        let mut out = stdout().lock();
        writeln!(out, "{triangles} triangles, {receivers} receivers, {lights}, {width}×{height} pixels, on {on}\n")?;
        if let Some(casters) = casters {
            writeln!(out, "casters: {casters}\n")?;
        }
        writeln!(out, "{table}")?;
        writeln!(out, "pairs tested       {:>12}", counts.pairs_tested)?;
        writeln!(out, "pairs kept         {:>12}", counts.pairs_kept)?;
        writeln!(out, "pairs relevant     {:>12}", counts.pairs_relevant)?;
        writeln!(out, "integer fallbacks  {:>12}", counts.fallbacks)?;
        if !visibility.is_empty() {
            let share = |class: fn(f32) -> bool| {
                100.0 * visibility.iter().filter(|v| class(**v)).count() as f64 / visibility.len() as f64
            };
            let (umbra, lit) = (share(|v| v <= 0.0), share(|v| v >= 1.0));
            writeln!(out, "umbra {umbra:.1} %, penumbra {:.1} %, lit {lit:.1} %", 100.0 - umbra - lit)?;
        }
        writeln!(out, "wrote {}", output.display())?;
        Ok(())
    }
}

/// The lights in a few words: how many the file has, or which one the command line gives.
pub fn lights(lights: &[Light], of_file: bool, frames: Option<u32>) -> String {
    let count = lights.len();
    let jittered = frames.map_or_else(String::new, |frames| format!(", {}", counted(frames, "jittered frame")));
    match lights.first().map(|light| &light.source) {
        Some(Source::Area(area)) if !of_file => samples(area.front().area.rows(), frames),
        Some(Source::Hard(HardLight::Sun(_))) if !of_file => "the sun".to_owned(),
        Some(Source::Hard(_)) if !of_file => "a lamp without extent".to_owned(),
        _ => counted(u32::try_from(count).unwrap_or(u32::MAX), "light") + &jittered,
    }
}

/// How many casters of which kind there are.
pub fn casters(casters: &[Caster]) -> String {
    let of = |work: CasterWork| casters.iter().filter(|caster| caster.packed().work() == work).count();
    let closed = casters.iter().filter(|caster| caster.casting().closed).count();
    let counts = [
        (of(CasterWork::Plain), "opaque"),
        (of(CasterWork::Cutout), "cut out or offset"),
        (of(CasterWork::Tinted), "tinted"),
        (closed, "of them closed"),
    ];
    let said = counts.into_iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
    said.collect::<Vec<_>>().join(", ")
}

/// Samples, and frames of jittered ones.
fn samples(side: u32, frames: Option<u32>) -> String {
    match frames {
        None => format!("{side}×{side} light samples"),
        Some(frames) => format!("{side}×{side} jittered light samples, {}", counted(frames, "frame")),
    }
}

fn counted(count: u32, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}
