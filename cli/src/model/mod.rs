//! Triangle meshes from files: one loader a format, all behind [`load`].

mod casting;
mod gltf;
mod gltf_buffers;
mod gltf_camera;
mod gltf_coordinates;
mod gltf_extras;
mod gltf_lights;
mod gltf_materials;
mod gltf_parts;
mod gltf_pictures;
mod material_error;
mod obj;
mod part;
mod ply;
mod soup;
mod surface;

use std::{ffi::OsStr, fs, io, path::Path};

use umbra4_core::{
    Bounds,
    glam::{DVec3, Vec3},
};

use crate::{
    array_file::ArrayError,
    camera::Viewpoint,
    description::DescriptionError,
    in_file::InFile,
    light::{InLight, Light},
};

pub use casting::{Casting, CastingError, CastingSaid, Closed, InPart};
pub use gltf_pictures::PictureError;
pub use material_error::{CoordinatesError, InMaterial, MaterialError, TextureError, TextureName};
pub use part::{Part, Parts};
pub use surface::{Surface, Texture};

/// An indexed triangle mesh, in world units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model<V = Vec3> {
    /// Positions; all finite where a model comes from a file.
    pub vertices: Vec<V>,
    /// Vertex indices; all in range where a model comes from a file.
    pub triangles: Vec<[u32; 3]>,
}

/// A model with what its file brings along.
#[derive(Clone, Debug, Default)]
pub struct Furnished<V = Vec3> {
    /// The triangles.
    pub model: Model<V>,
    /// How they cast and receive shadows; glTF alone says.
    pub parts: Parts,
    /// Its lights, where they are taken; glTF alone has some.
    pub lights: Vec<Light>,
    /// Its first camera, if there is one; glTF alone has some.
    pub camera: Option<Viewpoint>,
}

/// What becomes of the lights of a model's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileLights {
    /// They are read: what is wrong with them is an error.
    Taken,
    /// They are not looked at.
    PassedOver,
}

