//! The parts of a scene as casters on the lattice. Parts that cast alike are one caster, so that there are few.

use std::collections::HashMap;

use umbra4_core::{
    Lattice,
    glam::{Vec2, Vec3},
    plane_offset::MOST_OFFSET,
    texture::{Coordinate, TextureError},
};
use umbra4_cpu::{Caster, CasterError, Occluders, Receivers, SceneError};

use crate::{
    model::{Casting, Closed, InPart, Model, Part, Parts, Surface},
    primary::GBuffer,
};

/// What the triangles that belong to no part are called, and what they do to light.
const REST: &str = "the rest of the scene";
static OPAQUE: Surface = Surface::Opaque;

/// Why a part is no caster.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The library refuses it.
    #[error(transparent)]
    Caster(#[from] CasterError),
    /// An offset beyond what the lattice holds.
    #[error("field `plane_offset` is {offset}: more than {most}, the most in a scene of this size")]
    Offset {
        /// Its value, world units.
        offset: f64,
        /// The most, world units.
        most: f64,
    },
}

/// The casters of a scene; `None` where all of it is opaque, and casts on everything.
///
/// # Errors
/// A texture, texture coordinates or an offset that the library refuses; a part that is said to be closed, and is not.
pub fn casters(model: &Model, parts: &Parts, lattice: &Lattice) -> Result<Option<Vec<Caster>>, InPart<PartError>> {
    if parts.is_plain() {
        return Ok(None);
    }
    let mut groups = Groups { model, lattice, groups: Vec::new() };
    let whole: Vec<&Part> = parts.iter().collect();
    // The primitives of a node make up its mesh: closed is what they are together.
    for node in whole.chunk_by(|a, b| a.label == b.label) {
        groups.add_node(node)?;
    }
    let rest = (0..model.triangles.len()).filter(|triangle| parts.of(*triangle).is_none());
    groups.group(REST, &OPAQUE, Casting::default(), false).extend(model, rest, None);
    let casters = groups.groups.into_iter().filter(|group| !group.mesh.triangles.is_empty());
    casters.map(|group| group.caster(lattice)).collect::<Result<_, _>>().map(Some)
}

/// What is seen, on the layers of its parts.
///
/// # Errors
/// None, where the receivers are what is seen.
pub fn on_layers(receivers: Receivers, seen: &GBuffer, parts: &Parts) -> Result<Receivers, SceneError> {
    if parts.iter().all(|part| part.casting.receiver_layers == Casting::default().receiver_layers) {
        return Ok(receivers);
    }
    let layers = seen.seen().map(|hit| parts.of(hit.triangle as usize).map(|part| part.casting).unwrap_or_default());
    receivers.on_layers(&layers.map(|casting| casting.receiver_layers).collect::<Vec<_>>())
}

/// What becomes one caster.
struct Group<'a> {
    label: &'a str,
    surface: &'a Surface,
    casting: Casting,
    closed: bool,
    mesh: Mesh,
}

/// A part of the model, with a numbering of its own.
#[derive(Default)]
struct Mesh {
    vertices: Vec<Vec3>,
    coordinates: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
    /// By the model's indices.
    places: HashMap<u32, u32>,
}

struct Groups<'a> {
    model: &'a Model,
    lattice: &'a Lattice,
    groups: Vec<Group<'a>>,
}

