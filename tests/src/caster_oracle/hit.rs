//! Does a triangle stand between a receiver and a light sample, and where does the way between them meet it?
//!
//! As in [`crate::oracle`], by Cramer's rule: `L − p = α(a − p) + β(b − p) + γ(c − p)`, all times `|V|`,
//! `V = det(a−p, b−p, c−p)`. The weights α, β, γ are those of the corners a, b, c at the hit. Everything but moved samples fits
//! `i128`: differences of coordinates stay below 2^30, determinants below 6·2^90.

use dashu_int::IBig;
use umbra4_core::{LatticeLight, glam::IVec3, jitter::PLACES};

use crate::bigint::{Point, det3, point, sign};

type Vector = [i128; 3];

/// Weights of a triangle's corners at a hit: none negative, not all zero.
pub type Weights = [i128; 3];

fn difference(a: IVec3, b: IVec3) -> Vector {
    [0, 1, 2].map(|k| i128::from(a[k]) - i128::from(b[k]))
}

fn cross(u: &Vector, v: &Vector) -> Vector {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

fn dot(u: &Vector, v: &Vector) -> i128 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

fn normal([a, b, c]: [IVec3; 3]) -> Vector {
    cross(&difference(b, a), &difference(c, a))
}

/// Whether a point lies strictly behind a triangle: on the side that its normal points away from.
pub fn is_behind(triangle: [IVec3; 3], q: IVec3) -> bool {
    dot(&normal(triangle), &difference(q, triangle[0])) < 0
}

/// The side of a triangle's plane that the light lies on, strictly: 1 where its normal points to it, −1 where it points away. None
/// where there is no such side: planes are not moved then.
///
/// The light is all places that samples may take, whatever the pattern of jitter, so that patterns that follow on one another agree on
/// it. What is linear takes its extremes at the corners.
pub fn offset_side(light: &LatticeLight, triangle: [IVec3; 3]) -> Option<i128> {
    // Places to a step; without jitter the samples are the places.
    let places = if light.jitter.is_some() { i128::from(PLACES) } else { 1 };
    let last = |count: u32| i128::from(count) * places - 1;
    let (normal, from) = (normal(triangle), difference(light.origin, triangle[0]));
    let along = [light.step_u, light.step_v].map(|step| dot(&normal, &difference(step, IVec3::ZERO)));
    let mut sides = [(0, 0), (0, last(light.columns)), (last(light.rows), 0), (last(light.rows), last(light.columns))]
        .map(|(row, column)| (places * dot(&normal, &from) + row * along[1] + column * along[0]).signum())
        .into_iter();
    let first = sides.next().filter(|&side| side != 0)?;
    sides.all(|side| side == first).then_some(first)
}

/// A triangle as one receiver sees it.
#[derive(Clone, Debug)]
pub struct Cone {
    p: IVec3,
    triangle: [IVec3; 3],
    /// Normals of the planes through p and the edges b → c, c → a, a → b.
    planes: [Vector; 3],
    /// V.
    volume: i128,
}

impl Cone {
    /// Of a receiver and a triangle.
    pub fn new(p: IVec3, triangle: [IVec3; 3]) -> Self {
        let [a, b, c] = triangle.map(|corner| difference(corner, p));
        let planes = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
        Self { p, triangle, planes, volume: dot(&a, &planes[0]) }
    }

    /// α, β, γ times `side · V`.
    fn weights(&self, side: i128, sample: IVec3) -> Weights {
        let l = difference(sample, self.p);
        [0, 1, 2].map(|k| side * dot(&self.planes[k], &l))
    }

    /// The weights at the hit where the triangle stands, by the plain rule, between p and a sample: none of them is negative, and their sum
    /// is more than 1, times |V|.
    pub fn plain(&self, sample: IVec3) -> Option<Weights> {
        let weights = self.weights(self.volume.signum(), sample);
        let between = self.volume != 0 && weights.iter().sum::<i128>() > self.volume.abs();
        (between && weights.iter().all(|&weight| weight >= 0)).then_some(weights)
    }

    /// The same with p moved by `offset` away from the samples, which lie on `side` of the plane, but for where the edges lie.
    ///
    /// With n the normal towards the samples and e the axis of its largest component, n·e is that component's size. So p, moved, lies
    /// behind the plane iff `n·(p − a) < offset · max |n|`.
    pub fn with_plane_moved(&self, sample: IVec3, side: i128, offset: i32) -> Option<Weights> {
        let normal = normal(self.triangle);
        let largest = normal.iter().map(|n| n.abs()).max().unwrap_or(0);
        let along = side * dot(&normal, &difference(self.p, self.triangle[0]));
        let weights = self.weights(side, sample);
        (along < i128::from(offset) * largest && weights.iter().all(|&weight| weight >= 0)).then_some(weights)
    }

    /// Whether the sample, moved by a small step along `steps[0]` and a much smaller one along `steps[1]`, lies strictly inside
    /// the cone of p and the triangle.
    ///
    /// All lengths are multiplied by 2^192, so that the steps, times 2^96 and times 1, are small: what they change a determinant by is below
    /// 2^93 times that factor, and no determinant that is not zero is below 2^192.
    pub fn sees_moved(&self, sample: IVec3, steps: [IVec3; 2]) -> bool {
        let scaled = |q: IVec3| point(q).map(|x| x << 192_usize);
        let from = scaled(self.p);
        let relative = |q: Point| [0, 1, 2].map(|k| &q[k] - &from[k]);
        let [u, v] = steps.map(point);
        let at = scaled(sample);
        let moved = relative([0, 1, 2].map(|k| &at[k] + (&u[k] << 96_usize) + &v[k]));
        let [a, b, c] = self.triangle.map(|corner| relative(scaled(corner)));
        let side = sign(&det3(&a, &b, &c));
        let inside = |weight: IBig| sign(&weight) == side;
        side != 0 && inside(det3(&moved, &b, &c)) && inside(det3(&a, &moved, &c)) && inside(det3(&a, &b, &moved))
    }

    /// True where some weight is negative at every corner of the light's cells, hence at every sample: what is linear is negative
    /// on all of a parallelogram if it is at its corners. The only short cut.
    pub fn misses(&self, light: &LatticeLight, offset_side: Option<i128>) -> bool {
        let side = offset_side.unwrap_or_else(|| self.volume.signum());
        let (l, u, v) = (difference(light.origin, self.p), difference(light.step_u, IVec3::ZERO), light.step_v);
        let v = difference(v, IVec3::ZERO);
        let (rows, columns) = (i128::from(light.rows), i128::from(light.columns));
        self.planes.iter().any(|plane| {
            let (origin, along_u, along_v) = (dot(plane, &l), columns * dot(plane, &u), rows * dot(plane, &v));
            [origin, origin + along_u, origin + along_v, origin + along_u + along_v].iter().all(|x| side * x < 0)
        })
    }
}

/// Whether the triangle blocks a sample by the plain rule.
pub fn blocks(p: IVec3, sample: IVec3, triangle: [IVec3; 3]) -> bool {
    Cone::new(p, triangle).plain(sample).is_some()
}

/// Whether a sample is seen through the triangle, where that alone counts: strictly between by the plain rule, and, on edges, by
/// the place of the moved sample. Always moves it: [`Cone::sees_moved`] is asked only on edges elsewhere.
pub fn sees_through(p: IVec3, sample: IVec3, triangle: [IVec3; 3], steps: [IVec3; 2]) -> bool {
    let cone = Cone::new(p, triangle);
    cone.plain(sample).is_some() && cone.sees_moved(sample, steps)
}
