//! What an axis-aligned rectangle blocks of regular samples; and the rectangle that stands for a microquad in the older approximation.
//!
//! Seed: Schwarz, Stamminger 2008, sections 2 and 3 and figure 3, on what their bitmask soft shadows of 2007 did: a quad's corners are clamped to the light,
//! which may move them, and an axis-aligned rectangle takes its place. Which rectangle the paper at hand does not say; here each side lies midway
//! between the two corners that it stands for.

use umbra4_core::MaskWord;

use crate::{
    arithmetic::{Arithmetic, ceil_within, greater, lesser},
    microquad::{params::MicroquadParams, projection::Point, rows::Mask},
};

/// The light's rectangle, in columns and rows of samples: its low and its high corner.
#[inline(always)]
pub fn light(params: &MicroquadParams) -> [Point; 2] {
    // Multiples of 1/64: exact.
    let (x, y) = (0.5 * params.columns() as f32, 0.5 * params.rows() as f32);
    let middle = params.grid;
    [Point { x: middle.x - x, y: middle.y - y }, Point { x: middle.x + x, y: middle.y + y }]
}

/// The point of the light's rectangle that is nearest to `p`.
#[inline(always)]
pub fn clamped(p: Point, [low, high]: [Point; 2]) -> Point {
    Point { x: lesser(greater(p.x, low.x), high.x), y: lesser(greater(p.y, low.y), high.y) }
}

/// The rectangle in place of a quad, its low and its high corner. Corners come around the quad as on the map, from its first texel along
/// the rows.
#[inline(always)]
pub fn of_quad(a: Arithmetic, params: &MicroquadParams, corners: [Point; 4]) -> [Point; 2] {
    let light = light(params);
    let [p, q, r, s] = [
        clamped(corners[0], light),
        clamped(corners[1], light),
        clamped(corners[2], light),
        clamped(corners[3], light),
    ];
    let middle = |x: f32, y: f32| a.mul(a.add(x, y), 0.5);
    let (left, right) = (middle(p.x, s.x), middle(q.x, r.x));
    let (below, above) = (middle(p.y, q.y), middle(r.y, s.y));
    [
        Point { x: lesser(left, right), y: lesser(below, above) },
        Point { x: greater(left, right), y: greater(below, above) },
    ]
}

/// ORs the samples of a rectangle into a mask: of its sides, the low ones are inside.
#[inline(always)]
pub fn fill<W: MaskWord>(params: &MicroquadParams, [low, high]: [Point; 2], mask: &mut Mask<W>) {
    let (rows, columns) = (params.rows() as i32, params.columns() as i32);
    let from = ceil_within(low.x, 0, columns) as u32;
    let to = ceil_within(high.x, 0, columns) as u32;
    let (mut row, end) = (ceil_within(low.y, 0, rows) as usize, ceil_within(high.y, 0, rows) as usize);
    if from >= to {
        return;
    }
    let word = W::span(from, to);
    while row < end {
        let place = row % mask.len();
        mask[place] = mask[place].or(word);
        row += 1;
    }
}