impl<'a> Groups<'a> {
    /// The parts of one node.
    fn add_node(&mut self, node: &[&'a Part]) -> Result<(), InPart<PartError>> {
        let model = self.model;
        let asks =
            |part: &&Part| part.casting.closed == Closed::Found && part.one_sided && part.surface == Surface::Opaque;
        let (asking, others): (Vec<&Part>, Vec<&Part>) = node.iter().copied().partition(asks);
        for part in others {
            check_coordinates(model, part).map_err(|e| named(&part.label)(CasterError::Texture(e).into()))?;
            let closed = part.casting.closed == Closed::Yes;
            let group = self.group(&part.label, &part.surface, part.casting, closed);
            group.extend(model, part.triangles.clone(), Some(part));
        }
        let Some(first) = asking.first() else { return Ok(()) };
        let triangles: Vec<usize> = asking.iter().flat_map(|part| part.triangles.clone()).collect();
        let mut mesh = Mesh::default();
        triangles.iter().for_each(|triangle| mesh.push(model, *triangle, None));
        let found = occluders(&mesh, self.lattice).map_err(|e| named(&first.label)(e.into()))?.closed_parts();
        for (triangle, closed) in triangles.into_iter().zip(found.triangles()) {
            let group = self.group(&first.label, &first.surface, first.casting, *closed);
            group.extend(model, [triangle], None);
        }
        Ok(())
    }

    /// The group of those that cast so. What is said to be closed stays by itself, so that an error names it.
    fn group(&mut self, label: &'a str, surface: &'a Surface, casting: Casting, closed: bool) -> &mut Group<'a> {
        // What has become of that is `closed`.
        let said = if casting.closed == Closed::Yes { Closed::Yes } else { Closed::No };
        let casting = Casting { receiver_layers: Casting::default().receiver_layers, closed: said, ..casting };
        let alike = |group: &Group<'_>| {
            let named = said == Closed::No || group.label == label;
            group.surface.is_same(surface) && (group.casting, group.closed) == (casting, closed) && named
        };
        let place = self.groups.iter().position(alike).unwrap_or_else(|| {
            self.groups.push(Group { label, surface, casting, closed, mesh: Mesh::default() });
            self.groups.len() - 1
        });
        &mut self.groups[place]
    }
}

impl Group<'_> {
    fn extend(&mut self, model: &Model, triangles: impl IntoIterator<Item = usize>, part: Option<&Part>) {
        if *self.surface != Surface::Absent {
            triangles.into_iter().for_each(|triangle| self.mesh.push(model, triangle, part));
        }
    }

    fn caster(self, lattice: &Lattice) -> Result<Caster, InPart<PartError>> {
        let Self { label, surface, casting, closed, mesh } = self;
        let caster = || -> Result<Caster, PartError> {
            let (occluders, coordinates) = (occluders(&mesh, lattice)?, &mesh.coordinates);
            let caster = match surface {
                Surface::Opaque | Surface::Absent => Caster::opaque(occluders),
                Surface::Cutout { alphas, threshold } => {
                    Caster::cutout(occluders, coordinates, alphas.size, &alphas.texels, *threshold)?
                }
                Surface::Tinted(tint) => Caster::tinted(occluders, tint.to_array())?,
                Surface::Stained(tints) => Caster::stained(occluders, coordinates, tints.size, &tints.texels)?,
            };
            let caster = if closed { caster.closed()? } else { caster };
            Ok(caster.with_plane_offset(units(casting.plane_offset, lattice)?)?.on_layers(casting.caster_layers))
        };
        caster().map_err(named(label))
    }
}

impl Mesh {
    /// Adds a triangle of the model, with the texture coordinates that its part has.
    fn push(&mut self, model: &Model, triangle: usize, part: Option<&Part>) {
        let Some(corners) = model.triangles.get(triangle) else { return };
        let corners = corners.map(|vertex| {
            *self.places.entry(vertex).or_insert_with(|| {
                self.vertices.push(model.vertices.get(vertex as usize).copied().unwrap_or_default());
                self.coordinates.extend(part.and_then(|part| part.coordinates_of(vertex)).map(Vec2::from));
                self.vertices.len() as u32 - 1
            })
        });
        self.triangles.push(corners);
    }
}

fn occluders(mesh: &Mesh, lattice: &Lattice) -> Result<Occluders, CasterError> {
    Ok(Occluders::new(lattice, &mesh.vertices, &mesh.triangles)?)
}

/// An offset on the lattice: none is 0 that is not.
fn units(offset: f64, lattice: &Lattice) -> Result<u32, PartError> {
    let most = f64::from(MOST_OFFSET) * lattice.step();
    match offset {
        0.0 => Ok(0),
        offset if offset <= most => Ok((offset / lattice.step()).round().max(1.0) as u32),
        _ => Err(PartError::Offset { offset, most }),
    }
}

