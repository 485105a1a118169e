//! One light.

use std::path::Path;

use serde_json::value::RawValue;
use umbra4_core::{
    DirectionalLight,
    glam::{DMat4, DVec3},
};

use super::{DescriptionError, Fields, power, rectangle, volume};
use crate::light::{HardLight, InLight, Light, Source};

/// Takes the fields of one kind of light. Returns where it shines from, and what it emits in the mean, red, green and
/// blue, where colour and intensity are 1.
type Read = fn(&mut Fields, &Path) -> Result<(Source, DVec3), DescriptionError>;

/// All kinds, by name.
const KINDS: [(&str, Read); 7] = [
    (RECTANGLE, rectangle::read),
    ("point", |fields, _| point(fields)),
    ("directional", |fields, _| directional(fields)),
    ("sphere", |fields, _| volume::sphere(fields)),
    ("ellipsoid", |fields, _| volume::ellipsoid(fields)),
    ("tube", |fields, _| volume::tube(fields)),
    ("cloud", |fields, _| volume::cloud(fields)),
];

/// The one kind that nodes have.
const RECTANGLE: &str = "rectangle";

/// Reads a light with its own place in the world. `index` counts the lights of the file; pictures lie in `folder`.
///
/// # Errors
/// See [`DescriptionError`]; the light is named.
pub fn light(index: usize, json: &RawValue, folder: &Path) -> Result<Light, InLight<DescriptionError>> {
    described(index, None, json, |fields| {
        let found: String = fields.required("kind")?;
        match KINDS.iter().find(|(kind, _)| *kind == found) {
            Some((_, read)) => read(fields, folder),
            None => Err(DescriptionError::Kind { found, known: KINDS.map(|(kind, _)| kind).join(", ") }),
        }
    })
}

/// Reads a rectangle that has its place, and unless it says otherwise its name, from a node.
///
/// # Errors
/// See [`DescriptionError`]; the light is named.
pub fn light_on_node(
    index: usize,
    name: Option<&str>,
    json: &RawValue,
    (folder, transform): (&Path, &DMat4),
) -> Result<Light, InLight<DescriptionError>> {
    described(index, name, json, |fields| match fields.optional::<String>("kind")? {
        Some(found) if found != RECTANGLE => Err(DescriptionError::Kind { found, known: RECTANGLE.to_owned() }),
        _ => rectangle::read_on_node(fields, folder, transform),
    })
}

/// What messages call a light.
pub fn label(index: usize, name: Option<&str>) -> String {
    name.map_or_else(|| format!("light {index}"), |name| format!("light {index} '{name}'"))
}

/// Takes what all lights have, and by `read` what that kind has; nothing may be left over.
fn described(
    index: usize,
    node: Option<&str>,
    json: &RawValue,
    read: impl FnOnce(&mut Fields) -> Result<(Source, DVec3), DescriptionError>,
) -> Result<Light, InLight<DescriptionError>> {
    // Until its own name is known.
    let by_node = label(index, node);
    let unnamed = InLight::at(&by_node);
    let mut fields: Fields = serde_json::from_str(json.get()).map_err(|e| unnamed(e.into()))?;
    let name: Option<String> = fields.optional("name").map_err(|e| unnamed(e.into()))?;
    let label = label(index, name.as_deref().or(node));
    let describe = || {
        let color = fields.optional("color")?.unwrap_or([1.0; 3]);
        let power = power(color, fields.optional("intensity")?.unwrap_or(1.0))?;
        let (source, mean) = read(&mut fields)?;
        fields.finish()?;
        Ok((source, power * mean))
    };
    let (source, power) = describe().map_err(InLight::at(&label))?;
    Ok(Light { label, power, source })
}

fn point(fields: &mut Fields) -> Result<(Source, DVec3), DescriptionError> {
    let position = DVec3::from_array(fields.required("position")?);
    Ok((Source::Hard(HardLight::Lamp(position)), DVec3::ONE))
}

