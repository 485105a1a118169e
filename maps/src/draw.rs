//! One triangle on a shadow map: the inverse depth at the texel centres that it covers.
//!
//! Homogeneous rasterisation (Olano and Greer 1997): a ray from the light's centre meets the triangle where three determinants
//! have the sign of the triangle's own, so that nothing needs to be clipped, triangles that reach behind the light neither. All is relative
//! to the first corner's place on the map, so that small triangles do not cancel out. Edges are moved outwards
//! by `SLACK` texels: where two triangles meet no centre is lost to rounding.

use glam::IVec3;

use crate::{
    arithmetic::{Arithmetic, floor_within, greater, lesser},
    shadow_map::{MapFrame, OnMap},
};

/// Texels by which edges are moved outwards.
const SLACK: f32 = 1.0 / 1024.0;
/// Depth in near distances above which a corner has a place on the map.
const PLACED: f32 = 0.25;
/// Most that the slope moves an inverse depth by, as a share of it: triangles that the light's centre sees from their edge
/// would vanish else.
pub const MOST_OFFSET: f32 = 1.0 / 32.0;

/// A triangle, ready to be drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Edges: at a place, `a·x + b·y + c`, not negative inside.
    edges: [[f32; 3]; 3],
    /// Inverse depth at a place, as `a·x + b·y + c`, and what it is moved by.
    depth: [f32; 3],
    offset: f32,
    /// Inverse depths of its corners: the least and the greatest.
    ends: [f32; 2],
    /// Places are relative to this one, texels.
    origin: [f32; 2],
    /// Texels that may be covered: first and end.
    pub columns: [u32; 2],
    /// Texels that may be covered: first and end.
    pub rows: [u32; 2],
}

/// `p × q`
#[inline(always)]
fn cross(a: Arithmetic, p: OnMap, q: OnMap) -> [f32; 3] {
    [
        a.difference_of_products(p.y, q.z, p.z, q.y),
        a.difference_of_products(p.z, q.x, p.x, q.z),
        a.difference_of_products(p.x, q.y, p.y, q.x),
    ]
}

#[inline(always)]
fn relative(a: Arithmetic, p: OnMap, origin: [f32; 2]) -> OnMap {
    OnMap { x: a.sub(p.x, a.mul(origin[0], p.z)), y: a.sub(p.y, a.mul(origin[1], p.z)), z: p.z }
}

/// `sign·(a, b, c)`, moved outwards.
#[inline(always)]
fn edge(a: Arithmetic, [x, y, c]: [f32; 3], sign: f32) -> [f32; 3] {
    let slack = a.mul(a.add(x.abs(), y.abs()), SLACK);
    [x * sign, y * sign, a.add(c * sign, slack)]
}

/// First and end of the texels whose centres may lie in `low..=high`.
#[inline(always)]
fn texels(a: Arithmetic, low: f32, high: f32, size: u32) -> [u32; 2] {
    let size = size as i32;
    [floor_within(a.sub(low, 0.625), 0, size) as u32, floor_within(a.add(high, 0.625), 0, size) as u32]
}

/// Sets a triangle up; one that covers nothing has no columns.
#[inline(always)]
pub fn set_up(a: Arithmetic, frame: &MapFrame, corners: [IVec3; 3]) -> Drawing {
    let mut drawing = Drawing::default();
    let size = frame.size();
    let [p, q, r] = [frame.place(a, corners[0]), frame.place(a, corners[1]), frame.place(a, corners[2])];
    if p.z < 1.0 && q.z < 1.0 && r.z < 1.0 {
        return drawing;
    }
    // Where all corners have a place, so has the triangle; else it may be anywhere, at any depth.
    drawing.columns = [0, size];
    drawing.rows = [0, size];
    drawing.ends = [0.0, f32::MAX];
    if p.z > PLACED && q.z > PLACED && r.z > PLACED {
        let [i, j, k] = [a.reciprocal(p.z), a.reciprocal(q.z), a.reciprocal(r.z)];
        let (x, y) = ([a.mul(p.x, i), a.mul(q.x, j), a.mul(r.x, k)], [a.mul(p.y, i), a.mul(q.y, j), a.mul(r.y, k)]);
        let ends = |v: [f32; 3]| [lesser(lesser(v[0], v[1]), v[2]), greater(greater(v[0], v[1]), v[2])];
        let (columns, rows) = (ends(x), ends(y));
        drawing.columns = texels(a, columns[0], columns[1], size);
        drawing.rows = texels(a, rows[0], rows[1], size);
        drawing.ends = ends([i, j, k]);
        drawing.origin = [x[0], y[0]];
    }
    let [p, q, r] = [relative(a, p, drawing.origin), relative(a, q, drawing.origin), relative(a, r, drawing.origin)];
    let edges = [cross(a, q, r), cross(a, r, p), cross(a, p, q)];
    let volume = a.add(a.sum_of_products(edges[0][0], p.x, edges[0][1], p.y), a.mul(edges[0][2], p.z));
    // Also where it is no number.
    let size_of_volume = volume.abs();
    if !(size_of_volume > f32::MIN_POSITIVE * 16.0 && size_of_volume < f32::MAX / 16.0) {
        drawing.columns = [0, 0];
        return drawing;
    }
    let sign = if volume < 0.0 { -1.0 } else { 1.0 };
    let scale = a.reciprocal(volume);
    let sum = |k: usize| a.mul(a.add(a.add(edges[0][k], edges[1][k]), edges[2][k]), scale);
    drawing.depth = [sum(0), sum(1), sum(2)];
    drawing.offset = a.mul(a.add(drawing.depth[0].abs(), drawing.depth[1].abs()), frame.toward.w);
    drawing.edges = [edge(a, edges[0], sign), edge(a, edges[1], sign), edge(a, edges[2], sign)];
    drawing
}

#[inline(always)]
fn at(a: Arithmetic, form: [f32; 3], x: f32, y: f32) -> f32 {
    a.add(a.sum_of_products(form[0], x, form[1], y), form[2])
}

impl Drawing {
    /// The word of texel (`x`, `y`): the bits of the inverse depth at its centre; 0 where the triangle does not cover it, or is nearer
    /// than the near distance.
    #[inline(always)]
    pub fn texel(&self, a: Arithmetic, x: u32, y: u32) -> u32 {
        let column = a.sub(a.add(x as f32, 0.5), self.origin[0]);
        let row = a.sub(a.add(y as f32, 0.5), self.origin[1]);
        let inside = |k: usize| at(a, self.edges[k], column, row) >= 0.0;
        if !(inside(0) && inside(1) && inside(2)) {
            return 0;
        }
        let inverse = at(a, self.depth, column, row);
        // What rounding, or a centre just outside, makes of it is no depth that the triangle has.
        let inverse = lesser(greater(inverse, self.ends[0]), self.ends[1]);
        if !(inverse > 0.0 && inverse <= 1.0) {
            return 0;
        }
        let offset = lesser(self.offset, a.mul(inverse, MOST_OFFSET));
        a.sub(inverse, offset).to_bits()
    }
}
