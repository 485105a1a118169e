//! The parts of a model: runs of triangles that cast and receive shadows in the same way.

use std::ops::Range;

use umbra4_core::glam::DVec3;

use super::{Casting, CastingError, Closed, InPart, Model, Surface};

/// A run of triangles of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What messages call it.
    pub label: String,
    /// The names by which a scene file calls it: of its node and of its mesh.
    pub names: Vec<String>,
    /// Indices of its triangles.
    pub triangles: Range<usize>,
    /// Indices of its vertices: no other part has them.
    pub vertices: Range<usize>,
    /// Texture coordinates of `vertices`; none where no texture has a say in it.
    pub coordinates: Vec<[f32; 2]>,
    /// What it does to light.
    pub surface: Surface,
    /// Whether only its front is seen.
    pub one_sided: bool,
    /// Who is in its shadow, and in whose it is.
    pub casting: Casting,
}

/// The parts of a model, in the order of their triangles. What belongs to none is opaque and two-sided, casts on
/// everything and is in the shadow of everything.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts(Vec<Part>);

impl Parts {
    /// Adds a part, whose triangles come after those of all others.
    pub fn push(&mut self, part: Part) {
        self.0.push(part);
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Part> {
        self.0.iter()
    }

    /// The part that a triangle belongs to.
    pub fn of(&self, triangle: usize) -> Option<&Part> {
        let after = self.0.partition_point(|part| part.triangles.start <= triangle);
        self.0[..after].last().filter(|part| part.triangles.contains(&triangle))
    }

    /// Whether all of them are opaque, cast on everything and are in the shadow of everything, so that nobody has to tell
    /// them apart.
    pub fn is_plain(&self) -> bool {
        self.0.iter().all(|part| part.surface == Surface::Opaque && part.casting == Casting::default())
    }

    /// Says how the parts of that name cast, or all of them. A model without parts becomes one.
    ///
    /// # Errors
    /// No part has that name.
    pub fn cast(&mut self, name: Option<&str>, said: &super::CastingSaid, model: &Model) -> Result<(), CastingError> {
        if name.is_none() && self.0.is_empty() {
            self.0.push(Part {
                label: "the model".to_owned(),
                names: Vec::new(),
                triangles: 0..model.triangles.len(),
                vertices: 0..model.vertices.len(),
                coordinates: Vec::new(),
                surface: Surface::Opaque,
                one_sided: false,
                casting: Casting::default(),
            });
        }
        let meant = |part: &Part| name.is_none_or(|name| part.names.iter().any(|own| own == name));
        let mut parts = self.0.iter_mut().filter(|part| meant(part)).peekable();
        if parts.peek().is_none() {
            return Err(CastingError::NoPart(name.unwrap_or_default().to_owned()));
        }
        parts.for_each(|part| part.casting = said.over(part.casting));
        Ok(())
    }

    /// Whether what is said about them goes together.
    ///
    /// # Errors
    /// A part that lets light through has a plane offset, or is closed.
    pub fn check(&self) -> Result<(), InPart<CastingError>> {
        for part in self.0.iter().filter(|part| part.surface.is_tinted()) {
            let wrong = match part.casting {
                Casting { plane_offset, .. } if plane_offset > 0.0 => CastingError::OffsetOfTinted(plane_offset),
                Casting { closed: Closed::Yes, .. } => CastingError::ClosedTinted,
                _ => continue,
            };
            return Err(InPart { part: part.label.clone(), source: wrong });
        }
        Ok(())
    }
}

impl Part {
    /// The texture coordinates of a vertex of the model; `None` where it is not one of the part's, or has none.
    pub fn coordinates_of(&self, vertex: u32) -> Option<[f32; 2]> {
        let own = (vertex as usize).checked_sub(self.vertices.start)?;
        self.coordinates.get(own).copied()
    }

    /// The texture coordinates at a point of a triangle of the model, by its weights of the three corners.
    pub fn coordinates_at(&self, corners: [u32; 3], weights: DVec3) -> [f64; 2] {
        let [a, b, c] = corners.map(|vertex| self.coordinates_of(vertex).unwrap_or_default().map(f64::from));
        let at = |axis: usize| weights.dot(DVec3::new(a[axis], b[axis], c[axis]));
        [at(0), at(1)]
    }
}

#[cfg(test)]
mod tests {
    use umbra4_core::Layers;

    use super::*;
    use crate::model::CastingSaid;

    fn part(name: &str, triangles: Range<usize>) -> Part {
        Part {
            label: format!("node '{name}'"),
            names: vec![name.to_owned()],
            triangles,
            vertices: 3..6,
            coordinates: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]],
            surface: Surface::Opaque,
            one_sided: false,
            casting: Casting::default(),
        }
    }

    #[test]
    fn triangles_find_their_parts() {
        let mut parts = Parts::default();
        parts.push(part("a", 2..5));
        parts.push(part("empty", 5..5));
        parts.push(part("b", 5..7));
        let name = |triangle| parts.of(triangle).map(|part| part.names[0].as_str());
        assert_eq!([0, 2, 4, 5, 6, 7].map(name), [None, Some("a"), Some("a"), Some("b"), Some("b"), None]);
    }

    #[test]
    fn coordinates_are_those_of_the_corners() {
        let coordinates = part("a", 0..1).coordinates_at([5, 3, 4], DVec3::new(0.5, 0.25, 0.25));
        assert_eq!(coordinates, [0.25, 1.0]);
    }

    #[test]
    fn what_is_said_of_a_name_holds_for_its_parts() {
        let mut parts = Parts::default();
        parts.push(part("a", 0..1));
        parts.push(part("b", 1..2));
        assert!(parts.is_plain());
        let model = Model::default();
        let said = CastingSaid {
            caster_layers: Some(Layers::from_bits(4)),
            plane_offset: Some(0.5),
            ..CastingSaid::default()
        };
        parts.cast(Some("b"), &said, &model).unwrap();
        parts
            .cast(None, &CastingSaid { receiver_layers: Some(Layers::from_bits(2)), ..CastingSaid::default() }, &model)
            .unwrap();
        let castings: Vec<Casting> = parts.iter().map(|part| part.casting).collect();
        let receiver_layers = Layers::from_bits(2);
        assert_eq!(castings[0], Casting { receiver_layers, ..Casting::default() });
        let caster_layers = Layers::from_bits(4);
        assert_eq!(castings[1], Casting { caster_layers, receiver_layers, plane_offset: 0.5, closed: Closed::No });
        assert!(!parts.is_plain() && parts.check().is_ok());
        let missing = parts.cast(Some("c"), &said, &model).unwrap_err().to_string();
        assert_eq!(missing, "no node or mesh of the model is called 'c'");
        parts.0[1].surface = Surface::Tinted(umbra4_core::glam::Vec3::X);
        assert!(parts.check().unwrap_err().to_string().starts_with("node 'b': field `plane_offset` is 0.5"));
        parts.0[1].casting = Casting { closed: Closed::Yes, ..Casting::default() };
        assert!(parts.check().unwrap_err().to_string().starts_with("node 'b': field `closed` is true"));
    }

    #[test]
    fn a_model_without_parts_becomes_one() {
        let model = Model { vertices: Vec::new(), triangles: vec![[0; 3]; 9] };
        let mut parts = Parts::default();
        parts.cast(None, &CastingSaid { closed: Some(Closed::Yes), ..CastingSaid::default() }, &model).unwrap();
        assert_eq!(parts.of(8).unwrap().casting.closed, Closed::Yes);
    }
}
