//! The ways to buy accuracy. One more is one more entry in [`all`].

mod bvh;
mod over_frames;
mod rays;
mod shadow_maps;
mod umbra;

use umbra4_core::Counts;

use crate::{
    args::PrecisionArg,
    error::ProgramError,
    executor::{AnyExecutor, Device, Report},
    report::{problem::Problem, tiles::Choice},
};
use bvh::Bvh;
use over_frames::OverFrames;
use rays::{Pattern, Rays};
use shadow_maps::ShadowMaps;
use umbra::Umbra;
pub use umbra::{REFERENCE_SIDE, reference};

/// Methods that differ in nothing but the number of samples, or of a map's texels: one curve of the plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// umbra4 on the processor, certified.
    CpuExact,
    /// umbra4 on the processor, plain f32.
    CpuFast,
    /// umbra4 on the processor, certified, with jittered samples.
    CpuJittered,
    /// The same, accumulated over frames: they are what the methods differ in.
    CpuFrames,
    /// umbra4 on a GPU, certified.
    GpuExact,
    /// umbra4 on a GPU, plain f32.
    GpuFast,
    /// umbra4 on a GPU, certified, with jittered samples.
    GpuJittered,
    /// Microquads and microtris from a shadow map, on the processor.
    Microquads,
    /// Stochastic soft shadow maps, on the processor.
    StochasticMaps,
    /// Microquads and microtris, on a GPU.
    GpuMicroquads,
    /// Stochastic soft shadow maps, on a GPU.
    GpuStochasticMaps,
    /// Rays to the samples that umbra4 has too.
    RegularRays,
    /// Rays to stratified, jittered samples, other ones for every receiver.
    JitteredRays,
}

impl Family {
    /// All of them, in the order of legends and tables.
    pub const ALL: [Self; 13] = [
        Self::CpuExact,
        Self::CpuFast,
        Self::CpuJittered,
        Self::CpuFrames,
        Self::GpuExact,
        Self::GpuFast,
        Self::GpuJittered,
        Self::Microquads,
        Self::StochasticMaps,
        Self::GpuMicroquads,
        Self::GpuStochasticMaps,
        Self::RegularRays,
        Self::JitteredRays,
    ];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::CpuExact => "umbra4 exact",
            Self::CpuFast => "umbra4 fast",
            Self::CpuJittered => "umbra4 exact, jittered",
            Self::CpuFrames => "umbra4 exact, 8×8 jittered, over frames",
            Self::GpuExact => "umbra4 exact, GPU",
            Self::GpuFast => "umbra4 fast, GPU",
            Self::GpuJittered => "umbra4 exact, jittered, GPU",
            Self::Microquads => "microquads",
            Self::StochasticMaps => "stochastic maps",
            Self::GpuMicroquads => "microquads, GPU",
            Self::GpuStochasticMaps => "stochastic maps, GPU",
            Self::RegularRays => "BVH rays, regular samples",
            Self::JitteredRays => "BVH rays, jittered samples",
        }
    }

    /// Its colour, as CSS writes it: told apart by those who see colours differently, too (Okabe and Ito's).
    pub fn color(self) -> &'static str {
        match self {
            Self::CpuExact => "#0072b2",
            Self::CpuFast => "#56b4e9",
            Self::CpuJittered => "#a87400",
            Self::CpuFrames => "#000000",
            Self::GpuExact => "#007a5a",
            Self::GpuFast => "#3fbf9b",
            Self::GpuJittered => "#7a7a00",
            Self::Microquads => "#5b3fa8",
            Self::StochasticMaps => "#8a8a8a",
            Self::GpuMicroquads => "#9c7fe0",
            Self::GpuStochasticMaps => "#5a5a5a",
            Self::RegularRays => "#d55e00",
            Self::JitteredRays => "#b5527f",
        }
    }

    /// Whether exact masks are what it measures.
    pub fn is_exact(self) -> bool {
        !self.is_rays() && !self.is_map()
    }

    /// Whether it draws a shadow map: its methods differ in the map's texels.
    pub fn is_map(self) -> bool {
        matches!(self, Self::Microquads | Self::StochasticMaps | Self::GpuMicroquads | Self::GpuStochasticMaps)
    }

    /// Whether it is one frame of umbra4 with jittered samples.
    pub fn is_jittered(self) -> bool {
        matches!(self, Self::CpuJittered | Self::GpuJittered)
    }

    /// Whether it traces rays.
    pub fn is_rays(self) -> bool {
        matches!(self, Self::RegularRays | Self::JitteredRays)
    }

    /// The name of one of its methods: unlike any other's.
    pub fn method(self, side: u32, frames: u32) -> String {
        match self {
            Self::CpuFrames => format!("umbra4 exact, {side}×{side} jittered, {frames} frames"),
            Self::JitteredRays => format!("{}, {}", self.name(), side * side),
            _ if self.is_map() => format!("{}, map of {side}×{side}", self.name()),
            _ => format!("{}, {side}×{side}", self.name()),
        }
    }
}

