//! The command `gpu`: its arguments, and what it prints.

use std::{path::PathBuf, process::ExitCode};

use clap::{Args, ValueEnum};
use umbra4::args::PrecisionArg;
use umbra4_wgpu::{Choice, Gpu, Loading};

use crate::{
    gpu::{GpuBenchError, Options, compare},
    gpu_table::{MOST_DIFFERING, csv, markdown},
    image_size::ImageSize,
    scene::PAPER_LIGHT,
};

/// Names of the ways to load kernels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum LoadingArg {
    /// With wgpu's checks: every backend
    #[default]
    Checked,
    /// As they are: Vulkan only; the rival goes without checks too
    Passthrough,
}

/// Arguments of the command.
#[derive(Args)]
pub struct GpuArgs {
    /// Where bench/fetch-scenes.sh put the models.
    #[arg(long, default_value = "target/scenes")]
    scenes: PathBuf,
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(long, value_delimiter = ',', default_value = "dragon48k,dragon203k,dragon871k,sponza")]
    scene: Vec<String>,
    /// Sizes of the image, WIDTHxHEIGHT in pixels.
    #[arg(long, value_delimiter = ',', default_value = "512x512,1024x1024,1920x1080")]
    sizes: Vec<ImageSize>,
    /// Rows and columns of the light's samples.
    #[arg(long, value_delimiter = ',', default_value = "8,16,32,64", value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: Vec<u32>,
    /// Precisions of umbra4.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "exact,fast")]
    precision: Vec<PrecisionArg>,
    /// A part of the adapter's name; unless it is given, a GPU and no software driver is taken.
    #[arg(long)]
    adapter: Option<String>,
    /// How kernels reach the driver.
    #[arg(long, value_enum, default_value_t)]
    loading: LoadingArg,
    /// Runs of everybody; they are interleaved, and the least times count.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Diagonal of the light in the paper's units (its table 5: 1 to 5).
    #[arg(long, default_value_t = PAPER_LIGHT, value_parser = crate::shared_args::light_scale)]
    light_scale: f64,
    /// Measure the rival on about so many receivers, in whole 8×8 image tiles, and scale its time.
    #[arg(long, default_value_t = usize::MAX, hide_default_value = true)]
    rival_receivers: usize,
    /// Run umbra4 alone.
    #[arg(long)]
    no_rival: bool,
    /// Chooses the tiles.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Also write the figures as CSV.
    #[arg(long)]
    csv: Option<PathBuf>,
}

impl GpuArgs {
    fn options(&self) -> Options {
        Options {
            scenes: self.scenes.clone(),
            names: self.scene.clone(),
            sizes: self.sizes.clone(),
            samples: self.samples.clone(),
            precisions: self.precision.iter().map(|&precision| precision.into()).collect(),
            loading: match self.loading {
                LoadingArg::Checked => Loading::Checked,
                LoadingArg::Passthrough => Loading::Passthrough,
            },
            light: self.light_scale,
            repeat: self.repeat,
            rival: !self.no_rival,
            rival_receivers: self.rival_receivers,
            seed: self.seed,
        }
    }

    /// Runs the command. What was measured is printed also where something fails later; the exit code is 1 where too many
    /// bits differ from the rival's.
    ///
    /// # Errors
    /// No such adapter or scene; a device that fails; a file that cannot be written.
    pub fn run(&self) -> Result<ExitCode, GpuBenchError> {
        let gpu = Gpu::open(&self.adapter.clone().map_or(Choice::Hardware, Choice::Named))?;
        let mut lines = Vec::new();
        let done = compare(&gpu, &self.options(), &mut lines);
        if !lines.is_empty() {
            print!("{}", markdown(&gpu, &lines));
            if let Some(path) = &self.csv {
                std::fs::write(path, csv(&gpu, &lines))?;
            }
        }
        done?;
        if lines.iter().any(|line| line.is_wrong()) {
            eprintln!(
                "umbra4-bench: more than {MOST_DIFFERING} of the bits differ from the rival's: one of the two is wrong"
            );
            return Ok(ExitCode::from(1));
        }
        Ok(ExitCode::SUCCESS)
    }
}
