//! What an edge of the silhouette adds to the depths of jittered samples: [`crate::edge_trace`], with [`crate::jitter`].
//!
//! Rows are rows of places. An edge between rows of places p and q (the first not below its ends) is passed by the samples that lie
//! in `p..q`: all of the rows in between, and of the first and the last row of samples those whose columns are shifted far enough, or
//! not too far. On which side of the line they lie is told as for lines of triangles ([`crate::jittered_rows`]). Depths are
//! counted from the light's first place, where no sample need lie.

use glam::IVec3;

use crate::{
    depth::Depths,
    edge_plane::LightGrid,
    edge_trace::Seen,
    exact::{self, GridForm, Wide},
    jitter::{PLACE_BITS, PLACES, Samples},
    jittered_rows::Line,
    lanes::{Lanes, TILE},
    mask_word::MaskWord,
    precision::PrecisionMode,
    row_mask::MASK_ROWS,
    silhouette::SilhouetteEdge,
    view::Corner,
};

/// Largest δ, in rows, that is worked with: less than half of what places lie apart.
pub(crate) const MOST_OFF: f32 = 1.0 / 128.0;
/// Half of what places lie apart, in rows.
const HALF_PLACE: f32 = 0.5 / PLACES as f32;

/// A row, or half a place off the light.
#[inline(always)]
pub(crate) fn within_places<L: Lanes>(row: L, last_row: f32) -> L {
    row.max(L::splat(-HALF_PLACE)).min(L::splat(last_row + HALF_PLACE))
}

/// The first row of places not below a row that [`within_places`] gave.
#[inline(always)]
pub(crate) fn first_place<L: Lanes>(row: L) -> L::Ints {
    row.mul(L::splat(PLACES as f32)).ceil()
}

/// Lanes in which a sample may lie within `off` rows and `wide` columns of an end. `row` is what [`within_places`] gave.
#[inline(always)]
pub(crate) fn near_sample<L: Lanes, S: Samples>(
    end: &Corner<L>,
    row: L,
    [off, wide]: [L; 2],
    last_column: f32,
    samples: &S,
) -> u32 {
    let (zero, places, half) = (L::splat(0.0), L::splat(PLACES as f32), L::splat(0.5));
    let none = L::splat_int(0);
    let place = L::difference(row.mul_add(places, half).floor(), none);
    let beside = off.mul(places).ge(row.mul(places).sub(place).abs());
    // The only sample of its row that may lie near, if it is shifted by as much as it has to.
    let at_row = place.mul(L::splat(1.0 / PLACES as f32)).floor();
    let shift = samples.row_shifts::<L>(at_row);
    let column = end.column.max(L::splat(-2.0)).min(L::splat(last_column + 2.0)).sub(shift);
    let at_column = column.add(half).max(zero).min(L::splat(last_column)).floor();
    let away = column.sub(L::difference(at_column, none)).abs();
    let height = L::difference(at_row, none).add(samples.column_shifts::<L>(at_column)).mul(places);
    let same = half.ge(height.sub(place).abs());
    L::bits(L::both(beside, L::both(wide.ge(away), same)))
}

/// The columns of samples that are shifted by `places` places or more.
#[inline(always)]
fn shifted_from<L: Lanes, W: MaskWord, S: Samples>(places: usize, columns: u32, samples: &S) -> W {
    let least = L::splat(places as f32 * (1.0 / PLACES as f32));
    let (mut word, mut first) = (W::EMPTY, 0);
    while first < columns {
        let shifts = samples.column_shifts::<L>(L::count_from(first as usize).ceil());
        word = word.or(W::columns(first, L::bits(shifts.ge(least))));
        first += L::WIDTH as u32;
    }
    word.and(W::below(columns))
}

/// Row of samples, and rows of places above it.
#[inline(always)]
fn split(place: usize) -> (usize, usize) {
    (place >> PLACE_BITS, place & (PLACES as usize - 1))
}

