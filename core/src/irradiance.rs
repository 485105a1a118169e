//! The irradiance that a Lambertian receiver gets of a light with an area, from its mask: over lit samples L,
//!
//! `E = Σ w(L) · max(0, cos θ) · max(0, cos φ) / |L − p|² · A/N`,
//!
//! w what the sample emits, θ and φ the angles at the receiver and at the light, A/N the area that a sample stands for. Lengths
//! cancel: in lattice units E is what it is in the world's. Its unit is that of w, times a steradian: a receiver below a whole sky
//! of w = 1 gets π.
//!
//! It is what a mask is good for beyond its number of lit samples: the usual product of unshadowed irradiance and visibility takes all
//! samples for equally bright, and is wrong where a wide light is near, or near a receiver's horizon.
//!
//! **Exact, and rounded.** Differences of places are exact integers. `cos φ · A/N = (u × v)·(p − O) / |L − p|` for *every* sample,
//! u and v the light's steps and O its origin, as all samples lie in one plane: the triple product is taken in integers, once a
//! receiver, and rounded once. The rest is f32. With ε = 2^-24, E the true sum and G the same sum without cos θ,
//!
//! `|error| ≤ ε·(`[`COSINE_ROUNDINGS`]`·G + (`[`ROUNDINGS`]` + rows + columns)·E)`,
//!
//! *since* n·(L − p) is off by at most 6 ε·|L − p| (n, the difference and products are rounded, two sums), and the other factors by
//! relative errors: 5 ε each time for |L − p|², 5 ε for its reciprocal on GPUs (2.5 units of the last place), used twice; one for
//! the triple product, 5 for products, 2 for the emission; sums go row by row, so that a term passes fewer than rows + columns of them.
//! (Errors of second order are left for the one or two roundings that are counted too many; parts below 2^-100 of the largest may
//! vanish.) Contracted products only make it smaller.

use glam::{IVec3, Vec3};

#[cfg(not(target_arch = "spirv"))]
use crate::{
    emission::{Emission, Weight},
    kernel::weigh::packed,
    mask_word::MaskWord,
};
use crate::{
    exact::{self, Wide, WideInt},
    kernel::weigh::{PackedWeight, unpacked},
    light::LatticeLight,
};

/// Roundings of a receiver's cosine, each 2^-24 of 1: see the error above.
pub const COSINE_ROUNDINGS: u32 = 6;
/// Roundings of a sample's part of the light, each 2^-24 of it, without those of sums.
pub const ROUNDINGS: u32 = 34;

/// One weight in 65535: see [`crate::emission::WHOLE`].
const ONE_WEIGHT: f32 = 1.0 / 65535.0;

/// What a light sample is to a receiver: where it lies, as the bits of lattice coordinates, and what it emits.
pub type PackedSample = [u32; 5];

/// The place of a sample, lattice.
#[inline(always)]
pub fn place(sample: &PackedSample) -> IVec3 {
    IVec3::new(sample[0] as i32, sample[1] as i32, sample[2] as i32)
}

/// What a sample emits: red, green and blue, in `0.0..=65535.0`.
#[inline(always)]
pub fn emitted(sample: &PackedSample) -> [f32; 3] {
    let weight: PackedWeight = [sample[3], sample[4]];
    let [red, green, blue] = unpacked(weight);
    [red as f32, green as f32, blue as f32]
}

/// The samples of a light, row by row. The emission has as many rows and columns.
#[cfg(not(target_arch = "spirv"))]
pub fn samples<S: AsRef<[Weight]>>(light: &LatticeLight, emission: &Emission<S>) -> impl Iterator<Item = PackedSample> {
    let (light, columns) = (*light, light.columns.max(1));
    (0..light.sample_count()).zip(emission.weights()).map(move |(index, weight)| {
        let place = light.sample(index / columns, index % columns);
        let [low, high] = packed(*weight);
        [place.x as u32, place.y as u32, place.z as u32, low, high]
    })
}

/// A normal of length 1, rounded once; `None` where it is zero or not finite.
#[cfg(not(target_arch = "spirv"))]
pub fn unit(normal: Vec3) -> Option<Vec3> {
    let long = normal.as_dvec3();
    let unit = long / long.length();
    if normal.is_finite() && unit.is_finite() { Some(unit.as_vec3()) } else { None }
}

