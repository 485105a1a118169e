//! The rule in big integers, where nothing can overflow: what the oracle is itself checked against.
//!
//! A third formulation, by 4×4 determinants of homogeneous points: with `D(q, r, s, t)` the determinant of the rows
//! `(x, y, z, 1)`, a triangle blocks L from p iff `D(p,a,b,c)` and `D(L,a,b,c)` have strictly opposite signs and
//! `D(p,a,b,L)`, `D(p,b,c,L)`, `D(p,c,a,L)` have the sign of `D(p,a,b,c)` or are zero.

use dashu_int::{IBig, Sign};
use umbra4_core::{LatticeLight, glam::IVec3};

/// A point in big integers.
pub type Point = [IBig; 3];

/// A lattice point.
pub fn point(p: IVec3) -> Point {
    [p.x, p.y, p.z].map(IBig::from)
}

/// −1, 0 or 1.
pub fn sign(x: &IBig) -> i32 {
    match (*x == IBig::ZERO, x.sign()) {
        (true, _) => 0,
        (_, Sign::Positive) => 1,
        (_, Sign::Negative) => -1,
    }
}

/// The 3×3 determinant with rows u, v, w.
pub fn det3(u: &Point, v: &Point, w: &Point) -> IBig {
    &u[0] * (&v[1] * &w[2] - &v[2] * &w[1]) - &u[1] * (&v[0] * &w[2] - &v[2] * &w[0])
        + &u[2] * (&v[0] * &w[1] - &v[1] * &w[0])
}

/// The 4×4 determinant of homogeneous points, by expansion along the column of ones.
fn det4(q: &Point, r: &Point, s: &Point, t: &Point) -> IBig {
    det3(q, s, t) - det3(r, s, t) - det3(q, r, t) + det3(q, r, s)
}

/// Whether the triangle blocks `sample` from `p`.
pub fn hit(p: &Point, sample: &Point, [a, b, c]: &[Point; 3]) -> bool {
    let side = sign(&det4(p, a, b, c));
    side != 0
        && sign(&det4(sample, a, b, c)) == -side
        && sign(&det4(p, a, b, sample)) * side >= 0
        && sign(&det4(p, b, c, sample)) * side >= 0
        && sign(&det4(p, c, a, sample)) * side >= 0
}

/// One bit of the mask of `p`.
pub fn bit(light: &LatticeLight, p: IVec3, triangles: &[[IVec3; 3]], row: u32, column: u32) -> bool {
    let (origin, u, v, p) = (point(light.origin), point(light.step_u), point(light.step_v), point(p));
    let from_origin = [0, 1, 2].map(|k| &p[k] - &origin[k]);
    if sign(&det3(&u, &v, &from_origin)) <= 0 {
        return true;
    }
    // Where jitter puts a sample is input, as in the oracle.
    let sample = match light.jitter.is_some() {
        true => point(light.sample(row, column)),
        false => [0, 1, 2].map(|k| &origin[k] + &v[k] * IBig::from(row) + &u[k] * IBig::from(column)),
    };
    triangles.iter().any(|t| hit(&p, &sample, &t.map(point)))
}
