//! The scenes and their settings: model, light and camera, fitted once and the same in every run.
//!
//! Lights are those of the paper (Wang et al. 2016, section 5 and table 5) in proportion. Its Dragon scene has a diagonal
//! of 58, the centre of its light lies 32 away from the scene's centre, and the light rectangle's diagonal is 3 unless
//! table 5 says otherwise (1 to 5). Here lights are squares whose diagonal is 3/58 of the scene's:
//!
//! | scene | its diagonal | of what | light's edge | light's distance |
//! |---|--:|---|--:|---|
//! | dragons | 0.266 | the model's own box, whose floor goes on as a ground plane | 0.0097 | 0.147 (32/58 of the diagonal) |
//! | sponza | 41.6 | the atrium's box | 1.52 | inside, 7.5 above the floor |
//!
//! The paper does not say how much ground its diagonal contains. The dragon's own box makes light and distance the
//! smallest that can be meant; the light's size as seen from the dragon, 3/32 of a radian, is the same in any case.

use std::path::Path;

use thiserror::Error;
use umbra4::{
    in_file::InFile,
    model::{Model, ModelError, load},
};
use umbra4_core::{AreaLight, Bounds, LightError, glam::DVec3};

use crate::primary::Camera;

/// The paper's dragon scene: its diagonal.
const PAPER_DIAGONAL: f64 = 58.0;

/// The paper's dragon scene: distance between the centres of light and scene.
const PAPER_DISTANCE: f64 = 32.0;

/// The paper's diagonal of the light rectangle, where it does not vary it.
pub const PAPER_LIGHT: f64 = 3.0;

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
    #[error("{source} (bench/fetch-scenes.sh fetches the scenes)")]
    Load {
        /// What is wrong with it, and in which file.
        source: InFile<ModelError>,
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

/// A square or parallelogram that shines towards `edge_u × edge_v`.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Its corner, world.
    pub corner: DVec3,
    /// Its edge along the columns.
    pub edge_u: DVec3,
    /// Its edge along the rows.
    pub edge_v: DVec3,
}

impl Lamp {
    /// The lamp around a point.
    fn around(center: DVec3, edge_u: DVec3, edge_v: DVec3) -> Self {
        Self { corner: center - (edge_u + edge_v) * 0.5, edge_u, edge_v }
    }

    /// With `samples` × `samples`.
    ///
    /// # Errors
    /// A number of samples that no light can have.
    pub fn light(&self, samples: u32) -> Result<AreaLight, LightError> {
        AreaLight::new(self.corner, self.edge_u, self.edge_v, samples, samples)
    }
}

/// A scene to render: everything but the resolution.
#[derive(Clone, Debug)]
pub struct Scene {
    /// All triangles; they block light and are seen.
    pub model: Model,
    /// What the light is proportioned to: the model's box, without the ground added to it.
    pub extent: Bounds,
    /// The lamp behind the light.
    pub lamp: Lamp,
    /// The light.
    pub light: AreaLight,
    /// The camera whose primary hits are the receivers.
    pub camera: Camera,
}

impl Scene {
    fn new(model: Model, extent: Bounds, lamp: Lamp, camera: Camera, samples: u32) -> Result<Self, SceneError> {
        Ok(Self { model, extent, lamp, light: lamp.light(samples)?, camera })
    }

    /// Replaces the light by one with `samples` × `samples`.
    ///
    /// # Errors
    /// A number of samples that no light can have.
    pub fn with_samples(self, samples: u32) -> Result<Self, SceneError> {
        Ok(Self { light: self.lamp.light(samples)?, ..self })
    }

    /// The light's setting, for the reader of a table.
    pub fn setting(&self) -> String {
        let (edge, distance) = (self.lamp.edge_u.length(), self.light.center().distance(self.extent.center()));
        let diagonal = diagonal(self.extent);
        format!("scene diagonal {diagonal:.4}, light edge {edge:.4}, {distance:.4} from the centre")
    }
}