/// All samples in the rows of places from `place` on are deeper by `by`.
#[inline(always)]
pub(crate) fn step<L: Lanes, W: MaskWord, S: Samples>(
    depths: &mut Depths<W>,
    place: usize,
    by: i32,
    columns: u32,
    samples: &S,
) {
    let (row, above) = split(place);
    if above > 0 {
        let mut words = [W::EMPTY; TILE];
        words[0] = shifted_from::<L, W, S>(above, columns, samples);
        depths.add_words(row, words, by);
    }
    depths.step(row + (above > 0) as usize, by);
    if place == 0 {
        depths.step_origin(by);
    }
}

/// An edge as one receiver sees it.
pub(crate) struct Crossing<'a> {
    pub(crate) grid: &'a LightGrid,
    pub(crate) point: IVec3,
    pub(crate) edge: &'a SilhouetteEdge,
    /// Columns a row, and column at row 0.
    pub(crate) slope: f32,
    pub(crate) start: f32,
    /// How well a column is known.
    pub(crate) doubt: f32,
    /// Rows of places: the first, and the first beyond.
    pub(crate) places: [usize; 2],
    /// Whether it runs upwards.
    pub(crate) rises: bool,
}

impl Crossing<'_> {
    /// Makes the samples on the right of the edge deeper by `by`. Returns false where the light's first place is near the
    /// edge.
    #[inline(always)]
    pub(crate) fn add<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
        &self,
        by: i32,
        samples: &S,
        seen: &mut Seen<'_, W>,
    ) -> bool {
        let [from, to] = self.places;
        if from >= to {
            return true;
        }
        if from == 0 {
            if P::CERTIFIED && Lanes::abs(self.start) <= self.doubt {
                return false;
            }
            seen.depths.step_origin(if self.start <= 0.0 { by } else { 0 });
        }
        let columns = self.grid.light.columns;
        let line = Line::new(self.slope, self.start, true, self.doubt, -self.doubt);
        let ((first, above), last) = (split(from), split(to - 1).0);
        let mut near = NearSamples { crossing: self, form: None };
        let mut row = first;
        while row <= last {
            let here = if last + 1 - row < L::WIDTH { last + 1 - row } else { L::WIDTH };
            let x = line.crossings::<L, S>(samples, row);
            let mut words = [W::EMPTY; TILE];
            if line.is_shallow(self.doubt) {
                near.shallow::<L, W, P, S>(&line, x, [row, here], &mut words, samples, seen);
            } else {
                near.steep::<L, W, P, S>(&line, x, [row, here], &mut words, samples, seen);
            }
            if row == first && above > 0 {
                words[0] = words[0].and(shifted_from::<L, W, S>(above, columns, samples));
            }
            if row + here > last {
                let k = (last - row) % TILE;
                words[k] = words[k].without(shifted_from::<L, W, S>(to - (last << PLACE_BITS), columns, samples));
            }
            seen.depths.add_words(row, words, by);
            row += L::WIDTH;
        }
        true
    }
}

/// Samples near an edge, decided in integers.
struct NearSamples<'a> {
    crossing: &'a Crossing<'a>,
    form: Option<GridForm<Wide>>,
}

