//! The oriented planes through a receiver and the edges of a triangle, as lines over the light's grid, in f32 with a
//! stated error bound; and which receivers they leave anything of.
//!
//! Seed: Wang et al. 2016, section 3.3 (planes P0 to P2 of Algorithm 3, lines 7 to 10). Departures: planes are oriented
//! by the receiver's side of the triangle (the listing omits it), each switch column comes with a bound on its
//! error, and pairs of which no sample can be blocked are dropped before any row is looked at. Most pairs never come
//! here: `outline` settles those whose corners rise from the receiver.
//!
//! # Error bound
//! For receiver p, edge a → b and sample (i, j), the sign sought is that of
//! `f(i, j) = A + C·i + B·j` with `A = n·(O − p)`, `C = n·dV`, `B = n·dU` and `n = (a − p) × (b − a)`. Each term of the
//! expanded sum is a product of one component each of d = a − p, e = b − a and g = O − p (or dV, dU), all exact integer
//! differences, under at most eight relative errors ε: three conversions, two products, one difference, two sums.
//! So `|f̂ − f| ≤ 8ε·P`, where P is the permanent: the same sum over absolute values, with
//! `|g| + (rows−1)·|dV| + (columns−1)·|dU|` in the place of g. Contraction and redistribution by a compiler only regroup
//! those terms, and are covered.
//!
//! A slope |B| below `least = 2^-10·bound` is replaced by it, to keep quotients finite: at most one ε·P more, over 64
//! columns. The switch column `x(i) = −(A + C·i)/B` is computed as `α + β·i` from a reciprocal (3ε), products and sums: at
//! most `7ε·P/|B|`. So column j is on the side that the float says if `|j − x̂(i)| > doubt`, where
//! `doubt = bound/|B|` and `bound = 20ε·P`: 16, and four to spare for the bound's own arithmetic, second-order terms, and
//! the rounding when a line is moved by its doubt.

use glam::{IVec3, Vec3};

#[cfg(not(target_arch = "spirv"))]
use crate::frame;
use crate::{
    doubt::Margins,
    frame::LightFrame,
    jittered_rows::Limits,
    lanes::{Lanes, TILE},
    light::LatticeLight,
    occluder::Occluder,
    precision::PrecisionMode,
    side::Sides,
};

/// Roundoffs in the bound on the switch column.
const COLUMN_ERRORS: f32 = 20.0;
/// The least slope that is divided by, in units of the bound.
const LEAST_SLOPE: f32 = 1.0 / 1024.0;

/// What the planes of all pairs need of the light, in f32.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(target_arch = "spirv"), repr(C))]
#[cfg_attr(target_arch = "spirv", repr(C, align(16)))]
pub struct LightGrid {
    /// The light itself, for the signs that are decided in integers.
    pub light: LatticeLight,
    /// Its frame.
    pub frame: LightFrame,
    /// Columns, rows and minus the height, not yet rounded to f32.
    #[cfg(not(target_arch = "spirv"))]
    pub(crate) long_axes: [[f64; 3]; 3],
    /// What the long axes' own rounding moves on the light, in columns or rows.
    pub(crate) skew: f32,
    step_u: Vec3,
    step_v: Vec3,
    last_column: f32,
    last_row: f32,
    extent: Vec3,
}

impl LightGrid {
    /// Rounds what is needed to f32, once a light.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(light: LatticeLight) -> Self {
        let [u, v, n] = frame::axes(&light);
        let long_axes = [u.to_array(), v.to_array(), (-n).to_array()];
        Self { long_axes, ..Self::from_frame(light, LightFrame::new(&light), frame::skew(&light)) }
    }

    /// From what the host computed in f64: the frame, and what the rounding of its axes moves on the light. On the host
    /// the long axes are left out: they are zero.
    #[inline(always)]
    pub fn from_frame(light: LatticeLight, frame: LightFrame, skew: f32) -> Self {
        let (step_u, step_v) = (float(light.step_u), float(light.step_v));
        let (last_row, last_column) = (light.last_row(), light.last_column());
        let extent = step_v.abs() * last_row + step_u.abs() * last_column;
        Self {
            step_u,
            step_v,
            last_column,
            last_row,
            extent,
            frame,
            #[cfg(not(target_arch = "spirv"))]
            long_axes: [[0.0; 3]; 3],
            skew,
            light,
        }
    }
}

