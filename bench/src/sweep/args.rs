//! The command `sweep`: its arguments, and what it prints.

use std::path::PathBuf;

use clap::Args;

use super::{
    measure::{Options, measure},
    table::{csv, markdown},
};
use crate::{compare::CompareError, scene::PAPER_LIGHT, timing::Budget};

/// Rivals of a plain run.
const RIVALS: &str =
    if cfg!(feature = "embree") { "umbra4-fast,embree8,embree16-square,obvhs" } else { "umbra4-fast,obvhs" };

/// Arguments of the command.
#[derive(Args)]
pub struct SweepArgs {
    /// Where bench/fetch-scenes.sh put the models.
    #[arg(long, default_value = "target/scenes")]
    scenes: PathBuf,
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(long, value_delimiter = ',', default_value = "dragon48k,dragon203k,sponza,foliage,lattice,hairball")]
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
    /// Edge of the image in pixels.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=8192))]
    size: u32,
    /// Diagonal of the light in the paper's units (its table 5: 1 to 5).
    #[arg(long, default_value_t = PAPER_LIGHT, value_parser = crate::light_scale)]
    light_scale: f64,
    /// Seconds that every contender is measured for with each number of samples, at least; all runs on a scene are
    /// interleaved, and the least times count.
    #[arg(long, default_value_t = 3.0, value_parser = crate::seconds)]
    seconds: f64,
    /// Runs of every contender, at least.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Measure the rivals on about so many receivers, in whole 8×8 image tiles.
    #[arg(long, default_value_t = 16384)]
    rival_receivers: usize,
    /// Chooses the tiles.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Also write all times as CSV.
    #[arg(long)]
    csv: Option<PathBuf>,
}

impl SweepArgs {
    /// Measures all scenes. What was measured is printed also where a later scene fails.
    ///
    /// # Errors
    /// No such scene or contender; a file that cannot be written.
    pub fn run(&self) -> Result<(), CompareError> {
        let options = Options {
            scenes: &self.scenes,
            rivals: &self.rivals,
            samples: &self.samples,
            threads: self.threads.max(1),
            size: self.size,
            light: self.light_scale,
            rival_receivers: self.rival_receivers,
            seed: self.seed,
            budget: Budget { seconds: self.seconds, repeat: self.repeat },
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
