//! A rectangle of samples.

use std::path::Path;

use serde::Deserialize;
use umbra4_core::glam::{DMat4, DVec3};

use super::{DescriptionError, FieldError, Fields, Samples, emission};
use crate::{
    light::{AreaSource, Source},
    light_file::LightShape,
};

/// Samples each way where none are asked for.
const SAMPLES: u32 = 32;

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "a number of samples each way or [rows, columns] is called for")]
enum SamplesField {
    Square(u32),
    Grid(u32, u32),
}

/// Takes the fields of a rectangle; returns it with what a sample emits in the mean.
pub(super) fn read(fields: &mut Fields, folder: &Path) -> Result<(Source, DVec3), DescriptionError> {
    let shape = LightShape {
        corner: fields.required("corner")?,
        edge_u: fields.required("edge_u")?,
        edge_v: fields.required("edge_v")?,
    };
    filled(&shape, fields, folder)
}

/// The same of one that has its place from a node: in its xy plane, centred, and shining along −z.
pub(super) fn read_on_node(
    fields: &mut Fields,
    folder: &Path,
    transform: &DMat4,
) -> Result<(Source, DVec3), DescriptionError> {
    let (width, height) = (size(fields, "width")?, size(fields, "height")?);
    // Rows run downwards: x × −y = −z.
    let (u, v) = (DVec3::X * width, DVec3::NEG_Y * height);
    let corner = transform.transform_point3((u + v) * -0.5);
    let [edge_u, edge_v] = [u, v].map(|edge| transform.transform_vector3(edge));
    let shape = LightShape { corner: corner.to_array(), edge_u: edge_u.to_array(), edge_v: edge_v.to_array() };
    let (source, mean) = filled(&shape, fields, folder)?;
    // A mirror turns products around: there, the back is what shines along −z.
    let mirrored = edge_u.cross(edge_v).dot(transform.transform_vector3(DVec3::NEG_Z)) < 0.0;
    match source {
        Source::Area(area) if mirrored && area.back().is_none() => Ok((Source::Area(area.turned(&shape)?), mean)),
        source => Ok((source, mean)),
    }
}

fn size(fields: &mut Fields, field: &'static str) -> Result<f64, FieldError> {
    let value: f64 = fields.required(field)?;
    if value > 0.0 { Ok(value) } else { Err(FieldError::Size { field, value }) }
}

/// The samples of a rectangle, and what they emit.
fn filled(shape: &LightShape, fields: &mut Fields, folder: &Path) -> Result<(Source, DVec3), DescriptionError> {
    let samples = match fields.optional("samples")?.unwrap_or(SamplesField::Square(SAMPLES)) {
        SamplesField::Square(side) => Samples { rows: side, columns: side },
        SamplesField::Grid(rows, columns) => Samples { rows, columns },
    };
    let two_sided = fields.optional("two_sided")?.unwrap_or(false);
    // Numbers of samples are checked before as many weights are made.
    shape.grid(samples.rows, samples.columns)?;
    let emitted = emission::read(fields, samples, folder)?;
    let area = AreaSource::new(shape, [samples.rows, samples.columns], emitted.weights, two_sided)?;
    Ok((Source::Area(area), emitted.mean))
}
