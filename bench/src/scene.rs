//! The scenes and their settings: model, light and camera, fitted once and the same in every run.

use std::path::Path;

use thiserror::Error;
use umbra4_core::{AreaLight, Bounds, LightError, glam::DVec3};

use crate::{
    load::{LoadError, Model, load},
    primary::Camera,
};

/// Edge of the dragon's light over its distance from the model's centre.
const DRAGON_LIGHT_SHARE: f64 = 0.3;

/// Edge of Sponza's light, world units (the atrium is 23 × 6.5 units wide and 15.5 high).
const SPONZA_LIGHT_EDGE: f64 = 1.75;

/// Name, file and number of triangles of every scene.
const SCENES: [(&str, &str, usize); 5] = [
    ("dragon11k", "dragon_vrip_res4.ply.gz", 11_102),
    ("dragon48k", "dragon_vrip_res3.ply.gz", 47_794),
    ("dragon203k", "dragon_vrip_res2.ply.gz", 202_520),
    ("dragon871k", "dragon_vrip.ply.gz", 871_414),
    ("sponza", "sponza.obj", 66_450),
];

/// Why a scene cannot be set up.
#[derive(Debug, Error)]
pub enum SceneError {
    /// There is no such scene.
    #[error("no scene is called {name}; there are dragon11k, dragon48k, dragon203k, dragon871k and sponza")]
    Unknown {
        /// The name asked for.
        name: String,
    },
    /// The model cannot be read.
    #[error("{file}: {source} (bench/fetch-scenes.sh fetches the scenes)")]
    Load {
        /// The model's file name.
        file: &'static str,
        /// What is wrong with it.
        source: LoadError,
    },
    /// The model is not the one that the figures are about.
    #[error("{file} has {found} triangles instead of {expected}")]
    Triangles {
        /// The model's file name.
        file: &'static str,
        /// Triangles in it.
        found: usize,
        /// Triangles that it should have.
        expected: usize,
    },
    /// The light is refused.
    #[error(transparent)]
    Light(#[from] LightError),
}

/// A scene to render: everything but the resolution.
#[derive(Clone, Debug)]
pub struct Scene {
    /// All triangles; they block light and are seen.
    pub model: Model,
    /// The light.
    pub light: AreaLight,
    /// The camera whose primary hits are the receivers.
    pub camera: Camera,
}

/// Loads the scene called `name` from `directory`, with a light of `samples` × `samples`.
///
/// # Errors
/// An unknown name; a model that cannot be read or is another one; a number of samples that no light can have.
pub fn scene(name: &str, directory: &Path, samples: u32) -> Result<Scene, SceneError> {
    let found = SCENES.into_iter().find(|(known, ..)| *known == name);
    let (_, file, expected) = found.ok_or_else(|| SceneError::Unknown { name: name.to_owned() })?;
    let model = load(&directory.join(file)).map_err(|source| SceneError::Load { file, source })?;
    if model.triangles.len() != expected {
        return Err(SceneError::Triangles { file, found: model.triangles.len(), expected });
    }
    if name == "sponza" { sponza(model, samples) } else { dragon(model, samples) }
}

/// The dragon on a ground plane; the light above and beside it, about as far as the model is large.
fn dragon(mut model: Model, samples: u32) -> Result<Scene, SceneError> {
    let bounds = Bounds::of(model.vertices.iter().map(|v| v.as_dvec3()));
    let (center, diagonal) = (bounds.center(), bounds.min.distance(bounds.max));
    add_ground(&mut model, center, bounds.min.y, 2.5 * diagonal);

    let away = DVec3::new(-0.45, 0.8, 0.4).normalize();
    let edge = DRAGON_LIGHT_SHARE * diagonal;
    // edge_u × edge_v points back at the dragon.
    let edge_v = DVec3::Y.cross(away).normalize() * edge;
    let edge_u = edge_v.normalize().cross(-away) * edge;
    let corner = center + away * diagonal - (edge_u + edge_v) * 0.5;
    let light = AreaLight::new(corner, edge_u, edge_v, samples, samples)?;

    let eye = center + DVec3::new(0.25, 0.55, 1.0).normalize() * 1.2 * diagonal;
    let target = center + DVec3::new(0.04, -0.06, 0.0) * diagonal;
    let camera = Camera { eye, target, vertical_degrees: 40.0 };
    Ok(Scene { model, light, camera })
}

/// Two triangles under the model.
fn add_ground(model: &mut Model, center: DVec3, height: f64, half: f64) {
    let first = model.vertices.len() as u32;
    for (x, z) in [(-half, -half), (-half, half), (half, half), (half, -half)] {
        model.vertices.push(DVec3::new(center.x + x, height, center.z + z).as_vec3());
    }
    model.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// The atrium, with the light hanging in it at half its height, shining down; the camera looks along it.
fn sponza(model: Model, samples: u32) -> Result<Scene, SceneError> {
    let edge = SPONZA_LIGHT_EDGE;
    let center = DVec3::new(0.0, 7.5, 0.0);
    let (edge_u, edge_v) = (DVec3::X * edge, DVec3::Z * edge);
    let light = AreaLight::new(center - (edge_u + edge_v) * 0.5, edge_u, edge_v, samples, samples)?;
    debug_assert!(edge_u.cross(edge_v).y < 0.0, "the light shines down");
    let camera = Camera { eye: DVec3::new(-9.5, 5.0, 0.7), target: DVec3::new(2.0, 2.2, -0.3), vertical_degrees: 60.0 };
    Ok(Scene { model, light, camera })
}

/// A small scene made by code, for tests: a leaning fan of triangles over a ground plane.
#[cfg(test)]
pub fn tiny(samples: u32) -> Scene {
    use umbra4_core::glam::Vec3;

    let mut model = Model::default();
    for i in 0..12_u8 {
        let a = f32::from(i) * 0.55;
        let base = Vec3::new(a.cos(), 0.3 + 0.07 * f32::from(i), a.sin());
        let first = model.vertices.len() as u32;
        model.vertices.extend([base, base + Vec3::new(0.4, 0.3, -0.2), base + Vec3::new(-0.1, 0.5, 0.37)]);
        model.triangles.push([first, first + 1, first + 2]);
    }
    add_ground(&mut model, DVec3::ZERO, 0.0, 4.0);
    let corner = DVec3::new(-0.6, 4.0, -0.4);
    #[expect(clippy::unwrap_used, reason = "a light with an area")]
    let light = AreaLight::new(corner, DVec3::X * 1.1, DVec3::new(0.0, 0.1, 1.2), samples, samples).unwrap();
    let camera = Camera { eye: DVec3::new(0.5, 3.0, 5.0), target: DVec3::Y * 0.4, vertical_degrees: 50.0 };
    Scene { model, light, camera }
}
