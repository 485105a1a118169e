//! glTF 2.0, .gltf and .glb: the triangles of all meshes of the scene, with their nodes' transforms, and what its
//! materials do to light; its lights and its camera.

use std::{borrow::Cow, ops::Range, path::Path};

use gltf::{
    Document, Glb, Node, Primitive, Semantic,
    accessor::{DataType, Dimensions},
    json::{Root, validation::Checked},
    mesh::Mode,
};
use umbra4_core::glam::{DMat4, DVec3};

use super::{
    FileLights, Furnished, Model, ModelError, gltf_buffers, gltf_camera, gltf_lights,
    gltf_materials::{self, Materials},
    gltf_parts::Collector,
    gltf_pictures::Pictures,
};

const FORMAT: &str = "glTF";
const GLB_HEADER: u32 = 12;

pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Model<DVec3>, ModelError> {
    let (document, blob) = open(bytes)?;
    let buffers = gltf_buffers::read(&document, blob, path)?;
    triangles(&placed(&document)?, &buffers, |_, _, _| Ok(()))
}

/// The triangles and their parts, the lights where they are taken, and the camera.
pub(super) fn parse_furnished(bytes: &[u8], path: &Path, lights: FileLights) -> Result<Furnished<DVec3>, ModelError> {
    let (document, blob) = open(bytes)?;
    let buffers = gltf_buffers::read(&document, blob, path)?;
    let mut nodes = placed(&document)?;
    let materials = Materials::new(document.as_json(), Pictures::new(document.as_json(), &buffers, path));
    let mut parts = Collector::new(materials, &buffers);
    let model = triangles(&nodes, &buffers, |node, primitive, added| parts.add(node, primitive, added))?;
    // As the file counts them, not as the tree is walked.
    nodes.sort_by_key(|(node, _)| node.index());
    let lights = if lights == FileLights::Taken { gltf_lights::read(&nodes, path)? } else { Vec::new() };
    Ok(Furnished { model, parts: parts.finish(), lights, camera: gltf_camera::read(&document, &nodes) })
}

/// What messages call an element of the document.
pub(super) fn called(kind: &str, index: usize, name: Option<&str>) -> String {
    name.map_or_else(|| format!("{kind} {index}"), |name| format!("{kind} {index} '{name}'"))
}

/// A node, and its transform to the world.
pub(super) type Placed<'a> = (Node<'a>, DMat4);

/// All nodes of the scene.
fn placed(document: &Document) -> Result<Vec<Placed<'_>>, ModelError> {
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next())
        .ok_or_else(|| malformed("the document has no scene"))?;
    let mut nodes = Vec::new();
    let mut seen = vec![false; document.nodes().len()];
    let mut open: Vec<(Node, DMat4)> = scene.nodes().map(|node| (node, DMat4::IDENTITY)).collect();
    while let Some((node, parent)) = open.pop() {
        // Nodes form a tree; a file where they do not could be walked forever.
        if std::mem::replace(&mut seen[node.index()], true) {
            return Err(malformed(format!("node {} has two parents", node.index())));
        }
        let local = node.transform().matrix().map(|column| column.map(f64::from));
        let transform = parent * DMat4::from_cols_array_2d(&local);
        open.extend(node.children().map(|child| (child, transform)));
        nodes.push((node, transform));
    }
    Ok(nodes)
}

/// What a primitive has added to the model.
pub(super) struct Added {
    /// Indices of its triangles.
    pub(super) triangles: Range<usize>,
    /// Indices of its vertices.
    pub(super) vertices: Range<usize>,
}

/// The triangles of all nodes; `each` is told of every primitive.
fn triangles(
    nodes: &[Placed<'_>],
    buffers: &[Vec<u8>],
    mut each: impl FnMut(&Node<'_>, &Primitive<'_>, Added) -> Result<(), ModelError>,
) -> Result<Model<DVec3>, ModelError> {
    let mut model = Model::default();
    for (node, transform) in nodes {
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            let (triangles, vertices) = (model.triangles.len(), model.vertices.len());
            append(&mut model, &primitive, transform, buffers)?;
            let added = Added { triangles: triangles..model.triangles.len(), vertices: vertices..model.vertices.len() };
            if !added.triangles.is_empty() {
                each(node, &primitive, added)?;
            }
        }
    }
    Ok(model)
}

pub(super) fn malformed(reason: impl Into<String>) -> ModelError {
    ModelError::Malformed { format: FORMAT, reason: reason.into() }
}

/// The document, and the binary chunk where there is one.
fn open(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), ModelError> {
    let failed = |e: gltf::Error| malformed(e.to_string());
    check_length(bytes)?;
    let (json, blob) = if bytes.starts_with(b"glTF") {
        let container = Glb::from_slice(bytes).map_err(failed)?;
        (container.json, container.bin.map(Cow::into_owned))
    } else {
        (bytes.into(), None)
    };
    let root = Root::from_slice(&json).map_err(|e| malformed(e.to_string()))?;
    // The crate's own validation looks the positions up before it has checked their index.
    for (semantic, accessor) in root.meshes.iter().flat_map(|m| &m.primitives).flat_map(|p| &p.attributes) {
        if accessor.value() >= root.accessors.len() {
            return Err(malformed(format!(
                "{} names accessor {}, which does not exist",
                semantic_name(semantic),
                accessor.value()
            )));
        }
    }
    gltf_materials::check_names(&root)?;
    Ok((Document::from_json(root).map_err(failed)?, blob))
}

