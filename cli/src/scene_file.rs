//! Scene files: a model, a camera and lights in one JSON file. docs/scene-files.md describes them.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use serde_json::value::RawValue;
use umbra4_core::glam::DVec3;

use crate::{
    camera::{CameraError, Viewpoint},
    description::{self, DescriptionError, FieldError, Fields},
    in_file::InFile,
    light::{InLight, Light},
    model::{CastingError, CastingSaid, InPart, Model, Parts},
};

/// Why a scene file is refused.
#[derive(Debug, thiserror::Error)]
pub enum SceneFileError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// The file is not a JSON object.
    #[error("not a scene: {0}")]
    Malformed(#[from] serde_json::Error),
    /// One of its fields.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A field of its camera.
    #[error("field `camera`: {0}")]
    CameraField(FieldError),
    /// Its camera looks nowhere.
    #[error("field `camera`: {0}")]
    Camera(#[from] CameraError),
    /// It is dark.
    #[error("field `lights` is empty: a scene has one light at least")]
    NoLights,
    /// One of its casters.
    #[error("field `casters[{index}]`: {reason}")]
    Caster {
        /// Which of them.
        index: usize,
        /// What is wrong with it.
        reason: CastingError,
    },
    /// Casters that do not go with the model.
    #[error("field `casters`: {0}")]
    Casters(#[from] InPart<CastingError>),
    /// One of its lights.
    #[error(transparent)]
    Light(#[from] InLight<DescriptionError>),
}

/// What a scene file says.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// Where the model is.
    pub model: PathBuf,
    /// Whether there is a ground under it.
    pub ground: bool,
    /// The camera, as far as it is given.
    pub camera: Viewpoint,
    /// How parts of the model cast shadows, one after the other.
    pub casters: Vec<CasterSaid>,
    /// The lights, one at least.
    pub lights: Vec<Light>,
}

/// What a scene says about parts of its model.
#[derive(Clone, Debug, PartialEq)]
pub struct CasterSaid {
    /// The name of their nodes or of their meshes; all of them without it.
    pub name: Option<String>,
    /// How they cast and receive shadows.
    pub said: CastingSaid,
}

/// Whether a file is a scene by its name.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

/// Reads a scene file; the paths in it are relative to its folder.
///
/// # Errors
/// See [`SceneFileError`].
pub fn read(path: &Path) -> Result<SceneFile, InFile<SceneFileError>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let text = fs::read(path).map_err(SceneFileError::from);
    text.and_then(|text| parse(&text, folder)).map_err(InFile::at(path))
}

fn parse(text: &[u8], folder: &Path) -> Result<SceneFile, SceneFileError> {
    let mut fields: Fields = serde_json::from_slice(text)?;
    let model: PathBuf = fields.required("model")?;
    let ground = fields.optional("ground")?.unwrap_or(true);
    let camera = fields.optional("camera")?.map(viewpoint).transpose()?.unwrap_or_default();
    let casters: Vec<Box<RawValue>> = fields.optional("casters")?.unwrap_or_default();
    let lights: Vec<Box<RawValue>> = fields.required("lights")?;
    fields.finish()?;
    if lights.is_empty() {
        return Err(SceneFileError::NoLights);
    }
    let lights = lights.iter().enumerate().map(|(index, light)| description::light(index, light, folder));
    let casters = casters
        .iter()
        .enumerate()
        .map(|(index, json)| caster(json).map_err(|reason| SceneFileError::Caster { index, reason }));
    Ok(SceneFile {
        model: folder.join(model),
        ground,
        camera,
        casters: casters.collect::<Result<_, _>>()?,
        lights: lights.collect::<Result<_, _>>()?,
    })
}

fn caster(json: &RawValue) -> Result<CasterSaid, CastingError> {
    let mut fields: Fields = serde_json::from_str(json.get())?;
    let name = fields.optional("name")?;
    let said = CastingSaid::take(&mut fields)?;
    fields.finish()?;
    Ok(CasterSaid { name, said })
}

/// Says of the parts of a model what a scene says of them.
///
/// # Errors
/// A name that none of them has; what does not go together, the model's own file included.
pub fn cast(casters: &[CasterSaid], parts: &mut Parts, model: &Model) -> Result<(), SceneFileError> {
    for (index, CasterSaid { name, said }) in casters.iter().enumerate() {
        parts.cast(name.as_deref(), said, model).map_err(|reason| SceneFileError::Caster { index, reason })?;
    }
    Ok(parts.check()?)
}

fn viewpoint(mut fields: Fields) -> Result<Viewpoint, SceneFileError> {
    let mut read = || -> Result<Viewpoint, FieldError> {
        let point = |point: [f64; 3]| DVec3::from_array(point);
        let from = fields.optional("from")?.map(point);
        Ok(Viewpoint { from, to: fields.optional("to")?.map(point), fov: fields.optional("fov")? })
    };
    let viewpoint = read().map_err(SceneFileError::CameraField)?;
    fields.finish().map_err(SceneFileError::CameraField)?;
    viewpoint.check()?;
    Ok(viewpoint)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(text: &str) -> Result<SceneFile, String> {
        parse(text.as_bytes(), Path::new("folder")).map_err(|e| e.to_string())
    }

    const LIGHTS: &str = r#""lights":[{"kind":"point","position":[0,4,0]}]"#;

    #[test]
    fn what_is_left_out_has_a_default() {
        let read = scene(&format!(r#"{{"model":"model.obj",{LIGHTS}}}"#)).unwrap();
        assert_eq!((read.model.as_path(), read.ground, read.lights.len()), (Path::new("folder/model.obj"), true, 1));
        assert_eq!(read.camera, Viewpoint::default());
        let camera = r#""camera":{"from":[1,2,3],"to":[0,0,0],"fov":40}"#;
        let read = scene(&format!(r#"{{"model":"/m.obj","ground":false,{camera},{LIGHTS}}}"#)).unwrap();
        assert_eq!((read.model.as_path(), read.ground), (Path::new("/m.obj"), false));
        assert_eq!(read.camera.from, Some(DVec3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn errors_name_the_field() {
        for (fields, words) in [
            (r#""model":"m.obj","lights":[]"#, "field `lights` is empty"),
            (r#""model":"m.obj""#, "field `lights` is missing"),
            (r#""model":3"#, "field `model`: invalid type"),
            (r#""model":"m.obj","sky":1,"lights":[]"#, "field `sky` is unknown"),
            (r#""model":"m.obj","lights":[3]"#, "light 0: not a light: invalid type"),
            (r#""model":"m.obj","camera":{"form":[0,0,0]}"#, "field `camera`: field `form` is unknown"),
            (r#""model":"m.obj","camera":{"fov":0}"#, "field `camera`: the field of view is 0"),
            (r#""model":"m.obj","camera":{"from":[1,1,1],"to":[1,1,1]}"#, "field `camera`: the camera stands"),
            (r#""model":"m.obj","casters":3"#, "field `casters`: invalid type"),
            (r#""model":"m.obj","casters":[{},3],"lights":[3]"#, "field `casters[1]`: not a description of shadows"),
            (r#""model":"m.obj","casters":[{"name":3}],"lights":[3]"#, "field `casters[0]`: field `name`: invalid"),
            (
                r#""model":"m.obj","casters":[{"caster_layers":[32]}],"lights":[3]"#,
                "field `casters[0]`: field `caster_layers[0]` is 32: not a layer, 0 to 31",
            ),
            (
                r#""model":"m.obj","casters":[{"plane_offset":-1}],"lights":[3]"#,
                "field `casters[0]`: field `plane_offset` is -1",
            ),
            (r#""model":"m.obj","casters":[{"layer":1}],"lights":[3]"#, "field `casters[0]`: field `layer` is unknown"),
            (r#""model":"m.obj","lights":[{"kind":"point"}]"#, "light 0: field `position` is missing"),
        ] {
            let message = scene(&format!("{{{fields}}}")).unwrap_err();
            assert!(message.contains(words), "{fields}: {message}");
        }
        assert!(scene("[]").unwrap_err().contains("expected an object"));
        assert!(scene(&format!(r#"{{"model":NaN,{LIGHTS}}}"#)).unwrap_err().contains("not a scene: expected value"));
    }

    #[test]
    fn mutilated_files_never_panic() {
        let page = include_str!("../../docs/scene-files.md");
        let example = page.split("```json").nth(1).and_then(|rest| rest.split("```").next()).unwrap().as_bytes();
        assert_eq!(parse(example, Path::new("folder")).unwrap().lights.len(), 6);
        for position in 0..example.len() {
            assert!(position + 2 > example.len() || parse(&example[..position], Path::new("folder")).is_err());
            for byte in [0, b'9', b'-', b'"', b'}', b',', 0xff] {
                let mut broken = example.to_vec();
                broken[position] = byte;
                let _ = parse(&broken, Path::new("folder"));
            }
        }
    }
}
