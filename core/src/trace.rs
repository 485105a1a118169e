//! Traces: the lines in which the sides of an outline, or a mixed triangle's own plane, meet the light; and the cuts that
//! stand for those that run along the rows. Bounds and proof: [`crate::outline`].

use crate::{
    edge_plane::{LightGrid, cross_magnitudes, float},
    jitter::{PLACES, Regular, Samples},
    lanes::Lanes,
    light::MAX_SAMPLES,
    occluder::Occluder,
    precision::PrecisionMode,
    real::Real,
    view::Corner,
};

/// See [`flat`].
const FLAT: f32 = 1.0 / 32.0;
/// The same where samples are jittered: hardly a flat side would have none of their heights beside it.
const FLAT_JITTERED: f32 = 1.0 / 1024.0;
/// The same where nothing is certified.
pub(crate) const LEAST_RISE: f32 = 1.0e-6;
/// The slope that stands for a flat side, in columns a row: over `FLAT_MARGIN` it crosses the whole grid.
pub(crate) const FLAT_SLOPE: f32 = (1 << 22) as f32;
/// How far from a flat side rows must lie beyond δ, in rows. (Rounding moves the cut by less than δ.)
pub(crate) const FLAT_MARGIN: f32 = 1.0 / (1 << 14) as f32;
/// Largest doubt, in columns, of a line from a plane that others share: doubts differ much from plane to plane, and the
/// largest counts for all.
pub(crate) const MOST_PLANE_DOUBT: f32 = 1.0 / 64.0;
/// The least slope of a triangle's own plane along the columns that is divided by, as a part of its largest value.
pub(crate) const LEAST_COLUMN: f32 = 1.0 / (1 << 20) as f32;
/// A column off any grid: larger doubts make no difference.
pub(crate) const MOST_COLUMN: f32 = (1 << 30) as f32;

/// One side of sixteen outlines.
#[derive(Clone, Copy)]
pub(crate) struct Side<L: Lanes> {
    /// Columns a row.
    pub(crate) slope: L,
    /// Column at row 0, not yet moved inwards.
    pub(crate) start: L,
    /// Whether it bounds the columns from below.
    pub(crate) lower: L::Mask,
    /// |slope|, 0 where a cut stands for the side.
    pub(crate) steep: L,
    /// Rows from one end to the other, either way.
    pub(crate) rise: L,
    /// Rows of both ends.
    ends: [L; 2],
    /// Row of the corner that is not on it.
    opposite: L,
}

impl<L: Lanes> Side<L> {
    /// Between two corners, `along` columns and rows from one to the other, whichever goes clockwise.
    #[inline(always)]
    pub(crate) fn new<P: PrecisionMode, S: Samples>(
        corner: &Corner<L>,
        other: &Corner<L>,
        opposite: &Corner<L>,
        along: [L; 2],
    ) -> Self {
        let zero = L::splat(0.0);
        let rise = along[1].abs();
        let lower = along[1].ge(zero);
        let inverse = rise.max(L::splat(if P::CERTIFIED { flat::<S>() } else { LEAST_RISE })).recip();
        let slope = along[0].mul(L::select(lower, inverse, zero.sub(inverse)));
        let start = corner.column.sub(slope.mul(corner.row));
        let ends = [corner.row, other.row];
        Self { slope, start, lower, steep: slope.abs(), rise, ends, opposite: opposite.row }
    }

    /// In flat lanes, puts a line along the rows in the place of the side. Returns the lanes in which a sample may lie within
    /// `off` rows of the side: nothing can stand for it there.
    #[inline(always)]
    pub(crate) fn cut_flat<S: Samples>(&mut self, off: L) -> u32 {
        let (zero, off) = (L::splat(0.0), off.add(L::splat(FLAT_MARGIN)));
        let sloped = self.rise.ge(L::splat(flat::<S>()));
        let [one, other] = self.ends;
        let stuck = meets_row::<L, S>(one.min(other).sub(off), one.max(other).add(off));
        // The third corner tells which rows are inside: a side so short may well run along the columns. (Where that corner is
        // as near, no row lies within the triangle.)
        let middle = one.add(other).mul(L::splat(0.5));
        let cut = L::select(middle.ge(self.opposite), L::splat(FLAT_SLOPE), L::splat(-FLAT_SLOPE));
        self.slope = L::select(sloped, self.slope, cut);
        self.start = L::select(sloped, self.start, zero.sub(cut.mul(middle)));
        self.steep = L::select(sloped, self.steep, zero);
        self.lower = L::either(self.lower, L::not(sloped));
        stuck & !L::bits(sloped)
    }
}

/// A row, or the nearest place between rows that is off the light: where exactly does not matter there.
#[inline(always)]
fn within_rows<L: Lanes>(row: L) -> L {
    row.max(L::splat(-8.5)).min(L::splat(MAX_SAMPLES as f32 + 8.5))
}

