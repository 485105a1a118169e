//! Reads the benchmark's models: Wavefront .obj, and ASCII .ply (also .ply.gz) of triangles.

use std::{
    fs::File,
    io::{BufRead, BufReader, Read},
    path::Path,
};

use flate2::read::GzDecoder;
use thiserror::Error;
use umbra4_core::glam::Vec3;

/// An indexed triangle mesh.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Positions, world.
    pub vertices: Vec<Vec3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// Why a model cannot be read.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The .obj reader refuses the file.
    #[error(transparent)]
    Obj(#[from] tobj::LoadError),
    /// The .ply file is not what this reader reads.
    #[error("{0}")]
    Ply(&'static str),
}

/// Reads a model; the kind is told by the file's name.
///
/// # Errors
/// Unreadable, truncated or malformed files.
pub fn load(path: &Path) -> Result<Model, LoadError> {
    let name = path.to_string_lossy();
    if name.ends_with(".obj") {
        return obj(path);
    }
    let file = File::open(path)?;
    let reader: Box<dyn Read> = if name.ends_with(".gz") { Box::new(GzDecoder::new(file)) } else { Box::new(file) };
    ply(BufReader::new(reader))
}

fn obj(path: &Path) -> Result<Model, LoadError> {
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    // Materials are not used; that their file is missing does not matter.
    let (objects, _) = tobj::load_obj(path, &options)?;
    let mut model = Model::default();
    for object in objects {
        let first = model.vertices.len() as u32;
        model.vertices.extend(object.mesh.positions.chunks_exact(3).map(Vec3::from_slice));
        let triangles = object.mesh.indices.chunks_exact(3);
        model.triangles.extend(triangles.map(|t| [first + t[0], first + t[1], first + t[2]]));
    }
    Ok(model)
}

fn ply(reader: impl BufRead) -> Result<Model, LoadError> {
    let mut lines = reader.lines();
    let (mut vertices, mut triangles) = (0, 0);
    loop {
        let line = lines.next().ok_or(LoadError::Ply("the header does not end"))??;
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["end_header"] => break,
            ["format", format, ..] if *format != "ascii" => return Err(LoadError::Ply("only ASCII .ply is read")),
            ["element", "vertex", count] => vertices = parse(count)?,
            ["element", "face", count] => triangles = parse(count)?,
            _ => {}
        }
    }
    let mut line = || lines.next().ok_or(LoadError::Ply("the file is truncated"));
    let mut model = Model::default();
    for _ in 0..vertices {
        let line = line()??;
        let mut words = line.split_whitespace().map(parse::<f32>);
        let mut next = || words.next().unwrap_or(Err(LoadError::Ply("a vertex has less than three coordinates")));
        model.vertices.push(Vec3::new(next()?, next()?, next()?));
    }
    for _ in 0..triangles {
        let line = line()??;
        let words: Vec<u32> = line.split_whitespace().map(parse).collect::<Result<_, _>>()?;
        let [3, a, b, c] = words[..] else { return Err(LoadError::Ply("a face is no triangle")) };
        model.triangles.push([a, b, c]);
    }
    Ok(model)
}

fn parse<T: std::str::FromStr>(word: &str) -> Result<T, LoadError> {
    word.parse().map_err(|_| LoadError::Ply("a number cannot be read"))
}
