//! The second oracle: masks on the original f32 coordinates, in big integers, without the snap. It shows what the snap
//! moves: every bit that differs must be explained by a determinant that the snap could have carried across zero.
//!
//! Floats are dyadic rationals: times a common power of two, and twice the rows and columns of the light (samples lie at
//! odd multiples of `edge / 2·count`), all coordinates are integers. One lattice unit is an integer there too.
//!
//! The criterion. The snap moves a coordinate of a vertex or receiver by at most ½ unit, and that of a sample by at most
//! `½ + (rows − 1)/4 + (columns − 1)/4`: its steps are rounded, each by at most ½, its centre stays. A determinant whose
//! entries `x` move by at most `e` changes by at most `perm(|x| + e) − perm(|x|)`. So if a bit differs, one of the
//! determinants that decide it is at most that far from zero; if none is, something other than the snap moved the bit.

use dashu_int::{
    IBig,
    ops::{Abs, BitTest, UnsignedAbs},
};
use umbra4_core::{
    Lattice,
    glam::{DVec3, Vec3},
};

use crate::{
    bigint::{Point, det3, sign},
    scene::WorldScene,
};

/// Lattice units are divided this finely in the criterion: the f64 rounding of a light's centre needs a little room.
const UNIT: u32 = 1024;

/// A signed mantissa and the exponent of its lowest bit: `x = mantissa · 2^exponent`.
fn dyadic(x: f64) -> (i64, i32) {
    if x == 0.0 {
        return (0, 0);
    }
    let bits = x.to_bits();
    let (biased, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    let shift = mantissa.trailing_zeros();
    let mantissa = (mantissa >> shift) as i64;
    (if x < 0.0 { -mantissa } else { mantissa }, exponent + shift as i32)
}

/// A world scene in exact integers.
#[derive(Debug)]
pub struct ExactScene {
    triangles: Vec<[Point; 3]>,
    receivers: Vec<Point>,
    /// All samples, row by row.
    samples: Vec<Point>,
    columns: usize,
    /// Sample (0, 0) and twice the steps.
    light: [Point; 3],
    /// Half a lattice unit, at the scale of the coordinates.
    half_unit: IBig,
    /// What the snap moves a coordinate of a sample by, at most.
    sample_moves: IBig,
}

/// One bit, and the smallest thing that is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unexplained {
    /// Index of the receiver.
    pub receiver: usize,
    /// Row of the sample.
    pub row: usize,
    /// Column of the sample.
    pub column: usize,
}

