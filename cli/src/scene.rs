//! What is shown, and how: a model or the built-in scene, with camera and light given or fitted.

use umbra4_core::glam::{DVec3, Vec3};

use crate::{
    args::SceneArgs,
    builtin::BuiltinScene,
    camera::Camera,
    error::ProgramError,
    fit,
    light_file::{self, LightShape},
    model::{self, Model},
    shade::Look,
};

/// Everything that is shown, and how.
#[derive(Clone, Debug)]
pub struct Scene {
    /// All triangles, the ground included.
    pub model: Model,
    /// Linear reflectance of every triangle; empty where all are of one colour.
    pub colors: Vec<Vec3>,
    /// Where it is seen from.
    pub camera: Camera,
    /// The light, without a number of samples.
    pub light: LightShape,
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
    /// What the command line asks for.
    ///
    /// # Errors
    /// A model or a light that cannot be read; a camera that looks nowhere; a light without area.
    pub fn load(args: &SceneArgs) -> Result<Self, ProgramError> {
        let shape = args.light.as_deref().map(light_file::read).transpose()?;
        let Some(path) = &args.model else {
            let BuiltinScene { model, colors, light } = BuiltinScene::new();
            let camera = BuiltinScene::camera(args.camera_from, args.camera_to, args.fov)?;
            let light = shape.unwrap_or(light);
            return Ok(Self { model, colors, camera, light, focus: BuiltinScene::FOCUS, fade: BuiltinScene::FADE });
        };
        let mut model = model::load(path)?;
        let bounds = model.bounds();
        let camera = fit::camera(bounds, args.camera_from, args.camera_to, args.fov.unwrap_or(fit::FOV))?;
        let fitted =
            || fit::light(bounds, args.light_size.unwrap_or(LIGHT_SIZE), args.light_distance.unwrap_or(LIGHT_DISTANCE));
        let light = shape.unwrap_or_else(fitted);
        if !args.no_ground {
            model.append(&fit::ground(bounds));
        }
        let fade = fit::FADE * fit::diagonal(bounds);
        Ok(Self { model, colors: Vec::new(), camera, light, focus: bounds.center(), fade })
    }

    /// How its surfaces reflect.
    pub fn look(&self) -> Look<'_> {
        Look { colors: &self.colors, focus: self.focus, fade: self.fade }
    }
}
