//! The command `maps`: its arguments, and what it prints.

use clap::Args;

use super::{
    measure::{Options, measure},
    table::markdown,
};
use crate::{
    compare::CompareError,
    shared_args::{ImageArgs, RunArgs, seconds},
};

/// Arguments of the command.
#[derive(Args)]
pub struct MapsArgs {
    /// court (the program's built-in scene), dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(long, value_delimiter = ',', default_value = "court,dragon48k,sponza")]
    scene: Vec<String>,
    /// Rows and columns of the light's samples.
    #[arg(long, value_delimiter = ',', default_value = "32", value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: Vec<u32>,
    /// Texels of maps along each edge: a power of two.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=2048))]
    map: u32,
    /// Seconds of each way, at least; the fastest run counts.
    #[arg(long, default_value_t = 2.0, value_parser = seconds)]
    seconds: f64,
    #[command(flatten)]
    run: RunArgs,
    #[command(flatten)]
    image: ImageArgs,
}

impl MapsArgs {
    /// Measures all scenes.
    ///
    /// # Errors
    /// No such scene; whatever umbra4 refuses.
    pub fn run(&self) -> Result<(), CompareError> {
        for &samples in &self.samples {
            let options = Options {
                scenes: &self.image.scenes,
                samples,
                threads: self.run.threads(),
                size: self.image.size,
                map: self.map,
                budget: self.run.budget(self.seconds),
            };
            let measured: Vec<_> = self.scene.iter().map(|scene| measure(scene, &options)).collect::<Result<_, _>>()?;
            print!("{}", markdown(&measured, samples, self.map));
        }
        Ok(())
    }
}