/// Why a model is refused.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// Nothing is known about files of that name.
    #[error("unknown model format '{extension}': .obj, .ply, .ply.gz, .gltf, .glb and .npy are known")]
    UnknownExtension {
        /// Extension of the file, without the dot.
        extension: String,
    },
    /// The file ends before what it announces.
    #[error("the {format} file is truncated: {reason}")]
    Truncated {
        /// Name of the format.
        format: &'static str,
        /// What is missing.
        reason: String,
    },
    /// The file is not what its format calls for.
    #[error("not a readable {format} file: {reason}")]
    Malformed {
        /// Name of the format.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// One of its lights is refused.
    #[error(transparent)]
    Light(#[from] InLight<DescriptionError>),
    /// One of its materials is refused.
    #[error(transparent)]
    Material(#[from] InMaterial),
    /// What is said about how a part casts shadows is refused.
    #[error(transparent)]
    Casting(#[from] InPart<CastingError>),
    /// The array of a triangle soup is refused.
    #[error(transparent)]
    Array(#[from] ArrayError),
    /// There is no triangle.
    #[error("the model is empty: it has no triangles")]
    Empty,
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices}")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: i64,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN, infinite, or beyond what f32 holds.
    #[error("vertex {vertex}: coordinate {axis} is {value}, not a finite number")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
        /// 'x', 'y' or 'z'.
        axis: char,
        /// Its value.
        value: f64,
    },
}

/// Loads a model; coordinates that the file holds in f64 are rounded to f32.
///
/// # Errors
/// See [`ModelError`].
pub fn load(path: &Path) -> Result<Model, InFile<ModelError>> {
    load_f64(path).and_then(|model| rounded(model).map_err(InFile::at(path)))
}

/// Loads a model with the precision that the file has.
///
/// # Errors
/// See [`ModelError`].
pub fn load_f64(path: &Path) -> Result<Model<DVec3>, InFile<ModelError>> {
    parse_file(path).map_err(InFile::at(path))
}

/// As [`load`], with what the file says beyond triangles. Whether that goes together is asked of [`Parts::check`], once all has been said.
///
/// # Errors
/// See [`ModelError`].
pub fn load_furnished(path: &Path, lights: FileLights) -> Result<Furnished, InFile<ModelError>> {
    let Furnished { model, parts, lights, camera } = load_furnished_f64(path, lights)?;
    Ok(Furnished { model: rounded(model).map_err(InFile::at(path))?, parts, lights, camera })
}

/// As [`load_f64`], with what the file says beyond triangles.
///
/// # Errors
/// See [`ModelError`].
pub fn load_furnished_f64(path: &Path, lights: FileLights) -> Result<Furnished<DVec3>, InFile<ModelError>> {
    if !matches!(extension(path).as_str(), "gltf" | "glb") {
        return Ok(Furnished { model: load_f64(path)?, ..Furnished::default() });
    }
    let parse = || {
        let furnished = gltf::parse_furnished(&fs::read(path)?, path, lights)?;
        check(&furnished.model)?;
        Ok(furnished)
    };
    parse().map_err(InFile::at(path))
}

fn parse_file(path: &Path) -> Result<Model<DVec3>, ModelError> {
    let extension = extension(path);
    let parse: fn(&[u8], &Path) -> Result<Model<DVec3>, ModelError> = match extension.as_str() {
        "obj" => |bytes, _| obj::parse(bytes),
        "ply" => |bytes, _| ply::parse(bytes),
        "ply.gz" => |bytes, _| ply::parse_gz(bytes),
        "gltf" | "glb" => gltf::parse,
        "npy" => |bytes, _| soup::parse(bytes),
        _ => return Err(ModelError::UnknownExtension { extension }),
    };
    let model = parse(&fs::read(path)?, path)?;
    check(&model)?;
    Ok(model)
}

/// The model in f32, where that holds its coordinates.
///
/// # Errors
/// A coordinate beyond what f32 holds.
pub fn rounded(model: Model<DVec3>) -> Result<Model, ModelError> {
    let vertices: Vec<Vec3> = model.vertices.iter().map(|v| v.as_vec3()).collect();
    check_finite(vertices.iter().map(|v| v.as_dvec3()))?;
    Ok(Model { vertices, triangles: model.triangles })
}

/// Lower case, without the dot; both parts where the file is compressed.
fn extension(path: &Path) -> String {
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default().to_lowercase();
    if name.ends_with(".ply.gz") {
        return "ply.gz".to_owned();
    }
    name.rsplit_once('.').map(|(_, extension)| extension.to_owned()).unwrap_or_default()
}

fn check(model: &Model<DVec3>) -> Result<(), ModelError> {
    if model.triangles.is_empty() {
        return Err(ModelError::Empty);
    }
    let vertices = model.vertices.len();
    for (triangle, indices) in model.triangles.iter().enumerate() {
        if let Some(&vertex) = indices.iter().find(|&&v| v as usize >= vertices) {
            return Err(ModelError::IndexOutOfRange { triangle, vertex: i64::from(vertex), vertices });
        }
    }
    check_finite(model.vertices.iter().copied())
}

fn check_finite(vertices: impl Iterator<Item = DVec3>) -> Result<(), ModelError> {
    for (vertex, position) in vertices.enumerate() {
        for (axis, value) in ['x', 'y', 'z'].into_iter().zip(position.to_array()) {
            if !value.is_finite() {
                return Err(ModelError::NotFinite { vertex, axis, value });
            }
        }
    }
    Ok(())
}

/// Cuts a polygon into a fan of triangles; fewer than three corners give none.
fn push_polygon(triangles: &mut Vec<[u32; 3]>, corners: &[u32]) {
    if let [first, rest @ ..] = corners {
        triangles.extend(rest.windows(2).map(|edge| [*first, edge[0], edge[1]]));
    }
}

impl Model {
    /// The box around all vertices.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.vertices.iter().map(|v| v.as_dvec3()))
    }

    /// The corners of a triangle, in f64; `None` where there is no such triangle.
    pub fn corners(&self, triangle: usize) -> Option<[DVec3; 3]> {
        let [a, b, c] = *self.triangles.get(triangle)?;
        let corner = |v: u32| self.vertices.get(v as usize).map(|v| v.as_dvec3());
        Some([corner(a)?, corner(b)?, corner(c)?])
    }

    /// Adds the triangles of another model.
    pub fn append(&mut self, other: &Self) {
        let base = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + base)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_become_fans() {
        let mut triangles = Vec::new();
        push_polygon(&mut triangles, &[4, 5, 6, 7]);
        push_polygon(&mut triangles, &[1, 2]);
        push_polygon(&mut triangles, &[]);
        assert_eq!(triangles, [[4, 5, 6], [4, 6, 7]]);
    }

    #[test]
    fn extensions_ignore_case_and_know_compression() {
        assert_eq!(extension(Path::new("a/Dragon.PLY.gz")), "ply.gz");
        assert_eq!(extension(Path::new("scene.v2.GLB")), "glb");
        assert_eq!(extension(Path::new("scene")), "");
    }
}
