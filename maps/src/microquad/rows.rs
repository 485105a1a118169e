//! What a convex hull blocks of regular samples, row by row.
//!
//! Seed: Schwarz, Stamminger 2008, section 3.3 and figure 6: of each row, the columns from `⌈l⌉` up to `⌈r⌉`, excluded. Departures: `l` and `r`
//! are computed anew for every row, where adding up increments would add up rounding; edges are taken from their lower end, so that both
//! neighbours of an edge find the same crossing and no sample between them is lost, or blocked twice; and an edge bounds the rows that it crosses,
//! from `⌈lower end⌉` up to `⌈upper end⌉`, excluded, so that horizontal edges bound none and need no tilt.

use umbra4_core::{MaskWord, light::MAX_SAMPLES};

use crate::{
    arithmetic::{Arithmetic, ceil_within, greater, lesser},
    microquad::{hull::Hull, params::MicroquadParams, projection::Point},
};

/// Rows of a mask; those beyond the light's are empty.
pub type Mask<W> = [W; MAX_SAMPLES as usize];

/// An edge that bounds rows `from..to`: its column at row `k` is `start + (k − from)·slope`.
#[derive(Clone, Copy, Default)]
struct Edge {
    start: f32,
    from: f32,
    to: f32,
    slope: f32,
    /// It bounds rows from below; else from above.
    lower: bool,
}

#[inline(always)]
fn edge(a: Arithmetic, p: Point, q: Point) -> Edge {
    // Counter-clockwise, what is inside lies to the left of an edge: edges that fall have it at higher columns.
    let lower = q.y < p.y;
    let (low, high) = if lower { (q, p) } else { (p, q) };
    let rise = a.sub(high.y, low.y);
    let slope = if rise > FLAT { a.mul(a.sub(high.x, low.x), a.reciprocal(rise)) } else { 0.0 };
    Edge { start: low.x, from: low.y, to: high.y, slope, lower }
}

/// Edges that rise by less cross a row at their lower end, if at all.
const FLAT: f32 = 1.0 / (1 << 24) as f32;

/// ORs the samples inside of `hull` into a mask.
#[inline(always)]
pub fn fill<W: MaskWord>(a: Arithmetic, params: &MicroquadParams, hull: &Hull, mask: &mut Mask<W>) {
    if hull.count == 0 {
        return;
    }
    let (rows, columns) = (params.rows(), params.columns());
    let [p, q, r, s] = hull.corners;
    let low = lesser(lesser(p.y, q.y), lesser(r.y, s.y));
    let high = greater(greater(p.y, q.y), greater(r.y, s.y));
    let (mut row, end) = (ceil_within(low, 0, rows as i32) as usize, ceil_within(high, 0, rows as i32) as usize);
    let left = lesser(lesser(p.x, q.x), lesser(r.x, s.x));
    let right = greater(greater(p.x, q.x), greater(r.x, s.x));
    if row >= end || left > (columns - 1) as f32 || right <= 0.0 {
        return;
    }
    // With three corners the last edge has no length.
    let edges = [edge(a, p, q), edge(a, q, r), edge(a, r, s), edge(a, s, p)];
    while row < end {
        let (mut from, mut to) = (0.0, columns as f32);
        let mut k = 0;
        while k < 4 {
            let Edge { start, from: first, to: end, slope, lower } = edges[k];
            // Of two edges that meet in this row, one: the other's rounding is not known to its neighbour.
            let crosses = row as f32 >= first && (row as f32) < end;
            let x = a.add(a.mul(a.sub(row as f32, first), slope), start);
            if crosses && lower {
                from = greater(x, from);
            } else if crosses {
                to = lesser(x, to);
            }
            k += 1;
        }
        let (from, to) = (ceil_within(from, 0, columns as i32) as u32, ceil_within(to, 0, columns as i32) as u32);
        if from < to {
            mask[row % mask.len()] = mask[row % mask.len()].or(W::span(from, to));
        }
        row += 1;
    }
}
