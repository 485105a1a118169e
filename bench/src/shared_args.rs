//! Arguments that several commands have.

use std::path::PathBuf;

use clap::Args;

use crate::{scene::PAPER_LIGHT, timing::Budget};

/// Where receivers come from.
#[derive(Args)]
pub struct ImageArgs {
    /// Where bench/fetch-scenes.sh put the models.
    #[arg(long, default_value = "target/scenes")]
    pub scenes: PathBuf,
    /// Edge of the image in pixels, where it does not vary.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub size: u32,
    /// Chooses tiles, where not all of the image is looked at.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// How rivals are measured.
#[derive(Args)]
pub struct RivalArgs {
    /// Diagonal of the light in the paper's units (its table 5: 1 to 5), where it does not vary.
    #[arg(long, default_value_t = PAPER_LIGHT, value_parser = light_scale)]
    pub light_scale: f64,
    /// Measure the rivals on about so many receivers, in whole 8×8 image tiles, so that they too have several runs.
    #[arg(long, default_value_t = 16384)]
    pub rival_receivers: usize,
    /// Runs of every contender, at least.
    #[arg(long, default_value_t = 3)]
    pub repeat: usize,
}

/// How commands that time umbra4 alone run it.
#[derive(Args)]
pub struct RunArgs {
    /// Threads.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Runs of each subject, at least.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
}

impl RunArgs {
    /// At least one.
    pub fn threads(&self) -> usize {
        self.threads.max(1)
    }

    /// Of each subject.
    pub fn budget(&self, seconds: f64) -> Budget {
        Budget { seconds, repeat: self.repeat }
    }
}

fn in_range(text: &str, range: std::ops::RangeInclusive<f64>) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if range.contains(&value) { Ok(value) } else { Err(format!("not in {} to {}", range.start(), range.end())) }
}

/// Seconds to measure for.
pub fn seconds(text: &str) -> Result<f64, String> {
    in_range(text, 0.0..=1e6)
}

/// A diagonal of the paper's.
pub fn light_scale(text: &str) -> Result<f64, String> {
    in_range(text, 1.0..=5.0)
}