impl ExactScene {
    /// The scene in integers fine enough for `lattice`, whose origin is zero.
    pub fn new(scene: &WorldScene, lattice: &Lattice) -> Self {
        assert_eq!(lattice.origin(), DVec3::ZERO, "offsets are not needed here");
        let (rows, columns) = (scene.rows, scene.columns);
        let light = [scene.corner, scene.edge_u, scene.edge_v];
        let floats = |p: &Vec3| p.as_dvec3().to_array();
        let all = scene.vertices.iter().chain(&scene.receivers).map(floats).chain(light.iter().map(|p| p.to_array()));
        let lowest = all.flatten().map(|x| dyadic(x).1).min().unwrap_or(0);
        // Coordinates times 2^scale are integers, and so is a lattice unit divided by UNIT.
        let scale = (-lowest).max(lattice.exponent() + UNIT.ilog2() as i32).max(0);
        let factor = IBig::from(2 * rows * columns);
        let integer = |x: f64| {
            let (mantissa, exponent) = dyadic(x);
            &factor * (IBig::from(mantissa) << (exponent + scale) as usize)
        };
        let point = |p: DVec3| p.to_array().map(integer);
        let [corner, edge_u, edge_v] = light.map(point);
        let at = |i: u32, j: u32| {
            [0, 1, 2].map(|k| {
                let along_u = &edge_u[k] * IBig::from(2 * j + 1) / IBig::from(2 * columns);
                let along_v = &edge_v[k] * IBig::from(2 * i + 1) / IBig::from(2 * rows);
                &corner[k] + along_u + along_v
            })
        };
        let double_step = |edge: &Point, count: u32| [0, 1, 2].map(|k| &edge[k] * IBig::from(2) / IBig::from(count));
        let fine = &factor * (IBig::ONE << (scale - lattice.exponent() - UNIT.ilog2() as i32) as usize);
        Self {
            triangles: scene
                .triangles
                .iter()
                .map(|t| t.map(|v| point(scene.vertices[v as usize].as_dvec3())))
                .collect(),
            receivers: scene.receivers.iter().map(|p| point(p.as_dvec3())).collect(),
            samples: (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect(),
            columns: columns as usize,
            light: [at(0, 0), double_step(&edge_u, columns), double_step(&edge_v, rows)],
            half_unit: &fine * IBig::from(UNIT / 2),
            sample_moves: &fine * IBig::from(UNIT / 2 + UNIT / 4 * (rows - 1 + columns - 1) + 1),
        }
    }

    /// `det((p − O), 2·step_u, 2·step_v)`: ≤ 0 where the receiver is behind the light.
    fn before(&self, receiver: usize) -> [Point; 3] {
        let [origin, u, v] = &self.light;
        [minus(&self.receivers[receiver], origin), u.clone(), v.clone()]
    }

    /// Whether one triangle blocks one sample, and the rows of the five determinants that decide it.
    fn deciding(&self, p: &Point, sample: &Point, [a, b, c]: &[Point; 3]) -> (bool, [[Point; 3]; 5]) {
        let (pa, pb, pc, pl) = (minus(a, p), minus(b, p), minus(c, p), minus(sample, p));
        let rows = [
            [pa.clone(), pb.clone(), pc.clone()],
            [pl.clone(), pb.clone(), pc.clone()],
            [pa.clone(), pl.clone(), pc],
            [pa, pb, pl],
            [minus(b, a), minus(c, a), minus(sample, a)],
        ];
        let [volume, alpha, beta, gamma, beyond] =
            [0, 1, 2, 3, 4].map(|k| sign(&det3(&rows[k][0], &rows[k][1], &rows[k][2])));
        // det(b−a, c−a, p−a) = −det(a−p, b−p, c−p): the sample is beyond where its sign is that of the volume.
        let blocked = volume != 0 && beyond == volume && [alpha, beta, gamma].iter().all(|s| s * volume >= 0);
        (blocked, rows)
    }

    /// Compares the masks of the snapped scene (`rows` words a receiver) with the exact ones, bit by bit.
    ///
    /// Returns the number of differing bits and those that the snap does not explain.
    pub fn differences(&self, receiver: usize, mask: &[u64], snapped: &SnappedHit<'_>) -> (u64, Vec<Unexplained>) {
        let half = || self.half_unit.clone();
        let (point, sample) = (&half() + &half(), &self.half_unit + &self.sample_moves);
        let p = &self.receivers[receiver];
        let before = self.before(receiver);
        let behind = sign(&det3(&before[0], &before[1], &before[2])) <= 0;
        // Twice a step is moved by twice a half.
        let behind_is_near = near_zero(&before, &[sample.clone(), point.clone(), point.clone()]);
        let candidates: Vec<usize> =
            (0..self.triangles.len()).filter(|&t| self.may_touch(p, &self.triangles[t])).collect();
        let (mut differing, mut unexplained) = (0, Vec::new());
        for (k, l) in self.samples.iter().enumerate() {
            let (row, column) = (k / self.columns, k % self.columns);
            let exact = behind || candidates.iter().any(|&t| self.deciding(p, l, &self.triangles[t]).0);
            if exact == (mask[row] >> column & 1 == 1) {
                continue;
            }
            differing += 1;
            // A triangle must differ by itself, and wherever one does, one of its determinants must be near zero.
            let mut differs = false;
            let mut near = true;
            for (t, triangle) in self.triangles.iter().enumerate() {
                let (hit, rows) = self.deciding(p, l, triangle);
                if hit == snapped(receiver, row, column, t) {
                    continue;
                }
                differs = true;
                let [s, q] = [&sample, &point];
                let moves = [[q, q, q], [s, q, q], [q, s, q], [q, q, s], [q, q, s]];
                near &= rows.iter().zip(moves).any(|(rows, moves)| near_zero(rows, &moves.map(Clone::clone)));
            }
            if !(behind_is_near || differs && near) {
                unexplained.push(Unexplained { receiver, row, column });
            }
        }
        (differing, unexplained)
    }

    /// False only where the triangle cannot block any sample: one condition fails at all four corners of the light, and
    /// is linear between them.
    fn may_touch(&self, p: &Point, triangle: &[Point; 3]) -> bool {
        let last = self.samples.len() - 1;
        let corners = [0, self.columns - 1, last + 1 - self.columns, last].map(|k| {
            let (_, rows) = self.deciding(p, &self.samples[k], triangle);
            rows.map(|r| sign(&det3(&r[0], &r[1], &r[2])))
        });
        let volume = corners[0][0];
        volume != 0 && (1..5).all(|form| corners.iter().any(|c| c[form] * volume >= 0))
    }
}

/// Whether a triangle, snapped, blocks a sample: (receiver, row, column, triangle).
pub type SnappedHit<'a> = dyn Fn(usize, usize, usize, usize) -> bool + 'a;

fn minus(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

/// The permanent of the absolute values of three rows, each entry enlarged by its row's `moves`.
fn permanent(rows: &[Point; 3], moves: &[IBig; 3]) -> IBig {
    let [u, v, w] = [0, 1, 2].map(|r| [0, 1, 2].map(|k| (&rows[r][k]).abs() + &moves[r]));
    &u[0] * (&v[1] * &w[2] + &v[2] * &w[1])
        + &u[1] * (&v[0] * &w[2] + &v[2] * &w[0])
        + &u[2] * (&v[0] * &w[1] + &v[1] * &w[0])
}

/// Whether a determinant can reach zero when the entries of its rows move by at most `moves`.
fn near_zero(rows: &[Point; 3], moves: &[IBig; 3]) -> bool {
    let change = permanent(rows, moves) - permanent(rows, &[IBig::ZERO, IBig::ZERO, IBig::ZERO]);
    det3(&rows[0], &rows[1], &rows[2]).abs() <= change
}

/// Bits of the largest coordinate: how large the integers of this oracle are.
pub fn bits_of_largest(scene: &ExactScene) -> usize {
    let points = scene.receivers.iter().chain(scene.triangles.iter().flatten());
    points.flatten().map(|x| x.unsigned_abs().bit_len()).max().unwrap_or(0)
}
