//! PLY, ascii and binary of both byte orders, plain or gzipped: positions and faces.

use std::io::{self, Read};

use flate2::bufread::MultiGzDecoder;
use ply_rs_bw::{
    parser::{ParseError, Parser, Reader},
    ply::{Property, PropertyAccess, PropertyAccessResult, PropertyType},
};
use umbra4_core::glam::DVec3;

use super::{Model, ModelError, push_polygon};

const FORMAT: &str = "PLY";

pub(super) fn parse_gz(bytes: &[u8]) -> Result<Model<DVec3>, ModelError> {
    let mut plain = Vec::new();
    MultiGzDecoder::new(bytes).read_to_end(&mut plain).map_err(|e| fault("gzip", e.kind(), e.to_string()))?;
    parse(&plain)
}

pub(super) fn parse(bytes: &[u8]) -> Result<Model<DVec3>, ModelError> {
    let fail = |e: ParseError| fault(FORMAT, e.kind(), e.to_string());
    let mut reader = Reader::new(bytes);
    let header = Parser::<Vertex>::new().read_header(&mut reader).map_err(fail)?;
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    for element in header.elements.values() {
        let scalar =
            |name: &str| element.properties.get(name).is_some_and(|p| matches!(p.data_type, PropertyType::Scalar(_)));
        match element.name.as_str() {
            // An element without properties takes no room in a binary file: its count would be believed blindly.
            _ if element.properties.is_empty() => {
                return Err(malformed(format!("element '{}' has no properties", element.name)));
            }
            "vertex" if !(scalar("x") && scalar("y") && scalar("z")) => {
                return Err(malformed("vertices have no x, y and z".to_owned()));
            }
            "vertex" => {
                vertices =
                    Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header).map_err(fail)?;
            }
            "face" => {
                faces = Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header).map_err(fail)?;
            }
            _ => {
                Parser::<Skipped>::new().read_payload_for_element(&mut reader, element, &header).map_err(fail)?;
            }
        }
    }
    let mut triangles = Vec::new();
    for Face(corners) in &faces {
        if let Some(&vertex) = corners.iter().find(|&&v| v < 0 || v as usize >= vertices.len()) {
            return Err(ModelError::IndexOutOfRange { triangle: triangles.len(), vertex, vertices: vertices.len() });
        }
        let corners: Vec<u32> = corners.iter().map(|&v| v as u32).collect();
        push_polygon(&mut triangles, &corners);
    }
    Ok(Model { vertices: vertices.into_iter().map(|Vertex(v)| v).collect(), triangles })
}

fn malformed(reason: String) -> ModelError {
    ModelError::Malformed { format: FORMAT, reason }
}

fn fault(format: &'static str, kind: io::ErrorKind, reason: String) -> ModelError {
    match kind {
        io::ErrorKind::UnexpectedEof => ModelError::Truncated { format, reason },
        _ => ModelError::Malformed { format, reason },
    }
}

struct Vertex(DVec3);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self(DVec3::ZERO)
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let coordinate = match name {
            "x" => &mut self.0.x,
            "y" => &mut self.0.y,
            "z" => &mut self.0.z,
            _ => return PropertyAccessResult::Ignored,
        };
        *coordinate = match value {
            Property::Float(v) => v.into(),
            Property::Double(v) => v,
            Property::Char(v) => v.into(),
            Property::UChar(v) => v.into(),
            Property::Short(v) => v.into(),
            Property::UShort(v) => v.into(),
            Property::Int(v) => v.into(),
            Property::UInt(v) => v.into(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

struct Face(Vec<i64>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match value {
            Property::ListChar(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUChar(v) => v.into_iter().map(i64::from).collect(),
            Property::ListShort(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUShort(v) => v.into_iter().map(i64::from).collect(),
            Property::ListInt(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUInt(v) => v.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};

    use super::*;

    fn header(encoding: &str) -> Vec<u8> {
        format!(
            "ply\nformat {encoding} 1.0\ncomment a quad\nelement vertex 4\nproperty float x\nproperty float y\n\
             property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        )
        .into_bytes()
    }

    const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.25]];

    fn ascii() -> Vec<u8> {
        let mut file = header("ascii");
        for [x, y, z] in CORNERS {
            file.extend(format!("{x} {y} {z} 255\n").bytes());
        }
        file.extend(b"4 0 1 2 3\n");
        file
    }

    fn binary(encoding: &str, float: fn(f32) -> [u8; 4], int: fn(i32) -> [u8; 4]) -> Vec<u8> {
        let mut file = header(encoding);
        for corner in CORNERS {
            corner.iter().for_each(|&x| file.extend(float(x)));
            file.push(255);
        }
        file.push(4);
        (0..4).for_each(|i| file.extend(int(i)));
        file
    }

    fn gz(plain: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(plain).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn all_encodings_agree() {
        let files = [
            ascii(),
            binary("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes),
            binary("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes),
        ];
        for file in files {
            let model = parse(&file).unwrap();
            assert_eq!(model.triangles, [[0, 1, 2], [0, 2, 3]]);
            assert_eq!(model.vertices[2], DVec3::new(1.0, 1.0, 0.5));
            assert_eq!(parse_gz(&gz(&file)).unwrap(), model);
        }
    }

    #[test]
    fn what_is_cut_off_is_told() {
        let file = binary("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes);
        assert!(matches!(parse(&file[..file.len() - 1]), Err(ModelError::Truncated { .. })));
        let packed = gz(&file);
        assert!(matches!(parse_gz(&packed[..packed.len() - 1]), Err(ModelError::Truncated { .. })));
    }

    #[test]
    fn negative_indices_are_out_of_range() {
        let text = String::from_utf8(ascii()).unwrap().replace("4 0 1 2 3", "4 0 1 2 -1");
        assert!(matches!(parse(text.as_bytes()), Err(ModelError::IndexOutOfRange { vertex: -1, vertices: 4, .. })));
    }

    #[test]
    fn mutilated_files_never_panic() {
        let files = [ascii(), binary("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes)];
        for file in files {
            for position in 0..file.len() {
                assert!(position + 1 >= file.len() || parse(&file[..position]).is_err());
                for byte in [0, b'9', b'-', b' ', 0xff] {
                    let mut broken = file.clone();
                    broken[position] = byte;
                    let _ = parse(&broken);
                }
            }
        }
    }
}
