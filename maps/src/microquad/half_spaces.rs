//! What a convex hull blocks of samples that lie anywhere, from a table of half-spaces.
//!
//! Seed: Schwarz, Stamminger 2008, section 3.2: the half-space of each edge is looked up by the direction and the distance of its line, with a circular
//! wrap of the first and a clamp of the second, and the masks are AND-ed. Departure: lines are measured with `|x| + |y|` in
//! the place of `√(x² + y²)`. Directions are then places on a diamond, not angles, and distances from the centre of a light that spans −1 to 1 lie in
//! −1 to 1, not in −√2 to √2; neither takes a root nor an arc tangent, in which GPUs differ.
//!
//! Entries lie on the table's ends and on both axes, so that lines along the light's edges lose nothing to their direction. The half-space of a line and
//! that of its reverse share no sample and miss none, so that neighbours do not crack.

#[cfg(not(target_arch = "spirv"))]
use umbra4_core::{
    LatticeLight,
    jitter::{Pattern, Regular, Samples},
};
use umbra4_core::{MaskWord, PairWord};

#[cfg(not(target_arch = "spirv"))]
use crate::microquad::options::HalfSpaces;
use crate::{
    arithmetic::{Arithmetic, floor_within},
    microquad::{hull::Hull, params::MicroquadParams, projection::Point, rectangles::light, rows::Mask},
};

/// A mask word as a table holds it.
pub trait TableWord: MaskWord {
    /// Row `index` of a table, in which each takes `words` words of 32 bits: 1, or 2 where the light has more columns.
    fn load(table: &[u32], index: usize, words: usize) -> Self;
}

#[inline(always)]
fn word(table: &[u32], index: usize) -> u32 {
    if index < table.len() { table[index] } else { 0 }
}

impl TableWord for u16 {
    #[inline(always)]
    fn load(table: &[u32], index: usize, _: usize) -> Self {
        word(table, index) as Self
    }
}

