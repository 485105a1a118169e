//! What of glTF's materials has a say in shadows, read from documents that are written here.

use std::{path::Path, sync::Arc};

use crate::common::{
    Folder,
    gltf::{card, data_uri, encoded},
};
use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};
use serde_json::{Value, json};
use umbra4::model::{self, FileLights, Furnished, Surface};
use umbra4_core::{Layers, glam::Vec3, texture::Wrap};

/// Two texels each way: alphas 0, 100, 200 and 255.
fn picture() -> DynamicImage {
    let alphas = [0, 100, 200, 255];
    RgbaImage::from_fn(2, 2, |x, y| Rgba([255, 0, 255, alphas[(2 * y + x) as usize]])).into()
}

fn mask() -> Value {
    json!({"name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": true,
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})
}

fn load(folder: &Folder, document: &Value) -> Result<Furnished, String> {
    folder.write("card.gltf", document.to_string());
    model::load_furnished(&folder.path("card.gltf"), FileLights::PassedOver).map_err(|e| e.to_string())
}

fn surface(folder: &Folder, document: &Value) -> Surface {
    let parts = load(folder, document).unwrap().parts;
    parts.iter().find(|part| part.names == ["card", "leaf"]).unwrap().surface.clone()
}

#[test]
fn a_mask_is_a_cutout() {
    let folder = Folder::new();
    let mut document = card(mask(), &picture());
    document["nodes"][0]["children"] = json!([2]);
    document["nodes"].as_array_mut().unwrap().push(json!({"mesh": 0, "translation": [0, 1, 0]}));
    let Furnished { model, parts, .. } = load(&folder, &document).unwrap();
    let all: Vec<_> = parts.iter().collect();
    assert_eq!((all.len(), model.triangles.len()), (3, 6));
    let cutouts: Vec<_> = all
        .iter()
        .filter_map(|part| match &part.surface {
            Surface::Cutout { alphas, threshold } => Some((*part, alphas, *threshold)),
            _ => None,
        })
        .collect();
    let [(first, alphas, threshold), (second, others, _)] = cutouts[..] else { panic!("{all:?}") };
    assert_eq!(
        (alphas.size.width, alphas.size.height, alphas.texels.as_slice()),
        (2, 2, [0, 100, 200, 255].as_slice())
    );
    assert_eq!((threshold, alphas.size.wrap), (128, [Wrap::Repeat; 2]));
    // Nodes that share a mesh share its texture, not its coordinates, which go by vertices.
    assert!(Arc::ptr_eq(alphas, others));
    assert_eq!(
        (first.coordinates.as_slice(), &second.coordinates),
        ([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].as_slice(), &first.coordinates)
    );
    assert!(!first.one_sided);
    // A primitive without material is glTF's default: opaque, and seen from its front.
    let floor = all.iter().find(|part| part.names == ["floor", "slab"]).unwrap();
    assert!(floor.surface == Surface::Opaque && floor.one_sided && floor.coordinates.is_empty());
}

#[test]
fn blends_and_transmission_are_tints() {
    let folder = Folder::new();
    let mut material = mask();
    material["alphaMode"] = json!("BLEND");
    material["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, 0.5]);
    let Surface::Stained(tints) = surface(&folder, &card(material, &picture())) else { panic!("no tints") };
    let expected = [0.0, 100.0, 200.0, 255.0].map(|alpha: f32| [1.0 - alpha / 255.0 * 0.5; 3]);
    assert_eq!(tints.texels, expected);
    let glass = json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1], "baseColorTexture": {"index": 0}},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}}});
    // All texels have the same colour; alpha has no say.
    assert_eq!(surface(&folder, &card(glass, &picture())), Surface::Tinted(Vec3::new(0.5, 0.0, 0.125)));
    let document =
        card(json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.25]}}), &picture());
    assert_eq!(surface(&folder, &document), Surface::Tinted(Vec3::splat(0.75)));
}

#[test]
fn opaque_materials_ask_for_nothing() {
    let folder = Folder::new();
    let mut document =
        card(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 7}}}), &picture());
    document["images"][0] = json!({"uri": "missing.png"});
    let read = load(&folder, &document).unwrap();
    assert!(read.parts.iter().all(|part| part.surface == Surface::Opaque));
    // No cutout is where no texel is cut out.
    let opaque = DynamicImage::from(RgbaImage::from_pixel(2, 2, Rgba([255; 4])));
    assert_eq!(surface(&folder, &card(mask(), &opaque)), Surface::Opaque);
}

#[test]
fn pictures_are_where_gltf_allows_them() {
    let folder = Folder::new();
    let embedded = surface(&folder, &card(mask(), &picture()));
    let png = encoded(&picture(), ImageFormat::Png);
    folder.write("a b.png", &png);
    for image in [json!({"uri": data_uri("image/png", &png)}), json!({"uri": "a%20b.png"})] {
        let mut document = card(mask(), &picture());
        document["images"][0] = image;
        assert_eq!(surface(&folder, &document), embedded);
    }
    // A JPEG has no alpha, but a colour.
    let red = DynamicImage::from(RgbaImage::from_pixel(8, 8, Rgba([255, 0, 0, 255]))).into_rgb8().into();
    let glass = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}});
    let mut document = card(glass, &picture());
    document["images"][0] = json!({"uri": data_uri("image/jpeg", &encoded(&red, ImageFormat::Jpeg))});
    let Surface::Tinted(tint) = surface(&folder, &document) else { panic!("not even") };
    assert!(tint.x > 0.97 && tint.y < 0.01 && tint.z < 0.01, "{tint}");
}

