//! The edges of one triangle as lines over the light's rows, for sixteen receivers: what a table is asked with.

use umbra4_core::{
    LatticeLight,
    exact::{self, GridForm, Wide},
    glam::{DVec3, IVec3},
    lanes::TILE,
    occluder::Occluder,
};

/// Steeper lines, in columns a row, are given this slope: over 64 rows they cross the whole grid within 2^-16 rows.
const STEEPEST: f64 = (1 << 22) as f64;
/// By how much, in rows, corners may be off where they tell which rows can change.
const ROW_DOUBT: f64 = 1.0 / 1024.0;

/// Column `slope·i + start` at row i, of three edges and sixteen receivers; as core's outlines have them.
#[derive(Clone, Copy, Debug)]
pub struct EdgeTile {
    /// Columns a row.
    pub slope: [[f32; TILE]; 3],
    /// Column at row 0.
    pub start: [[f32; TILE]; 3],
    /// Bit l: for lane l the edge bounds the columns from below.
    pub lower: [u32; 3],
    /// First row that may change.
    pub first: [u32; TILE],
    /// Number of rows that may.
    pub count: [u32; TILE],
}

impl EdgeTile {
    /// No edges.
    pub const EMPTY: Self =
        Self { slope: [[0.0; TILE]; 3], start: [[0.0; TILE]; 3], lower: [0; 3], first: [0; TILE], count: [0; TILE] };

    /// Puts a pair into a lane. The lines are the exact ones, rounded once: nobody knows them better.
    ///
    /// The receiver lies on the triangle's far side, and all corners between it and the light.
    pub fn set(&mut self, lane: usize, light: &LatticeLight, receiver: IVec3, occluder: &Occluder) {
        let [a, b, c] = occluder.corners();
        for (k, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            let (slope, start, lower) = line(&exact::edge_form::<Wide>(*light, receiver, from, to));
            (self.slope[k][lane], self.start[k][lane]) = (slope as f32, start as f32);
            self.lower[k] = self.lower[k] & !(1 << lane) | u32::from(lower) << lane;
        }
        let rows = [a, b, c].map(|corner| row_of(light, receiver, corner));
        let lowest = rows.into_iter().fold(f64::MAX, f64::min) - ROW_DOUBT;
        let highest = rows.into_iter().fold(f64::MIN, f64::max) + ROW_DOUBT;
        let first = lowest.ceil().clamp(0.0, f64::from(light.rows));
        let end = (highest.floor() + 1.0).clamp(first, f64::from(light.rows));
        (self.first[lane], self.count[lane]) = (first as u32, (end - first) as u32);
    }
}

/// Slope, start, and whether it is a lower bound, of the line where a form is zero; samples inside have a positive form.
fn line(form: &GridForm<Wide>) -> (f64, f64, bool) {
    let (at_origin, per_row, per_column) = (form.at_origin as f64, form.per_row as f64, form.per_column as f64);
    if per_row.abs() > STEEPEST * per_column.abs() {
        let slope = -STEEPEST.copysign(per_row);
        return (slope, slope * at_origin / per_row, true);
    }
    (-per_row / per_column, -at_origin / per_column, per_column > 0.0)
}

/// The row at which a receiver sees a point.
fn row_of(light: &LatticeLight, receiver: IVec3, point: IVec3) -> f64 {
    let [u, v] = [light.step_u.as_dvec3(), light.step_v.as_dvec3()];
    let normal = u.cross(v);
    let towards: DVec3 = (point - receiver).as_dvec3();
    let from = (receiver - light.origin).as_dvec3();
    let seen = from - towards * (normal.dot(from) / normal.dot(towards));
    normal.cross(u).dot(seen) / normal.cross(u).dot(v)
}
