//! What can be wrong with a material, as far as it has a say in shadows.

use std::fmt;

use super::PictureError;

/// Why a material is refused.
#[derive(Debug, thiserror::Error)]
pub enum MaterialError {
    /// A factor that is no fraction.
    #[error("field `{field}` is {value}: not a number in 0..=1")]
    Factor {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f32,
    },
    /// A cutoff that is no amount.
    #[error("field `alphaCutoff` is {0}: not a number that is 0 at least")]
    Cutoff(f32),
    /// A texture that is not there.
    #[error("field `{field}` names texture {texture}, but there are only {textures}")]
    NoTexture {
        /// Name of the field.
        field: &'static str,
        /// Index of the texture.
        texture: usize,
        /// How many there are.
        textures: usize,
    },
    /// A texture of a kind that is not known here.
    #[error("field `{field}`, {texture}, is not supported")]
    Unsupported {
        /// Name of the field.
        field: &'static str,
        /// The texture.
        texture: TextureName,
    },
    /// What is wrong with a texture.
    #[error("{texture}: {reason}")]
    Texture {
        /// The texture.
        texture: TextureName,
        /// What is wrong with it.
        reason: TextureError,
    },
    /// What is wrong with the texture coordinates that it needs.
    #[error("{primitive}: TEXCOORD_{set}, which `baseColorTexture` needs, {reason}")]
    Coordinates {
        /// What has the coordinates.
        primitive: String,
        /// Number of the set of coordinates.
        set: u32,
        /// What is wrong with it.
        reason: CoordinatesError,
    },
}

/// An error, and the material that it is about.
#[derive(Debug, thiserror::Error)]
#[error("{material}: {reason}")]
pub struct InMaterial {
    /// What the material is called.
    pub material: String,
    /// What is wrong with it; in a box, since it may be much.
    pub reason: Box<MaterialError>,
}

impl InMaterial {
    /// For `map_err`: puts what the material is called to an error.
    pub(super) fn at(material: String) -> impl Fn(MaterialError) -> Self {
        move |reason| Self { material: material.clone(), reason: Box::new(reason) }
    }
}

/// A texture, as messages call it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextureName {
    /// Its index.
    pub index: usize,
    /// Its own name.
    pub name: Option<String>,
}

impl fmt::Display for TextureName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            Some(name) => write!(f, "texture {} '{name}'", self.index),
            None => write!(f, "texture {}", self.index),
        }
    }
}

/// Why a texture is refused.
#[derive(Debug, thiserror::Error)]
pub enum TextureError {
    /// It has no picture.
    #[error("field `source` is missing")]
    NoSource,
    /// Its picture is not there.
    #[error("field `source` names image {image}, but there are only {images}")]
    NoImage {
        /// Index of the picture.
        image: usize,
        /// How many there are.
        images: usize,
    },
    /// Its sampler is not there.
    #[error("field `sampler` names sampler {sampler}, but there are only {samplers}")]
    NoSampler {
        /// Index of the sampler.
        sampler: usize,
        /// How many there are.
        samplers: usize,
    },
    /// It is repeated in a way that is not known here.
    #[error("field `{axis}` of its sampler is MIRRORED_REPEAT, which is not supported")]
    Mirrored {
        /// "wrapS" or "wrapT".
        axis: &'static str,
    },
    /// Its picture is refused.
    #[error("image {image}: {reason}")]
    Picture {
        /// Index of the picture.
        image: usize,
        /// What is wrong with it.
        reason: PictureError,
    },
}

/// Why texture coordinates are refused.
#[derive(Debug, thiserror::Error)]
pub enum CoordinatesError {
    /// There are none.
    #[error("is missing")]
    Missing,
    /// There are others than two numbers a vertex.
    #[error("is not two f32, or two normalized u8 or u16")]
    Type,
    /// There are not as many as vertices.
    #[error("has {count} elements for {vertices} vertices")]
    Count {
        /// Elements.
        count: usize,
        /// Vertices.
        vertices: usize,
    },
    /// One of them is NaN or infinite.
    #[error("of vertex {vertex} is {value}, not a finite number")]
    NotFinite {
        /// Index of the vertex in its primitive.
        vertex: usize,
        /// The value.
        value: f32,
    },
    /// They do not lie in their buffer.
    #[error("cannot be read: {0}")]
    Unreadable(Box<super::ModelError>),
}