fn semantic_name(semantic: &Checked<Semantic>) -> String {
    match semantic {
        Checked::Valid(semantic) => semantic.to_string(),
        Checked::Invalid => "an unknown attribute".to_owned(),
    }
}

/// The binary container announces its length first; what disagrees is not handed on.
fn check_length(bytes: &[u8]) -> Result<(), ModelError> {
    if !bytes.starts_with(b"glTF") {
        return Ok(());
    }
    let announced = bytes.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    match announced {
        Some(length) if length < GLB_HEADER => Err(malformed("the container is shorter than its header")),
        Some(length) if length as usize <= bytes.len() => Ok(()),
        _ => Err(ModelError::Truncated {
            format: FORMAT,
            reason: format!("{} bytes of {}", bytes.len(), announced.unwrap_or(GLB_HEADER)),
        }),
    }
}

fn append(
    model: &mut Model<DVec3>,
    primitive: &Primitive,
    transform: &DMat4,
    buffers: &[Vec<u8>],
) -> Result<(), ModelError> {
    let mode = primitive.mode();
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(());
    }
    let positions = primitive.get(&Semantic::Positions).ok_or_else(|| malformed("a primitive has no positions"))?;
    if positions.data_type() != DataType::F32 || positions.dimensions() != Dimensions::Vec3 {
        return Err(malformed("positions are not three f32"));
    }
    let base = model.vertices.len();
    for bytes in gltf_buffers::elements(&positions, buffers)? {
        let axis = |i: usize| f64::from(f32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]));
        let world = transform.transform_point3(DVec3::new(axis(0), axis(4), axis(8)));
        // Rounded once, so that the model is the same whether it is asked for in f32 or f64.
        model.vertices.push(world.as_vec3().as_dvec3());
    }
    let count = model.vertices.len() - base;
    let base = u32::try_from(base).map_err(|_| malformed("too many vertices"))?;
    let indices = match primitive.indices() {
        None => (0..count as u32).collect(),
        Some(accessor) => {
            if accessor.dimensions() != Dimensions::Scalar {
                return Err(malformed("indices are not scalars"));
            }
            gltf_buffers::elements(&accessor, buffers)?
                .map(|bytes| match *bytes {
                    [a] => Ok(u32::from(a)),
                    [a, b] => Ok(u32::from(u16::from_le_bytes([a, b]))),
                    [a, b, c, d] => Ok(u32::from_le_bytes([a, b, c, d])),
                    _ => Err(malformed("indices have no integer type")),
                })
                .collect::<Result<Vec<u32>, _>>()?
        }
    };
    let first = model.triangles.len();
    match mode {
        Mode::Triangles => model.triangles.extend(indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]])),
        Mode::TriangleStrip => model.triangles.extend(indices.windows(3).map(|t| [t[0], t[1], t[2]])),
        _ => super::push_polygon(&mut model.triangles, &indices),
    }
    for (triangle, corners) in model.triangles.iter_mut().enumerate().skip(first) {
        for vertex in corners {
            // Checked here, where the part's own numbering is still known.
            if *vertex as usize >= count {
                let vertex = i64::from(*vertex);
                return Err(ModelError::IndexOutOfRange { triangle, vertex, vertices: count });
            }
            *vertex = vertex.checked_add(base).ok_or_else(|| malformed("too many vertices"))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use base64::{Engine, engine::general_purpose::STANDARD};

    use super::*;

    fn data() -> Vec<u8> {
        let mut bytes: Vec<u8> = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        bytes.extend([0_u16, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
        bytes
    }

    fn document(buffer: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
            "nodes":[{{"children":[1],"translation":[10,0,0]}},{{"mesh":0,"scale":[2,2,2]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
            "buffers":[{{{buffer}"byteLength":42}}]}}"#
        )
    }

    fn embedded() -> Vec<u8> {
        let uri = format!("\"uri\":\"data:application/octet-stream;base64,{}\",", STANDARD.encode(data()));
        document(&uri).into_bytes()
    }

    fn container() -> Vec<u8> {
        let mut json = document("").into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut binary = data();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        file
    }

    #[test]
    fn transforms_are_applied_from_the_root_down() {
        for file in [embedded(), container()] {
            let model = parse(&file, Path::new("x.gltf")).unwrap();
            assert_eq!(model.triangles, [[0, 1, 2]]);
            assert_eq!(model.vertices[1], DVec3::new(12.0, 0.0, 0.0));
        }
    }

    #[test]
    fn external_buffers_lie_beside_the_file() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a b.bin"), data()).unwrap();
        let file = document("\"uri\":\"a%20b.bin\",");
        assert_eq!(parse(file.as_bytes(), &folder.path().join("x.gltf")).unwrap().triangles.len(), 1);
        assert!(parse(file.as_bytes(), Path::new("/nowhere/x.gltf")).is_err());
    }

    #[test]
    fn a_ring_of_nodes_is_refused() {
        let ring = String::from_utf8(embedded()).unwrap().replace("\"mesh\":0", "\"mesh\":0,\"children\":[0]");
        assert!(matches!(parse(ring.as_bytes(), Path::new("x.gltf")), Err(ModelError::Malformed { .. })));
    }

    #[test]
    fn mutilated_files_never_panic() {
        for file in [embedded(), container()] {
            for position in 0..file.len() {
                assert!(parse(&file[..position], Path::new("/nowhere/x.gltf")).is_err());
                for byte in [0, 1, b'9', b'-', b'"', b'}', 0xff] {
                    let mut broken = file.clone();
                    broken[position] = byte;
                    let _ = parse(&broken, Path::new("/nowhere/x.gltf"));
                }
            }
        }
    }
}
