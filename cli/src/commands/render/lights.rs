//! The lights that are rendered, and what they are rendered on.

use crate::{
    args::{ExecutorArg, RenderArgs, WorkArgs},
    error::ProgramError,
    executor::AnyExecutor,
    light::{Light, Source},
    scene::Scene,
};

/// Samples each way of the light with an area, where none are asked for.
const SAMPLES: u32 = 32;

/// The lights of the file, or the one of the command line.
///
/// # Errors
/// A light without area; a number of samples for lights that have theirs.
pub fn lights_of(args: &RenderArgs, scene: &Scene) -> Result<Vec<Light>, ProgramError> {
    if !scene.lights.is_empty() {
        if args.samples.is_some() {
            let file = args.scene.model.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
            return Err(ProgramError::FileLights { option: "--samples", file });
        }
        return Ok(scene.lights.clone());
    }
    if let Some(light) = args.hard_light() {
        return Ok(vec![light]);
    }
    // clap lets nothing but 8, 16, 32 and 64 through; whatever else is refused by the light.
    let samples = args.samples.as_ref().map_or(SAMPLES, |samples| samples.parse().unwrap_or(0));
    Ok(vec![Light::plain(args.scene.light_option().unwrap_or("the light"), scene.light.sampled(samples)?)])
}

/// The executor that is asked for: GPUs take no lights with a volume.
///
/// # Errors
/// A GPU is asked for, and there is such a light, or no GPU.
pub fn executor_for(work: &WorkArgs, lights: &[Light]) -> Result<AnyExecutor, ProgramError> {
    let volume = lights.iter().find(|light| matches!(light.source, Source::Volume(_)));
    let executor = match (work.executor, volume) {
        (ExecutorArg::Gpu, Some(light)) => {
            let light = format!("{} ({})", light.label, light.kind());
            return Err(ProgramError::NoVolumes { option: "--executor gpu", light });
        }
        (ExecutorArg::Auto, Some(_)) => ExecutorArg::Cpu,
        (executor, _) => executor,
    };
    AnyExecutor::new(&WorkArgs { executor, ..work.clone() })
}