/// A receiver before a light: what all samples share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambertian {
    point: IVec3,
    normal: Vec3,
    /// `(u × v)·(p − O)`: the height over the light's plane, times the area of a sample's cell. Not above 0 behind the light.
    height: f32,
}

impl Lambertian {
    /// The receiver at the lattice point `point`, whose surface has the unit normal `normal`.
    #[inline(always)]
    pub fn new(light: &LatticeLight, point: IVec3, normal: Vec3) -> Self {
        let height = exact::dot::<Wide>(exact::cross(light.step_u, light.step_v), point - light.origin);
        Self { point, normal, height: if height.sign() > 0 { rounded(height) } else { 0.0 } }
    }

    /// What a sample at the lattice point `sample` gives the receiver where it is lit and emits 1: `cos θ · cos φ / |L − p|² · A/N`,
    /// 0 where one of them does not face the other.
    #[inline(always)]
    pub fn form_factor(&self, sample: IVec3) -> f32 {
        let d = sample - self.point;
        let (x, y, z) = (d.x as f32, d.y as f32, d.z as f32);
        let cosine = self.normal.x * x + self.normal.y * y + self.normal.z * z;
        if cosine > 0.0 && self.height > 0.0 {
            let inverse = 1.0 / (x * x + y * y + z * z);
            (cosine * inverse) * (self.height * inverse)
        } else {
            0.0
        }
    }
}

/// A positive integer below 2^96, rounded to the nearest float, or to the one beside it.
#[inline(always)]
fn rounded(positive: Wide) -> f32 {
    let down = positive.bits() as i32 - 32;
    positive.shifted(down) as f32 * f32::from_bits(((127 + down) as u32) << 23)
}

/// Sums of the light of samples: by rows, and then of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    rows: [f32; 3],
    row: [f32; 3],
}

impl Sums {
    /// Adds a sample: what it emits, or as much of that as arrives (red, green, blue; in `0.0..=65535.0`), times its
    /// [form factor](Lambertian::form_factor).
    #[inline(always)]
    #[must_use]
    pub fn plus(self, emitted: [f32; 3], form_factor: f32) -> Self {
        let Self { rows, row } = self;
        let [red, green, blue] = emitted;
        Self { rows, row: [row[0] + red * form_factor, row[1] + green * form_factor, row[2] + blue * form_factor] }
    }

    /// Ends a row.
    #[inline(always)]
    #[must_use]
    pub fn row_ended(self) -> Self {
        let Self { rows, row } = self;
        Self { rows: [rows[0] + row[0], rows[1] + row[1], rows[2] + row[2]], row: [0.0; 3] }
    }

    /// The irradiance of all rows that have ended, where 65535 is emitted by samples of radiance 1.
    #[inline(always)]
    pub fn irradiance(self) -> [f32; 3] {
        [self.rows[0] * ONE_WEIGHT, self.rows[1] * ONE_WEIGHT, self.rows[2] * ONE_WEIGHT]
    }
}

/// The irradiance from the rows of a mask. `samples`: row by row, `columns` a row.
#[cfg(not(target_arch = "spirv"))]
#[inline]
pub fn of_rows<W: MaskWord>(receiver: &Lambertian, samples: &[PackedSample], columns: u32, rows: &[W]) -> [f32; 3] {
    let (mut sums, all) = (Sums::default(), W::below(columns));
    for (row, of_row) in rows.iter().zip(samples.chunks(columns.max(1) as usize)) {
        let mut lit = all.without(*row);
        while lit != W::EMPTY {
            let column = lit.lowest();
            lit = lit.without(W::span(column, column + 1));
            if let Some(sample) = of_row.get(column as usize) {
                sums = sums.plus(emitted(sample), receiver.form_factor(place(sample)));
            }
        }
        sums = sums.row_ended();
    }
    sums.irradiance()
}

/// The irradiance where nothing lies between. The usual approximation is this times the fraction that is lit
/// ([`Emission::fraction`]).
#[cfg(not(target_arch = "spirv"))]
pub fn unshadowed(receiver: &Lambertian, samples: &[PackedSample], columns: u32) -> [f32; 3] {
    let of_row = |sums: Sums, row: &[PackedSample]| {
        let add = |sums: Sums, sample: &PackedSample| sums.plus(emitted(sample), receiver.form_factor(place(sample)));
        row.iter().fold(sums, add).row_ended()
    };
    samples.chunks(columns.max(1) as usize).fold(Sums::default(), of_row).irradiance()
}