#[test]
fn samplers_and_sets_of_coordinates() {
    let folder = Folder::new();
    let mut document = card(mask(), &picture());
    document["textures"][0]["sampler"] = json!(0);
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(1);
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0,
        "extensions": {"KHR_texture_transform": {"texCoord": 1, "offset": [0.25, 0], "scale": [0.5, 2]}}});
    let read = load(&folder, &document).unwrap();
    let part = read.parts.iter().find(|part| part.surface.is_textured()).unwrap();
    assert_eq!(part.coordinates, [[0.25, 0.0], [0.25, 2.0], [0.75, 2.0], [0.75, 0.0]]);
    let Surface::Cutout { alphas, .. } = &part.surface else { panic!("no cutout") };
    assert_eq!(alphas.size.wrap, [Wrap::Clamp, Wrap::Repeat]);
}

#[test]
fn bad_descriptions_name_field_and_value() {
    let folder = Folder::new();
    folder.write("noise.png", "noise");
    let mut cut = encoded(&picture(), ImageFormat::Png);
    cut.truncate(50);
    folder.write("cut.png", cut);
    let base = |field: &str| format!("/materials/0/pbrMetallicRoughness/{field}");
    let primitive = "/meshes/0/primitives/0/attributes";
    for (place, value, words) in [
        ("/materials/0/alphaCutoff".into(), json!(-0.25), "material 0 'leaf': field `alphaCutoff` is -0.25"),
        ("/materials/0/alphaCutoff".into(), json!(1e39), "field `alphaCutoff` is inf: not a number that is 0 at least"),
        (base("baseColorFactor"), json!([1, 1, 1, 1.5]), "field `baseColorFactor[3]` is 1.5: not a number in 0..=1"),
        (base("baseColorFactor"), json!([1, -2, 1, 1]), "field `baseColorFactor[1]` is -2"),
        (
            "/materials/0/extensions".into(),
            json!({"KHR_materials_transmission": {"transmissionFactor": 3}}),
            "material 0 'leaf': field `transmissionFactor` is 3",
        ),
        (
            "/materials/0/extensions".into(),
            json!({"KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": {"index": 0}}}),
            "field `transmissionTexture`, texture 0 'leaves', is not supported",
        ),
        (
            base("baseColorTexture"),
            json!({"index": 4}),
            "field `baseColorTexture` names texture 4, but there are only 1",
        ),
        (
            "/textures/0/source".into(),
            json!(3),
            "texture 0 'leaves': field `source` names image 3, but there are only 1",
        ),
        ("/textures/0".into(), json!({}), "texture 0: field `source` is missing"),
        ("/textures/0/sampler".into(), json!(2), "field `sampler` names sampler 2, but there are only 2"),
        (
            "/textures/0/sampler".into(),
            json!(1),
            "texture 0 'leaves': field `wrapT` of its sampler is MIRRORED_REPEAT, which is not supported",
        ),
        ("/images/0".into(), json!({}), "texture 0 'leaves': image 0: fields `uri` and `bufferView` are both missing"),
        ("/images/0".into(), json!({"uri": "missing.png"}), "missing.png"),
        ("/images/0".into(), json!({"uri": "noise.png"}), "image 0: neither a PNG nor a JPEG"),
        ("/images/0".into(), json!({"uri": "cut.png"}), "image 0: cannot be decoded"),
        ("/bufferViews/3/byteLength".into(), json!(4000), "field `bufferView` is 3, which reaches outside its buffer"),
        (
            primitive.into(),
            json!({"POSITION": 0}),
            "material 0 'leaf': primitive 0 of mesh 0 'leaf': TEXCOORD_0, which `baseColorTexture` needs, is missing",
        ),
        (
            base("baseColorTexture"),
            json!({"index": 0, "texCoord": 3}),
            "TEXCOORD_3, which `baseColorTexture` needs, is missing",
        ),
        (primitive.into(), json!({"POSITION": 0, "TEXCOORD_0": 3}), "has 3 elements for 4 vertices"),
        (primitive.into(), json!({"POSITION": 0, "TEXCOORD_0": 0}), "is not two f32, or two normalized u8 or u16"),
        (
            base("baseColorTexture"),
            json!({"index": 0, "extensions": {"KHR_texture_transform": {"scale": [1e39, 1]}}}),
            "of vertex 0 is NaN, not a finite number",
        ),
        (
            "/nodes/0/extras".into(),
            json!({"umbra4_caster": {"caster_layers": [3, 32]}}),
            "node 0 'card': field `caster_layers[1]` is 32: not a layer, 0 to 31",
        ),
        (
            "/meshes/0/extras".into(),
            json!({"umbra4_caster": {"plane_offset": -1}}),
            "mesh 0 'leaf': field `plane_offset` is -1: not a distance, 0 at least",
        ),
        ("/nodes/0/extras".into(), json!({"umbra4_caster": 3}), "node 0 'card': not a description of shadows"),
    ] {
        let mut document = card(mask(), &picture());
        put(&mut document, &place, value);
        let message = load(&folder, &document).err().unwrap_or_default();
        assert!(message.contains(words), "{place}: {message}");
    }
    // The same through the program.
    folder.write("card.gltf", card(json!({"alphaMode": "MASK", "alphaCutoff": -1}), &picture()).to_string());
    folder.fail("render card.gltf -o out.png", "card.gltf: material 0: field `alphaCutoff` is -1");
}

