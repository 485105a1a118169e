//! Lights that fill a volume.

use umbra4_core::{EllipsoidLight, SphereLight, TubeLight, cloud::MAX_CLOUD, glam::DVec3};

use super::{DescriptionError, Fields};
use crate::light::{Source, Volume, VolumeSource};

/// Samples of a volume that says nothing else.
const SAMPLES: u32 = 256;

type Read = Result<(Source, DVec3), DescriptionError>;

/// Reads a ball.
///
/// # Errors
/// A field that is missing or malformed; a number of samples out of range.
pub(super) fn sphere(fields: &mut Fields) -> Read {
    let (center, radius) = (point(fields, "center")?, fields.required("radius")?);
    sampled(fields, Volume::Sphere(SphereLight { center, radius }))
}

/// Reads a ball of other axes.
///
/// # Errors
/// As [`sphere`].
pub(super) fn ellipsoid(fields: &mut Fields) -> Read {
    let (center, axes) = (point(fields, "center")?, fields.required::<[[f64; 3]; 3]>("axes")?);
    sampled(fields, Volume::Ellipsoid(EllipsoidLight { center, axes: axes.map(DVec3::from_array) }))
}

/// Reads a tube.
///
/// # Errors
/// As [`sphere`].
pub(super) fn tube(fields: &mut Fields) -> Read {
    let (from, to) = (point(fields, "from")?, point(fields, "to")?);
    let radius = fields.required("radius")?;
    sampled(fields, Volume::Tube(TubeLight { from, to, radius }))
}

/// Reads samples as they are given.
///
/// # Errors
/// As [`sphere`].
pub(super) fn cloud(fields: &mut Fields) -> Read {
    let points: Vec<[f64; 3]> = fields.required("points")?;
    let samples = checked("points", points.len() as u64)?;
    let volume = Volume::Points(points.into_iter().map(DVec3::from_array).collect());
    Ok((Source::Volume(VolumeSource { volume, samples }), DVec3::ONE))
}

fn point(fields: &mut Fields, field: &'static str) -> Result<DVec3, DescriptionError> {
    Ok(DVec3::from_array(fields.required(field)?))
}

fn sampled(fields: &mut Fields, volume: Volume) -> Read {
    let samples: Option<u32> = fields.optional("samples")?;
    let samples = checked("samples", u64::from(samples.unwrap_or(SAMPLES)))?;
    Ok((Source::Volume(VolumeSource { volume, samples }), DVec3::ONE))
}

fn checked(field: &'static str, count: u64) -> Result<usize, DescriptionError> {
    let most = MAX_CLOUD as u64;
    if (1..=most).contains(&count) { Ok(count as usize) } else { Err(DescriptionError::Count { field, count, most }) }
}
