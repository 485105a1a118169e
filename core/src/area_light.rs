//! What a light is in the world: a rectangle or parallelogram with a grid of samples; and how it is rounded to the lattice.

use glam::{DVec3, IVec3};
use thiserror::Error;

use crate::{
    exact::{self, Wide, WideInt},
    jitter::Jitter,
    lattice::{Lattice, round_f64},
    light::{LatticeLight, MAX_SAMPLES},
    snap::LIMIT,
    surface::{self, Lift},
};

/// Shortest step between samples, in lattice units: below it the rounding of steps would be visible.
pub const MIN_STEP: i32 = 64;
/// The same between places of jittered samples.
pub const MIN_PLACE_STEP: i32 = 32;

/// Why a light is refused.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LightError {
    /// A coordinate is NaN or infinite.
    #[error("light {field}.{axis} is {value}, not a finite number")]
    NotFinite {
        /// "corner", "edge_u" or "edge_v".
        field: &'static str,
        /// 'x', 'y' or 'z'.
        axis: char,
        /// Its value.
        value: f64,
    },
    /// The edges are zero or parallel.
    #[error("the light has no area: edge_u {edge_u} and edge_v {edge_v} are zero or parallel")]
    NoArea {
        /// Edge along the columns, world.
        edge_u: DVec3,
        /// Edge along the rows, world.
        edge_v: DVec3,
    },
    /// The number of rows or columns is outside `1..=64`.
    #[error("light {field} is {value}, outside 1..=64")]
    SampleCount {
        /// "rows" or "columns".
        field: &'static str,
        /// Its value.
        value: u32,
    },
    /// The samples lie closer together than the lattice can tell apart.
    #[error(
        "the light is too fine for the lattice: samples along {field} are {step:.1} lattice units apart, at least {least} are \
         needed; bounds of at most {largest_bounds:e} around the lattice origin would do"
    )]
    LightTooFine {
        /// "edge_u" or "edge_v".
        field: &'static str,
        /// Distance of neighbouring samples along the longest axis, lattice units.
        step: f64,
        /// The least distance: [`MIN_STEP`], or, of jittered samples, [`MIN_PLACE_STEP`] for each of their places.
        least: i32,
        /// Largest coordinate for which the lattice would be fine enough, world units.
        largest_bounds: f64,
    },
    /// A sample lies outside the bounds that the lattice covers.
    #[error("the light reaches outside the lattice: sample (row {row}, column {column}) has {axis} = {value}")]
    OutOfRange {
        /// Row of the sample.
        row: u32,
        /// Column of the sample.
        column: u32,
        /// 'x', 'y' or 'z'.
        axis: char,
        /// World coordinate of the sample.
        value: f64,
    },
}

/// A one-sided rectangular (or parallelogram) light in world space, with a grid of cells that have a sample each.
///
/// Sample (i, j) sits at `corner + edge_u·(j+½)/columns + edge_v·(i+½)/rows`, or, with jitter, elsewhere in that cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLight {
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    rows: u32,
    columns: u32,
    jitter: Jitter,
}

impl AreaLight {
    /// A light with `rows` × `columns` samples, each in `1..=64`, that shines towards `edge_u × edge_v`.
    ///
    /// # Errors
    /// Non-finite coordinates, edges without area, sample counts out of range.
    pub fn new(corner: DVec3, edge_u: DVec3, edge_v: DVec3, rows: u32, columns: u32) -> Result<Self, LightError> {
        for (field, vector) in [("corner", corner), ("edge_u", edge_u), ("edge_v", edge_v)] {
            for (axis, value) in ['x', 'y', 'z'].into_iter().zip(vector.to_array()) {
                if !value.is_finite() {
                    return Err(LightError::NotFinite { field, axis, value });
                }
            }
        }
        for (field, value) in [("rows", rows), ("columns", columns)] {
            if !(1..=MAX_SAMPLES).contains(&value) {
                return Err(LightError::SampleCount { field, value });
            }
        }
        // Both edges are scaled to a length near one first, so that tiny lights do not vanish in the product.
        let (u, v) = (edge_u.normalize_or_zero(), edge_v.normalize_or_zero());
        if u.cross(v) == DVec3::ZERO {
            return Err(LightError::NoArea { edge_u, edge_v });
        }
        Ok(Self { corner, edge_u, edge_v, rows, columns, jitter: Jitter::NONE })
    }

