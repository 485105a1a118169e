//! The program's built-in scene, with its own light and camera: fine structure, contacts, and a light that is wide and close.

use umbra4::builtin::{BuiltinScene, FOV};
use umbra4_core::glam::DVec3;

use super::{Lamp, Scene, SceneError};
use crate::primary::Camera;

/// Its name.
pub const COURT: &str = "court";

/// The scene, with `samples` × `samples` light samples.
///
/// # Errors
/// A number of samples that no light can have.
pub fn court(samples: u32) -> Result<Scene, SceneError> {
    let BuiltinScene { model, light, .. } = BuiltinScene::new();
    let [corner, edge_u, edge_v] = [light.corner, light.edge_u, light.edge_v].map(DVec3::from_array);
    let camera = Camera { eye: BuiltinScene::EYE, target: BuiltinScene::TARGET, vertical_degrees: FOV };
    let extent = model.bounds();
    Scene::new(model, extent, Lamp { corner, edge_u, edge_v }, camera, samples)
}
