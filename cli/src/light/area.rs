//! A part of a plane that shines, from one side or from both.

use umbra4_core::{
    AreaLight, Bounds, LightError,
    emission::{Emission, EmissionError, Weight},
};

use crate::light_file::LightShape;

/// The weights of a light's samples.
pub type Weights = Emission<Vec<Weight>>;

/// One side of an area: a light that the library knows.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// Its place and samples.
    pub area: AreaLight,
    /// What its samples emit; `None` where all emit the same.
    pub emission: Option<Weights>,
}

/// A part of a plane that shines.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaSource {
    front: Side,
    back: Option<Side>,
}

/// Why an area is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(transparent)]
pub enum AreaError {
    /// Its place or its samples.
    Light(#[from] LightError),
    /// What its samples emit.
    Emission(#[from] EmissionError),
}

impl AreaSource {
    /// An area that shines towards one side.
    pub fn one_sided(front: Side) -> Self {
        Self { front, back: None }
    }

    /// An area of `rows` × `columns` samples that shines towards `edge_u × edge_v`, and the other way too where it is
    /// `two_sided`.
    ///
    /// # Errors
    /// Edges or numbers of samples that make no light.
    pub fn new(
        shape: &LightShape,
        [rows, columns]: [u32; 2],
        emission: Option<Weights>,
        two_sided: bool,
    ) -> Result<Self, AreaError> {
        let back = if two_sided { Some(back_of(shape, [rows, columns], emission.as_ref())?) } else { None };
        Ok(Self { front: Side { area: shape.grid(rows, columns)?, emission }, back })
    }

    /// The same rectangle of `shape`, shining to the other side only.
    ///
    /// # Errors
    /// As [`AreaSource::new`].
    pub fn turned(&self, shape: &LightShape) -> Result<Self, AreaError> {
        let samples = [self.front.area.rows(), self.front.area.columns()];
        Ok(Self::one_sided(back_of(shape, samples, self.front.emission.as_ref())?))
    }

    /// The side that faces `edge_u × edge_v`.
    pub fn front(&self) -> &Side {
        &self.front
    }

    /// The other side, where it shines from there, too. No receiver lies before both.
    pub fn back(&self) -> Option<&Side> {
        self.back.as_ref()
    }

    /// All sides, the front first.
    pub fn sides(&self) -> impl Iterator<Item = &Side> {
        std::iter::once(&self.front).chain(&self.back)
    }

    /// What the lattice has to hold of it.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.front.area.corners())
    }

    /// What it is, in a few words.
    pub fn kind(&self) -> String {
        let area = &self.front.area;
        let weighted = if self.front.emission.is_some() { ", with weights" } else { "" };
        let sides = if self.back.is_some() { ", two-sided" } else { "" };
        format!("a rectangle of {}×{} samples{weighted}{sides}", area.rows(), area.columns())
    }
}

/// The back of an area: with its edges exchanged, rows become columns, and every sample keeps its weight. It is a light of its
/// own, not the library's `LatticeLight::back`, since each side is lifted off the area, so that a lamp may be drawn there.
fn back_of(shape: &LightShape, [rows, columns]: [u32; 2], emission: Option<&Weights>) -> Result<Side, AreaError> {
    let area = shape.exchanged().grid(columns, rows)?;
    let transposed = |front: &Weights| {
        let places = (0..columns).flat_map(|column| (0..rows).map(move |row| (row, column)));
        Emission::new(columns, rows, places.filter_map(|(row, column)| front.weight(row, column)).collect())
    };
    Ok(Side { area, emission: emission.map(transposed).transpose()? })
}

#[cfg(test)]
mod tests {
    use umbra4_core::{Lattice, Lift, glam::DVec3};

    use super::*;

    const SHAPE: LightShape =
        LightShape { corner: [-0.5, 2.0, -0.25], edge_u: [1.0, 0.0, 0.0], edge_v: [0.0, 0.25, 0.5] };

    #[test]
    fn the_back_has_the_samples_and_weights_of_the_front() {
        let weights = (0..6).map(|i| [i, 2 * i, 7]).collect();
        let area = AreaSource::new(&SHAPE, [2, 3], Some(Emission::new(2, 3, weights).unwrap()), true).unwrap();
        let sides: Vec<&Side> = area.sides().collect();
        let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) }).unwrap();
        let [front, back] = [0, 1].map(|side| sides[side].area.snap(&lattice, Lift::NONE).unwrap());
        for (row, column) in [(0, 0), (0, 2), (1, 0), (1, 1)] {
            let apart = (front.sample(row, column) - back.sample(column, row)).abs().max_element();
            assert!(apart <= 4, "{apart} lattice units");
            let weight = |side: usize, i, j| sides[side].emission.as_ref().and_then(|e| e.weight(i, j));
            assert_eq!(weight(0, row, column).unwrap(), weight(1, column, row).unwrap());
        }
        let point = |y| [lattice.snap_f64(DVec3::new(0.0, y, 0.0)).unwrap()];
        assert!(back.reaches(&point(4.0)) != front.reaches(&point(4.0)));
        assert!(back.reaches(&point(0.0)) != front.reaches(&point(0.0)));
    }

    #[test]
    fn one_side_is_all_unless_told() {
        assert_eq!(AreaSource::new(&SHAPE, [4, 4], None, false).unwrap().sides().count(), 1);
        assert!(AreaSource::new(&SHAPE, [4, 65], None, false).is_err());
    }
}
