//! The few operations that row and plane arithmetic needs, over any number of lanes: one value on a GPU thread, sixteen
//! on a CPU core. One source serves both; executors bring implementations for their instruction sets.
//!
//! Data that lanes walk over is stored in tiles of [`TILE`] values. A vector of [`Lanes::WIDTH`] lanes covers the lanes
//! `first..first + WIDTH` of a tile.

use crate::{
    light::MAX_SAMPLES,
    real::{Axis, Real},
};

/// Receivers of a group, and rows of a chunk: they come in tiles of this many. On a GPU a thread has one of each.
#[cfg(not(target_arch = "spirv"))]
pub const TILE: usize = 16;
/// Receivers of a group, and rows of a chunk: they come in tiles of this many. On a GPU a thread has one of each.
#[cfg(target_arch = "spirv")]
pub const TILE: usize = 1;

/// A value for every row, or for every column, of a light: lane-major tiles.
pub type Table = [[f32; TILE]; MAX_SAMPLES as usize / TILE];

/// A piece of work that is compiled as a function of its own, see [`Lanes::apart`].
pub trait Apart {
    /// What comes of it.
    type Found;
    /// Does the work. Implementations are `#[inline(always)]`: what is called instead is compiled without the instruction set.
    fn run(self) -> Self::Found;
}

/// A vector of f32 lanes with the masks and integers that go with it.
///
/// Results need not be the same on all implementations: whatever decides a bit is certified with
/// [`Lanes::ROUNDOFF`]. No operation receives or produces NaN or an infinity.
pub trait Lanes: Copy {
    /// Lanes a vector; a divisor of [`TILE`].
    const WIDTH: usize;
    /// Largest relative error of one operation, and of the conversion of an integer.
    const ROUNDOFF: f32;
    /// The float in which points are placed in the light's frame.
    type Long: Real;
    /// A vector of i32.
    type Ints: Copy;
    /// One truth value a lane.
    type Mask: Copy;

