//! The texture coordinates of a glTF primitive, with the transform of KHR_texture_transform.

use gltf::{
    Accessor, Primitive, Semantic,
    accessor::{DataType, Dimensions},
    json::texture::Info,
};
use umbra4_core::glam::{DAffine2, DMat2, DVec2};

use super::{CoordinatesError, gltf_buffers};

/// Which coordinates a texture takes, and what becomes of them before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coordinates {
    /// Number of the set.
    pub(super) set: u32,
    transform: DAffine2,
}

impl Coordinates {
    /// Those of a texture.
    pub(super) fn of(texture: &Info) -> Self {
        let transform = texture.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
        let Some(transform) = transform else {
            return Self { set: texture.tex_coord, transform: DAffine2::IDENTITY };
        };
        let [offset, scale] = [transform.offset.0, transform.scale.0].map(|v| DVec2::from_array(v.map(f64::from)));
        // Counter-clockwise where v points down, as renderers have it.
        let turn = DMat2::from_angle(-f64::from(transform.rotation.0));
        Self {
            set: transform.tex_coord.unwrap_or(texture.tex_coord),
            transform: DAffine2::from_mat2_translation(turn * DMat2::from_diagonal(scale), offset),
        }
    }

    /// Those of a primitive with so many vertices.
    pub(super) fn read(
        &self,
        primitive: &Primitive<'_>,
        buffers: &[Vec<u8>],
        vertices: usize,
    ) -> Result<Vec<[f32; 2]>, CoordinatesError> {
        let accessor = primitive.get(&Semantic::TexCoords(self.set)).ok_or(CoordinatesError::Missing)?;
        let number = number(&accessor).ok_or(CoordinatesError::Type)?;
        if accessor.count() != vertices {
            return Err(CoordinatesError::Count { count: accessor.count(), vertices });
        }
        let elements =
            gltf_buffers::elements(&accessor, buffers).map_err(|e| CoordinatesError::Unreadable(Box::new(e)))?;
        let half = accessor.size() / 2;
        let transformed = |(vertex, bytes): (usize, &[u8])| {
            let (u, v) = bytes.split_at(half);
            let at = self.transform.transform_point2(DVec2::new(number(u), number(v))).as_vec2().to_array();
            match at.into_iter().find(|value| !value.is_finite()) {
                Some(value) => Err(CoordinatesError::NotFinite { vertex, value }),
                None => Ok(at),
            }
        };
        elements.enumerate().map(transformed).collect()
    }
}

/// How one number is read from its bytes.
fn number(accessor: &Accessor<'_>) -> Option<fn(&[u8]) -> f64> {
    if accessor.dimensions() != Dimensions::Vec2 {
        return None;
    }
    match (accessor.data_type(), accessor.normalized()) {
        (DataType::F32, false) => Some(|bytes| bytes.try_into().map_or(0.0, f32::from_le_bytes).into()),
        (DataType::U8, true) => Some(|bytes| bytes.first().map_or(0.0, |byte| f64::from(*byte) / 255.0)),
        (DataType::U16, true) => Some(|bytes| f64::from(bytes.try_into().map_or(0, u16::from_le_bytes)) / 65535.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coordinates(text: &str) -> Coordinates {
        Coordinates::of(&gltf::json::deserialize::from_str(text).unwrap())
    }

    #[test]
    fn coordinates_are_scaled_turned_and_moved() {
        assert_eq!(coordinates(r#"{"index":0,"texCoord":2}"#).set, 2);
        let turned = coordinates(
            r#"{"index":0,"extensions":{"KHR_texture_transform":
            {"offset":[0.5,0],"rotation":1.5707963267948966,"scale":[2,3],"texCoord":1}}}"#,
        );
        assert_eq!(turned.set, 1);
        // A quarter turn upwards: u becomes −v, and v becomes u.
        let at = |u, v| turned.transform.transform_point2(DVec2::new(u, v));
        assert!((at(1.0, 0.0) - DVec2::new(0.5, -2.0)).length() < 1e-6);
        assert!((at(0.0, 1.0) - DVec2::new(3.5, 0.0)).length() < 1e-6);
    }
}