/// Whether texture coordinates are ones that can be looked up, by their numbers in the part: those of a caster are of several parts.
fn check_coordinates(model: &Model, part: &Part) -> Result<(), TextureError> {
    let size = match &part.surface {
        Surface::Cutout { alphas, .. } => alphas.size,
        Surface::Stained(tints) => tints.size,
        Surface::Opaque | Surface::Absent | Surface::Tinted(_) => return Ok(()),
    };
    let snap = |(index, at): (usize, &[f32; 2])| Coordinate::snap(index, Vec2::from(*at));
    let snapped: Vec<Coordinate> = part.coordinates.iter().enumerate().map(snap).collect::<Result<_, _>>()?;
    for (index, corners) in model.triangles.iter().skip(part.triangles.start).take(part.triangles.len()).enumerate() {
        let at = corners.map(|vertex| snapped.get((vertex as usize).wrapping_sub(part.vertices.start)).copied());
        // A vertex without coordinates is the library's to refuse.
        if let [Some(a), Some(b), Some(c)] = at {
            size.triangle(index, [a, b, c])?;
        }
    }
    Ok(())
}

fn named(label: &str) -> impl Fn(PartError) -> InPart<PartError> {
    move |source| InPart { part: label.to_owned(), source }
}

#[cfg(test)]
mod tests {
    use std::{ops::Range, sync::Arc};

    use umbra4_core::{
        Bounds, CasterWork, Layers,
        glam::DVec3,
        texture::{TextureSize, Wrap},
    };

    use super::*;
    use crate::{model::Texture, primary::Hit};

    const TETRAHEDRON: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    const SIDES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    /// A scene of tetrahedra, each a part with that surface, and of one more that is none.
    fn scene(surfaces: &[Surface]) -> (Model, Parts) {
        let one = Model { vertices: TETRAHEDRON.to_vec(), triangles: SIDES.to_vec() };
        let (mut model, mut parts) = (Model::default(), Parts::default());
        for (index, surface) in surfaces.iter().enumerate() {
            let all = |count: usize| -> Range<usize> { count * index..count * (index + 1) };
            parts.push(Part {
                label: format!("node {index}"),
                names: Vec::new(),
                triangles: all(4),
                vertices: all(4),
                coordinates: vec![[0.0, 0.5]; 4],
                surface: surface.clone(),
                one_sided: false,
                casting: Casting::default(),
            });
            model.append(&one);
        }
        model.append(&one);
        (model, parts)
    }

