//! The command `sweep`: its arguments, and what it prints.

use std::path::PathBuf;

use clap::Args;

use super::{
    measure::{Options, measure},
    table::{csv, markdown},
};
use crate::{
    compare::CompareError,
    shared_args::{ImageArgs, RivalArgs, seconds},
    timing::Budget,
};

/// Rivals of a plain run.
const RIVALS: &str =
    if cfg!(feature = "embree") { "umbra4-fast,embree8,embree16-square,obvhs" } else { "umbra4-fast,obvhs" };

/// Arguments of the command.
#[derive(Args)]
pub struct SweepArgs {
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "dragon48k,dragon203k,dragon871k,sponza,foliage,lattice,hairball"
    )]
    scene: Vec<String>,
    /// Contenders beside umbra4, named as for `compare`.
    #[arg(long, value_delimiter = ',', default_value = RIVALS)]
    rivals: Vec<String>,
    /// Rows and columns of the light's samples.
    #[arg(long, value_delimiter = ',', default_value = "8,16,32,64", value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: Vec<u32>,
    /// Threads of umbra4 that are compared with one; 1: none.
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Seconds that every contender is measured for with each number of samples, at least; all runs on a scene are
    /// interleaved, and the least times count.
    #[arg(long, default_value_t = 3.0, value_parser = seconds)]
    seconds: f64,
    /// Also write all times as CSV.
    #[arg(long)]
    csv: Option<PathBuf>,
    #[command(flatten)]
    image: ImageArgs,
    #[command(flatten)]
    measured: RivalArgs,
}

impl SweepArgs {
    /// Measures all scenes. What was measured is printed also where a later scene fails.
    ///
    /// # Errors
    /// No such scene or contender; a file that cannot be written.
    pub fn run(&self) -> Result<(), CompareError> {
        let options = Options {
            scenes: &self.image.scenes,
            rivals: &self.rivals,
            samples: &self.samples,
            threads: self.threads.max(1),
            size: self.image.size,
            light: self.measured.light_scale,
            rival_receivers: self.measured.rival_receivers,
            seed: self.image.seed,
            budget: Budget { seconds: self.seconds, repeat: self.measured.repeat },
        };
        let mut sweeps = Vec::new();
        let done = self.scene.iter().try_for_each(|name| {
            sweeps.push(measure(name, &options)?);
            Ok(())
        });
        if !sweeps.is_empty() {
            print!("{}", markdown(&sweeps, &self.rivals, options.threads));
            if let Some(path) = &self.csv {
                std::fs::write(path, csv(&sweeps))?;
            }
        }
        done
    }
}
