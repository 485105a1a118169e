//! The command `lookup`: its arguments, and what it prints.

use clap::Args;

use super::{
    markdown::markdown,
    measure::{Options, measure},
};
use crate::{
    compare::CompareError,
    shared_args::{ImageArgs, seconds},
    timing::Budget,
};

/// Arguments of the command.
#[derive(Args)]
pub struct LookupArgs {
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(long, value_delimiter = ',', default_value = "dragon48k,sponza,foliage")]
    scene: Vec<String>,
    /// Rows and columns of the light's samples: 16, 32 or 64.
    #[arg(long, value_delimiter = ',', default_value = "16,32,64", value_parser = samples)]
    samples: Vec<u32>,
    /// Angles of the tables, and as many distances; multiples of four.
    #[arg(long, value_delimiter = ',', default_value = "64,128,256", value_parser = cells)]
    cells: Vec<u32>,
    /// Look at about so many receivers, in whole 8×8 image tiles.
    #[arg(long, default_value_t = 8192)]
    receivers: usize,
    /// Seconds that every way to fill masks is measured for, at least; runs are interleaved, and the least times count.
    #[arg(long, default_value_t = 1.0, value_parser = seconds)]
    seconds: f64,
    /// Runs of every way, at least.
    #[arg(long, default_value_t = 20)]
    repeat: usize,
    #[command(flatten)]
    image: ImageArgs,
}

fn samples(text: &str) -> Result<u32, String> {
    let samples = text.parse().map_err(|_| "not a number".to_owned())?;
    if matches!(samples, 16 | 32 | 64) { Ok(samples) } else { Err("not 16, 32 or 64".to_owned()) }
}

fn cells(text: &str) -> Result<u32, String> {
    let cells: u32 = text.parse().map_err(|_| "not a number".to_owned())?;
    let known = cells.is_multiple_of(4) && (4..=512).contains(&cells);
    if known { Ok(cells) } else { Err("not a multiple of four in 4 to 512".to_owned()) }
}

impl LookupArgs {
    /// Measures all scenes.
    ///
    /// # Errors
    /// No such scene.
    pub fn run(&self) -> Result<(), CompareError> {
        let options = Options {
            scenes: &self.image.scenes,
            samples: &self.samples,
            cells: &self.cells,
            size: self.image.size,
            receivers: self.receivers,
            seed: self.image.seed,
            budget: Budget { seconds: self.seconds, repeat: self.repeat },
        };
        let mut lines = Vec::new();
        for scene in &self.scene {
            lines.extend(measure(scene, &options)?);
        }
        print!("{}", markdown(&lines));
        Ok(())
    }
}
