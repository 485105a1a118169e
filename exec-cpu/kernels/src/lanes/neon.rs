//! [`Lanes`] on NEON: four registers a vector.

use core::arch::aarch64::*;

use umbra4_core::{
    lanes::{Apart, Lanes, TILE, Table},
    light::MAX_SAMPLES,
};

/// Sixteen f32 in four registers.
#[derive(Clone, Copy)]
pub struct Neon([float32x4_t; 4]);

/// Integers in four registers.
#[derive(Clone, Copy)]
pub struct Ints([int32x4_t; 4]);

/// All-ones and all-zeros in four registers.
#[derive(Clone, Copy)]
pub struct Mask([uint32x4_t; 4]);

// SAFETY of every block below: NEON is part of what every aarch64 target of Rust's with f32 in registers has; loads and stores
// stay within arrays of sixteen.
macro_rules! intrinsics {
    ($e:expr) => {{
        // SAFETY: see the note above.
        unsafe { $e }
    }};
}

/// Lanes of a register.
const QUARTER: usize = TILE / 4;

/// The same of each register.
macro_rules! each {
    ($k:ident => $e:expr) => {
        intrinsics!([
            { const $k: usize = 0; $e },
            { const $k: usize = 1; $e },
            { const $k: usize = 2; $e },
            { const $k: usize = 3; $e },
        ])
    };
}

/// Bit l for lane l, of every register.
#[inline(always)]
fn lane_bits() -> [uint32x4_t; 4] {
    const BITS: [u32; TILE] = {
        let mut bits = [0; TILE];
        let mut lane = 0;
        while lane < TILE {
            bits[lane] = 1 << lane;
            lane += 1;
        }
        bits
    };
    each!(K => vld1q_u32(BITS.as_ptr().add(K * QUARTER)))
}

impl Lanes for Neon {
    const WIDTH: usize = TILE;
    const ROUNDOFF: f32 = f32::EPSILON / 2.0;
    type Long = f64;
    type Ints = Ints;
    type Mask = Mask;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([intrinsics!(vdupq_n_f32(x)); 4])
    }
    #[inline(always)]
    fn splat_int(x: i32) -> Ints {
        Ints([intrinsics!(vdupq_n_s32(x)); 4])
    }
    #[inline(always)]
    fn load<const N: usize>(tile: &[f32; N], _: usize) -> Self {
        const { assert!(N == TILE) }
        Self(each!(K => vld1q_f32(tile.as_ptr().add(K * QUARTER))))
    }
    #[inline(always)]
    fn load_ints(tile: &[i32; TILE], _: usize) -> Ints {
        Ints(each!(K => vld1q_s32(tile.as_ptr().add(K * QUARTER))))
    }
    #[inline(always)]
    fn store(self, tile: &mut [f32; TILE], _: usize) {
        each!(K => vst1q_f32(tile.as_mut_ptr().add(K * QUARTER), self.0[K]));
    }
    #[inline(always)]
    fn store_ints(ints: Ints, tile: &mut [i32; TILE], _: usize) {
        each!(K => vst1q_s32(tile.as_mut_ptr().add(K * QUARTER), ints.0[K]));
    }
    #[inline(always)]
    fn count_from(first: usize) -> Self {
        const RAMP: [f32; QUARTER] = [0.0, 1.0, 2.0, 3.0];
        Self(each!(K => vaddq_f32(vdupq_n_f32((first + K * QUARTER) as f32), vld1q_f32(RAMP.as_ptr()))))
    }
    #[inline(always)]
    fn difference(a: Ints, b: Ints) -> Self {
        Self(each!(K => vcvtq_f32_s32(vsubq_s32(a.0[K], b.0[K]))))
    }
    #[inline(always)]
    fn sub_ints(a: Ints, b: Ints) -> Ints {
        Ints(each!(K => vsubq_s32(a.0[K], b.0[K])))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(each!(K => vaddq_f32(self.0[K], other.0[K])))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(each!(K => vsubq_f32(self.0[K], other.0[K])))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(each!(K => vmulq_f32(self.0[K], other.0[K])))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(each!(K => vfmaq_f32(c.0[K], self.0[K], b.0[K])))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        Self(each!(K => vdivq_f32(vdupq_n_f32(1.0), self.0[K])))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(each!(K => vabsq_f32(self.0[K])))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(each!(K => vminq_f32(self.0[K], other.0[K])))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(each!(K => vmaxq_f32(self.0[K], other.0[K])))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Mask {
        Mask(each!(K => vcgeq_f32(self.0[K], other.0[K])))
    }
    #[inline(always)]
    fn mask(bits: u32) -> Mask {
        let lanes = lane_bits();
        Mask(each!(K => vtstq_u32(vdupq_n_u32(bits), lanes[K])))
    }
    #[inline(always)]
    fn both(a: Mask, b: Mask) -> Mask {
        Mask(each!(K => vandq_u32(a.0[K], b.0[K])))
    }
    #[inline(always)]
    fn either(a: Mask, b: Mask) -> Mask {
        Mask(each!(K => vorrq_u32(a.0[K], b.0[K])))
    }
    #[inline(always)]
    fn not(a: Mask) -> Mask {
        Mask(each!(K => vmvnq_u32(a.0[K])))
    }
    #[inline(always)]
    fn select(mask: Mask, a: Self, b: Self) -> Self {
        Self(each!(K => vbslq_f32(mask.0[K], a.0[K], b.0[K])))
    }
    #[inline(always)]
    fn bits(mask: Mask) -> u32 {
        let lanes = lane_bits();
        let [a, b, c, d] = each!(K => vandq_u32(mask.0[K], lanes[K]));
        intrinsics!(vaddvq_u32(vorrq_u32(vorrq_u32(a, b), vorrq_u32(c, d))))
    }
    #[inline(always)]
    fn ceil(self) -> Ints {
        Ints(each!(K => vcvtpq_s32_f32(self.0[K])))
    }
    #[inline(always)]
    fn floor(self) -> Ints {
        Ints(each!(K => vcvtmq_s32_f32(self.0[K])))
    }
    #[inline(always)]
    fn integer_below(self, by: Self) -> u32 {
        Self::bits(by.ge(self.sub(Self(each!(K => vrndmq_f32(self.0[K]))))))
    }
    #[inline(always)]
    fn integer_above(self, by: Self) -> u32 {
        Self::bits(by.ge(Self(each!(K => vrndpq_f32(self.0[K]))).sub(self)))
    }
    #[inline(always)]
    fn lookup(table: &Table, places: Ints) -> Self {
        let (table, mut at) = (table.as_flattened(), [0; TILE]);
        Self::store_ints(places, &mut at, 0);
        Self::load(&at.map(|place| table[place as usize % MAX_SAMPLES as usize]), 0)
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        let [a, b, c, d] = self.0;
        intrinsics!(vmaxvq_f32(vmaxq_f32(vmaxq_f32(a, b), vmaxq_f32(c, d))))
    }
    #[inline(always)]
    fn less(a: Ints, b: Ints) -> u32 {
        Self::bits(Mask(each!(K => vcltq_s32(a.0[K], b.0[K]))))
    }
    #[inline(never)]
    fn apart<A: Apart>(work: A) -> A::Found {
        work.run()
    }
}
