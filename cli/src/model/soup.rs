//! An .npy array of shape (T, 3, 3): a triangle soup.

use umbra4_core::glam::DVec3;

use super::{Model, ModelError};
use crate::array_file;

pub(super) fn parse(bytes: &[u8]) -> Result<Model<DVec3>, ModelError> {
    let vertices = array_file::parse_points(bytes, &[3, 3])?;
    let count = u32::try_from(vertices.len() / 3)
        .ok()
        .filter(|count| *count < u32::MAX / 3)
        .ok_or_else(|| ModelError::Malformed { format: "NPY", reason: "too many triangles".to_owned() })?;
    Ok(Model { vertices, triangles: (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect() })
}