impl NearSamples<'_> {
    /// Samples on the right of a shallow line, in `rows` (the first, and how many).
    #[inline(always)]
    fn shallow<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
        &mut self,
        line: &Line,
        x: L,
        [row, here]: [usize; 2],
        words: &mut [W; TILE],
        samples: &S,
        seen: &mut Seen<'_, W>,
    ) {
        let last_column = (self.crossing.grid.light.columns - 1) as f32;
        // The only column of which it is not clear on which side it lies.
        let places = line.outer(x).max(L::splat(0.0)).min(L::splat(last_column)).ceil();
        let column = L::difference(places, L::splat_int(0));
        let depth = line.depth(line.t(column, samples.column_shifts::<L>(places)), x);
        let starts = L::select(depth.ge(L::splat(0.0)), column, column.add(L::splat(1.0)));
        let mut columns = [0; TILE];
        L::store_ints(starts.ceil(), &mut columns, 0);
        let mut k = 0;
        while k < TILE {
            let word = W::span(columns[k] as u32, W::BITS);
            words[k] = if k < here { word } else { W::EMPTY };
            k += 1;
        }
        if P::CERTIFIED {
            let doubt = L::splat(self.crossing.doubt);
            let near = L::bits(depth.add(doubt).ge(L::splat(0.0))) & !L::bits(depth.ge(doubt));
            let mut near = near & ((1_u32 << here) - 1);
            if near != 0 {
                L::store_ints(places, &mut columns, 0);
            }
            while near != 0 {
                let k = near.trailing_zeros() as usize % TILE;
                near &= near - 1;
                self.settle(row + k, columns[k] as u32, &mut words[k], samples, seen);
            }
        }
    }

    /// The same of a steep one.
    #[inline(always)]
    fn steep<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
        &mut self,
        line: &Line,
        x: L,
        [row, here]: [usize; 2],
        words: &mut [W; TILE],
        samples: &S,
        seen: &mut Seen<'_, W>,
    ) {
        let zero = L::splat(0.0);
        let all = L::splat(self.crossing.grid.light.columns as f32);
        let (from, to) = (line.outer(x).max(zero).min(all), line.inner(x).max(zero).min(all));
        let (mut starts, mut ends, mut crossings) = ([0; TILE], [0; TILE], [0.0; TILE]);
        L::store_ints(from.ceil(), &mut starts, 0);
        L::store_ints(to.ceil(), &mut ends, 0);
        x.store(&mut crossings, 0);
        let mut k = 0;
        while k < here && k < TILE {
            let mut word = W::span(starts[k] as u32, W::BITS);
            let mut first = starts[k];
            while first < ends[k] {
                let columns = L::count_from(first as usize);
                let shifts = samples.column_shifts::<L>(columns.ceil());
                let depth = line.depth(line.t(columns, shifts), L::splat(crossings[k]));
                let right = L::bits(depth.ge(zero));
                let open = !right & (((1_u64 << L::WIDTH) - 1) as u32);
                word = word.without(W::columns(first as u32, open));
                if P::CERTIFIED {
                    let doubt = L::splat(self.crossing.doubt);
                    let near = L::bits(depth.add(doubt).ge(zero)) & !L::bits(depth.ge(doubt));
                    let mut near = W::columns(first as u32, near).and(W::below(ends[k] as u32));
                    while near != W::EMPTY {
                        let column = near.lowest();
                        near = near.without(W::span(column, column + 1));
                        self.settle(row + k, column, &mut word, samples, seen);
                    }
                }
                first += L::WIDTH as i32;
            }
            words[k] = word;
            k += 1;
        }
    }

    /// Decides in integers on which side of the edge a sample lies, if the edge passes its row of places. Out of line: few come here.
    #[inline(never)]
    fn settle<W: MaskWord, S: Samples>(
        &mut self,
        row: usize,
        column: u32,
        word: &mut W,
        samples: &S,
        seen: &mut Seen<'_, W>,
    ) {
        let Crossing { grid, point, edge, places: [from, to], rises, .. } = *self.crossing;
        let place = samples.place(row, column as usize);
        if !(from as i32..to as i32).contains(&place.fine_row) {
            return;
        }
        let form = *self
            .form
            .get_or_insert_with(|| exact::edge_form::<Wide>(grid.light.fine(), point, edge.from(), edge.to()));
        *seen.fallbacks += 1;
        // Positive on the right of the edge.
        let sign = form.sign_at(place.fine_row, place.fine_column);
        let bit = W::span(column, column + 1);
        *word = if if rises { sign < 0 } else { sign > 0 } { word.without(bit) } else { word.or(bit) };
        if sign == 0 {
            seen.mask[row % MASK_ROWS] = seen.mask[row % MASK_ROWS].or(bit);
        }
    }
}
