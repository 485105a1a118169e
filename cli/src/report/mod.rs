//! The price of accuracy: every way to buy it is run on one scene, and its error and time are put on one page.

mod csv;
mod curve;
mod difference;
mod equal;
mod facts;
mod flip;
mod judge;
mod maps;
mod measure;
mod methods;
mod numbers;
mod page;
mod pareto;
mod plot;
mod problem;
mod results;
mod tiles;

use std::io::Cursor;

use image::{ImageFormat, RgbImage};

use crate::{
    args::ReportArgs,
    error::ProgramError,
    executor::{self, Device},
    in_file::InFile,
    output::OutputError,
    output_folder::PreparedFolder,
    scene::{Scene, check_pixels},
    stages::Stages,
};
pub use difference::{CompareError, Difference};
use plot::Kind;
pub use plot::{NOTE as PLOT_NOTE, RasterError};
use problem::Problem;

/// Pixels of plot.png a unit of the drawing.
const PLOT_SCALE: f32 = 1.75;

/// Stages beside those of the measurement: load, primary, methods, page.
const STAGES: u64 = 4;

/// Measures, and writes the folder. Returns a table for the terminal.
///
/// # Errors
/// See [`ProgramError`].
pub fn run(args: &ReportArgs) -> Result<String, ProgramError> {
    let folder = PreparedFolder::new(&args.output)?;
    executor::use_threads(&args.machine)?;
    let (width, height) = args.scene.pixels();
    check_pixels(width, height)?;

    let mut stages = Stages::new(STAGES);
    let scene = stages.run("load", || Scene::load(&args.scene, Some("report")))?;
    let problem = stages.run("primary", || Problem::new(scene, width, height))?;
    if problem.receivers() == 0 {
        return Err(CompareError::Empty.into());
    }
    problem.check_light(methods::REFERENCE_SIDE / 2)?;
    // Last of what can be refused: drivers may have something to say of their own.
    let device = Device::open(&args.machine)?;
    let gpu = device.name().unwrap_or("no GPU");
    stages
        .announce(&format!("measuring {}, {width}×{height} pixels, on the processor and {gpu}", args.scene.name()))?;
    let methods = stages.run("indices of rays", || methods::all(&problem, &device))?;
    stages.expect(measure::stages(methods.len()));
    let results = measure::measure(&problem, &methods, &mut stages)?;
    let equal = equal::equal(&results);

    stages.run("page", || {
        for entry in results.all() {
            for (image, name) in [(&entry.shaded, "shaded"), (&entry.map, "difference")] {
                let name = format!("pictures/{}-{name}.png", entry.slug());
                folder.write(&name, png(image).map_err(InFile::at(&args.output.join(&name)))?)?;
            }
        }
        folder.write("report.csv", csv::methods(&results))?;
        folder.write("equal.csv", csv::equal(&equal))?;
        let scene = facts::scene(&args.scene, &problem);
        let plot = plot::svg(&results, &scene, Kind::Alone);
        if let Some(png) = plot::png(&plot, PLOT_SCALE)? {
            folder.write("plot.png", png)?;
        }
        folder.write("plot.svg", plot)?;
        let facts = facts::facts(&args.scene, &problem, &device);
        let html = page::html(&results, &equal, &facts).map_err(InFile::at(&args.output.join("index.html")))?;
        folder.write("index.html", html)?;
        Ok::<(), ProgramError>(())
    })?;
    folder.publish()?;
    stages.clear();
    Ok(page::text(&results, &equal))
}

fn png(image: &RgbImage) -> Result<Vec<u8>, OutputError> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
