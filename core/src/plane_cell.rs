//! The place of a plane in a table of them ([`crate::cloud_table`]): the cell that its direction lies in, and its distance.
//!
//! All of it is integers, so that every executor looks up the same entry. The normal `n` and the value `v = n·(m − a)` at the
//! middle m of the cloud are exact; what they are divided by is rounded down. With `w` the lesser of `|n|·r` and
//! `|n_x|·h_x + |n_y|·h_y + |n_z|·h_z`, for the ball of radius r and the box of half extents h that hold the samples, and
//! rounded down too, a plane with `v ≥ w` has all samples on its inner side, and one with `v ≤ −w` none. So whatever surely holds
//! of all samples, as [`crate::cloud_pair`] finds it out in floats, holds here as well, and whoever asks there first gets the
//! same masks.
//!
//! Components of the normal are scaled by a power of two to below 2^30. Of that, 15 bits enter its length, and 18 its
//! direction: relative errors of 2^-14 and 2^-17, where cells are no finer than 2^-10.

use glam::IVec3;

use crate::{
    cloud_extent::CloudExtent,
    cloud_pair::{OWN_PLANE, Pair},
    exact::{self, Normal, Wide, WideInt},
};

/// Bits of the largest component of a scaled normal.
const NORMAL_BITS: u32 = 30;
/// Those of it, of the radius and of half extents that lengths are made of: three squares fit a word.
const LENGTH_BITS: u32 = 15;
/// Those that directions are made of: three times as much, doubled, times the most cells, fits a word.
const DIRECTION_BITS: u32 = 18;
/// Bits of what distances are divided by: doubled, times the most distances, it fits a word.
const DISTANCE_BITS: u32 = 18;

/// How finely planes are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableSize {
    /// Cells on a side of the square of directions, in `1..=1024`: there are as many directions as its square.
    pub directions: u32,
    /// Distances from the cloud's middle, of each direction, in `1..=4096`.
    pub distances: u32,
}

/// The place of a plane in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaneCell {
    /// Of the inner side: `row · directions + column` of the square.
    pub direction: u32,
    /// The distance. −1 where all samples lie on the inner side, the number of distances where none does.
    pub slot: i32,
}

/// The cells of a table, around a cloud.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellGrid {
    middle: IVec3,
    /// Half extents of the box, and the radius of the ball, in units of `2^-shift` lattice units, rounded down: below 2^15.
    half: [u32; 3],
    radius: u32,
    shift: i32,
    size: TableSize,
}

impl CellGrid {
    /// Of a cloud.
    #[inline(always)]
    pub fn new(extent: &CloudExtent, size: TableSize) -> Self {
        let bits = radius_of(extent).to_bits();
        // Of a float that is at least 1, the leading bit and those that follow it.
        let mantissa = bits & 0x007f_ffff | 0x0080_0000;
        let shift = LENGTH_BITS as i32 - 1 - ((bits >> 23) as i32 - 127);
        let half = extent.half_extents();
        Self {
            middle: extent.middle(),
            half: [scaled(half.x, shift), scaled(half.y, shift), scaled(half.z, shift)],
            radius: mantissa >> (24 - LENGTH_BITS),
            shift,
            size,
        }
    }

    /// Cells and distances.
    #[inline(always)]
    pub fn size(&self) -> TableSize {
        self.size
    }

    /// The place of a cell among the entries of the table; `None` where no sample lies on the inner side of its planes.
    #[inline(always)]
    pub fn entry(&self, cell: PlaneCell) -> Option<u32> {
        let TableSize { distances, .. } = self.size;
        if cell.slot >= distances as i32 { None } else { Some(cell.direction * distances + cell.slot as u32) }
    }

    /// Plane `k` of a pair, as [`Pair::cuts`] counts them.
    #[inline(always)]
    pub fn cell(&self, pair: &Pair, k: usize) -> PlaneCell {
        let [e, f, through] = pair.spans();
        let k = k % 4;
        self.place(f[k], e[k], self.middle - through[k], k == OWN_PLANE)
    }

