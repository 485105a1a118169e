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
//! | foliage | 29.0 | as of the dragons | 1.06 | 16.0 |
//! | lattice | 44.2 | as of the dragons | 1.62 | 24.4 |
//! | hairball | 3.47 | as of the dragons | 0.127 | 1.91 |
//!
//! The paper does not say how much ground its diagonal contains. The dragon's own box makes light and distance the
//! smallest that can be meant; the light's size as seen from the dragon, 3/32 of a radian, is the same in any case.

mod court;
mod foliage;
mod hairball;
mod lattice;
mod place;
mod solids;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tiny;

use std::path::Path;

use thiserror::Error;
use umbra4::{
    in_file::InFile,
    model::{Model, ModelError, load},
};
use umbra4_core::{AreaLight, Bounds, LightError, glam::DVec3};

use crate::primary::Camera;
pub use court::{COURT, court};
use place::{DRAGON_VIEW, FOLIAGE_VIEW, HAIRBALL_VIEW, LATTICE_VIEW, View};
#[cfg(test)]
pub use tiny::tiny;

/// The paper's dragon scene: its diagonal.
const PAPER_DIAGONAL: f64 = 58.0;

/// The paper's dragon scene: distance between the centres of light and scene.
const PAPER_DISTANCE: f64 = 32.0;

/// The paper's diagonal of the light rectangle, where it does not vary it.
pub const PAPER_LIGHT: f64 = 3.0;

/// Where a model comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// A file that is fetched, and its number of triangles.
    File(&'static str, usize),
    /// Code: the same triangles on every run.
    Code(fn() -> Model),
}

/// How light and camera are placed.
#[derive(Clone, Copy, Debug)]
enum Placing {
    /// On a ground plane, the light above and beside the model.
    OnGround(View),
    /// Inside the atrium.
    InAtrium,
}

/// Name, model and placing of every scene.
const SCENES: [(&str, Source, Placing); 8] = [
    ("dragon11k", Source::File("dragon_vrip_res4.ply.gz", 11_102), Placing::OnGround(DRAGON_VIEW)),
    ("dragon48k", Source::File("dragon_vrip_res3.ply.gz", 47_794), Placing::OnGround(DRAGON_VIEW)),
    ("dragon203k", Source::File("dragon_vrip_res2.ply.gz", 202_520), Placing::OnGround(DRAGON_VIEW)),
    ("dragon871k", Source::File("dragon_vrip.ply.gz", 871_414), Placing::OnGround(DRAGON_VIEW)),
    ("sponza", Source::File("sponza.obj", 66_450), Placing::InAtrium),
    ("foliage", Source::Code(foliage::model), Placing::OnGround(FOLIAGE_VIEW)),
    ("lattice", Source::Code(lattice::model), Placing::OnGround(LATTICE_VIEW)),
    ("hairball", Source::Code(hairball::model), Placing::OnGround(HAIRBALL_VIEW)),
];

/// Why a scene cannot be set up.
#[derive(Debug, Error)]
pub enum SceneError {
    /// There is no such scene.
    #[error("no scene is called {name}; there are {}", names().collect::<Vec<_>>().join(", "))]
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

    /// With `rows` × `columns` samples.
    ///
    /// # Errors
    /// A number of samples that no light can have.
    pub fn light(&self, rows: u32, columns: u32) -> Result<AreaLight, LightError> {
        AreaLight::new(self.corner, self.edge_u, self.edge_v, rows, columns)
    }

    /// Its centre.
    fn center(&self) -> DVec3 {
        self.corner + (self.edge_u + self.edge_v) * 0.5
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
        Ok(Self { model, extent, lamp, light: lamp.light(samples, samples)?, camera })
    }

    /// Replaces the light by one with `samples` × `samples`.
    ///
    /// # Errors
    /// A number of samples that no light can have.
    pub fn with_samples(self, samples: u32) -> Result<Self, SceneError> {
        self.with_grid(samples, samples)
    }

    /// Replaces the light by one with `rows` × `columns` samples.
    ///
    /// # Errors
    /// A number of samples that no light can have.
    pub fn with_grid(self, rows: u32, columns: u32) -> Result<Self, SceneError> {
        Ok(Self { light: self.lamp.light(rows, columns)?, ..self })
    }

    /// Replaces the light by one of another size, around the same centre: `paper_light` is its diagonal in the paper's
    /// units.
    ///
    /// # Errors
    /// A size that no light can have.
    pub fn with_light_scale(self, paper_light: f64) -> Result<Self, SceneError> {
        let factor = edge(paper_light, self.extent) / self.lamp.edge_u.length();
        let lamp = Lamp::around(self.lamp.center(), self.lamp.edge_u * factor, self.lamp.edge_v * factor);
        Ok(Self { light: lamp.light(self.light.rows(), self.light.columns())?, lamp, ..self })
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

/// The edge of a square light whose diagonal is `paper_light` of the paper's units, where the model fills `extent`.
fn edge(paper_light: f64, extent: Bounds) -> f64 {
    paper_light / PAPER_DIAGONAL * diagonal(extent) * std::f64::consts::FRAC_1_SQRT_2
}

/// Names of all scenes.
pub fn names() -> impl Iterator<Item = &'static str> {
    SCENES.into_iter().map(|(name, ..)| name)
}

/// Names of the scenes that are made by code.
#[cfg(test)]
fn generated() -> impl Iterator<Item = &'static str> {
    SCENES.into_iter().filter(|(_, source, _)| matches!(source, Source::Code(_))).map(|(name, ..)| name)
}

fn known(name: &str) -> Result<(Source, Placing), SceneError> {
    let found = SCENES.into_iter().find(|(known, ..)| *known == name);
    found.map(|(_, source, placing)| (source, placing)).ok_or_else(|| SceneError::Unknown { name: name.to_owned() })
}

/// Whether the scene can be had: one made by code always, others where the model's file is there.
///
/// # Errors
/// An unknown name.
pub fn is_there(name: &str, directory: &Path) -> Result<bool, SceneError> {
    Ok(match known(name)?.0 {
        Source::File(file, _) => directory.join(file).exists(),
        Source::Code(_) => true,
    })
}

/// Loads the scene called `name` from `directory`, or makes it, with a light of `samples` × `samples` whose diagonal is
/// `paper_light` of the paper's units ([`PAPER_LIGHT`] unless it is varied).
///
/// # Errors
/// An unknown name; a model that cannot be read or is another one; a light that cannot be.
pub fn scene(name: &str, directory: &Path, samples: u32, paper_light: f64) -> Result<Scene, SceneError> {
    let (source, placing) = known(name)?;
    let model = match source {
        Source::File(file, expected) => read(directory, file, expected)?,
        Source::Code(model) => model(),
    };
    match placing {
        Placing::OnGround(view) => place::on_ground(model, view, paper_light, samples),
        Placing::InAtrium => place::in_atrium(model, paper_light, samples),
    }
}

/// Reads the model in `file`.
fn read(directory: &Path, file: &'static str, expected: usize) -> Result<Model, SceneError> {
    let model = load(&directory.join(file)).map_err(|source| SceneError::Load { source })?;
    match model.triangles.len() {
        found if found == expected => Ok(model),
        found => Err(SceneError::Triangles { file, found, expected }),
    }
}
