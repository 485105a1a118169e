//! The signs that decide a bit, in integers: called where a float sign cannot be trusted.
//!
//! The rule: light sample L is blocked from receiver p by triangle (a, b, c) iff L and p lie *strictly* on opposite
//! sides of the triangle's plane and the three edge determinants, oriented by p's side, are ≥ 0. Triangles are closed:
//! a sample on a shared edge is blocked by both neighbours. A triangle whose plane holds the receiver or the sample
//! blocks nothing, and so does a degenerate one.
//!
//! With `n(a,b) = (a − p) × (b − a)`, the edge determinant is `n·(L − p)`, and along the light's rows and columns it is
//! linear: a [`GridForm`]. The plane of the triangle is one too.
//!
//! On GPUs the larger functions are not inlined: limbs take many instructions, and kernels would grow tenfold.

use glam::IVec3;

#[cfg(not(target_arch = "spirv"))]
use crate::jitter::{Pattern, Samples};
use crate::light::LatticeLight;
pub use crate::wide::{Wide, WideInt};

/// An integer that is linear over the light's grid: `at_origin + i·per_row + j·per_column` at sample (i, j).
#[derive(Clone, Copy, Debug)]
pub struct GridForm<W> {
    /// Value at sample (0, 0).
    pub at_origin: W,
    /// Difference from one row to the next.
    pub per_row: W,
    /// Difference from one column to the next.
    pub per_column: W,
}

impl<W: WideInt> GridForm<W> {
    /// Sign at sample (`row`, `column`).
    #[cfg_attr(not(target_arch = "spirv"), inline(always))]
    #[cfg_attr(target_arch = "spirv", inline(never))]
    pub fn sign_at(&self, row: i32, column: i32) -> i32 {
        self.at(row, column).sign()
    }

    /// Value at sample (`row`, `column`).
    #[inline(always)]
    pub fn at(&self, row: i32, column: i32) -> W {
        self.at_origin.plus(self.per_row.times(row)).plus(self.per_column.times(column))
    }

    /// As [`GridForm::sign_at`]; where that is 0, the sign a little farther along the columns; where that is 0 too, along the rows.
    /// Of two forms that differ in sign alone, one is positive: of triangles that share an edge, one is met by what meets the edge.
    #[cfg_attr(not(target_arch = "spirv"), inline(always))]
    #[cfg_attr(target_arch = "spirv", inline(never))]
    pub fn sign_beside(&self, row: i32, column: i32) -> i32 {
        let (here, across) = (self.at(row, column).sign(), self.per_column.sign());
        if here != 0 {
            here
        } else if across != 0 {
            across
        } else {
            self.per_row.sign()
        }
    }

    /// The form `n·(L − from)` over the light's samples.
    #[inline(always)]
    fn along(normal: Normal<W>, from: IVec3, light: LatticeLight) -> Self {
        Self {
            at_origin: dot(normal, light.origin - from),
            per_row: dot(normal, light.step_v),
            per_column: dot(normal, light.step_u),
        }
    }
}

/// An exact normal: a cross product of differences of lattice points.
#[derive(Clone, Copy, Debug)]
pub struct Normal<W: WideInt>([W::Area; 3]);

impl<W: WideInt> Normal<W> {
    /// The components, widened.
    pub fn components(&self) -> [W; 3] {
        [W::scaled(self.0[0], 1), W::scaled(self.0[1], 1), W::scaled(self.0[2], 1)]
    }
}

#[cfg(not(target_arch = "spirv"))]
impl Normal<i128> {
    /// The components, each rounded once.
    pub(crate) fn to_f64(self) -> glam::DVec3 {
        glam::DVec3::new(self.0[0] as f64, self.0[1] as f64, self.0[2] as f64)
    }
}

/// `u × v`; components of `u` and `v` below 2^31 in magnitude, as differences of lattice points are.
#[inline(always)]
pub fn cross<W: WideInt>(u: IVec3, v: IVec3) -> Normal<W> {
    Normal([W::area(u.y, v.z, u.z, v.y), W::area(u.z, v.x, u.x, v.z), W::area(u.x, v.y, u.y, v.x)])
}

/// `n·d`.
#[inline(always)]
pub fn dot<W: WideInt>(Normal(n): Normal<W>, d: IVec3) -> W {
    W::scaled(n[0], d.x).plus(W::scaled(n[1], d.y)).plus(W::scaled(n[2], d.z))
}

/// The oriented plane through receiver `p` and edge `a → b`, over the light's samples.
#[cfg_attr(not(target_arch = "spirv"), inline)]
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn edge_form<W: WideInt>(light: LatticeLight, p: IVec3, a: IVec3, b: IVec3) -> GridForm<W> {
    GridForm::along(cross(a - p, b - a), p, light)
}

/// The oriented plane of the triangle `(a, b, c)`, over the light's samples.
#[cfg_attr(not(target_arch = "spirv"), inline)]
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn triangle_form<W: WideInt>(light: LatticeLight, [a, b, c]: [IVec3; 3]) -> GridForm<W> {
    GridForm::along(cross(b - a, c - a), a, light)
}

/// The side of the triangle's plane on which light samples must lie to be blocked from `p`: the opposite of p's own.
/// 0 where p lies in the plane, or the triangle has none.
#[cfg_attr(not(target_arch = "spirv"), inline)]
#[cfg_attr(target_arch = "spirv", inline(never))]
pub fn far_side<W: WideInt>(p: IVec3, [a, b, c]: [IVec3; 3]) -> i32 {
    dot(cross::<W>(b - a, c - a), a - p).sign()
}

/// True where `p` is behind the light: `(step_u × step_v)·(p − O) ≤ 0`. All its samples count as blocked.
#[inline]
pub fn behind_light<W: WideInt>(light: &LatticeLight, p: IVec3) -> bool {
    dot(cross::<W>(light.step_u, light.step_v), p - light.origin).sign() <= 0
}

/// Whether the triangle blocks sample (`row`, `column`) from `p`: the rule as it stands above, one bit at a time.
#[cfg(not(target_arch = "spirv"))]
pub fn blocks<W: WideInt>(light: &LatticeLight, p: IVec3, triangle: [IVec3; 3], row: u32, column: u32) -> bool {
    let [a, b, c] = triangle;
    let fine = light.fine();
    let (row, column) = place(light, row, column);
    let side = far_side::<W>(p, triangle);
    side != 0
        && triangle_form::<W>(fine, triangle).sign_at(row, column) == side
        && edge_form::<W>(fine, p, a, b).sign_at(row, column) * side >= 0
        && edge_form::<W>(fine, p, b, c).sign_at(row, column) * side >= 0
        && edge_form::<W>(fine, p, c, a).sign_at(row, column) * side >= 0
}

/// Row and column of a sample among the places of the light.
#[cfg(not(target_arch = "spirv"))]
fn place(light: &LatticeLight, row: u32, column: u32) -> (i32, i32) {
    if !light.jitter.is_some() {
        return (row as i32, column as i32);
    }
    let place = Pattern::of(light).place(row as usize, column as usize);
    (place.fine_row, place.fine_column)
}
