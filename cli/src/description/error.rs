//! What can be wrong with the description of a light.

use std::fmt;

use umbra4_core::{LightError, PunctualLightError, emission::EmissionError};

use super::{FieldError, SampleImageError};
use crate::{
    in_file::InFile,
    light::{AreaError, ConeError},
};

/// Why the description of a light is refused.
#[derive(Debug, thiserror::Error)]
pub enum DescriptionError {
    /// It is no object, or has a field twice.
    #[error("not a light: {0}")]
    Malformed(#[from] serde_json::Error),
    /// One of its fields.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Its kind.
    #[error("field `kind` is '{found}': known here are {known}")]
    Kind {
        /// What was found.
        found: String,
        /// What could be there.
        known: String,
    },
    /// Its rectangle.
    #[error(transparent)]
    Light(#[from] LightError),
    /// Its position or direction.
    #[error(transparent)]
    Hard(#[from] PunctualLightError),
    /// Its cone.
    #[error(transparent)]
    Cone(#[from] ConeError),
    /// What its samples emit.
    #[error("field `{field}`: {reason}")]
    Emission {
        /// Name of the field.
        field: &'static str,
        /// What is wrong.
        reason: EmissionError,
    },
    /// A polygon that has no inside.
    #[error("field `shape`: a polygon of {0} corners: 3 at least are called for")]
    Polygon(usize),
    /// Samples of a volume.
    #[error("field `{field}`: {count} samples, outside 1..={most}")]
    Count {
        /// Name of the field.
        field: &'static str,
        /// How many there are.
        count: u64,
        /// How many there may be.
        most: u64,
    },
    /// The picture of its samples.
    #[error("field `{field}`: {reason}")]
    Image {
        /// Name of the field.
        field: &'static str,
        /// What is wrong.
        reason: InFile<SampleImageError>,
    },
}

impl DescriptionError {
    /// For `map_err`: what is wrong with an emission is said of the field that it comes from.
    pub(super) fn emission(field: &'static str) -> impl Fn(EmissionError) -> Self {
        move |reason| Self::Emission { field, reason }
    }

    /// For `map_err`: the same of a picture.
    pub(super) fn image(field: &'static str) -> impl Fn(InFile<SampleImageError>) -> Self {
        move |reason| Self::Image { field, reason }
    }
}

impl From<AreaError> for DescriptionError {
    fn from(error: AreaError) -> Self {
        match error {
            AreaError::Light(error) => error.into(),
            AreaError::Emission(reason) => Self::Emission { field: "two_sided", reason },
        }
    }
}

/// Rows and columns of a light's samples, or of the pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// Rows.
    pub rows: u32,
    /// Columns.
    pub columns: u32,
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} rows × {} columns", self.rows, self.columns)
    }
}
