//! The scenes that need no file: a small court, a grove of cut-out leaves, and a window of stained glass.
//!
//! Made by code from fixed numbers, so that they are the same on every run. Units are metres, y is up.

mod builder;
mod colonnade;
mod court;
mod foliage;
mod ground;
mod leaf_texture;
mod random;
mod rosette;
mod spheres;
mod stained_glass;
mod steps;
mod tree;
mod truss;

use clap::ValueEnum;
use umbra4_core::glam::{DVec3, Vec3};

use crate::{
    camera::{Camera, CameraError, Viewpoint},
    light_file::LightShape,
    model::{Model, Parts},
};
use builder::Builder;

/// Names of the scenes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Builtin {
    /// A court with a colonnade, a truss arch, trees, steps and spheres; all of it blocks light
    #[default]
    Court,
    /// Trees and bushes whose leaves are cut out of cards by a texture
    Foliage,
    /// A window of panes of many colours, whose light falls on a floor
    StainedGlass,
}

/// A model with its colours, and the camera and light that suit it.
#[derive(Clone, Debug)]
pub struct BuiltinScene {
    /// All triangles.
    pub model: Model,
    /// How they cast and receive shadows.
    pub parts: Parts,
    /// Linear reflectance of every triangle.
    pub colors: Vec<Vec3>,
    /// Its light.
    pub light: LightShape,
    /// How it is seen.
    pub view: View,
}

/// How a scene is seen, fitted by hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the camera stands.
    pub eye: DVec3,
    /// What it looks at.
    pub target: DVec3,
    /// Vertical angle of view, degrees.
    pub fov: f64,
    /// Middle of what is shown.
    pub focus: DVec3,
    /// Distance from the middle at which the plain has faded into the backdrop.
    pub fade: f64,
}

/// Vertical angle of view of the court, degrees.
pub const FOV: f64 = 30.0;

impl Builtin {
    /// Builds the scene.
    pub fn scene(self) -> BuiltinScene {
        match self {
            Self::Court => court::scene(),
            Self::Foliage => foliage::scene(),
            Self::StainedGlass => stained_glass::scene(),
        }
    }
}

impl BuiltinScene {
    /// The middle of the court.
    pub const FOCUS: DVec3 = DVec3::new(0.35, 1.0, 0.0);
    /// Where the camera that was fitted to the court by hand stands.
    pub const EYE: DVec3 = DVec3::new(2.2, 6.9, 17.8);
    /// What it looks at.
    pub const TARGET: DVec3 = DVec3::new(0.1, 1.55, 0.0);
    /// Distance from the middle of the court at which the plain has faded into the backdrop.
    pub const FADE: f64 = 19.0;

    /// Builds the court.
    pub fn new() -> Self {
        Builtin::Court.scene()
    }

    /// Its camera; what is given is kept.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn camera(&self, given: Viewpoint) -> Result<Camera, CameraError> {
        let View { eye, target, fov, .. } = self.view;
        Camera::new(given.from.unwrap_or(eye), given.to.unwrap_or(target), given.fov.unwrap_or(fov))
    }

    fn of(builder: Builder, light: LightShape, view: View) -> Self {
        let (model, parts, colors) = builder.finish();
        Self { model, parts, colors, light, view }
    }
}

impl Default for BuiltinScene {
    fn default() -> Self {
        Self::new()
    }
}

/// A square window of that size with its middle at `center`, that faces `target`.
fn window(center: DVec3, target: DVec3, size: f64) -> LightShape {
    let towards = (target - center).normalize();
    let u = towards.cross(DVec3::Y).normalize() * size;
    let v = towards.cross(u);
    let corner = center - (u + v) * 0.5;
    LightShape { corner: corner.to_array(), edge_u: u.to_array(), edge_v: v.to_array() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Surface;

    #[test]
    fn scenes_are_the_same_on_every_run_and_well_formed() {
        for (name, triangles) in [
            (Builtin::Court, 50_000..=200_000),
            (Builtin::Foliage, 10_000..=100_000),
            (Builtin::StainedGlass, 500..=20_000),
        ] {
            let (scene, again) = (name.scene(), name.scene());
            assert_eq!((&scene.model, &scene.parts), (&again.model, &again.parts));
            assert_eq!(scene.colors.len(), scene.model.triangles.len());
            assert!(triangles.contains(&scene.colors.len()), "{name:?}: {} triangles", scene.colors.len());
            let vertices = scene.model.vertices.len() as u32;
            assert!(scene.model.triangles.iter().flatten().all(|&v| v < vertices));
            assert!(scene.model.vertices.iter().all(|v| v.is_finite()));
            for part in scene.parts.iter().filter(|part| part.surface.is_textured()) {
                assert_eq!(part.coordinates.len(), part.vertices.len(), "{}", part.label);
            }
        }
    }

    #[test]
    fn lights_shine_on_what_is_shown() {
        for name in [Builtin::Court, Builtin::Foliage, Builtin::StainedGlass] {
            let BuiltinScene { light, view, .. } = name.scene();
            let [corner, u, v] = [light.corner, light.edge_u, light.edge_v].map(DVec3::from_array);
            assert!(u.cross(v).dot(view.focus - corner) > 0.0);
        }
    }

    #[test]
    fn surfaces_are_what_the_names_say() {
        assert!(BuiltinScene::new().parts.is_plain());
        let leaves = Builtin::Foliage.scene().parts;
        let cards: usize = leaves.iter().filter(|part| part.surface.is_textured()).map(|p| p.triangles.len() / 2).sum();
        assert!((2_000..=9_000).contains(&cards), "{cards} cards");
        let panes = Builtin::StainedGlass.scene().parts;
        assert!(panes.iter().filter(|part| part.surface.is_tinted()).count() >= 6);
        assert!(panes.iter().any(|part| matches!(part.surface, Surface::Stained(_))));
    }
}
