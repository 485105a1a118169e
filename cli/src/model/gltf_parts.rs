//! The parts of a glTF document: one for every primitive of every node.

use gltf::{Mesh, Node, Primitive};

use super::{
    Casting, CastingError, CastingSaid, CoordinatesError, InMaterial, InPart, MaterialError, ModelError, Part, Parts,
    gltf::{Added, called},
    gltf_extras,
    gltf_materials::Materials,
};

/// Collects the parts of a document.
pub(super) struct Collector<'a> {
    materials: Materials<'a>,
    buffers: &'a [Vec<u8>],
    parts: Parts,
}

impl<'a> Collector<'a> {
    /// None yet.
    pub(super) fn new(materials: Materials<'a>, buffers: &'a [Vec<u8>]) -> Self {
        Self { materials, buffers, parts: Parts::default() }
    }

    /// One more: a primitive of a node's mesh, by what it has added to the model.
    pub(super) fn add(&mut self, node: &Node<'_>, primitive: &Primitive<'_>, added: Added) -> Result<(), ModelError> {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        let material = primitive.material().index();
        let finish = self.materials.get(material)?;
        let coordinates = match finish.coordinates {
            Some(wanted) => {
                let read = wanted.read(primitive, self.buffers, added.vertices.len());
                read.map_err(|reason| coordinates_of(primitive, &mesh, wanted.set, reason))?
            }
            None => Vec::new(),
        };
        self.parts.push(Part {
            label: called("node", node.index(), node.name()),
            names: [node.name(), mesh.name()].into_iter().flatten().map(str::to_owned).collect(),
            triangles: added.triangles,
            vertices: added.vertices,
            coordinates,
            surface: finish.surface,
            one_sided: finish.one_sided,
            casting: casting(node, &mesh)?,
        });
        Ok(())
    }

    /// All of them.
    pub(super) fn finish(self) -> Parts {
        self.parts
    }
}

/// What the extras of a mesh, and before it those of its node, say.
fn casting(node: &Node<'_>, mesh: &Mesh<'_>) -> Result<Casting, ModelError> {
    let mut casting = Casting::default();
    let said = [
        (called("mesh", mesh.index(), mesh.name()), mesh.extras()),
        (called("node", node.index(), node.name()), node.extras()),
    ];
    for (part, extras) in said {
        if let Some(json) = gltf_extras::find(extras, gltf_extras::CASTER) {
            let in_extras = |source: CastingError| InPart { part, source };
            casting = CastingSaid::read(&json).map_err(in_extras)?.over(casting);
        }
    }
    Ok(casting)
}

fn coordinates_of(primitive: &Primitive<'_>, mesh: &Mesh<'_>, set: u32, reason: CoordinatesError) -> ModelError {
    let owner = format!("primitive {} of {}", primitive.index(), called("mesh", mesh.index(), mesh.name()));
    let material = primitive.material();
    let name = called("material", material.index().unwrap_or_default(), material.name());
    InMaterial::at(name)(MaterialError::Coordinates { primitive: owner, set, reason }).into()
}
