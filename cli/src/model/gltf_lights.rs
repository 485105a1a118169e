//! The lights of a glTF document: those of KHR_lights_punctual, and rectangles in the extras of nodes.

use std::path::Path;

use gltf::khr_lights_punctual::Kind;
use umbra4_core::{
    DirectionalLight,
    glam::{DMat4, DVec3},
};

use super::{ModelError, gltf::Placed, gltf_extras};
use crate::{
    description::{self, DescriptionError},
    light::{Cone, HardLight, InLight, Light, Source},
};

/// All lights, in the order of the nodes. Pictures of samples lie beside the document.
pub(super) fn read(nodes: &[Placed<'_>], path: &Path) -> Result<Vec<Light>, ModelError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut lights = Vec::new();
    for (node, transform) in nodes {
        if let Some(light) = node.light() {
            let label = description::label(lights.len(), node.name().or(light.name()));
            let (power, hard) = punctual(&light, transform).map_err(InLight::at(&label))?;
            lights.push(Light { label, power, source: Source::Hard(hard) });
        }
        if let Some(json) = gltf_extras::find(node.extras(), gltf_extras::LIGHT) {
            lights.push(description::light_on_node(lights.len(), node.name(), &json, (folder, transform))?);
        }
    }
    Ok(lights)
}

/// Its power, and where it shines from.
fn punctual(
    light: &gltf::khr_lights_punctual::Light<'_>,
    transform: &DMat4,
) -> Result<(DVec3, HardLight), DescriptionError> {
    let power = description::power(light.color().map(f64::from), f64::from(light.intensity()))?;
    let position = transform.transform_point3(DVec3::ZERO);
    let axis = transform.transform_vector3(DVec3::NEG_Z);
    let hard = match light.kind() {
        Kind::Point => HardLight::Lamp(position),
        Kind::Directional => {
            // One that points nowhere is wrong on any lattice.
            DirectionalLight { towards: -axis }.snap()?;
            HardLight::Sun(-axis)
        }
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            HardLight::Spot(position, Cone::new(axis, inner_cone_angle.into(), outer_cone_angle.into())?)
        }
    };
    Ok((power, hard))
}

#[cfg(test)]
mod tests {
    use crate::model::{FileLights, gltf::parse_furnished};

    use super::*;

    /// One triangle, and nodes with these fields beside it.
    fn document(nodes: &str, lights: &str) -> String {
        let count = nodes.matches("\"name\"").count();
        let list = (0..=count).map(|node| node.to_string()).collect::<Vec<_>>().join(",");
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{list}]}}],
            "extensionsUsed":["KHR_lights_punctual"],"extensions":{{"KHR_lights_punctual":{{"lights":[{lights}]}}}},
            "cameras":[{{"type":"perspective","perspective":{{"yfov":1,"znear":0.1}}}}],
            "nodes":[{{"mesh":0}},{nodes}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],
            "buffers":[{{"uri":"data:application/octet-stream;base64,{}","byteLength":36}}]}}"#,
            "A".repeat(48)
        )
    }

    const NODES: &str = r#"{"name":"spot","translation":[1,2,3],"rotation":[-0.7071068,0,0,0.7071068],
        "extensions":{"KHR_lights_punctual":{"light":0}}},
        {"name":"sun","extensions":{"KHR_lights_punctual":{"light":1}}},
        {"name":"panel","translation":[0,4,0],"extras":{"umbra4":{"width":2,"height":1,"samples":8},"other":1}},
        {"name":"camera","translation":[0,0,5],"camera":0,"extras":"text"}"#;
    const LIGHTS: &str = r#"{"type":"spot","color":[1,0.5,0],"intensity":4,"spot":{"outerConeAngle":0.5}},
        {"type":"directional"}"#;

    #[test]
    fn lights_and_camera_stand_where_their_nodes_are() {
        let read = parse_furnished(document(NODES, LIGHTS).as_bytes(), Path::new("x.gltf"), FileLights::Taken).unwrap();
        let labels: Vec<&str> = read.lights.iter().map(|light| light.label.as_str()).collect();
        assert_eq!(labels, ["light 0 'spot'", "light 1 'sun'", "light 2 'panel'"]);
        assert_eq!(read.lights[0].power, DVec3::new(4.0, 2.0, 0.0));
        let Source::Hard(spot) = read.lights[0].source else { panic!("{:?}", read.lights[0]) };
        // Turned down, it lights what is below and nothing beside.
        assert!(spot.irradiance(DVec3::new(1.0, 0.0, 3.0), DVec3::Y) > 0.249);
        assert_eq!(spot.irradiance(DVec3::new(3.0, 0.0, 3.0), DVec3::Y), 0.0);
        let Source::Hard(HardLight::Sun(towards)) = read.lights[1].source else { panic!("{:?}", read.lights[1]) };
        assert_eq!(towards, DVec3::Z);
        assert_eq!(read.lights[2].kind(), "a rectangle of 8×8 samples");
        let camera = read.camera.unwrap();
        assert_eq!(camera.from, Some(DVec3::new(0.0, 0.0, 5.0)));
        assert_eq!(camera.to, Some(DVec3::ZERO));
        assert!((camera.fov.unwrap() - 57.29578).abs() < 1e-4);
    }

    #[test]
    fn errors_name_the_light() {
        for (from, to, words) in [
            ("\"width\":2", "\"width\":0", "light 2 'panel': field `width` is 0"),
            ("\"width\":2,", "", "light 2 'panel': field `width` is missing"),
            ("\"samples\":8", "\"sample\":8", "field `sample` is unknown"),
            ("{\"width\":2,\"height\":1,\"samples\":8}", "3", "light 2 'panel': not a light: invalid type"),
            ("\"intensity\":4", "\"intensity\":-4", "light 0 'spot': field `intensity` is -4"),
            ("\"outerConeAngle\":0.5", "\"innerConeAngle\":1", "light 0 'spot': cone from innerConeAngle 1"),
            ("\"name\":\"sun\"", "\"name\":\"sun\",\"scale\":[0,0,0]", "light 1 'sun': light direction is"),
        ] {
            let text = document(NODES, LIGHTS);
            assert!(text.contains(from), "{from}");
            let text = text.replace(from, to);
            let parse = |lights| parse_furnished(text.as_bytes(), Path::new("x.gltf"), lights);
            let message = parse(FileLights::Taken).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
            // Where lights are passed over, what is wrong with them does not matter.
            assert!(parse(FileLights::PassedOver).is_ok());
        }
    }

    #[test]
    fn mutilated_files_never_panic() {
        let file = document(NODES, LIGHTS).into_bytes();
        for position in 0..file.len() {
            for byte in [0, b'9', b'-', b'"', b'}', 0xff] {
                let mut broken = file.clone();
                broken[position] = byte;
                let _ = parse_furnished(&broken, Path::new("/nowhere/x.gltf"), FileLights::Taken);
            }
        }
        let other = String::from_utf8(file).unwrap().replace("\"type\":\"perspective\"", "\"type\":\"orthographic\"");
        assert!(parse_furnished(other.as_bytes(), Path::new("x.gltf"), FileLights::Taken).is_ok());
    }
}
