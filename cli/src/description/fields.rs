//! The fields of a JSON object, each taken by name, so that whatever is wrong names the field.

use std::{collections::BTreeMap, fmt};

use serde::{
    Deserialize, Deserializer,
    de::{DeserializeOwned, Error, MapAccess, Visitor},
};
use serde_json::value::RawValue;

/// Why a field is refused.
#[derive(Debug, thiserror::Error)]
pub enum FieldError {
    /// It is not there.
    #[error("field `{0}` is missing")]
    Missing(&'static str),
    /// It holds something else than it should.
    #[error("field `{field}`: {reason}")]
    Malformed {
        /// Name of the field.
        field: &'static str,
        /// What is wrong.
        reason: serde_json::Error,
    },
    /// Nothing is known about it.
    #[error("field `{0}` is unknown")]
    Unknown(String),
    /// Two fields exclude each other.
    #[error("fields `{0}` and `{1}` are both there: one of them, or none, is called for")]
    Both(&'static str, &'static str),
    /// It holds no length.
    #[error("field `{field}` is {value}: not a number above 0")]
    Size {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// It holds no amount of light.
    #[error("field `{field}` is {value}: not a number in 0..={most:e}", most = f32::MAX)]
    Amount {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f64,
    },
}

/// The fields of an object that have not been taken yet.
#[derive(Debug)]
pub struct Fields(BTreeMap<String, Box<RawValue>>);

impl Fields {
    /// Takes a field that may be left out.
    ///
    /// # Errors
    /// It holds something else.
    pub fn optional<T: DeserializeOwned>(&mut self, field: &'static str) -> Result<Option<T>, FieldError> {
        let value = self.0.remove(field);
        let parse = |value: Box<RawValue>| serde_json::from_str(value.get());
        value.map(parse).transpose().map_err(|reason| FieldError::Malformed { field, reason })
    }

    /// Takes a field that must be there.
    ///
    /// # Errors
    /// It is missing, or holds something else.
    pub fn required<T: DeserializeOwned>(&mut self, field: &'static str) -> Result<T, FieldError> {
        self.optional(field)?.ok_or(FieldError::Missing(field))
    }

    /// Makes sure that nothing is left over.
    ///
    /// # Errors
    /// Something is.
    pub fn finish(self) -> Result<(), FieldError> {
        self.0.into_keys().next().map_or(Ok(()), |field| Err(FieldError::Unknown(field)))
    }
}

impl<'de> Deserialize<'de> for Fields {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(FieldsVisitor)
    }
}

struct FieldsVisitor;

impl<'de> Visitor<'de> for FieldsVisitor {
    type Value = Fields;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Fields, M::Error> {
        let mut fields = BTreeMap::new();
        while let Some((name, value)) = map.next_entry::<String, Box<RawValue>>()? {
            if fields.contains_key(&name) {
                return Err(Error::custom(format!("field `{name}` is there twice")));
            }
            fields.insert(name, value);
        }
        Ok(Fields(fields))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(text: &str) -> Fields {
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn every_error_names_its_field() {
        let missing = fields("{}").required::<f64>("width").unwrap_err().to_string();
        assert_eq!(missing, "field `width` is missing");
        for text in [r#"{"width":"a"}"#, r#"{"width":1e999}"#, r#"{"width":null}"#] {
            let malformed = fields(text).required::<f64>("width").unwrap_err().to_string();
            assert!(malformed.starts_with("field `width`: "), "{malformed}");
        }
        let unknown = fields(r#"{"width":1,"wide":2}"#).finish().unwrap_err().to_string();
        assert_eq!(unknown, "field `wide` is unknown");
        let twice = serde_json::from_str::<Fields>(r#"{"width":1,"width":2}"#).unwrap_err().to_string();
        assert!(twice.starts_with("field `width` is there twice"), "{twice}");
    }

    #[test]
    fn fields_are_taken_once() {
        let mut fields = fields(r#"{"size":[1,2]}"#);
        assert_eq!(fields.optional::<[u32; 2]>("size").unwrap(), Some([1, 2]));
        assert_eq!(fields.optional::<[u32; 2]>("size").unwrap(), None);
        assert!(fields.finish().is_ok());
    }
}