    fn build(model: &Model, parts: &Parts) -> Result<Option<Vec<Caster>>, String> {
        let lattice = Lattice::covering(Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) }).unwrap();
        casters(model, parts, &lattice).map_err(|e| e.to_string())
    }

    fn changed(parts: &Parts, change: impl Fn(usize, &mut Part)) -> Parts {
        let mut all = Parts::default();
        for (index, part) in parts.iter().enumerate() {
            let mut part = part.clone();
            change(index, &mut part);
            all.push(part);
        }
        all
    }

    fn leaf() -> Surface {
        let size = TextureSize { width: 1, height: 8, wrap: [Wrap::Repeat; 2] };
        let texels = vec![0, 0, 0, 0, 255, 255, 255, 255];
        Surface::Cutout { alphas: Arc::new(Texture { size, texels }), threshold: 128 }
    }

    #[test]
    fn what_is_opaque_needs_no_casters() {
        let (model, parts) = scene(&[Surface::Opaque, Surface::Opaque]);
        assert_eq!(build(&model, &parts).unwrap(), None);
        assert_eq!(build(&model, &changed(&parts, |_, part| part.one_sided = true)).unwrap(), None);
    }

    #[test]
    fn what_casts_alike_is_one_caster() {
        let (red, leaf) = (Surface::Tinted(Vec3::X), leaf());
        let (model, parts) = scene(&[Surface::Opaque, red.clone(), leaf.clone(), red, leaf, Surface::Absent]);
        let casters = build(&model, &parts).unwrap().unwrap();
        let kinds: Vec<_> = casters.iter().map(|c| (c.packed().work(), c.occluders().triangles().len())).collect();
        assert_eq!(kinds, [(CasterWork::Plain, 8), (CasterWork::Tinted, 8), (CasterWork::Cutout, 8)]);
    }

    #[test]
    fn closed_is_what_a_node_is_as_a_whole() {
        let (model, parts) = scene(&[Surface::Opaque, Surface::Opaque, leaf()]);
        let closed = |parts: &Parts| {
            let casters = build(&model, parts).unwrap().unwrap();
            let closed = casters.iter().filter(|caster| caster.casting().closed);
            closed.map(|caster| caster.occluders().triangles().len()).collect::<Vec<_>>()
        };
        assert!(closed(&parts).is_empty());
        // Nobody asks: receivers may be inside.
        assert!(closed(&changed(&parts, |_, part| part.one_sided = true)).is_empty());
        let asked = changed(&parts, |_, part| part.casting.closed = Closed::Found);
        // What is seen from both sides bounds nothing.
        assert!(closed(&asked).is_empty());
        let mut one_sided = changed(&asked, |_, part| part.one_sided = true);
        // A surface with holes is not closed.
        assert_eq!(closed(&one_sided), [8]);
        let halves = |index: usize, part: &mut Part| {
            // Two primitives, of one node or of two, that make up one tetrahedron; and one half of another.
            part.triangles = [0..2, 2..4, 4..6][index].clone();
            part.vertices = [0..4, 0..4, 4..8][index].clone();
            part.surface = [Surface::Opaque, Surface::Opaque, leaf()][index].clone();
            part.label = ["node 0", "node 0", "node 2"][index].to_owned();
        };
        one_sided = changed(&one_sided, halves);
        assert_eq!(closed(&one_sided), [4]);
        let apart = changed(&one_sided, |index, part| part.label = format!("node {index}"));
        assert!(closed(&apart).is_empty());
        let said = changed(&parts, |_, part| {
            part.casting.closed = if part.label == "node 1" { Closed::Yes } else { Closed::No }
        });
        assert_eq!(closed(&said), [4]);
        let wrong = changed(&apart, |_, part| {
            part.casting.closed = if part.label == "node 1" { Closed::Yes } else { Closed::No }
        });
        let message = build(&model, &wrong).unwrap_err();
        assert!(message.starts_with("node 1: the mesh is not closed: triangle"), "{message}");
    }

    #[test]
    fn offsets_and_layers_are_the_casters() {
        let (model, parts) = scene(&[Surface::Opaque, Surface::Opaque]);
        let offset = |offset: f64| {
            changed(&parts, |index, part| {
                if index == 1 {
                    part.casting.plane_offset = offset;
                    part.casting.caster_layers = Layers::from_bits(6);
                }
            })
        };
        let casters = build(&model, &offset(0.015625)).unwrap().unwrap();
        let lattice = Lattice::covering(Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) }).unwrap();
        assert_eq!(casters.iter().map(|caster| caster.layers().bits()).collect::<Vec<_>>(), [u32::MAX, 6]);
        assert_eq!(f64::from(casters[1].casting().offset) * lattice.step(), 0.015625);
        let message = build(&model, &offset(1e9)).unwrap_err();
        assert!(message.starts_with("node 1: field `plane_offset` is 1000000000: more than "), "{message}");
        // One that is not 0 is not lost.
        assert_eq!(build(&model, &offset(1e-12)).unwrap().unwrap()[1].casting().offset, 1);
    }

    #[test]
    fn bad_coordinates_name_the_part() {
        let leaf = leaf();
        let (model, parts) = scene(&[leaf.clone(), leaf]);
        let wrong = |coordinates: [f32; 2]| {
            let only = |index, part: &mut Part| {
                if index == 1 {
                    part.coordinates[2] = coordinates
                }
            };
            build(&model, &changed(&parts, only)).unwrap_err()
        };
        // The two are one caster.
        let message = wrong([3e4, 0.0]);
        assert!(message.starts_with("node 1: texture coordinate 2 has u = 30000"), "{message}");
        let message = wrong([0.0, 16000.0]);
        assert!(message.starts_with("node 1: triangle 0 reaches over"), "{message}");
    }

    #[test]
    fn receivers_are_on_the_layers_of_their_parts() {
        let (_, parts) = scene(&[Surface::Opaque, Surface::Opaque]);
        let lattice = Lattice::covering(Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) }).unwrap();
        let receivers = Receivers::raw(&lattice, &[Vec3::ZERO; 3]).unwrap();
        let hit = |triangle| Some(Hit { position: Vec3::ZERO, normal: Vec3::Y, triangle });
        let seen = GBuffer { width: 4, height: 1, hits: vec![hit(5), None, hit(0), hit(9)], tints: Vec::new() };
        let everywhere = on_layers(receivers.clone(), &seen, &parts).unwrap();
        assert!(everywhere.layers().is_empty());
        let parts = changed(&parts, |index, part| part.casting.receiver_layers = Layers::from_bits(1 << index));
        let layered = on_layers(receivers, &seen, &parts).unwrap();
        assert_eq!(layered.layers(), [2, 1, u32::MAX].map(Layers::from_bits));
    }
}
