//! The light's own frame: oblique axes along its two edges, and the normal. In it projection and binning are
//! axis-aligned, for parallelograms too.
//!
//! Frame coordinates of a lattice point: `a` in columns and `b` in rows (sample (i, j) sits at a = j, b = i, w = 0), and
//! the height `w` above the light plane in lattice units, positive on the lit side. They are float, and so never decide
//! a bit: every use carries the error bound of [`FramePoint`].

use glam::{IVec3, Vec3};

use crate::lanes::Lanes;

#[cfg(not(target_arch = "spirv"))]
use crate::{
    exact,
    light::{LatticeLight, MAX_SAMPLES},
    snap::LIMIT,
};
#[cfg(not(target_arch = "spirv"))]
use glam::DVec3;

/// The frame of one light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(target_arch = "spirv"), repr(C))]
#[cfg_attr(target_arch = "spirv", repr(C, align(16)))]
pub struct LightFrame {
    /// Lattice point of sample (0, 0).
    pub origin: IVec3,
    /// Columns per lattice unit: `a = along_u·(p − origin)`.
    pub along_u: Vec3,
    /// Rows per lattice unit.
    pub along_v: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// `a` of the last column: the samples span `0..=last_column`.
    pub last_column: f32,
    /// `b` of the last row.
    pub last_row: f32,
    /// Lattice units per column, and per row: turns slopes into tangents.
    pub scale: [f32; 2],
}

/// Columns, rows and heights per lattice unit: the dual basis of the steps, and the unit normal. On the host, in f64. The
/// normal's components are right to 2^-53, since the cross product is taken in integers; those of the other two to a few
/// 2^-53 of `|step|/|step_u × step_v|`.
#[cfg(not(target_arch = "spirv"))]
pub(crate) fn axes(light: &LatticeLight) -> [DVec3; 3] {
    let (u, v) = (light.step_u.as_dvec3(), light.step_v.as_dvec3());
    let n = exact::cross::<i128>(light.step_u, light.step_v).to_f64();
    let area = n.dot(n);
    [v.cross(n) / area, n.cross(u) / area, n / n.length()]
}

/// What the rounding of [`axes`] moves on the light, at most, in columns or rows: large only where the steps are all but
/// parallel.
#[cfg(not(target_arch = "spirv"))]
pub(crate) fn skew(light: &LatticeLight) -> f32 {
    let (u, v) = (light.step_u.as_dvec3(), light.step_v.as_dvec3());
    let lengths = u.length() + v.length();
    let area = exact::cross::<i128>(light.step_u, light.step_v).to_f64().length();
    (f64::from(MAX_SAMPLES) * f64::EPSILON * 8.0 * lengths * lengths / area) as f32
}

/// A point in a light's frame, with bounds on the absolute error of each coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePoint {
    /// Columns.
    pub a: f32,
    /// Rows.
    pub b: f32,
    /// Height above the light plane, lattice units.
    pub w: f32,
    /// Error bound of `a`.
    pub error_a: f32,
    /// Error bound of `b`.
    pub error_b: f32,
    /// Error bound of `w`.
    pub error_w: f32,
}

/// Relative error of a dot product of rounded axes and rounded differences, against the sum over absolute values:
/// one rounding each for the axis and the difference, one for the product, two for the sums, with 2^-23 each for any
/// rounding direction; and one more for the bound's own arithmetic, and one to spare.
const DOT_ERROR: f32 = 7.0 * f32::EPSILON;

impl LightFrame {
    /// Computed on the host, in f64, and rounded once to f32.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(light: &LatticeLight) -> Self {
        let [along_u, along_v, unit] = axes(light);
        Self {
            origin: light.origin,
            along_u: along_u.as_vec3(),
            along_v: along_v.as_vec3(),
            normal: unit.as_vec3(),
            last_column: light.last_column(),
            last_row: light.last_row(),
            scale: [light.step_u.as_dvec3().length() as f32, light.step_v.as_dvec3().length() as f32],
        }
    }

    /// The frame of a light that is infinitely far away, `towards` it. Its two axes across are the direction's products with those
    /// two of the lattice's that it is least along: their components are the direction's, or zero, so that rounding leaves them
    /// perpendicular to it but for what [`DOT_ERROR`] counts. The origin lies 2^30 lattice units towards the light, beyond the
    /// lattice, and heights grow away from it.
    #[cfg(not(target_arch = "spirv"))]
    pub(crate) fn parallel(towards: IVec3) -> Self {
        let direction = towards.as_dvec3();
        let (u, v) = match direction.abs().max_position() {
            0 => (DVec3::Y, DVec3::Z),
            1 => (DVec3::Z, DVec3::X),
            _ => (DVec3::X, DVec3::Y),
        };
        let unit = f64::from(LIMIT) * direction.abs().max_element().max(1.0);
        let up = direction.normalize_or(DVec3::Y);
        Self {
            origin: (up * f64::from(2 * LIMIT)).as_ivec3(),
            along_u: (direction.cross(u) / unit).as_vec3(),
            along_v: (direction.cross(v) / unit).as_vec3(),
            normal: (-up).as_vec3(),
            last_column: 0.0,
            last_row: 0.0,
            scale: [1.0; 2],
        }
    }

    /// Where a lattice point lies in this frame.
    #[inline]
    pub fn place(&self, p: IVec3) -> FramePoint {
        let d = p - self.origin;
        let d = [d.x as f32, d.y as f32, d.z as f32];
        let (a, error_a) = dot(self.along_u, &d);
        let (b, error_b) = dot(self.along_v, &d);
        let (w, error_w) = dot(self.normal, &d);
        FramePoint { a, b, w, error_a, error_b, error_w }
    }
}

/// A dot product and a bound on its error.
#[inline(always)]
pub(crate) fn dot<L: Lanes>(axis: Vec3, d: &[L; 3]) -> (L, L) {
    let (x, y, z) = (d[0].mul(L::splat(axis.x)), d[1].mul(L::splat(axis.y)), d[2].mul(L::splat(axis.z)));
    (x.add(y).add(z), x.abs().add(y.abs()).add(z.abs()).mul(L::splat(DOT_ERROR)))
}
