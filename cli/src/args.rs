//! The command line.

use std::path::PathBuf;

use clap::{Args as ClapArgs, Parser, Subcommand, ValueEnum};
use umbra4_core::{Precision, glam::DVec3};

use crate::{
    builtin::Builtin,
    camera::Viewpoint,
    light::{HardLight, Light},
};

/// Options of lights with an area.
const AREA_OPTIONS: [&str; 5] = ["light", "light_size", "light_distance", "samples", "jitter"];

/// Exact soft shadows of area lights. Without a command: renders a built-in scene to umbra4.png.
#[derive(Debug, Parser)]
#[command(version)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a model or a scene with the exact soft shadows of its lights
    Render(Box<RenderArgs>),
    /// Write the occlusion mask of every receiver, one bit a light sample
    Masks(MasksArgs),
    /// Measure what accuracy costs, for every way to buy it, on one page
    Report(Box<ReportArgs>),
    /// Show what this machine offers and what would run
    Info(InfoArgs),
}

/// Size of the picture.
#[derive(Clone, Debug, ClapArgs)]
pub struct SizeArgs {
    /// Size of the picture, WIDTHxHEIGHT
    #[arg(long, value_parser = size, default_value = "512x512", conflicts_with_all = ["width", "height"])]
    pub size: (u32, u32),
    /// Width of the picture
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=32768))]
    pub width: Option<u32>,
    /// Height of the picture
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=32768))]
    pub height: Option<u32>,
}

impl Default for SizeArgs {
    fn default() -> Self {
        Self { size: (512, 512), width: None, height: None }
    }
}

/// Options of `info`.
#[derive(Clone, Debug, ClapArgs)]
pub struct InfoArgs {
    /// Scene file or model whose lights are planned for [default: an example]
    pub scene: Option<PathBuf>,
    /// Size of the picture that is planned for
    #[command(flatten)]
    pub size: SizeArgs,
}

/// What is shown, and from where.
#[derive(Clone, Debug, Default, ClapArgs)]
pub struct SceneArgs {
    /// Model: .obj, .ply, .ply.gz, .gltf, .glb, or .npy of shape (T, 3, 3); or a scene file, .json
    #[arg(required_unless_present = "builtin", conflicts_with = "builtin")]
    pub model: Option<PathBuf>,
    /// Take a built-in scene instead of a model [default: court]
    #[arg(long, value_name = "SCENE", value_enum, num_args = 0..=1, default_missing_value = "court")]
    pub builtin: Option<Builtin>,
    /// Size of the picture
    #[command(flatten)]
    pub size: SizeArgs,
    /// Where the camera stands [default: fitted to the model]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub camera_from: Option<DVec3>,
    /// What the camera looks at [default: the middle of the model]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub camera_to: Option<DVec3>,
    /// Vertical angle of view, degrees
    #[arg(long, value_name = "DEGREES")]
    pub fov: Option<f64>,
    /// Light: JSON with corner, edge_u and edge_v, three numbers each; shines towards edge_u × edge_v [default: the
    /// model's own, or fitted]
    #[arg(long, value_name = "LIGHT.json")]
    pub light: Option<PathBuf>,
    /// Edge of the fitted light, in diagonals of the model's box [default: 0.25]
    #[arg(long, conflicts_with = "light")]
    pub light_size: Option<f64>,
    /// Distance of the fitted light from the model's middle, in diagonals of the model's box [default: 1]
    #[arg(long, conflicts_with = "light")]
    pub light_distance: Option<f64>,
    /// Leave out the ground under the model
    #[arg(long)]
    pub no_ground: bool,
}

/// Options of `render`.
#[derive(Clone, Debug, ClapArgs)]
pub struct RenderArgs {
    /// What is shown
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Picture to write: .png (tone-mapped) or .exr (linear f32)
    #[arg(short, long)]
    pub output: PathBuf,
    /// What to show of every pixel
    #[arg(long, value_enum, default_value_t = View::Shaded)]
    pub view: View,
    /// Receivers each way in every pixel of the picture: smooths edges
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub oversample: u32,
    /// Light samples each way [default: 32]
    #[arg(long, value_name = "N", value_parser = ["8", "16", "32", "64"])]
    pub samples: Option<String>,
    /// Instead of a light with an area, one infinitely far away, by the direction towards it: hard shadows, on the
    /// processor
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    #[arg(conflicts_with = "lamp", conflicts_with_all = AREA_OPTIONS)]
    pub sun: Option<DVec3>,
    /// The same, a point that shines to all sides
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = AREA_OPTIONS)]
    pub lamp: Option<DVec3>,
    /// Jitter the light samples, others in every frame, and accumulate so many frames: bands become noise, and then
    /// neither
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub jitter: Option<u32>,
    /// How the work is done
    #[command(flatten)]
    pub work: WorkArgs,
}

/// Options of `report`.
#[derive(Clone, Debug, ClapArgs)]
pub struct ReportArgs {
    /// What is shown
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Folder to make: index.html, report.csv, plot.svg and pictures; with the feature plot-png, plot.png
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// What the work is done on
    #[command(flatten)]
    pub machine: MachineArgs,
}

