//! What is shown, and how: a model, a scene file or the built-in scene, with camera and light given or fitted.

use std::path::Path;

use umbra4_core::glam::{DVec3, Vec3};

use crate::{
    args::SceneArgs,
    builtin::{BuiltinScene, View},
    camera::{Camera, Viewpoint},
    error::ProgramError,
    fit,
    in_file::InFile,
    light::Light,
    light_file::{self, LightShape},
    model::{self, FileLights, Furnished, Model, ModelError, Parts},
    scene_file::{self, SceneFile},
    shade::{self, Look},
};

/// Everything that is shown, and how.
#[derive(Clone, Debug)]
pub struct Scene {
    /// All triangles, the ground included.
    pub model: Model,
    /// How they cast and receive shadows; the ground is none of them.
    pub parts: Parts,
    /// Linear reflectance of every triangle; empty where all are of one colour.
    pub colors: Vec<Vec3>,
    /// Where it is seen from.
    pub camera: Camera,
    /// The light that is given or fitted, without a number of samples.
    pub light: LightShape,
    /// The lights of the file, which are there instead; none where the command line gives one.
    pub lights: Vec<Light>,
    /// Middle of what is shown, world.
    pub focus: DVec3,
    /// Distance from `focus` at which surfaces have faded into the backdrop, world.
    pub fade: f64,
}

const MOST_PIXELS: u64 = 1 << 27;
const LIGHT_SIZE: f64 = 0.25;
const LIGHT_DISTANCE: f64 = 1.0;

/// Whether a picture of so many receivers fits the memory of most machines.
///
/// # Errors
/// It does not.
pub fn check_pixels(width: u32, height: u32) -> Result<(), ProgramError> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MOST_PIXELS { Err(ProgramError::TooManyPixels { pixels, most: MOST_PIXELS }) } else { Ok(()) }
}

impl Scene {
    /// What the command line asks for. `option` is the one that gives a light there, whatever lights a file has.
    ///
    /// # Errors
    /// A file that cannot be read, or that the option does not go with; a camera that looks nowhere.
    pub fn load(args: &SceneArgs, option: Option<&'static str>) -> Result<Self, ProgramError> {
        let shape = args.light.as_deref().map(light_file::read).transpose()?;
        let Some(path) = &args.model else {
            let scene = args.builtin.unwrap_or_default().scene();
            let camera = scene.camera(args.viewpoint())?;
            let BuiltinScene { model, parts, colors, light, view: View { focus, fade, .. } } = scene;
            let light = shape.unwrap_or(light);
            return Ok(Self { model, parts, colors, camera, light, lights: Vec::new(), focus, fade });
        };
        let Setting { mut model, parts, lights, camera, ground } = Setting::load(path, option)?;
        let bounds = model.bounds();
        let camera = fit::camera(bounds, args.viewpoint().or(camera))?;
        let fitted =
            || fit::light(bounds, args.light_size.unwrap_or(LIGHT_SIZE), args.light_distance.unwrap_or(LIGHT_DISTANCE));
        let light = shape.unwrap_or_else(fitted);
        if ground && !args.no_ground {
            model.append(&fit::ground(bounds));
        }
        let fade = fit::FADE * fit::diagonal(bounds);
        Ok(Self { model, parts, colors: Vec::new(), camera, light, lights, focus: bounds.center(), fade })
    }

    /// How its surfaces reflect, and what light of power 1 looks like.
    pub fn look(&self) -> Look<'_> {
        let white = if self.lights.is_empty() { shade::WARM } else { shade::NEUTRAL };
        Look { colors: &self.colors, focus: self.focus, fade: self.fade, white }
    }
}

/// What a file says.
struct Setting {
    model: Model,
    parts: Parts,
    lights: Vec<Light>,
    camera: Viewpoint,
    ground: bool,
}

impl Setting {
    /// Reads a scene file or a model. Lights of models are passed over where an option gives one.
    fn load(path: &Path, option: Option<&'static str>) -> Result<Self, ProgramError> {
        if !scene_file::is_scene_file(path) {
            let lights = if option.is_none() { FileLights::Taken } else { FileLights::PassedOver };
            let Furnished { model, parts, lights, camera } = model::load_furnished(path, lights)?;
            parts.check().map_err(|e| InFile::at(path)(ModelError::from(e)))?;
            return Ok(Self { model, parts, lights, camera: camera.unwrap_or_default(), ground: true });
        }
        if let Some(option) = option {
            return Err(ProgramError::FileLights { option, file: path.display().to_string() });
        }
        let SceneFile { model, ground, camera, casters, lights } = scene_file::read(path)?;
        let Furnished { model, mut parts, camera: own, .. } = model::load_furnished(&model, FileLights::PassedOver)?;
        scene_file::cast(&casters, &mut parts, &model).map_err(InFile::at(path))?;
        Ok(Self { model, parts, lights, camera: camera.or(own.unwrap_or_default()), ground })
    }
}