    /// The same light, its samples jittered.
    ///
    /// ```
    /// use umbra4_core::{AreaLight, Bounds, Jitter, Lattice, Lift, glam::DVec3};
    /// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?;
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let regular = light.snap(&lattice, Lift::NONE)?;
    /// let frame = 7; // another pattern every frame
    /// let jittered = light.with_jitter(Jitter::pattern(frame)).snap(&lattice, Lift::NONE)?;
    /// assert_ne!(jittered.sample(3, 5), regular.sample(3, 5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_jitter(self, jitter: Jitter) -> Self {
        Self { jitter, ..self }
    }

    /// How samples are jittered.
    pub fn jitter(&self) -> Jitter {
        self.jitter
    }

    /// Rows of samples, along `edge_v`.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Samples a row, along `edge_u`.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// The middle of the light, world.
    pub fn center(&self) -> DVec3 {
        self.corner + (self.edge_u + self.edge_v) * 0.5
    }

    /// The four corners, world.
    pub fn corners(&self) -> [DVec3; 4] {
        let (c, u, v) = (self.corner, self.edge_u, self.edge_v);
        [c, c + u, c + u + v, c + v]
    }

    /// Rounds the light to `lattice`: steps first, then the origin, so that the centre stays where it is.
    /// `lift` moves the samples off a surface that the light is flush with ([`Lift::NONE`] leaves them where they are).
    ///
    /// # Errors
    /// Steps under [`MIN_STEP`] lattice units, or those between places under [`MIN_PLACE_STEP`]; samples outside the lattice; edges that become parallel.
    pub fn snap(&self, lattice: &Lattice, lift: Lift) -> Result<LatticeLight, LightError> {
        let scale = 1.0 / lattice.step();
        let mut steps = [IVec3::ZERO; 2];
        let places = 1 << self.jitter.place_bits();
        let least = if self.jitter.is_some() { MIN_PLACE_STEP * places } else { MIN_STEP };
        for (out, (field, edge, count)) in
            steps.iter_mut().zip([("edge_u", self.edge_u, self.columns), ("edge_v", self.edge_v, self.rows)])
        {
            let step = edge / f64::from(count) * scale;
            let length = step.abs().max_element();
            if length < f64::from(least) {
                let largest_bounds = lattice.reach_of_finer(f64::from(least) / length);
                return Err(LightError::LightTooFine { field, step: length, least, largest_bounds });
            }
            if length >= 2.0 * f64::from(LIMIT) {
                return Err(self.out_of_range(0, 0));
            }
            let place = step / f64::from(places);
            *out = IVec3::new(round_f64(place.x), round_f64(place.y), round_f64(place.z)) * places;
        }
        let [step_u, step_v] = steps;
        let (rows, columns, jitter) = (self.rows, self.columns, self.jitter);
        let light = LatticeLight { origin: IVec3::ZERO, step_u, step_v, rows, columns, jitter };
        let (last_row, last_column) = (f64::from(light.last_row()), f64::from(light.last_column()));
        let half = (step_u.as_dvec3() * last_column + step_v.as_dvec3() * last_row) * 0.5;
        let origin = (self.center() - lattice.origin()) * scale - half;
        // The steps' own rounding moves an outer sample by up to ¼ unit a step between places, on each axis.
        let lift = lift.with_error(0.25 * f64::from(places) * (last_row + last_column) + 0.5);
        let limit = f64::from(LIMIT) - 1.0 - f64::from(lift.steps());
        for (row, i) in [(0, 0.0), (rows - 1, last_row)] {
            for (column, j) in [(0, 0.0), (columns - 1, last_column)] {
                let sample = origin + step_u.as_dvec3() * j + step_v.as_dvec3() * i;
                if sample.abs().max_element() >= limit {
                    return Err(self.out_of_range(row, column));
                }
            }
        }
        let origin = IVec3::new(round_f64(origin.x), round_f64(origin.y), round_f64(origin.z));
        let normal = exact::cross::<Wide>(step_u, step_v).components();
        if normal.iter().all(|n| n.sign() == 0) {
            return Err(LightError::NoArea { edge_u: self.edge_u, edge_v: self.edge_v });
        }
        let (axis, sign) = surface::dominant_axis(&normal);
        Ok(LatticeLight { origin: surface::lift(origin, axis, sign * lift.steps()), ..light })
    }

    fn out_of_range(&self, row: u32, column: u32) -> LightError {
        let u = (f64::from(column) + 0.5) / f64::from(self.columns);
        let v = (f64::from(row) + 0.5) / f64::from(self.rows);
        let p = self.corner + self.edge_u * u + self.edge_v * v;
        let (mut axis, mut value) = ('x', p.x);
        for (name, other) in [('y', p.y), ('z', p.z)] {
            if other.abs() > value.abs() {
                (axis, value) = (name, other);
            }
        }
        LightError::OutOfRange { row, column, axis, value }
    }
}
