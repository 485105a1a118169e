//! A small glTF model with a texture: a card above a floor.

use std::io::Cursor;

use base64::{Engine, engine::general_purpose::STANDARD};
use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};

/// A card of two triangles at y = 1, from −1 to 1 each way, over a floor four times as wide at y = 0. Node 0, `card`, has the
/// mesh `leaf`; node 1, `floor`, the mesh `slab`. The card's material is 0, and its picture is 0.
pub fn card(material: Value, picture: &DynamicImage) -> Value {
    let corners = [[-1.0_f32, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]];
    let coordinates = [[0.0_f32, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let mut bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(coordinates.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let png = encoded(picture, ImageFormat::Png);
    let picture_at = bytes.len();
    bytes.extend(&png);
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"name": "card", "mesh": 0, "translation": [0, 1, 0]},
            {"name": "floor", "mesh": 1, "scale": [4, 1, 4]},
        ],
        "meshes": [
            {"name": "leaf", "primitives": [
                {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0},
            ]},
            {"name": "slab", "primitives": [{"attributes": {"POSITION": 0}, "indices": 2}]},
        ],
        "materials": [material],
        "textures": [{"name": "leaves", "source": 0}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "samplers": [{"wrapS": 33071, "wrapT": 10497}, {"wrapT": 33648}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, 0, -1], "max": [1, 0, 1]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12},
            {"buffer": 0, "byteOffset": picture_at, "byteLength": png.len()},
        ],
        "buffers": [{"uri": data_uri("application/octet-stream", &bytes), "byteLength": bytes.len()}],
    })
}

pub fn data_uri(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", STANDARD.encode(bytes))
}

pub fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    picture.write_to(&mut file, format).unwrap();
    file.into_inner()
}
