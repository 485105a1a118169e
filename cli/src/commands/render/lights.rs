//! The lights that are rendered.

use crate::{args::RenderArgs, error::ProgramError, light::Light, scene::Scene};

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