    /// The same value in all lanes.
    fn splat(x: f32) -> Self;
    /// The same integer in all lanes.
    fn splat_int(x: i32) -> Self::Ints;
    /// Lanes `first..first + WIDTH` of a tile; `first` is a multiple of `WIDTH` below N, and N one of [`TILE`].
    fn load<const N: usize>(tile: &[f32; N], first: usize) -> Self;
    /// As [`Lanes::load`], of integers.
    fn load_ints(tile: &[i32; TILE], first: usize) -> Self::Ints;
    /// Writes lanes `first..first + WIDTH` of a tile.
    fn store(self, tile: &mut [f32; TILE], first: usize);
    /// As [`Lanes::store`], of integers.
    fn store_ints(ints: Self::Ints, tile: &mut [i32; TILE], first: usize);
    /// `first, first + 1, …`
    fn count_from(first: usize) -> Self;
    /// `a − b` as a float; the integer difference is exact (below 2^31 in magnitude).
    fn difference(a: Self::Ints, b: Self::Ints) -> Self;
    /// `a − b`.
    fn sub_ints(a: Self::Ints, b: Self::Ints) -> Self::Ints;
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self − other`.
    fn sub(self, other: Self) -> Self;
    /// `self · other`.
    fn mul(self, other: Self) -> Self;
    /// `self·b + c`, rounded once or twice.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `1 / self`, to within 3 [`Lanes::ROUNDOFF`].
    fn recip(self) -> Self;
    /// `|self|`.
    fn abs(self) -> Self;
    /// The smaller.
    fn min(self, other: Self) -> Self;
    /// The larger.
    fn max(self, other: Self) -> Self;
    /// `self ≥ other`.
    fn ge(self, other: Self) -> Self::Mask;
    /// The lanes whose bit is set.
    fn mask(bits: u32) -> Self::Mask;
    /// Both.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either.
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// The others.
    fn not(a: Self::Mask) -> Self::Mask;
    /// `a` where the mask is set, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Bit l is lane l.
    fn bits(mask: Self::Mask) -> u32;
    /// The smallest integer not below; `|self| ≤ 2^20`.
    fn ceil(self) -> Self::Ints;
    /// The largest integer not above; `|self| ≤ 2^20`.
    fn floor(self) -> Self::Ints;
    /// Bit l is set where an integer lies in `self − by..=self`; `|self| ≤ 2^20`, `by ≥ 0`.
    fn integer_below(self, by: Self) -> u32;
    /// Bit l is set where an integer lies in `self..=self + by`; `|self| ≤ 2^20`, `by ≥ 0`.
    fn integer_above(self, by: Self) -> u32;
    /// Bit l is set where an integer lies in `below − by..=below` or in `above..=above + by`; as the two others.
    #[inline(always)]
    fn integer_beside(below: Self, above: Self, by: Self) -> u32 {
        below.integer_below(by) | above.integer_above(by)
    }
    /// Entries of a table; places modulo its length.
    fn lookup(table: &Table, places: Self::Ints) -> Self;
    /// The largest lane.
    fn largest(self) -> f32;
    /// Bit l is set where `a < b` in lane l.
    fn less(a: Self::Ints, b: Self::Ints) -> u32;
    /// Does a piece of work in a function of its own, compiled for the lanes' instruction set, so that all its callers share one copy:
    /// what is large takes compilers minutes where it is inlined into every stage and for every word.
    fn apart<A: Apart>(work: A) -> A::Found;
    /// Three axes' dot products with four integer vectors, axis-major, rounded to f32.
    #[inline(always)]
    fn dots(axes: &[Axis<Self::Long>; 3], d: &[[i32; 4]; 3]) -> [[f32; 4]; 3] {
        [Self::Long::dots(&axes[0], d), Self::Long::dots(&axes[1], d), Self::Long::dots(&axes[2], d)]
    }
}

/// One lane: a GPU thread, or plain scalar code. The roundoff is that of any conforming GPU, whose rounding direction
/// is unspecified.
impl Lanes for f32 {
    const WIDTH: usize = 1;
    const ROUNDOFF: f32 = f32::EPSILON;
    type Long = f32;
    type Ints = i32;
    type Mask = bool;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        x
    }
    #[inline(always)]
    fn splat_int(x: i32) -> i32 {
        x
    }
    #[inline(always)]
    fn load<const N: usize>(tile: &[f32; N], first: usize) -> Self {
        tile[first % N]
    }
    #[inline(always)]
    fn load_ints(tile: &[i32; TILE], first: usize) -> i32 {
        tile[first % TILE]
    }
    #[inline(always)]
    fn store(self, tile: &mut [f32; TILE], first: usize) {
        tile[first % TILE] = self;
    }
    #[inline(always)]
    fn store_ints(ints: i32, tile: &mut [i32; TILE], first: usize) {
        tile[first % TILE] = ints;
    }
    #[inline(always)]
    fn count_from(first: usize) -> Self {
        first as f32
    }
    #[inline(always)]
    fn difference(a: i32, b: i32) -> Self {
        a.wrapping_sub(b) as f32
    }
    #[inline(always)]
    fn sub_ints(a: i32, b: i32) -> i32 {
        a.wrapping_sub(b)
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self - other
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * other
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn recip(self) -> Self {
        1.0 / self
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if self < 0.0 { -self } else { self }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn ge(self, other: Self) -> bool {
        self >= other
    }
    #[inline(always)]
    fn either(a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn not(a: bool) -> bool {
        !a
    }
    #[inline(always)]
    fn mask(bits: u32) -> bool {
        bits & 1 == 1
    }
    #[inline(always)]
    fn both(a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn bits(mask: bool) -> u32 {
        mask as u32
    }
    #[inline(always)]
    fn ceil(self) -> i32 {
        let t = self as i32;
        t + ((t as f32) < self) as i32
    }
    #[inline(always)]
    fn floor(self) -> i32 {
        let t = self as i32;
        t - ((t as f32) > self) as i32
    }
    #[inline(always)]
    fn integer_below(self, by: Self) -> u32 {
        (self - Lanes::floor(self) as f32 <= by) as u32
    }
    #[inline(always)]
    fn integer_above(self, by: Self) -> u32 {
        (Lanes::ceil(self) as f32 - self <= by) as u32
    }
    #[inline(always)]
    fn lookup(table: &Table, place: i32) -> Self {
        table[place as usize / TILE % table.len()][place as usize % TILE]
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        self
    }
    #[inline(always)]
    fn less(a: i32, b: i32) -> u32 {
        (a < b) as u32
    }
    #[cfg_attr(target_arch = "spirv", inline(always))]
    #[cfg_attr(not(target_arch = "spirv"), inline(never))]
    fn apart<A: Apart>(work: A) -> A::Found {
        work.run()
    }
}

/// Lanes in plain arrays, `N` a divisor of [`TILE`]: what the compiler vectorises for instruction sets without an
/// implementation of their own. Rounds to nearest, as Rust does everywhere.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug)]
pub struct Array<const N: usize>([f32; N]);

/// Four lanes: a register of any processor's.
#[cfg(not(target_arch = "spirv"))]
pub type Four = Array<4>;

/// Sixteen lanes.
#[cfg(not(target_arch = "spirv"))]
pub type Sixteen = Array<TILE>;

#[cfg(not(target_arch = "spirv"))]
macro_rules! each {
    ($k:ident => $value:expr) => {{
        let mut out = [Default::default(); N];
        let mut $k = 0;
        while $k < N {
            out[$k] = $value;
            $k += 1;
        }
        out
    }};
}

#[cfg(not(target_arch = "spirv"))]
impl<const N: usize> Lanes for Array<N> {
    const WIDTH: usize = {
        assert!(N > 0 && TILE.is_multiple_of(N));
        N
    };
    const ROUNDOFF: f32 = f32::EPSILON / 2.0;
    type Long = f64;
    type Ints = [i32; N];
    type Mask = [bool; N];

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; N])
    }
    #[inline(always)]
    fn splat_int(x: i32) -> Self::Ints {
        [x; N]
    }
    #[inline(always)]
    fn load<const M: usize>(tile: &[f32; M], first: usize) -> Self {
        Self(each!(k => tile[(first + k) % M]))
    }
    #[inline(always)]
    fn load_ints(tile: &[i32; TILE], first: usize) -> Self::Ints {
        each!(k => tile[(first + k) % TILE])
    }
    #[inline(always)]
    fn store(self, tile: &mut [f32; TILE], first: usize) {
        let mut k = 0;
        while k < N {
            tile[(first + k) % TILE] = self.0[k];
            k += 1;
        }
    }
    #[inline(always)]
    fn store_ints(ints: Self::Ints, tile: &mut [i32; TILE], first: usize) {
        let mut k = 0;
        while k < N {
            tile[(first + k) % TILE] = ints[k];
            k += 1;
        }
    }
    #[inline(always)]
    fn count_from(first: usize) -> Self {
        Self(each!(k => (first + k) as f32))
    }
    #[inline(always)]
    fn difference(a: Self::Ints, b: Self::Ints) -> Self {
        Self(each!(k => a[k].wrapping_sub(b[k]) as f32))
    }
    #[inline(always)]
    fn sub_ints(a: Self::Ints, b: Self::Ints) -> Self::Ints {
        each!(k => a[k].wrapping_sub(b[k]))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(each!(k => self.0[k] + other.0[k]))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(each!(k => self.0[k] - other.0[k]))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(each!(k => self.0[k] * other.0[k]))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(each!(k => self.0[k] * b.0[k] + c.0[k]))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        Self(each!(k => 1.0 / self.0[k]))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(each!(k => self.0[k].abs()))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(each!(k => Lanes::min(self.0[k], other.0[k])))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(each!(k => Lanes::max(self.0[k], other.0[k])))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        each!(k => self.0[k] >= other.0[k])
    }
    #[inline(always)]
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each!(k => a[k] | b[k])
    }
    #[inline(always)]
    fn not(a: Self::Mask) -> Self::Mask {
        each!(k => !a[k])
    }
    #[inline(always)]
    fn mask(bits: u32) -> Self::Mask {
        each!(k => bits >> k & 1 == 1)
    }
    #[inline(always)]
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each!(k => a[k] & b[k])
    }
    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        Self(each!(k => if mask[k] { a.0[k] } else { b.0[k] }))
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        let mut bits = 0;
        let mut k = 0;
        while k < N {
            bits |= (mask[k] as u32) << k;
            k += 1;
        }
        bits
    }
    #[inline(always)]
    fn ceil(self) -> Self::Ints {
        each!(k => Lanes::ceil(self.0[k]))
    }
    #[inline(always)]
    fn floor(self) -> Self::Ints {
        each!(k => Lanes::floor(self.0[k]))
    }
    #[inline(always)]
    fn integer_below(self, by: Self) -> u32 {
        Self::bits(each!(k => Lanes::integer_below(self.0[k], by.0[k]) == 1))
    }
    #[inline(always)]
    fn integer_above(self, by: Self) -> u32 {
        Self::bits(each!(k => Lanes::integer_above(self.0[k], by.0[k]) == 1))
    }
    // A function of its own: many loads, and compilers take long over many of them.
    #[inline(never)]
    fn lookup(table: &Table, places: Self::Ints) -> Self {
        Self(each!(k => <f32 as Lanes>::lookup(table, places[k])))
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        let (mut largest, mut k) = (self.0[0], 1);
        while k < N {
            largest = Lanes::max(largest, self.0[k]);
            k += 1;
        }
        largest
    }
    #[inline(always)]
    fn less(a: Self::Ints, b: Self::Ints) -> u32 {
        Self::bits(each!(k => a[k] < b[k]))
    }
    #[inline(never)]
    fn apart<A: Apart>(work: A) -> A::Found {
        work.run()
    }
}
