//! Times umbra4 against ray tracers: same scenes, same receivers, same light, one run.

mod bvh_rival;
mod compare;
mod contender;
#[cfg(feature = "embree")]
mod embree;
mod load;
mod optimisations;
mod picture;
mod primary;
mod problem;
mod row_word;
mod scene;
mod subset;
mod table;
#[cfg(all(feature = "tinybvh", target_feature = "avx2"))]
mod tiny_rival;
mod umbra;

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, Parser, Subcommand};
use compare::{CompareError, Options, compare};

/// Benchmarks of umbra4.
#[derive(Parser)]
#[command(name = "umbra4-bench")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compares umbra4 with ray tracers, and prints a Markdown table.
    Compare(CompareArgs),
    /// Measures what each of the paper's optimisations pays, and prints Markdown tables.
    Optimisations(OptimisationsArgs),
}

/// Contenders that a plain run compares.
const CONTENDERS: &str = if cfg!(feature = "embree") {
    "umbra4,umbra4-fast,embree8,embree16,embree16-square,obvhs"
} else {
    "umbra4,umbra4-fast,obvhs"
};

#[derive(Args)]
struct CompareArgs {
    /// Where bench/fetch-scenes.sh put the models.
    #[arg(long, default_value = "target/scenes")]
    scenes: PathBuf,
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza.
    #[arg(long, value_delimiter = ',', default_value = "dragon48k,dragon203k,sponza")]
    scene: Vec<String>,
    /// `umbra4`, `umbra4-fast`, `obvhs[-cwbvh][-fast|-medium]`, and with their features
    /// `embree{1,8,16}[-high][-robust][-square][-avx2]` and `tinybvh[-high]`.
    #[arg(long, value_delimiter = ',', default_value = CONTENDERS)]
    contenders: Vec<String>,
    /// Rows and columns of the light's samples.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: u32,
    /// Edge of the image in pixels.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=8192))]
    size: u32,
    /// Threads of every contender.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Runs of every contender, interleaved; the fastest counts.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Measure everybody on about so many receivers, in whole 8×8 image tiles.
    #[arg(long, default_value_t = usize::MAX, hide_default_value = true)]
    receivers: usize,
    /// Measure the rivals on about so many receivers, in whole 8×8 image tiles.
    #[arg(long, default_value_t = usize::MAX, hide_default_value = true)]
    rival_receivers: usize,
    /// Chooses the tiles.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Also write the table as CSV.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Also write the first contender's visibility as a grey .pgm picture (of the last scene).
    #[arg(long)]
    picture: Option<PathBuf>,
    /// Run the first contender alone and once, for instruction counts:
    /// `valgrind --tool=callgrind --toggle-collect='*measured_section*' umbra4-bench compare --single-run …`
    #[arg(long)]
    single_run: bool,
}

impl CompareArgs {
    fn options(&self) -> Options {
        let mut contenders = self.contenders.clone();
        if self.single_run {
            contenders.truncate(1);
        }
        Options {
            scenes: self.scenes.clone(),
            contenders,
            samples: self.samples,
            size: self.size,
            threads: self.threads.max(1),
            repeat: if self.single_run { 1 } else { self.repeat },
            receivers: self.receivers,
            rival_receivers: self.rival_receivers,
            seed: self.seed,
            picture: self.picture.clone(),
        }
    }
}

#[derive(Args)]
struct OptimisationsArgs {
    /// Where bench/fetch-scenes.sh put the models.
    #[arg(long, default_value = "target/scenes")]
    scenes: PathBuf,
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza.
    #[arg(long, value_delimiter = ',', default_value = "dragon48k,dragon203k,sponza")]
    scene: Vec<String>,
    /// Rows and columns of the light's samples.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: u32,
    /// Edge of the image in pixels.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=8192))]
    size: u32,
    /// Measure on about so many receivers, in whole 8×8 image tiles.
    #[arg(long, default_value_t = 8192)]
    receivers: usize,
    /// Chooses the tiles.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads of every run.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Runs of every variant, interleaved; the fastest counts.
    #[arg(long, default_value_t = 2)]
    repeat: usize,
    /// Cells along each edge of the grid.
    #[arg(long, default_value_t = 128)]
    cells: u32,
    /// Cells along each edge for the table of frame sizes.
    #[arg(long, value_delimiter = ',', default_value = "32,64,128,256")]
    frame: Vec<u32>,
    /// Also write every variant's figures as CSV.
    #[arg(long)]
    csv: Option<PathBuf>,
}

fn run_optimisations(args: &OptimisationsArgs) -> Result<(), CompareError> {
    let options = optimisations::Options {
        scenes: args.scenes.clone(),
        samples: args.samples,
        size: args.size,
        receivers: args.receivers,
        seed: args.seed,
        threads: args.threads.max(1),
        repeat: args.repeat,
        cells: args.cells,
        frame: args.frame.clone(),
    };
    let mut lines = Vec::new();
    for scene in &args.scene {
        lines.push(match args.samples {
            ..=32 => optimisations::optimisations::<u32>(scene, &options)?,
            _ => optimisations::optimisations::<u64>(scene, &options)?,
        });
    }
    print!("{}", optimisations::markdown(&lines, args.cells));
    if let Some(path) = &args.csv {
        std::fs::write(path, optimisations::csv(&lines, args.cells))?;
    }
    Ok(())
}

fn run(args: &CompareArgs) -> Result<(), CompareError> {
    let options = args.options();
    let mut lines = Vec::new();
    for scene in &args.scene {
        lines.extend(match options.samples {
            ..=32 => compare::<u32>(scene, &options)?,
            _ => compare::<u64>(scene, &options)?,
        });
    }
    print!("{}", table::markdown(&lines));
    if let Some(path) = &args.csv {
        std::fs::write(path, table::csv(&lines))?;
    }
    Ok(())
}

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Compare(args) => run(&args),
        Command::Optimisations(args) => run_optimisations(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("umbra4-bench: {error}");
            ExitCode::from(2)
        }
    }
}
