//! `shape`, `texture` and `radiance`: what the samples of a light emit.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use umbra4_core::{
    emission::{self, Emission, WHOLE},
    glam::DVec3,
};

use super::{DescriptionError, FieldError, Fields, Samples, sample_image};
use crate::light::Weights;

/// Which samples of a rectangle emit.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Shape {
    /// Those in the ellipse that touches the edges.
    Disk,
    /// Those in a polygon: (along the columns, along the rows), each from 0 to 1.
    Polygon(Vec<[f64; 2]>),
    /// Those that are white in a picture.
    Stencil(PathBuf),
}

/// What the samples of a light emit.
pub(super) struct Emitted {
    /// Their weights; `None` where all emit the same.
    pub weights: Option<Weights>,
    /// What a sample emits in the mean, red, green and blue.
    pub mean: DVec3,
}

/// Takes the fields that say what the samples emit. Pictures lie in `folder`.
pub(super) fn read(fields: &mut Fields, samples: Samples, folder: &Path) -> Result<Emitted, DescriptionError> {
    let shape: Option<Shape> = fields.optional("shape")?;
    let texture: Option<PathBuf> = fields.optional("texture")?;
    let radiance: Option<Vec<[f32; 3]>> = fields.optional("radiance")?;

    let (field, colors) = match (texture, radiance) {
        (Some(_), Some(_)) => return Err(FieldError::Both("texture", "radiance").into()),
        (Some(texture), None) => {
            let colors = sample_image::radiance(&folder.join(texture), samples);
            ("texture", Some(colors.map_err(DescriptionError::image("texture"))?))
        }
        (None, radiance) => (if radiance.is_some() { "radiance" } else { "shape" }, radiance),
    };
    let emitting = shape.map(|shape| emitting(&shape, samples, folder)).transpose()?;
    let mut colors = match (colors, &emitting) {
        (None, None) => return Ok(Emitted { weights: None, mean: DVec3::ONE }),
        (None, Some(emitting)) => vec![[1.0; 3]; emitting.len()],
        (Some(colors), _) => colors,
    };
    for (color, _) in colors.iter_mut().zip(emitting.iter().flatten()).filter(|(_, emits)| !**emits) {
        *color = [0.0; 3];
    }
    weighted(&colors, samples).map_err(DescriptionError::emission(field))
}

/// Whether each sample emits, row by row.
fn emitting(shape: &Shape, samples: Samples, folder: &Path) -> Result<Vec<bool>, DescriptionError> {
    let shape = match shape {
        Shape::Disk => emission::Shape::Disk,
        Shape::Polygon(corners) if corners.len() < 3 => return Err(DescriptionError::Polygon(corners.len())),
        Shape::Polygon(corners) => emission::Shape::Polygon(corners),
        Shape::Stencil(file) => {
            return sample_image::stencil(&folder.join(file), samples).map_err(DescriptionError::image("shape"));
        }
    };
    let Samples { rows, columns } = samples;
    let room = vec![[0; 3]; (rows * columns) as usize];
    let shaped = Emission::shaped(rows, columns, room, shape).map_err(DescriptionError::emission("shape"))?;
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    Ok(places.map(|(row, column)| shaped.weight(row, column) == Some([WHOLE; 3])).collect())
}

fn weighted(colors: &[[f32; 3]], Samples { rows, columns }: Samples) -> Result<Emitted, emission::EmissionError> {
    let weights = Emission::textured(rows, columns, vec![[0; 3]; (rows * columns) as usize], colors)?;
    // The largest of them weighs `WHOLE`.
    let largest = colors.iter().flatten().fold(0.0, |most: f32, color| most.max(*color));
    let whole = f64::from(WHOLE) * f64::from(rows * columns);
    let mean = DVec3::from_array(weights.total().map(f64::from)) / whole * f64::from(largest);
    Ok(Emitted { weights: Some(weights), mean })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, rows: u32, columns: u32) -> Result<Emitted, DescriptionError> {
        let mut fields: Fields = serde_json::from_str(text).unwrap();
        let emitted = read(&mut fields, Samples { rows, columns }, Path::new("/nowhere"))?;
        fields.finish()?;
        Ok(emitted)
    }

    #[test]
    fn what_emits_the_same_everywhere_has_no_weights() {
        let plain = parse("{}", 2, 2).unwrap();
        assert!(plain.weights.is_none() && plain.mean == DVec3::ONE);
    }

    #[test]
    fn shapes_leave_samples_out_of_textures() {
        let text = r#"{"shape":{"polygon":[[0,0],[0.5,0],[0.5,1],[0,1]]},"radiance":[[8,4,0],[9,9,9]]}"#;
        let emitted = parse(text, 1, 2).unwrap();
        assert_eq!(emitted.weights.unwrap().total(), [u32::from(WHOLE), 32768, 0]);
        assert!((emitted.mean - DVec3::new(4.0, 2.0, 0.0)).abs().max_element() < 1e-4, "{}", emitted.mean);
        let disk = parse(r#"{"shape":"disk"}"#, 64, 64).unwrap();
        assert!((disk.mean.x - std::f64::consts::FRAC_PI_4).abs() < 0.01);
    }

    #[test]
    fn errors_name_the_field() {
        for (text, words) in [
            (r#"{"shape":{"polygon":[[0,0],[1,1]]}}"#, "field `shape`: a polygon of 2 corners"),
            (r#"{"shape":{"polygon":[[0,0],[1,1],[1e999,0]]}}"#, "field `shape`: number out of range"),
            (r#"{"shape":{"polygon":[[2,2],[3,2],[3,3]]}}"#, "field `shape`: no sample"),
            (r#"{"shape":"star"}"#, "field `shape`: unknown variant"),
            (r#"{"shape":{"stencil":"missing.png"}}"#, "field `shape`: /nowhere/missing.png: cannot be read"),
            (r#"{"texture":"missing.png"}"#, "field `texture`: /nowhere/missing.png: cannot be read"),
            (r#"{"radiance":[[1,1,1]]}"#, "field `radiance`: 1 radiances for a light of 2×2"),
            (r#"{"radiance":[[1,1,1],[0,0,0],[0,-1,0],[0,0,0]]}"#, "green = -1"),
            (r#"{"radiance":[[0,0,0],[0,0,0],[0,0,0],[0,0,0]]}"#, "field `radiance`: no sample"),
            (r#"{"texture":"a.png","radiance":[]}"#, "fields `texture` and `radiance`"),
        ] {
            let message = parse(text, 2, 2).err().map(|e| e.to_string()).unwrap_or_default();
            assert!(message.contains(words), "{text}: {message}");
        }
    }
}