#[inline(always)]
pub(crate) fn float(v: IVec3) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// The sums of magnitudes of the terms of `a × b`.
#[inline(always)]
pub(crate) fn cross_magnitudes(a: Vec3, b: Vec3) -> Vec3 {
    let (a, b) = (a.abs(), b.abs());
    Vec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x)
}

/// Sixteen receivers on the lattice, lane-major.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(target_arch = "spirv"), repr(C))]
#[cfg_attr(target_arch = "spirv", repr(C, align(16)))]
pub struct ReceiverTile {
    /// Lattice coordinates: `axes[axis][lane]`.
    axes: [[i32; TILE]; 3],
    low: IVec3,
    high: IVec3,
}

impl ReceiverTile {
    /// A tile without receivers.
    pub const EMPTY: Self = Self { axes: [[0; TILE]; 3], low: IVec3::splat(i32::MAX), high: IVec3::splat(i32::MIN) };

    /// Puts a receiver into a lane; `lane < TILE`.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, p: IVec3) {
        let l = lane % TILE;
        self.axes[0][l] = p.x;
        self.axes[1][l] = p.y;
        self.axes[2][l] = p.z;
        self.low = self.low.min(p);
        self.high = self.high.max(p);
    }

    /// Upper bounds of `|q − p|` on each axis, over all points q of a box and all receivers p of the tile: one bound
    /// serves all lanes, since the receivers of a group lie close together. (Up to the roundoff of the conversion, which
    /// error bounds count.)
    #[inline(always)]
    pub(crate) fn farthest(&self, low: IVec3, high: IVec3) -> Vec3 {
        float((high - self.low).max(self.high - low))
    }

    /// The points of the lanes from `first` on.
    #[inline(always)]
    pub(crate) fn load<L: Lanes>(&self, first: usize) -> [L::Ints; 3] {
        [L::load_ints(&self.axes[0], first), L::load_ints(&self.axes[1], first), L::load_ints(&self.axes[2], first)]
    }

    /// The point of one lane; `lane < TILE`.
    #[inline(always)]
    pub fn point(&self, lane: usize) -> IVec3 {
        let l = lane % TILE;
        IVec3::new(self.axes[0][l], self.axes[1][l], self.axes[2][l])
    }
}

/// The switch columns of `E` planes for sixteen receivers, as lines over the rows: `x(i) = slope·i + …`. A plane with its
/// bit in `lower` blocks from x upwards, one without from x downwards.
#[derive(Clone, Copy, Debug)]
pub struct Lines<const E: usize> {
    /// Columns a row.
    pub slope: [[f32; TILE]; E],
    /// Switch column at row 0.
    pub start: [[f32; TILE]; E],
    /// Error bound of the switch column, in columns, at any row. Written only where signs are certified.
    pub doubt: [[f32; TILE]; E],
    /// Bit l: for lane l the plane bounds the columns from below.
    pub lower: [u32; E],
    /// Bit l: lane l's side of the triangle's plane is the negative one.
    pub flipped: u32,
}

impl<const E: usize> Lines<E> {
    /// Lines of nothing, to be written by [`PairPlanes::lines`].
    pub const EMPTY: Self =
        Self { slope: [[0.0; TILE]; E], start: [[0.0; TILE]; E], doubt: [[0.0; TILE]; E], lower: [0; E], flipped: 0 };
}

impl<const E: usize> Margins for Lines<E> {
    #[inline(always)]
    fn margin(&self, k: usize, lane: usize, row: f32, column: f32) -> (f32, f32) {
        let k = k % E;
        let x = self.slope[k][lane] * row + self.start[k][lane];
        (if self.lower[k] >> lane & 1 == 1 { column - x } else { x - column }, self.doubt[k][lane])
    }

    #[inline(always)]
    fn flipped(&self, lane: usize) -> bool {
        self.flipped >> lane & 1 == 1
    }
}

impl<const E: usize> Limits for Lines<E> {
    #[inline(always)]
    fn limit(&self, k: usize, lane: usize) -> (f32, f32) {
        let k = k % E;
        let (start, doubt) = (self.start[k][lane], self.doubt[k][lane]);
        (self.slope[k][lane], if self.is_lower(k, lane) { start + doubt } else { start - doubt })
    }