/// Puts a value where there may be none yet.
fn put(document: &mut Value, place: &str, value: Value) {
    let (parent, field) = place.rsplit_once('/').unwrap();
    let parent = document.pointer_mut(parent).unwrap();
    match parent {
        Value::Array(items) => items[field.parse::<usize>().unwrap()] = value,
        parent => parent[field] = value,
    }
}

#[test]
fn extras_and_scene_files_say_how_parts_cast() {
    let folder = Folder::new();
    let mut document = card(mask(), &picture());
    document["meshes"][0]["extras"] = json!({"umbra4_caster": {"caster_layers": [1], "plane_offset": 0.5}, "other": 1});
    document["nodes"][0]["extras"] = json!({"umbra4_caster": {"caster_layers": [2, 0]}});
    let read = load(&folder, &document).unwrap();
    let casting = |name: &str| read.parts.iter().find(|part| part.names.iter().any(|own| own == name)).unwrap().casting;
    assert_eq!(
        (casting("card").caster_layers, casting("card").receiver_layers),
        (Layers::from_bits(0b101), Layers::ALL)
    );
    assert_eq!(casting("leaf").plane_offset, 0.5);
    assert_eq!(casting("floor"), Default::default());

    let scene = |casters: &str| {
        format!(
            r#"{{"model":"card.gltf","casters":[{casters}],"lights":[{{"kind":"directional","towards":[0,1,0]}}]}}"#
        )
    };
    folder.write(
        "scene.json",
        scene(r#"{"name":"leaf","plane_offset":0},{"name":"floor","receiver_layers":[4]},{"caster_layers":[9]}"#),
    );
    let args = umbra4::args::SceneArgs { model: Some(folder.path("scene.json")), ..Default::default() };
    let read = umbra4::scene::Scene::load(&args, None).unwrap();
    let castings: Vec<_> = read.parts.iter().map(|part| (part.names[0].clone(), part.casting)).collect();
    for (name, casting) in castings {
        let receivers = if name == "floor" { Layers::from_bits(1 << 4) } else { Layers::ALL };
        assert_eq!(
            (casting.caster_layers, casting.receiver_layers, casting.plane_offset),
            (Layers::from_bits(1 << 9), receivers, 0.0)
        );
    }
    // The ground is no part.
    assert!(read.parts.of(read.model.triangles.len() - 1).is_none());

    for (casters, words) in [
        (r#"{"name":"stem"}"#, "scene.json: field `casters[0]`: no node or mesh of the model is called 'stem'"),
        (r#"{},{"caster_layers":[-1]}"#, "scene.json: field `casters[1]`: field `caster_layers[0]` is -1: not a layer"),
        (r#"{"plane_offset":1e999}"#, "field `casters[0]`: field `plane_offset`: number out of range"),
    ] {
        folder.write("scene.json", scene(casters));
        folder.fail("render scene.json -o out.png", words);
    }
    let pane = json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}});
    folder.write("card.gltf", card(pane, &picture()).to_string());
    folder.write("scene.json", scene(r#"{"plane_offset":0.25}"#));
    let words =
        "field `casters`: node 0 'card': field `plane_offset` is 0.25: surfaces that let light through have none";
    folder.fail("render scene.json -o out.png", words);
}

#[test]
fn mutilated_documents_never_panic() {
    let folder = Folder::new();
    let mut document = card(mask(), &picture());
    document["extensionsUsed"] = json!(["KHR_materials_transmission"]);
    document["materials"][0]["extensions"] = json!({"KHR_materials_transmission": {"transmissionFactor": 0.5}});
    let text = document.to_string().into_bytes();
    let path = folder.path("card.gltf");
    for position in 0..text.len() {
        // Inside the buffer one in many, outside of it each.
        let in_data = text[..position].windows(7).any(|word| word == b";base64") && position % 37 != 0;
        for byte in [b'9', b'-', b'"', b'}'] {
            if !in_data {
                let mut broken = text.clone();
                broken[position] = byte;
                std::fs::write(&path, broken).unwrap();
                let _ = model::load_furnished(&path, FileLights::Taken);
            }
        }
    }
    assert!(model::load_furnished(Path::new("/nowhere/card.gltf"), FileLights::Taken).is_err());
}
