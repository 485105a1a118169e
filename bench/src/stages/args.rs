//! The command `stages`: its arguments, and what it prints.

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
pub struct StagesArgs {
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "dragon48k,dragon203k,dragon871k,sponza,foliage,lattice,hairball"
    )]
    scene: Vec<String>,
    /// Rows and columns of the light's samples.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: u32,
    /// Seconds of each way to run, at least; the fastest run counts.
    #[arg(long, default_value_t = 3.0, value_parser = seconds)]
    seconds: f64,
    #[command(flatten)]
    run: RunArgs,
    #[command(flatten)]
    image: ImageArgs,
}

impl StagesArgs {
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
            seed: self.image.seed,
            budget: self.run.budget(self.seconds),
        };
        let mut lines = Vec::new();
        for scene in &self.scene {
            lines.extend(match self.samples {
                ..=16 => measure::<u16>(scene, &options)?,
                17..=32 => measure::<u32>(scene, &options)?,
                _ => measure::<u64>(scene, &options)?,
            });
        }
        print!("{}", markdown(&lines));
        Ok(())
    }
}
