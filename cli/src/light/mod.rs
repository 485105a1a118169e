//! Lights as they are rendered, wherever they come from.

mod area;
mod hard;
mod irradiance;
mod snap;
mod volume;

use umbra4_core::{AreaLight, Bounds, glam::DVec3};

pub use area::{AreaError, AreaSource, Side, Weights};
pub use hard::{Cone, ConeError, HardLight};
pub use irradiance::Lamp;
pub use snap::SnapLightError;
pub use volume::{Volume, VolumeSource};

/// A light, its power and what messages call it.
#[derive(Clone, Debug)]
pub struct Light {
    /// What messages and tables call it.
    pub label: String,
    /// What it emits, red, green and blue, each at least 0: the mean radiance of an area, the intensity of a point, the
    /// irradiance from a direction; of a volume, the intensity of a point that is as bright from afar.
    pub power: DVec3,
    /// Where it shines from.
    pub source: Source,
}

/// Where a light shines from.
#[derive(Clone, Debug)]
pub enum Source {
    /// A part of a plane.
    Area(AreaSource),
    /// A point, or a direction.
    Hard(HardLight),
    /// A volume.
    Volume(VolumeSource),
}

/// An error, and the light that it is about.
#[derive(Debug, thiserror::Error)]
#[error("{light}: {source}")]
pub struct InLight<E: std::error::Error + 'static> {
    /// What the light is called.
    pub light: String,
    /// What is wrong with it; in a box, since it may be much.
    pub source: Box<E>,
}

impl<E: std::error::Error + 'static> InLight<E> {
    /// For `map_err`: puts what the light is called to an error.
    pub fn at(label: &str) -> impl Fn(E) -> Self {
        move |source| Self { light: label.to_owned(), source: Box::new(source) }
    }
}

impl Light {
    /// A rectangle of power 1, all of whose samples emit the same.
    pub fn plain(label: &str, area: AreaLight) -> Self {
        let source = Source::Area(AreaSource::one_sided(Side { area, emission: None }));
        Self { label: label.to_owned(), power: DVec3::ONE, source }
    }

    /// A light without extent, of power 1.
    pub fn hard(label: &str, light: HardLight) -> Self {
        Self { label: label.to_owned(), power: DVec3::ONE, source: Source::Hard(light) }
    }

    /// What the lattice has to hold of it.
    pub fn bounds(&self) -> Option<Bounds> {
        match &self.source {
            Source::Area(area) => Some(area.bounds()),
            Source::Hard(light) => light.bounds(),
            Source::Volume(volume) => Some(volume.bounds()),
        }
    }

    /// The sides of a plain area: one whose samples all emit the same.
    pub fn plain_sides(&self) -> Option<Vec<AreaLight>> {
        match &self.source {
            Source::Area(area) => area.sides().map(|side| side.emission.is_none().then_some(side.area)).collect(),
            Source::Hard(_) | Source::Volume(_) => None,
        }
    }

    /// What it is, in a few words.
    pub fn kind(&self) -> String {
        match &self.source {
            Source::Area(area) => area.kind(),
            Source::Hard(light) => light.kind().to_owned(),
            Source::Volume(volume) => volume.kind(),
        }
    }
}
