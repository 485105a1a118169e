//! LIGHT.json: `{"corner":[x,y,z],"edge_u":[x,y,z],"edge_v":[x,y,z]}`.

use std::{fs, io, path::Path};

use serde::Deserialize;
use umbra4_core::{AreaLight, LightError, glam::DVec3};

use crate::in_file::InFile;

/// Why a light file is refused.
#[derive(Debug, thiserror::Error)]
pub enum LightFileError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// The file is not the JSON called for; the reason names the field.
    #[error("not a light: {0}")]
    Malformed(#[from] serde_json::Error),
    /// The numbers make no light.
    #[error(transparent)]
    Light(#[from] LightError),
}

/// A light as a file gives it: without a number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightShape {
    /// Corner of the light, world.
    pub corner: [f64; 3],
    /// Edge along the columns of samples, world.
    pub edge_u: [f64; 3],
    /// Edge along the rows of samples, world.
    pub edge_v: [f64; 3],
}

impl LightShape {
    /// The light with `samples` × `samples` samples.
    ///
    /// # Errors
    /// As [`AreaLight::new`].
    pub fn sampled(&self, samples: u32) -> Result<AreaLight, LightError> {
        self.grid(samples, samples)
    }

    /// The light with `rows` × `columns` samples.
    ///
    /// # Errors
    /// As [`AreaLight::new`].
    pub fn grid(&self, rows: u32, columns: u32) -> Result<AreaLight, LightError> {
        let [corner, edge_u, edge_v] = [self.corner, self.edge_u, self.edge_v].map(DVec3::from_array);
        AreaLight::new(corner, edge_u, edge_v, rows, columns)
    }

    /// The same rectangle, shining to the other side: rows run where columns did.
    #[must_use]
    pub fn exchanged(&self) -> Self {
        Self { corner: self.corner, edge_u: self.edge_v, edge_v: self.edge_u }
    }
}

/// Reads the shape of a light.
///
/// # Errors
/// See [`LightFileError`].
pub fn read(path: &Path) -> Result<LightShape, InFile<LightFileError>> {
    let parse = || -> Result<LightShape, LightFileError> {
        let shape: LightShape = serde_json::from_slice(&fs::read(path)?)?;
        // Whatever is wrong with the numbers is wrong with this file.
        shape.sampled(1)?;
        Ok(shape)
    };
    parse().map_err(InFile::at(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<LightShape, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), text).unwrap();
        read(file.path()).map_err(|e| e.to_string())
    }

    #[test]
    fn a_light_is_read() {
        let light = parse(r#"{"corner":[0,1,2],"edge_u":[1,0,0],"edge_v":[0,0.5,0]}"#).unwrap();
        assert_eq!(light.edge_v, [0.0, 0.5, 0.0]);
    }

    #[test]
    fn errors_name_the_field() {
        let missing = parse(r#"{"corner":[0,1,2],"edge_u":[1,0,0]}"#).unwrap_err();
        assert!(missing.contains("edge_v"), "{missing}");
        let extra = parse(r#"{"corner":[0,1,2],"edge_u":[1,0,0],"edge_v":[0,1,0],"colour":1}"#).unwrap_err();
        assert!(extra.contains("colour"), "{extra}");
        let flat = parse(r#"{"corner":[0,1,2],"edge_u":[1,0,0],"edge_v":[2,0,0]}"#).unwrap_err();
        assert!(flat.contains("no area"), "{flat}");
    }
}