    /// The plane with the inner normal `e × f` that has the middle at `d` from a point of it. A sample in the plane lies on the
    /// inner side, or if that is `open`, outside.
    ///
    /// On GPUs not inlined: limbs take many instructions.
    #[cfg_attr(not(target_arch = "spirv"), inline(always))]
    #[cfg_attr(target_arch = "spirv", inline(never))]
    fn place(&self, e: IVec3, f: IVec3, d: IVec3, open: bool) -> PlaneCell {
        let normal: Normal<Wide> = exact::cross(e, f);
        let value = exact::dot(normal, d);
        let [x, y, z] = normal.components();
        let most = greater(greater(x.bits(), y.bits()), z.bits());
        let down = most as i32 - NORMAL_BITS as i32;
        let n = [x.shifted(down), y.shifted(down), z.shifted(down)];
        let (length, spread) = self.lengths(n);
        let reach = length * self.radius;
        let within = if spread < reach { spread } else { reach };
        // In the units of both.
        let away = value.shifted(down + (NORMAL_BITS - LENGTH_BITS) as i32 - self.shift);
        let (sign, last) = (value.sign(), self.size.distances as i32);
        if away >= within || most == 0 {
            let all = sign > 0 || (sign == 0 && !open);
            return PlaneCell { direction: 0, slot: if all { -1 } else { last } };
        }
        let direction = self.direction(n, [x.sign(), y.sign(), z.sign()]);
        PlaneCell { direction, slot: self.slot(away, reach, sign) }
    }

    /// Length of a scaled normal, and how far it reaches over the box; both rounded down.
    #[inline(always)]
    fn lengths(&self, n: [u32; 3]) -> (u32, u32) {
        let (mut square, mut spread, mut k) = (0, 0, 0);
        while k < 3 {
            let n = n[k] >> (NORMAL_BITS - LENGTH_BITS);
            square += n * n;
            spread += n * self.half[k];
            k += 1;
        }
        (root(square), spread)
    }

    /// Of a plane that has the middle `away` from it, on the side of `sign`, where the ball reaches to `reach`.
    #[inline(always)]
    fn slot(&self, away: u32, reach: u32, sign: i32) -> i32 {
        let bits = 32 - reach.leading_zeros();
        let down = greater(bits, DISTANCE_BITS) - DISTANCE_BITS;
        let (away, reach) = (away >> down, reach >> down);
        // What is nearer to the inner side than the middle has a slot below half of them.
        let from_inside = if sign > 0 { reach - away } else { reach + away };
        let slot = from_inside * self.size.distances / greater(2 * reach, 1);
        lesser(slot, self.size.distances - 1) as i32
    }

    /// The cell of a direction, on an octahedron that is unfolded onto a square.
    #[inline(always)]
    fn direction(&self, n: [u32; 3], signs: [i32; 3]) -> u32 {
        let down = NORMAL_BITS - DIRECTION_BITS;
        let [x, y, z] = [n[0] >> down, n[1] >> down, n[2] >> down];
        let whole = greater(x + y + z, 1);
        // Below, edges are folded outwards.
        let (column, row) = if signs[2] >= 0 { (x, y) } else { (whole - y, whole - x) };
        self.along(row, signs[1], whole) * self.size.directions + self.along(column, signs[0], whole)
    }

    /// The cell along one side of the square, of a place between `−whole` and `whole`.
    #[inline(always)]
    fn along(&self, magnitude: u32, sign: i32, whole: u32) -> u32 {
        let from_start = if sign >= 0 { whole + magnitude } else { whole - magnitude };
        lesser(from_start * self.size.directions / (2 * whole), self.size.directions - 1)
    }
}

/// The radius that distances are counted by: at least a lattice unit.
#[inline(always)]
pub(crate) fn radius_of(extent: &CloudExtent) -> f32 {
    if extent.radius() > 1.0 { extent.radius() } else { 1.0 }
}

/// `half·2^shift`, rounded down.
#[inline(always)]
fn scaled(half: i32, shift: i32) -> u32 {
    if shift < 0 { half as u32 >> -shift } else { (half as u32) << shift }
}

/// The root of a square in `2^28..3·2^30`, rounded down: by Newton's steps, of which none ends below it.
#[inline(always)]
fn root(square: u32) -> u32 {
    // No step ends at zero, which has to be said here: nothing may panic.
    let step = |root: u32| (root + square / greater(root, 1)) / 2;
    let root = step(step(step(step(1 << LENGTH_BITS))));
    if root * root > square { root - 1 } else { root }
}

#[inline(always)]
fn greater(a: u32, b: u32) -> u32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn lesser(a: u32, b: u32) -> u32 {
    if a < b { a } else { b }
}
