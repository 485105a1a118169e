//! Times umbra4 against ray tracers: same scenes, same receivers, same light, one run.

mod bvh_rival;
mod compare;
mod contender;
mod curves;
mod effects;
#[cfg(feature = "embree")]
mod embree;
mod gpu;
mod gpu_args;
mod gpu_rival;
mod gpu_table;
mod image_size;
mod lookup;
mod maps;
mod memory;
mod optimisations;
mod picture;
mod primary;
mod problem;
mod row_word;
mod scene;
mod shared_args;
mod stages;
mod subset;
mod svg;
mod sweep;
mod table;
mod timing;
#[cfg(all(feature = "tinybvh", target_feature = "avx2"))]
mod tiny_rival;
mod umbra;
mod unsnapped;
mod verify;

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, Parser, Subcommand};
use compare::{CompareError, Comparison, Options, compare};
use curves::CurvesArgs;
use effects::EffectsArgs;
use gpu_args::GpuArgs;
use lookup::LookupArgs;
use maps::MapsArgs;
use memory::{ChildArgs, MemoryArgs};
use scene::PAPER_LIGHT;
use shared_args::{ImageArgs, RivalArgs, light_scale, seconds};
use stages::StagesArgs;
use sweep::SweepArgs;
use umbra::{CALLING_THREAD, bind_calling_thread};
use umbra4_wgpu::Choice;
use verify::{VerifyError, verify};

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
    /// Compares umbra4 with ray tracers on several numbers of samples in one run, and with itself on two threads; prints a
    /// Markdown table.
    Sweep(SweepArgs),
    /// Measures where umbra4's time goes, and how far it is from its floor; prints a Markdown table.
    Stages(StagesArgs),
    /// Measures what each effect costs beside a plain rectangle, and which stages it adds; prints a Markdown table.
    Effects(EffectsArgs),
    /// Measures what shadow maps give and take beside exact masks; prints Markdown tables.
    Maps(MapsArgs),
    /// Measures how umbra4's cost grows with triangles, receivers, the light's size and its samples; writes a .csv and an
    /// .svg a curve, and prints a Markdown table.
    Curves(CurvesArgs),
    /// Measures the peak of resident memory beyond the scene, and prints a Markdown table. Linux only.
    Memory(MemoryArgs),
    /// The process that `memory` measures.
    #[command(name = memory::CHILD, hide = true)]
    MemoryChild(ChildArgs),
    /// Checks the bits of random receivers on all scenes against the oracles, and those of a whole image against one
    /// sample at a time; prints Markdown tables. The exit code is 1 where a bit is wrong.
    Verify(VerifyArgs),
    /// Compares umbra4 on a GPU with a ray tracer on the same GPU, and prints Markdown tables. The exit code is 1 where too
    /// many bits differ.
    Gpu(GpuArgs),
    /// Measures what each of the paper's optimisations pays, and prints Markdown tables.
    Optimisations(OptimisationsArgs),
    /// Compares masks that are looked up by the lines of edges with core's rows, and prints a Markdown table.
    Lookup(LookupArgs),
}

/// Contenders that a plain run compares.
const CONTENDERS: &str = if cfg!(feature = "embree") {
    "umbra4,umbra4-fast,embree8,embree16,embree16-square,obvhs"
} else {
    "umbra4,umbra4-fast,obvhs"
};

#[derive(Args)]
struct CompareArgs {
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(long, value_delimiter = ',', default_value = "dragon48k,dragon203k,sponza")]
    scene: Vec<String>,
    /// `umbra4[-triangles|-silhouette]`, `umbra4-fast`, `obvhs[-cwbvh][-fast|-medium]`, and with their features
    /// `embree{1,8,16}[-high][-robust][-square][-avx2]` and `tinybvh[-high]`.
    #[arg(long, value_delimiter = ',', default_value = CONTENDERS)]
    contenders: Vec<String>,
    /// Rows and columns of the light's samples.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: u32,
    /// Threads of every contender.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Seconds that every contender is measured for, at least; runs are interleaved, and the least times count.
    #[arg(long, default_value_t = 10.0, value_parser = seconds)]
    seconds: f64,
    /// Measure everybody on about so many receivers, in whole 8×8 image tiles.
    #[arg(long, default_value_t = usize::MAX, hide_default_value = true)]
    receivers: usize,
    /// Also write the table as CSV.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Also write the first contender's visibility as a grey .pgm picture (of the last scene).
    #[arg(long)]
    picture: Option<PathBuf>,
    /// Run the first contender alone and once, on the calling thread, for instruction counts (bench/instructions.sh):
    /// `valgrind --tool=callgrind --toggle-collect='*measured_section*' umbra4-bench compare --single-run …`
    #[arg(long)]
    single_run: bool,
    #[command(flatten)]
    image: ImageArgs,
    #[command(flatten)]
    measured: RivalArgs,
}