impl TableWord for u32 {
    #[inline(always)]
    fn load(table: &[u32], index: usize, _: usize) -> Self {
        word(table, index)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl TableWord for u64 {
    #[inline(always)]
    fn load(table: &[u32], index: usize, words: usize) -> Self {
        let PairWord { low, high } = PairWord::load(table, index, words);
        Self::from(low) | Self::from(high) << 32
    }
}

impl TableWord for PairWord {
    #[inline(always)]
    fn load(table: &[u32], index: usize, words: usize) -> Self {
        let first = words * index;
        Self { low: word(table, first), high: if words > 1 { word(table, first + 1) } else { 0 } }
    }
}

/// The entry of the half-space to the left of the line from `p` to `q`, which are different, in entries of a table.
#[inline(always)]
pub fn entry(a: Arithmetic, params: &MicroquadParams, p: Point, q: Point) -> u32 {
    let (directions, distances) = (params.counts.w, params.table.x);
    // On the light that spans −1 to 1.
    let [middle_x, middle_y, scale_x, scale_y] = params.grid.to_array();
    let (x, y) = (a.mul(a.sub(p.x, middle_x), scale_x), a.mul(a.sub(p.y, middle_y), scale_y));
    // The normal that points inwards.
    let (normal_x, normal_y) = (a.mul(a.sub(p.y, q.y), scale_y), a.mul(a.sub(q.x, p.x), scale_x));
    let length = a.add(normal_x.abs(), normal_y.abs());
    let inverse = a.reciprocal(if length > f32::MIN_POSITIVE * 16.0 { length } else { 1.0 });
    let (along, across) = (a.mul(normal_x, inverse), a.mul(normal_y, inverse));
    // On the diamond: 0 along the columns, 1 along the rows, 2 against the columns, −1 against the rows.
    let place = if along < 0.0 { a.sub(2.0, across) } else { across };
    let direction =
        floor_within(a.add(a.mul(a.add(place, 1.0), 0.25 * directions as f32), 0.5), 0, directions as i32) as u32;
    let direction = if direction < directions { direction } else { 0 };
    let distance = a.sum_of_products(along, x, across, y);
    let distance =
        floor_within(a.add(a.mul(a.add(distance, 1.0), 0.5 * (distances - 1) as f32), 0.5), 0, distances as i32 - 1)
            as u32;
    direction * distances + distance
}

/// ORs the samples inside of `hull` into a mask.
#[inline(always)]
pub fn fill<W: TableWord>(a: Arithmetic, params: &MicroquadParams, table: &[u32], hull: &Hull, mask: &mut Mask<W>) {
    if hull.count == 0 {
        return;
    }
    let (rows, words) = (params.rows(), params.table.y as usize);
    let [p, q, r, s] = hull.corners;
    // What lies beside the light blocks nothing, though lines of the table that stand for its edges might.
    let [low, high] = light(params);
    let beside = p.x < low.x && q.x < low.x && r.x < low.x && s.x < low.x
        || p.y < low.y && q.y < low.y && r.y < low.y && s.y < low.y
        || p.x > high.x && q.x > high.x && r.x > high.x && s.x > high.x
        || p.y > high.y && q.y > high.y && r.y > high.y && s.y > high.y;
    if beside {
        return;
    }
    let is_quad = hull.count == 4;
    // First rows of the edges' entries.
    let (pq, qr) = (entry(a, params, p, q) * rows, entry(a, params, q, r) * rows);
    let from_r = entry(a, params, r, if is_quad { s } else { p }) * rows;
    let sp = if is_quad { entry(a, params, s, p) * rows } else { from_r };
    let mut row = 0;
    while row < rows as usize {
        let (first, second) = (W::load(table, pq as usize + row, words), W::load(table, qr as usize + row, words));
        let (third, fourth) = (W::load(table, from_r as usize + row, words), W::load(table, sp as usize + row, words));
        let (inside, place) = (first.and(second).and(third).and(fourth), row % mask.len());
        mask[place] = mask[place].or(inside);
        row += 1;
    }
}

/// Words of 32 bits of the table of a light.
#[cfg(not(target_arch = "spirv"))]
pub fn table_length(light: &LatticeLight, fineness: HalfSpaces) -> usize {
    let words = if light.columns > 32 { 2 } else { 1 };
    fineness.directions as usize * fineness.distances as usize * light.rows as usize * words
}

/// Line `index` of a table, in f64: what is inside has `x·n.0 + y·n.1` beyond the third, on a light that spans −1 to 1.
#[cfg(not(target_arch = "spirv"))]
pub fn line(fineness: HalfSpaces, index: usize) -> [f64; 3] {
    let HalfSpaces { directions, distances } =
        HalfSpaces { directions: fineness.directions.max(2), distances: fineness.distances.max(2) };
    let (direction, distance) = (index as u32 / distances, index as u32 % distances);
    // The second half of the diamond is the first, reversed, to the last bit.
    let half = directions / 2;
    let sign = if direction >= half { -1.0 } else { 1.0 };
    let place = f64::from(direction % half) * 4.0 / f64::from(directions) - 1.0;
    let along = 1.0 - place.abs();
    // Reverse distances are reversed, to the last bit.
    let distance = f64::from(2 * distance as i32 - (distances as i32 - 1)) / f64::from(distances - 1);
    [along * sign, place * sign, distance]
}

/// Writes the samples in half-space `index` of a table to `rows`: as many words as the light has rows, or twice as many for more than
/// 32 columns. Jittered samples lie where `light` puts them.
#[cfg(not(target_arch = "spirv"))]
pub fn write_entry(light: &LatticeLight, fineness: HalfSpaces, index: usize, rows: &mut [u32]) {
    if light.jitter.is_some() {
        write_with(light, &Pattern::of(light), line(fineness, index), rows);
    } else {
        write_with(light, &Regular, line(fineness, index), rows);
    }
}

/// Writes a whole table, of [`table_length`] words.
#[cfg(not(target_arch = "spirv"))]
pub fn write_table(light: &LatticeLight, fineness: HalfSpaces, words: &mut [u32]) {
    let entries = fineness.directions as usize * fineness.distances as usize;
    let entry = words.len() / entries.max(1);
    for (index, rows) in words.chunks_exact_mut(entry.max(1)).enumerate() {
        write_entry(light, fineness, index, rows);
    }
}

#[cfg(not(target_arch = "spirv"))]
fn write_with<S: Samples>(light: &LatticeLight, samples: &S, [along, across, distance]: [f64; 3], out: &mut [u32]) {
    let words = if light.columns > 32 { 2 } else { 1 };
    let middle = crate::microquad::fit::middle(light);
    let half = [f64::from(light.columns) * 0.5, f64::from(light.rows) * 0.5];
    // Of samples on the line itself, one of both half-spaces has them.
    let with_line = along > 0.0 || along == 0.0 && across > 0.0;
    for (row, words) in out.chunks_exact_mut(words).enumerate().take(light.rows as usize) {
        words.fill(0);
        for column in 0..light.columns {
            let place = samples.place(row, column as usize);
            let x = (f64::from(place.column) - middle[0]) / half[0];
            let y = (f64::from(place.row) - middle[1]) / half[1];
            let beyond = along * x + across * y - distance;
            let is_beyond = beyond > 0.0 || beyond == 0.0 && with_line;
            if is_beyond && let Some(word) = words.get_mut(column as usize / 32) {
                *word |= 1 << (column % 32);
            }
        }
    }
}