/// Lanes in which samples may lie on a row in `bottom..=top`.
#[inline(always)]
fn meets_row<L: Lanes, S: Samples>(bottom: L, top: L) -> u32 {
    let (mut bottom, mut top) = (within_rows(bottom), within_rows(top));
    if S::JITTERED {
        (bottom, top) = (bottom.mul(L::splat(PLACES as f32)), top.mul(L::splat(PLACES as f32)));
    }
    top.integer_below(top.sub(bottom))
}

/// Sides that rise by less, in rows, have no usable slope.
#[inline(always)]
pub(crate) const fn flat<S: Samples>() -> f32 {
    if S::JITTERED { FLAT_JITTERED } else { FLAT }
}

/// A line so steep that it crosses the whole grid between two rows, as a cut along them.
pub(crate) struct Crossing<L> {
    pub(crate) slope: L,
    pub(crate) start: L,
    /// Lanes in which it crosses a row on its way: nothing can stand for it there.
    pub(crate) stuck: u32,
}

impl<L: Lanes> Crossing<L> {
    /// Of the line `slope·i + start`, known to within `doubt` columns.
    #[inline(always)]
    pub(crate) fn of(slope: L, start: L, doubt: L, columns: u32) -> Self {
        let zero = L::splat(0.0);
        let upwards = slope.ge(zero);
        let inverse = slope.abs().max(L::splat(1.0e-6)).recip();
        let inverse = L::select(upwards, inverse, zero.sub(inverse));
        // Rows at which the column is one off the grid, and the doubt more.
        let one = L::splat(-1.0).sub(doubt).sub(start).mul(inverse);
        let other = L::splat(columns as f32).add(doubt).sub(start).mul(inverse);
        let bottom = within_rows(one.min(other).sub(L::splat(FLAT_MARGIN)));
        let top = within_rows(one.max(other).add(L::splat(FLAT_MARGIN)));
        let cut = L::select(upwards, L::splat(FLAT_SLOPE), L::splat(-FLAT_SLOPE));
        let middle = bottom.add(top).mul(L::splat(0.5));
        Self { slope: cut, start: zero.sub(cut.mul(middle)), stuck: meets_row::<L, Regular>(bottom, top) }
    }
}

/// The line in which a mixed triangle's plane meets the light, the same for all receivers; as seen from its positive side.
#[derive(Clone, Copy)]
pub(crate) struct OwnSide {
    pub(crate) slope: f32,
    pub(crate) start: f32,
    pub(crate) doubt: f32,
    pub(crate) lower: bool,
    /// No line stands for it.
    pub(crate) stuck: bool,
}

impl OwnSide {
    pub(crate) const NONE: Self = Self { slope: 0.0, start: 0.0, doubt: 0.0, lower: true, stuck: false };

    /// The form `n·(L − a)` over the light, n the triangle's normal: its error is that of three products of three factors
    /// (see [`Real::SIDE_ERROR`]); its line has the roundoffs of a reciprocal, a product, the evaluation and the move.
    #[inline(always)]
    pub(crate) fn of<L: Lanes, P: PrecisionMode, S: Samples>(grid: &LightGrid, occluder: &Occluder) -> Self {
        let light = &grid.light;
        let [a, b, c] = occluder.corners();
        let (e, f, d) = (b - a, c - a, light.origin - a);
        let normal = L::Long::cross(e, f);
        let (at_origin, per_row) = (L::Long::dot(&normal, d).to_f32(), L::Long::dot(&normal, light.step_v).to_f32());
        let per_column = L::Long::dot(&normal, light.step_u).to_f32();
        let lower = per_column >= 0.0;
        // A smaller slope would make quotients that overflow. With this one the line crosses the same rows, less steeply.
        let samples = MAX_SAMPLES as f32;
        let whole = Lanes::abs(at_origin) + samples * Lanes::abs(per_row);
        let magnitude = Lanes::max(Lanes::max(Lanes::abs(per_column), whole * LEAST_COLUMN), 1.0e-20);
        let signed = if lower { -magnitude } else { magnitude };
        let (slope, start) = (per_row / signed, at_origin / signed);
        let mut own = Self { slope, start, doubt: 0.0, lower, stuck: false };
        if P::CERTIFIED {
            let steps = (float(light.step_u).abs() + float(light.step_v).abs()) * samples;
            let lost = L::Long::SIDE_ERROR * cross_magnitudes(float(e), float(f)).dot(float(d).abs() + steps);
            let rounding = 8.0 * L::ROUNDOFF * (Lanes::abs(start) + samples * Lanes::abs(slope) + samples);
            own.doubt = Lanes::min(lost / magnitude, MOST_COLUMN) + rounding;
            if own.doubt >= MOST_PLANE_DOUBT && S::JITTERED {
                // There is hardly a cut along the rows that no sample lies on.
                own.stuck = true;
            } else if own.doubt >= MOST_PLANE_DOUBT {
                let crossing = Crossing::of(slope, start, own.doubt, light.columns);
                own = Self {
                    slope: crossing.slope,
                    start: crossing.start,
                    doubt: 0.0,
                    lower,
                    stuck: crossing.stuck != 0,
                };
            }
        }
        own
    }
}