impl CompareArgs {
    fn options(&self) -> Options {
        let mut contenders = self.contenders.clone();
        if self.single_run {
            contenders.truncate(1);
        }
        Options {
            scenes: self.image.scenes.clone(),
            contenders,
            samples: self.samples,
            size: self.image.size,
            threads: if self.single_run { CALLING_THREAD } else { self.threads.max(1) },
            repeat: if self.single_run { 1 } else { self.measured.repeat },
            seconds: if self.single_run { 0.0 } else { self.seconds },
            light: self.measured.light_scale,
            receivers: self.receivers,
            rival_receivers: self.measured.rival_receivers,
            seed: self.image.seed,
            picture: self.picture.clone(),
        }
    }
}

#[derive(Args)]
struct VerifyArgs {
    /// Where bench/fetch-scenes.sh put the models.
    #[arg(long, default_value = "target/scenes")]
    scenes: PathBuf,
    /// The scenes to verify, where they are there; all of them unless said otherwise.
    #[arg(long, value_delimiter = ',')]
    scene: Vec<String>,
    /// Scenes that have to be there.
    #[arg(long, value_delimiter = ',')]
    require: Vec<String>,
    /// Random receivers a scene: half of them surface points (asked for lifted and raw), half points of its box. As many
    /// again are chosen from penumbrae.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(2..))]
    receivers: u32,
    /// Receivers of each kind that the slow second oracle is asked about.
    #[arg(long, default_value_t = 16)]
    unsnapped: usize,
    /// Edge of the image, in pixels, all of whose points are compared with one sample at a time.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=8192))]
    image: u32,
    /// Diagonal of the light in the paper's units (its table 5: 1 to 5).
    #[arg(long, default_value_t = PAPER_LIGHT, value_parser = light_scale)]
    light_scale: f64,
    /// Compares the masks of this adapter as well: "software", "hardware", or a part of its name.
    #[arg(long)]
    gpu: Option<String>,
    /// Chooses the receivers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl VerifyArgs {
    fn options(&self) -> verify::Options {
        let named = !self.scene.is_empty();
        verify::Options {
            scenes: self.scenes.clone(),
            names: if named { self.scene.clone() } else { scene::names().map(str::to_owned).collect() },
            require: self.require.clone(),
            receivers: self.receivers as usize,
            unsnapped: self.unsnapped,
            image: self.image,
            light: self.light_scale,
            seed: self.seed,
            gpu: self.gpu.as_deref().map(|name| match name {
                "hardware" => Choice::Hardware,
                "software" => Choice::Software,
                name => Choice::Named(name.to_owned()),
            }),
        }
    }
}

#[derive(Args)]
struct OptimisationsArgs {
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(long, value_delimiter = ',', default_value = "dragon48k,dragon203k,sponza")]
    scene: Vec<String>,
    /// Rows and columns of the light's samples.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: u32,
    /// Measure on about so many receivers, in whole 8×8 image tiles.
    #[arg(long, default_value_t = 8192)]
    receivers: usize,
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
    #[command(flatten)]
    image: ImageArgs,
}

fn run_optimisations(args: &OptimisationsArgs) -> Result<(), CompareError> {
    let options = optimisations::Options {
        scenes: args.image.scenes.clone(),
        samples: args.samples,
        size: args.image.size,
        receivers: args.receivers,
        seed: args.image.seed,
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

fn run_compare(args: &CompareArgs) -> Result<(), CompareError> {
    let options = args.options();
    if args.single_run {
        bind_calling_thread().map_err(std::io::Error::other)?;
    }
    let mut lines = Vec::new();
    for scene in &args.scene {
        // The narrowest word that holds a row.
        let Comparison { setting, lines: of_scene } = match options.samples {
            ..=16 => compare::<u16>(scene, &options)?,
            17..=32 => compare::<u32>(scene, &options)?,
            _ => compare::<u64>(scene, &options)?,
        };
        println!("- {setting}");
        lines.extend(of_scene);
    }
    print!("\n{}\n{}", table::markdown(&lines), table::precisions(&lines));
    if let Some(path) = &args.csv {
        std::fs::write(path, table::csv(&lines))?;
    }
    Ok(())
}

fn run_verify(args: &VerifyArgs) -> Result<ExitCode, VerifyError> {
    let report = verify(&args.options())?;
    print!("{}", report.markdown());
    if report.holds() {
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!("umbra4-bench: bits are wrong");
    Ok(ExitCode::from(1))
}

fn main() -> ExitCode {
    let fail = |error: &dyn std::error::Error| {
        eprintln!("umbra4-bench: {error}");
        ExitCode::from(2)
    };
    match Cli::parse().command {
        Command::Compare(args) => run_compare(&args).map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::Sweep(args) => args.run().map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::Effects(args) => args.run().map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::Stages(args) => args.run().map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::Maps(args) => args.run().map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::Curves(args) => args.run().map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::Memory(args) => args.run().map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::MemoryChild(args) => args.run().map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::Verify(args) => run_verify(&args).unwrap_or_else(|e| fail(&e)),
        Command::Gpu(args) => args.run().unwrap_or_else(|e| fail(&e)),
        Command::Optimisations(args) => run_optimisations(&args).map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
        Command::Lookup(args) => args.run().map_or_else(|e| fail(&e), |()| ExitCode::SUCCESS),
    }
}