/// Options of `masks`.
#[derive(Clone, Debug, ClapArgs)]
pub struct MasksArgs {
    /// Model: .obj, .ply, .ply.gz, .gltf, .glb, or .npy of float32 (T, 3, 3)
    #[arg(long, value_name = "FILE")]
    pub model: PathBuf,
    /// Light: JSON with corner, edge_u and edge_v, three numbers each; shines towards edge_u × edge_v
    #[arg(long, value_name = "LIGHT.json")]
    pub light: PathBuf,
    /// Receivers: .npy of float32 (R, 3), taken as they are
    #[arg(long, value_name = "R.npy")]
    pub receivers: PathBuf,
    /// Light samples each way, 1 to 64
    #[arg(long, value_name = "N")]
    pub samples: u32,
    /// Jitter the light samples by the pattern of this number [default: regular samples]
    #[arg(long, value_name = "PATTERN", value_parser = clap::value_parser!(u32).range(0..1 << 30))]
    pub jitter: Option<u32>,
    /// Masks: uint16, uint32 or uint64 of shape (R, N), bit j of row i set where sample (i, j) is blocked
    #[arg(short, long, value_name = "MASKS.npy")]
    pub output: PathBuf,
    /// Also write the integers on which the answer is exact: receivers, triangles, origin, step_u, step_v; with
    /// jitter, samples
    #[arg(long, value_name = "L.npz")]
    pub lattice_out: Option<PathBuf>,
    /// Print counts and times as JSON
    #[arg(long)]
    pub stats: bool,
    /// How the work is done
    #[command(flatten)]
    pub work: WorkArgs,
}

/// How the work is done.
#[derive(Clone, Debug, Default, ClapArgs)]
pub struct WorkArgs {
    /// Certified bits, or plain f32
    #[arg(long, value_enum, default_value_t = PrecisionArg::Exact)]
    pub precision: PrecisionArg,
    /// Where the work is done; the bits are the same
    #[arg(long, value_enum, default_value_t = ExecutorArg::Cpu)]
    pub executor: ExecutorArg,
    /// What the work is done on
    #[command(flatten)]
    pub machine: MachineArgs,
}

/// What the work is done on.
#[derive(Clone, Debug, Default, ClapArgs)]
pub struct MachineArgs {
    /// The GPU to take, by a part of its name [default: the best; never a software driver]; with the feature gpu
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Threads [default: all]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum View {
    /// The lit scene
    #[default]
    Shaded,
    /// The fraction of light samples that are seen
    Visibility,
    /// The fractions of red, green and blue that get through, panes and all
    Light,
    /// Umbra, penumbra and lit in false colour
    Penumbra,
    /// How many triangles block something: where the work goes
    Pairs,
}

/// Names of the precisions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PrecisionArg {
    /// Every bit is certified, or decided in integers
    #[default]
    Exact,
    /// Plain f32
    Fast,
}

impl From<PrecisionArg> for Precision {
    fn from(precision: PrecisionArg) -> Self {
        match precision {
            PrecisionArg::Exact => Self::Exact,
            PrecisionArg::Fast => Self::Fast,
        }
    }
}

/// Names of the executors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ExecutorArg {
    /// The processor's threads
    #[default]
    Cpu,
    /// A GPU; with the feature gpu
    Gpu,
    /// A GPU if there is one, else the processor
    Auto,
}

impl SceneArgs {
    /// The built-in scene with all defaults.
    pub fn built_in() -> Self {
        Self { builtin: Some(Builtin::Court), ..Self::default() }
    }

    /// What the scene is called: its file, or that it is built in.
    pub fn name(&self) -> String {
        match &self.model {
            Some(path) => path.display().to_string(),
            None => {
                let name = self.builtin.unwrap_or_default().to_possible_value();
                format!("the built-in scene {}", name.as_ref().map_or("", |name| name.get_name()))
            }
        }
    }

    /// Width and height of the picture.
    pub fn pixels(&self) -> (u32, u32) {
        let SizeArgs { size, width, height } = &self.size;
        (width.unwrap_or(size.0), height.unwrap_or(size.1))
    }

    /// What is said about the camera.
    pub fn viewpoint(&self) -> Viewpoint {
        Viewpoint { from: self.camera_from, to: self.camera_to, fov: self.fov }
    }

    /// The option that gives a light, whatever lights a file has.
    pub fn light_option(&self) -> Option<&'static str> {
        let given = [
            (self.light.is_some(), "--light"),
            (self.light_size.is_some(), "--light-size"),
            (self.light_distance.is_some(), "--light-distance"),
        ];
        given.into_iter().find_map(|(given, option)| given.then_some(option))
    }
}

impl InfoArgs {
    /// The scene that is planned for, if any.
    pub fn scene_args(&self) -> Option<SceneArgs> {
        let model = self.scene.clone()?;
        Some(SceneArgs { model: Some(model), size: self.size.clone(), ..SceneArgs::default() })
    }
}

impl RenderArgs {
    /// The light without extent that is asked for instead of one with an area.
    pub fn hard_light(&self) -> Option<Light> {
        let sun = self.sun.map(|towards| Light::hard("--sun", HardLight::Sun(towards)));
        sun.or(self.lamp.map(|position| Light::hard("--lamp", HardLight::Lamp(position))))
    }

    /// The option that gives a light, whatever lights a file has.
    pub fn light_option(&self) -> Option<&'static str> {
        let hard = self.sun.map(|_| "--sun").or(self.lamp.map(|_| "--lamp"));
        hard.or(self.scene.light_option())
    }

    /// The built-in scene with all defaults: what runs without a command.
    pub fn without_arguments() -> Self {
        Self {
            scene: SceneArgs::built_in(),
            output: "umbra4.png".into(),
            view: View::Shaded,
            oversample: 1,
            samples: None,
            sun: None,
            lamp: None,
            jitter: None,
            work: WorkArgs::default(),
        }
    }
}

fn point(text: &str) -> Result<DVec3, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse::<f64>()).collect();
    match numbers.as_deref() {
        Ok([x, y, z]) => Ok(DVec3::new(*x, *y, *z)),
        _ => Err("expected three numbers, x,y,z".to_owned()),
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |n: &str| n.parse::<u32>().ok().filter(|n| (1..=32768).contains(n));
    text.split_once('x')
        .and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| "expected WIDTHxHEIGHT, each in 1..=32768".to_owned())
}