fn diagonal(extent: Bounds) -> f64 {
    extent.min.distance(extent.max)
}

/// Names of all scenes.
pub fn names() -> impl Iterator<Item = &'static str> {
    SCENES.into_iter().map(|(name, ..)| name)
}

fn known(name: &str) -> Result<(&'static str, usize), SceneError> {
    let found = SCENES.into_iter().find(|(known, ..)| *known == name);
    found.map(|(_, file, count)| (file, count)).ok_or_else(|| SceneError::Unknown { name: name.to_owned() })
}

/// Whether the model's file is there.
///
/// # Errors
/// An unknown name.
pub fn is_there(name: &str, directory: &Path) -> Result<bool, SceneError> {
    Ok(directory.join(known(name)?.0).exists())
}

/// Loads the scene called `name` from `directory`, with a light of `samples` × `samples` whose diagonal is
/// `paper_light` of the paper's units ([`PAPER_LIGHT`] unless it is varied).
///
/// # Errors
/// An unknown name; a model that cannot be read or is another one; a light that cannot be.
pub fn scene(name: &str, directory: &Path, samples: u32, paper_light: f64) -> Result<Scene, SceneError> {
    let (file, expected) = known(name)?;
    let model = load(&directory.join(file)).map_err(|source| SceneError::Load { source })?;
    if model.triangles.len() != expected {
        return Err(SceneError::Triangles { file, found: model.triangles.len(), expected });
    }
    let extent = model.bounds();
    // The edge of a square from its diagonal.
    let edge = paper_light / PAPER_DIAGONAL * diagonal(extent) * std::f64::consts::FRAC_1_SQRT_2;
    if name == "sponza" { sponza(model, extent, edge, samples) } else { dragon(model, extent, edge, samples) }
}

/// The dragon on a ground plane; the light above and beside it, facing it.
fn dragon(mut model: Model, extent: Bounds, edge: f64, samples: u32) -> Result<Scene, SceneError> {
    let (center, diagonal) = (extent.center(), diagonal(extent));
    add_ground(&mut model, center, extent.min.y, 2.5 * diagonal);

    let away = DVec3::new(-0.45, 0.8, 0.4).normalize();
    // edge_u × edge_v points back at the dragon.
    let edge_v = DVec3::Y.cross(away).normalize() * edge;
    let edge_u = edge_v.normalize().cross(-away) * edge;
    let lamp = Lamp::around(center + away * (PAPER_DISTANCE / PAPER_DIAGONAL * diagonal), edge_u, edge_v);

    let eye = center + DVec3::new(0.25, 0.55, 1.0).normalize() * 1.2 * diagonal;
    let target = center + DVec3::new(0.04, -0.06, 0.0) * diagonal;
    let camera = Camera { eye, target, vertical_degrees: 40.0 };
    Scene::new(model, extent, lamp, camera, samples)
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
fn sponza(model: Model, extent: Bounds, edge: f64, samples: u32) -> Result<Scene, SceneError> {
    let lamp = Lamp::around(DVec3::new(0.0, 7.5, 0.0), DVec3::X * edge, DVec3::Z * edge);
    debug_assert!(lamp.edge_u.cross(lamp.edge_v).y < 0.0, "the light shines down");
    let camera = Camera { eye: DVec3::new(-9.5, 5.0, 0.7), target: DVec3::new(2.0, 2.2, -0.3), vertical_degrees: 60.0 };
    Scene::new(model, extent, lamp, camera, samples)
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
    let extent = model.bounds();
    let corner = DVec3::new(-0.6, 4.0, -0.4);
    let lamp = Lamp { corner, edge_u: DVec3::X * 1.1, edge_v: DVec3::new(0.0, 0.1, 1.2) };
    let camera = Camera { eye: DVec3::new(0.5, 3.0, 5.0), target: DVec3::Y * 0.4, vertical_degrees: 50.0 };
    #[expect(clippy::unwrap_used, reason = "a light with an area")]
    Scene::new(model, extent, lamp, camera, samples).unwrap()
}
