//! The scene that needs no file: a small court with a colonnade, a truss arch, trees, steps and spheres.
//!
//! Made by code from fixed numbers, so that it is the same on every run. Units are metres, y is up.

mod builder;
mod colonnade;
mod ground;
mod random;
mod spheres;
mod steps;
mod tree;
mod truss;

use umbra4_core::glam::{DVec3, Vec3};

use crate::{
    camera::{Camera, CameraError, Viewpoint},
    light_file::LightShape,
    model::Model,
};
use builder::Builder;

/// A model with its colours, and the camera and light that suit it.
#[derive(Clone, Debug)]
pub struct BuiltinScene {
    /// All triangles.
    pub model: Model,
    /// Linear reflectance of every triangle.
    pub colors: Vec<Vec3>,
    /// Light, above on the left.
    pub light: LightShape,
}

/// Vertical angle of view, degrees.
pub const FOV: f64 = 30.0;

impl BuiltinScene {
    /// The middle of the court.
    pub const FOCUS: DVec3 = DVec3::new(0.35, 1.0, 0.0);
    /// Where the camera that was fitted by hand stands.
    pub const EYE: DVec3 = DVec3::new(2.2, 6.9, 17.8);
    /// What it looks at.
    pub const TARGET: DVec3 = DVec3::new(0.1, 1.55, 0.0);
    /// Distance from the middle at which the plain has faded into the backdrop.
    pub const FADE: f64 = 19.0;

    /// Builds the scene.
    pub fn new() -> Self {
        let mut builder = Builder::default();
        ground::build(&mut builder);
        colonnade::build(&mut builder);
        truss::build(&mut builder);
        tree::build(&mut builder);
        steps::build(&mut builder);
        spheres::build(&mut builder);
        let (model, colors) = builder.finish();
        Self { model, colors, light: light() }
    }

    /// The camera that was fitted by hand; what is given is kept.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn camera(given: Viewpoint) -> Result<Camera, CameraError> {
        let from = given.from.unwrap_or(Self::EYE);
        Camera::new(from, given.to.unwrap_or(Self::TARGET), given.fov.unwrap_or(FOV))
    }
}

impl Default for BuiltinScene {
    fn default() -> Self {
        Self::new()
    }
}

/// A window of 2.6 m × 2.6 m, up on the left, that faces the middle of the court.
fn light() -> LightShape {
    let (center, target) = (DVec3::new(-7.6, 11.2, 3.6), DVec3::new(0.8, 0.3, 0.2));
    let towards = (target - center).normalize();
    let u = towards.cross(DVec3::Y).normalize() * 2.6;
    let v = towards.cross(u);
    let corner = center - (u + v) * 0.5;
    LightShape { corner: corner.to_array(), edge_u: u.to_array(), edge_v: v.to_array() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_is_the_same_on_every_run_and_well_formed() {
        let (scene, again) = (BuiltinScene::new(), BuiltinScene::new());
        assert_eq!(scene.model, again.model);
        assert_eq!(scene.colors.len(), scene.model.triangles.len());
        assert!((50_000..=200_000).contains(&scene.colors.len()), "{} triangles", scene.colors.len());
        let vertices = scene.model.vertices.len() as u32;
        assert!(scene.model.triangles.iter().flatten().all(|&v| v < vertices));
        assert!(scene.model.vertices.iter().all(|v| v.is_finite()));
    }

    #[test]
    fn the_light_shines_on_the_court() {
        let light = BuiltinScene::new().light;
        let [corner, u, v] = [light.corner, light.edge_u, light.edge_v].map(DVec3::from_array);
        assert!(u.cross(v).dot(DVec3::ZERO - corner) > 0.0);
    }
}
