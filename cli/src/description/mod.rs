//! Lights as JSON describes them, in scene files and in the extras of glTF's nodes.

mod emission;
mod error;
mod fields;
mod light;
mod power;
mod rectangle;
mod sample_image;
mod volume;

pub use error::{DescriptionError, Samples};
pub use fields::{FieldError, Fields};
pub use light::{label, light, light_on_node};
pub use power::power;
pub use sample_image::SampleImageError;