fn directional(fields: &mut Fields) -> Result<(Source, DVec3), DescriptionError> {
    let towards = DVec3::from_array(fields.required("towards")?);
    // One that points nowhere is wrong on any lattice.
    DirectionalLight { towards }.snap()?;
    Ok((Source::Hard(HardLight::Sun(towards)), DVec3::ONE))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Light, String> {
        light(2, &RawValue::from_string(text.to_owned()).unwrap(), Path::new("/nowhere")).map_err(|e| e.to_string())
    }

    fn on_node(text: &str, transform: DMat4) -> Light {
        let json = RawValue::from_string(text.to_owned()).unwrap();
        light_on_node(0, Some("lamp"), &json, (Path::new("/nowhere"), &transform)).unwrap()
    }

    #[test]
    fn every_kind_is_read() {
        let rectangle = r#"{"kind":"rectangle","corner":[0,1,0],"edge_u":[1,0,0],"edge_v":[0,0,1],"samples":[8,16]}"#;
        assert_eq!(parse(rectangle).unwrap().kind(), "a rectangle of 8×16 samples");
        let point =
            parse(r#"{"kind":"point","position":[0,1,0],"color":[1,0,0.5],"intensity":2,"name":"bulb"}"#).unwrap();
        assert_eq!((point.label.as_str(), point.power), ("light 2 'bulb'", DVec3::new(2.0, 0.0, 1.0)));
        let sun = parse(r#"{"kind":"directional","towards":[0,1,0]}"#).unwrap();
        assert_eq!(sun.label, "light 2");
        for (text, kind) in [
            (r#"{"kind":"sphere","center":[0,1,0],"radius":0.5}"#, "a sphere of 256 samples"),
            (
                r#"{"kind":"ellipsoid","center":[0,1,0],"axes":[[1,0,0],[0,1,0],[0,0,2]],"samples":64}"#,
                "an ellipsoid of 64 samples",
            ),
            (r#"{"kind":"tube","from":[0,1,0],"to":[1,1,0],"radius":0.1,"samples":1024}"#, "a tube of 1024 samples"),
            (r#"{"kind":"cloud","points":[[0,1,0],[1,1,0]]}"#, "a cloud of 2 samples"),
        ] {
            assert_eq!(parse(text).unwrap().kind(), kind);
        }
    }

    #[test]
    fn errors_name_light_and_field() {
        for (text, words) in [
            ("3", "light 2: not a light: invalid type: integer `3`, expected an object"),
            (r#"{"kind":"point","kind":"point"}"#, "light 2: not a light: field `kind` is there twice"),
            ("{}", "light 2: field `kind` is missing"),
            (r#"{"kind":"moon"}"#, "field `kind` is 'moon': known here are rectangle, point, directional, sphere"),
            (r#"{"kind":"point","name":"a"}"#, "light 2 'a': field `position` is missing"),
            (r#"{"kind":"point","name":3}"#, "light 2: field `name`: invalid type"),
            (r#"{"kind":"point","position":[0,0,0],"size":3}"#, "field `size` is unknown"),
            (r#"{"kind":"point","position":[0,0,0],"color":[1,1]}"#, "field `color`: invalid length"),
            (r#"{"kind":"point","position":[0,0,0],"color":[1,1,-1]}"#, "field `color[2]` is -1"),
            (r#"{"kind":"point","position":[0,0,0],"intensity":1e999}"#, "field `intensity`: number out of range"),
            (r#"{"kind":"directional","towards":[0,0,0]}"#, "points nowhere"),
            (r#"{"kind":"sphere","center":[0,0,0]}"#, "field `radius` is missing"),
            (
                r#"{"kind":"sphere","center":[0,0,0],"radius":1,"samples":0}"#,
                "field `samples`: 0 samples, outside 1..=1024",
            ),
            (r#"{"kind":"tube","from":[0,0,0],"to":[1,0,0],"radius":1,"samples":4000000000}"#, "4000000000 samples"),
            (r#"{"kind":"cloud","points":[]}"#, "field `points`: 0 samples"),
            (r#"{"kind":"rectangle","corner":[0,1,0],"edge_u":[1,0,0]}"#, "field `edge_v` is missing"),
            (r#"{"kind":"rectangle","corner":[0,1,0],"edge_u":[1,0,0],"edge_v":[1,0,0]}"#, "no area"),
            (
                r#"{"kind":"rectangle","corner":[0,1,0],"edge_u":[1,0,0],"edge_v":[0,0,1],"samples":65}"#,
                "rows is 65, outside 1..=64",
            ),
            (
                r#"{"kind":"rectangle","corner":[0,1,0],"edge_u":[1,0,0],"edge_v":[0,0,1],"samples":"9"}"#,
                "field `samples`: a number of samples each way or [rows, columns]",
            ),
        ] {
            let message = parse(text).unwrap_err();
            assert!(message.contains(words), "{text}: {message}");
        }
    }

    #[test]
    fn rectangles_on_nodes_shine_along_their_negative_z() {
        let text = r#"{"width":2,"height":1,"samples":4}"#;
        for transform in [
            DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0)),
            DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
            DMat4::from_scale(DVec3::new(3.0, 1.0, 2.0)) * DMat4::from_rotation_x(0.7),
        ] {
            let light = on_node(text, transform);
            let Source::Area(area) = &light.source else { panic!("{light:?}") };
            let [corner, along_u, _, along_v] = area.front().area.corners();
            let towards = transform.transform_vector3(DVec3::NEG_Z);
            assert!((along_u - corner).cross(along_v - corner).dot(towards) > 0.0, "{transform}");
            let center = transform.transform_point3(DVec3::ZERO);
            assert!((area.front().area.center() - center).length() < 1e-12);
        }
    }
}
