//! Shadow maps, drawn anew for every run as an engine does for every frame: what is cheaper than exact masks, or should be.

use std::time::Instant;

use umbra4_cpu::maps::{
    Technique,
    microquad::{MapOptions, MicroquadOptions},
    stochastic::StochasticOptions,
};

use crate::{
    error::ProgramError,
    executor::{AnyExecutor, Report},
    report::{
        methods::{Family, Method, Run},
        problem::Problem,
        tiles::Choice,
    },
};

/// Texels of the maps, each way.
pub const SIZES: [u32; 4] = [128, 256, 512, 1024];

/// Light samples of microquads' masks, each way: the most that the paper has.
const SAMPLES: u32 = 32;

/// A technique with maps of one size.
pub struct ShadowMaps {
    family: Family,
    size: u32,
    technique: Technique,
    executor: AnyExecutor,
    all: Choice,
}

impl ShadowMaps {
    /// The technique of a family that [is one of maps](Family::is_map), with maps of `size` × `size` texels: microquads and
    /// microtris by exact rows; or a stochastic map, filtered on four planes.
    pub fn new(problem: &Problem, family: Family, size: u32, executor: AnyExecutor) -> Self {
        let technique = match family {
            Family::StochasticMaps | Family::GpuStochasticMaps => {
                Technique::Stochastic(StochasticOptions { size, ..StochasticOptions::default() })
            }
            _ => {
                let map = MapOptions { size, ..MapOptions::default() };
                Technique::Microquads(MicroquadOptions { map, ..MicroquadOptions::default() })
            }
        };
        Self { family, size, technique, executor, all: Choice::everyone(problem.receivers()) }
    }
}

impl Method for ShadowMaps {
    fn family(&self) -> Family {
        self.family
    }

    fn side(&self) -> u32 {
        self.size
    }

    fn choice(&self) -> &Choice {
        &self.all
    }

    /// From the world to visibility. Receivers have their normals: maps leak light through the surface that they lie on.
    fn run(&self, problem: &Problem) -> Result<Vec<Run>, ProgramError> {
        let start = Instant::now();
        let snapped = problem.snapped(&problem.light(SAMPLES)?)?;
        let receivers = problem.facing(snapped.receivers)?;
        let mut report = Report::default();
        report.add_stage("snap", start.elapsed().as_secs_f64());
        let (visibility, stages) =
            self.executor.visibility_by(&self.technique, (&snapped.occluders, &snapped.light, &receivers))?;
        report.add(&stages);
        Ok(vec![Run { counts: None, ..Run::of_umbra(visibility, 1, report) }])
    }
}