    #[inline(always)]
    fn is_lower(&self, k: usize, lane: usize) -> bool {
        self.lower[k % E] >> lane & 1 == 1
    }

    #[inline(always)]
    fn beyond<P: PrecisionMode>(&self, planes: usize, lane: usize) -> f32 {
        let (mut most, mut k) = (0.0, 0);
        while P::CERTIFIED && k < planes && k < E {
            most = Lanes::max(most, self.doubt[k][lane]);
            k += 1;
        }
        2.0 * most
    }
}

/// One triangle against sixteen receivers.
pub struct PairPlanes {
    corners: [IVec3; 3],
    edges: [Vec3; 3],
    farthest: Vec3,
}

/// One vector of the three dot products that make a line, and what bounds their errors.
struct Form<L> {
    at_origin: L,
    per_row: L,
    per_column: L,
    /// P of the error bound, or more.
    permanent: f32,
}

impl PairPlanes {
    /// What all receivers share.
    #[inline(always)]
    pub fn new(receivers: &ReceiverTile, occluder: &Occluder) -> Self {
        let corners = occluder.corners();
        let [a, b, c] = corners;
        let edges = [float(b - a), float(c - b), float(a - c)];
        let farthest = receivers.farthest(a.min(b).min(c), a.max(b).max(c));
        Self { corners, edges, farthest }
    }

    /// Computes the lines of the lanes on the positive side of the triangle's plane, or of a mixed triangle those on either,
    /// and returns the lanes of which a sample may be blocked. `E` is at least 3, or 4 for a mixed triangle.
    #[inline(always)]
    pub fn lines<L: Lanes, P: PrecisionMode, const E: usize>(
        &self,
        grid: &LightGrid,
        receivers: &ReceiverTile,
        sides: Sides,
        mixed: bool,
        lines: &mut Lines<E>,
    ) -> u32 {
        let wanted = if mixed { sides.positive | sides.negative } else { sides.positive };
        let mut alive = 0;
        let mut first = 0;
        lines.lower = [0; E];
        lines.flipped = if mixed { sides.negative } else { 0 };
        while first < TILE {
            let lanes = wanted >> first & low_bits(L::WIDTH);
            if lanes != 0 {
                alive |= self.chunk::<L, P, E>(grid, receivers, first, lanes, mixed, lines) << first;
            }
            first += L::WIDTH;
        }
        alive
    }

    #[inline(always)]
    fn chunk<L: Lanes, P: PrecisionMode, const E: usize>(
        &self,
        grid: &LightGrid,
        receivers: &ReceiverTile,
        first: usize,
        wanted: u32,
        mixed: bool,
        lines: &mut Lines<E>,
    ) -> u32 {
        let p = receivers.load::<L>(first);
        let d0 = towards::<L>(self.corners[0], &p);
        let mut alive = wanted;
        let g = towards::<L>(grid.light.origin, &p);
        // One bound for all edges: the longest on each axis, from the farthest receiver.
        let origin = grid.light.origin;
        let longest = self.edges[0].abs().max(self.edges[1].abs()).max(self.edges[2].abs());
        let reach = receivers.farthest(origin, origin) + grid.extent;
        let permanent = cross_magnitudes(self.farthest, longest).dot(reach);
        let mut k = 0;
        while k < 3 {
            let d = if k == 0 { d0 } else { towards::<L>(self.corners[k], &p) };
            let e = self.edges[k];
            let n = cross_scalar(&d, e);
            let form = Form {
                at_origin: dot(&n, &g),
                per_row: dot_scalar(grid.step_v, &n),
                per_column: dot_scalar(grid.step_u, &n),
                permanent,
            };
            alive &= line::<L, P, E>(grid, k, first, form, mixed, lines);
            if alive == 0 {
                return 0;
            }
            k += 1;
        }
        if mixed {
            alive &= line::<L, P, E>(grid, 3, first, self.own_form(grid), mixed, lines);
        }
        alive
    }