/// What one run of a method gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Visibility of the receivers of the method's [`Choice`], in 0..=1, in its order.
    pub visibility: Vec<f32>,
    /// Frames that were accumulated.
    pub frames: u32,
    /// Names of stages and their seconds; of a method that ran on some receivers, what all would take.
    pub seconds_by_stage: Vec<(String, f64)>,
    /// Those of them, of rays, that come before the first ray, however many there are.
    pub index_seconds: f64,
    /// Pairs and fallbacks; rays have none.
    pub counts: Option<Counts>,
}

impl Run {
    /// Of umbra4: `report` is of all frames.
    pub fn of_umbra(visibility: Vec<f32>, frames: u32, report: Report) -> Self {
        let Report { seconds_by_stage, counts } = report;
        Self { visibility, frames, seconds_by_stage, index_seconds: 0.0, counts: Some(counts) }
    }

    /// All stages.
    pub fn seconds(&self) -> f64 {
        self.seconds_by_stage.iter().map(|(_, seconds)| seconds).sum()
    }
}

/// A way to buy accuracy.
pub trait Method {
    /// The curve that it is on.
    fn family(&self) -> Family;

    /// Light samples a receiver, each way; of shadow maps, their texels.
    fn side(&self) -> u32;

    /// The receivers that it runs on.
    fn choice(&self) -> &Choice;

    /// Most frames that it accumulates.
    fn frames(&self) -> u32 {
        1
    }

    /// Runs it, timed from the world to the visibility of its receivers: once, or, over frames, what it has after some and
    /// after all of them.
    ///
    /// # Errors
    /// Whatever the method refuses.
    fn run(&self, problem: &Problem) -> Result<Vec<Run>, ProgramError>;
}

/// The method whose time is the unit of relative times.
pub const UNIT: (Family, u32) = (Family::CpuExact, 8);

const SIDES: [u32; 4] = [8, 16, 32, 64];
const REGULAR: [u32; 3] = [8, 16, 32];
const JITTERED: [u32; 5] = [2, 4, 8, 16, 32];

fn boxed(method: impl Method + 'static) -> Box<dyn Method> {
    Box::new(method)
}

/// All methods, in the order of tables.
///
/// # Errors
/// A light that no lattice holds.
pub fn all(problem: &Problem, device: &Device) -> Result<Vec<Box<dyn Method>>, ProgramError> {
    let mut methods: Vec<Box<dyn Method>> = Vec::new();
    let precisions = [PrecisionArg::Exact, PrecisionArg::Fast, PrecisionArg::Exact];
    for (precision, family) in precisions.into_iter().zip([Family::CpuExact, Family::CpuFast, Family::CpuJittered]) {
        for side in SIDES {
            methods.push(Box::new(Umbra::new(problem, family, side, AnyExecutor::cpu(precision))));
        }
    }
    methods.push(Box::new(OverFrames::new(problem)));
    for (precision, family) in precisions.into_iter().zip([Family::GpuExact, Family::GpuFast, Family::GpuJittered]) {
        for side in SIDES {
            let executor = device.executor(precision);
            methods.extend(executor.map(|executor| boxed(Umbra::new(problem, family, side, executor))));
        }
    }
    for family in [Family::Microquads, Family::StochasticMaps] {
        for size in shadow_maps::SIZES {
            methods.push(Box::new(ShadowMaps::new(problem, family, size, AnyExecutor::cpu(PrecisionArg::Exact))));
        }
    }
    for family in [Family::GpuMicroquads, Family::GpuStochasticMaps] {
        for size in shadow_maps::SIZES {
            let executor = device.executor(PrecisionArg::Exact);
            methods.extend(executor.map(|executor| boxed(ShadowMaps::new(problem, family, size, executor))));
        }
    }
    let bvh = Bvh::new(problem)?;
    for (pattern, sides) in [(Pattern::Regular, &REGULAR[..]), (Pattern::Jittered, &JITTERED)] {
        for &side in sides {
            methods.push(Box::new(Rays::new(problem, &bvh, pattern, side)?));
        }
    }
    Ok(methods)
}
