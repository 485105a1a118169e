//! Who is in the shadow of a part, in whose shadow it is, and how far from its plane its shadow begins.

use std::fmt::{self, Formatter};

use serde::{
    Deserialize, Deserializer,
    de::{self, Visitor},
};
use serde_json::value::RawValue;
use umbra4_core::Layers;

use crate::description::{FieldError, Fields};

/// How a part casts and receives shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Casting {
    /// The layers that it casts on; all, by default.
    pub caster_layers: Layers,
    /// The layers that it is in the shadow of; all, by default.
    pub receiver_layers: Layers,
    /// How far towards the light its shadow begins, world units, 0 at least.
    pub plane_offset: f64,
    /// Whether only its triangles cast whose back is to the light.
    pub closed: Closed,
}

/// Whether only those triangles of a part cast whose back is to the light, as of a mesh that bounds a volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Closed {
    /// All cast.
    #[default]
    No,
    /// It is closed: an error where it is not.
    Yes,
    /// Where it is found to be closed, opaque, and has one side only.
    Found,
}

impl<'de> Deserialize<'de> for Closed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Said;
        impl Visitor<'_> for Said {
            type Value = Closed;

            fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
                f.write_str("true, false or \"found\"")
            }

            fn visit_bool<E: de::Error>(self, said: bool) -> Result<Closed, E> {
                Ok(if said { Closed::Yes } else { Closed::No })
            }

            fn visit_str<E: de::Error>(self, said: &str) -> Result<Closed, E> {
                match said {
                    "found" => Ok(Closed::Found),
                    other => Err(E::invalid_value(de::Unexpected::Str(other), &self)),
                }
            }
        }
        deserializer.deserialize_any(Said)
    }
}

/// What a file says about that.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CastingSaid {
    /// The layers that it casts on.
    pub caster_layers: Option<Layers>,
    /// The layers that it is in the shadow of.
    pub receiver_layers: Option<Layers>,
    /// How far towards the light its shadow begins, world units.
    pub plane_offset: Option<f64>,
    /// Whether only its triangles cast whose back is to the light.
    pub closed: Option<Closed>,
}

/// Why it is refused.
#[derive(Debug, thiserror::Error)]
pub enum CastingError {
    /// It is no object, or has a field twice.
    #[error("not a description of shadows: {0}")]
    Malformed(#[from] serde_json::Error),
    /// One of its fields.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A layer that there is not.
    #[error("field `{field}[{index}]` is {value}: not a layer, 0 to 31")]
    Layer {
        /// Name of the field.
        field: &'static str,
        /// Which of the layers.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// An offset that is no distance.
    #[error("field `plane_offset` is {0}: not a distance, 0 at least")]
    Offset(f64),
    /// An offset where there is no plane that blocks.
    #[error("field `plane_offset` is {0}: surfaces that let light through have none")]
    OffsetOfTinted(f64),
    /// A closed side where there is none that blocks.
    #[error("field `closed` is true: surfaces that let light through have two sides")]
    ClosedTinted,
    /// A name that nothing has.
    #[error("no node or mesh of the model is called '{0}'")]
    NoPart(String),
}

/// An error, and the part that it is about.
#[derive(Debug, thiserror::Error)]
#[error("{part}: {source}")]
pub struct InPart<E: std::error::Error + 'static> {
    /// What the part is called.
    pub part: String,
    /// What is wrong with it.
    pub source: E,
}

impl CastingSaid {
    /// Takes its fields; each may be left out.
    ///
    /// # Errors
    /// A number that is no layer, or no distance.
    pub fn take(fields: &mut Fields) -> Result<Self, CastingError> {
        Ok(Self {
            caster_layers: layers(fields, "caster_layers")?,
            receiver_layers: layers(fields, "receiver_layers")?,
            plane_offset: offset(fields)?,
            closed: fields.optional("closed")?,
        })
    }

    /// Reads an object of these fields and no others.
    ///
    /// # Errors
    /// As [`CastingSaid::take`]; no object.
    pub fn read(json: &RawValue) -> Result<Self, CastingError> {
        let mut fields: Fields = serde_json::from_str(json.get())?;
        let said = Self::take(&mut fields)?;
        fields.finish()?;
        Ok(said)
    }

    /// What is said here, and else what was said before.
    #[must_use]
    pub fn over(&self, before: Casting) -> Casting {
        Casting {
            caster_layers: self.caster_layers.unwrap_or(before.caster_layers),
            receiver_layers: self.receiver_layers.unwrap_or(before.receiver_layers),
            plane_offset: self.plane_offset.unwrap_or(before.plane_offset),
            closed: self.closed.unwrap_or(before.closed),
        }
    }
}

fn layers(fields: &mut Fields, field: &'static str) -> Result<Option<Layers>, CastingError> {
    let Some(numbers) = fields.optional::<Vec<f64>>(field)? else { return Ok(None) };
    let bit = |(index, value): (usize, f64)| {
        // Casts saturate: what is no such number is not the same afterwards.
        let layer = value as u32;
        let one = Layers::of(&[layer]).ok().filter(|_| f64::from(layer) == value);
        one.map(Layers::bits).ok_or(CastingError::Layer { field, index, value })
    };
    let bits = numbers.into_iter().enumerate().map(bit).try_fold(0, |all, bit| Ok(all | bit?));
    bits.map(|bits| Some(Layers::from_bits(bits)))
}

fn offset(fields: &mut Fields) -> Result<Option<f64>, CastingError> {
    match fields.optional("plane_offset")? {
        Some(offset) if !(offset >= 0.0 && f64::is_finite(offset)) => Err(CastingError::Offset(offset)),
        offset => Ok(offset),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<CastingSaid, String> {
        CastingSaid::read(&RawValue::from_string(text.to_owned()).unwrap()).map_err(|e| e.to_string())
    }

    #[test]
    fn layers_are_bits() {
        let said = read(r#"{"caster_layers":[0,31,0],"receiver_layers":[],"plane_offset":0,"closed":true}"#).unwrap();
        let casting = said.over(Casting::default());
        let caster_layers = Layers::from_bits(1 << 31 | 1);
        let closed = Closed::Yes;
        assert_eq!(casting, Casting { caster_layers, receiver_layers: Layers::NONE, plane_offset: 0.0, closed });
        assert_eq!(read("{}").unwrap().over(casting), casting);
    }

    #[test]
    fn errors_name_field_and_value() {
        for (text, words) in [
            ("3", "not a description of shadows: invalid type: integer `3`, expected an object"),
            (r#"{"caster_layers":[0,32]}"#, "field `caster_layers[1]` is 32: not a layer, 0 to 31"),
            (r#"{"receiver_layers":[-1]}"#, "field `receiver_layers[0]` is -1: not a layer"),
            (r#"{"receiver_layers":[0.5]}"#, "field `receiver_layers[0]` is 0.5: not a layer"),
            (r#"{"caster_layers":3}"#, "field `caster_layers`: invalid type"),
            (r#"{"closed":1}"#, "field `closed`: invalid type"),
            (
                r#"{"closed":"maybe"}"#,
                "field `closed`: invalid value: string \"maybe\", expected true, false or \"found\"",
            ),
            (r#"{"plane_offset":-0.5}"#, "field `plane_offset` is -0.5: not a distance, 0 at least"),
            (r#"{"plane_offset":1e999}"#, "field `plane_offset`: number out of range"),
            (r#"{"offset":1}"#, "field `offset` is unknown"),
            (r#"{"plane_offset":1,"plane_offset":1}"#, "field `plane_offset` is there twice"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(words), "{text}: {message}");
        }
    }
}