    /// The plane of the triangle itself, which is the same for all receivers.
    #[inline(always)]
    fn own_form<L: Lanes>(&self, grid: &LightGrid) -> Form<L> {
        let normal = self.edges[2].cross(self.edges[0]);
        let normal_magnitudes = cross_magnitudes(self.edges[2], self.edges[0]);
        let g = float(grid.light.origin - self.corners[0]);
        Form {
            at_origin: L::splat(normal.dot(g)),
            per_row: L::splat(normal.dot(grid.step_v)),
            per_column: L::splat(normal.dot(grid.step_u)),
            permanent: normal_magnitudes.dot(g.abs() + grid.extent),
        }
    }
}

/// Turns one form into a line, writes it, and returns the lanes of which a sample may be on the blocked side.
#[inline(always)]
fn line<L: Lanes, P: PrecisionMode, const E: usize>(
    grid: &LightGrid,
    k: usize,
    first: usize,
    form: Form<L>,
    mixed: bool,
    lines: &mut Lines<E>,
) -> u32 {
    let zero = L::splat(0.0);
    let Form { at_origin: a, per_row: c, per_column: b, .. } = form;
    // Lanes whose receiver is on the other side see the planes turned round.
    let (a, c, b) = if mixed {
        let turn = turned::<L>(lines.flipped, first);
        (a.mul(turn), c.mul(turn), b.mul(turn))
    } else {
        (a, c, b)
    };
    // A receiver on the edge's own vertex has a bound of zero.
    let bound = Lanes::max(form.permanent * (COLUMN_ERRORS * L::ROUNDOFF), 1.0e-6);
    let least = L::splat(if P::CERTIFIED { bound * LEAST_SLOPE } else { 1.0e-6 });
    let bound = L::splat(bound);
    let magnitude = b.abs().max(least);
    let lower = b.ge(zero);
    let inverse = magnitude.recip();
    let signed = L::select(lower, zero.sub(inverse), inverse);
    let (at_origin, slope) = (a.mul(signed), c.mul(signed));
    slope.store(&mut lines.slope[k], first);
    if P::CERTIFIED {
        bound.mul(inverse).store(&mut lines.doubt[k], first);
    }
    at_origin.store(&mut lines.start[k], first);
    lines.lower[k] |= L::bits(lower) << first;
    // The form's largest value over the grid.
    let rise = c.mul(L::splat(grid.last_row)).max(zero);
    let most = a.add(rise).add(b.mul(L::splat(grid.last_column)).max(zero));
    L::bits(if P::CERTIFIED { most.add(bound).ge(zero) } else { most.ge(zero) })
}

/// The lowest `n` bits; `n ≤ 16`.
#[inline(always)]
const fn low_bits(n: usize) -> u32 {
    (1 << n) - 1
}

// No closures from here on, nor above: a closure is a function of its own, and would be compiled without the instruction
// set that the executor chose.

/// `q − p`.
#[inline(always)]
pub(crate) fn towards<L: Lanes>(q: IVec3, p: &[L::Ints; 3]) -> [L; 3] {
    [
        L::difference(L::splat_int(q.x), p[0]),
        L::difference(L::splat_int(q.y), p[1]),
        L::difference(L::splat_int(q.z), p[2]),
    ]
}

/// −1 in the lanes whose bit is set, 1 in the others.
#[inline(always)]
pub(crate) fn turned<L: Lanes>(flipped: u32, first: usize) -> L {
    let mut signs = [1.0_f32; TILE];
    let mut lane = 0;
    while lane < TILE {
        if flipped >> lane & 1 == 1 {
            signs[lane] = -1.0;
        }
        lane += 1;
    }
    L::load(&signs, first)
}

#[inline(always)]
pub(crate) fn dot<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> L {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0].mul(b[0])))
}

#[inline(always)]
pub(crate) fn dot_scalar<L: Lanes>(a: Vec3, b: &[L; 3]) -> L {
    dot(&[L::splat(a.x), L::splat(a.y), L::splat(a.z)], b)
}

/// `d × e`.
#[inline(always)]
pub(crate) fn cross_scalar<L: Lanes>(d: &[L; 3], e: Vec3) -> [L; 3] {
    let (x, y, z) = (L::splat(e.x), L::splat(e.y), L::splat(e.z));
    [d[1].mul(z).sub(d[2].mul(y)), d[2].mul(x).sub(d[0].mul(z)), d[0].mul(y).sub(d[1].mul(x))]
}
