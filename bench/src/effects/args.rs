//! The command `effects`: its arguments, and what it prints.

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
pub struct EffectsArgs {
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(long, value_delimiter = ',', default_value = "dragon48k,sponza")]
    scene: Vec<String>,
    /// Rows and columns of the samples of lights with an area.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: u32,
    /// Seconds of each effect, at least; the fastest run counts.
    #[arg(long, default_value_t = 2.0, value_parser = seconds)]
    seconds: f64,
    #[command(flatten)]
    run: RunArgs,
    #[command(flatten)]
    image: ImageArgs,
}

impl EffectsArgs {
    /// Measures all scenes.
    ///
    /// # Errors
    /// No such scene; whatever umbra4 refuses.
    pub fn run(&self) -> Result<(), CompareError> {
        let options = Options {
            scenes: &self.image.scenes,
            samples: self.samples,
            threads: self.run.threads(),
            size: self.image.size,
            budget: self.run.budget(self.seconds),
        };
        let measured: Vec<_> = self.scene.iter().map(|scene| measure(scene, &options)).collect::<Result<_, _>>()?;
        let (lines, errors): (Vec<_>, Vec<_>) = measured.into_iter().map(|scene| (scene.lines, scene.errors)).unzip();
        print!("{}{}", markdown(&self.scene, &lines), errors.concat());
        Ok(())
    }
}
