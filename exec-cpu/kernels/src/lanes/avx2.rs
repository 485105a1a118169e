//! [`Lanes`] on AVX2: two registers a vector.

use core::arch::x86_64::*;

use umbra4_core::{
    lanes::{Apart, Lanes, TILE, Table},
    light::MAX_SAMPLES,
};

/// Sixteen f32 in two registers. Only kernels compiled for AVX2 and FMA use it, and those run only where it was detected.
#[derive(Clone, Copy)]
pub struct Avx2(__m256, __m256);

/// Integers, or a mask of all-ones and all-zeros, in two registers.
#[derive(Clone, Copy)]
pub struct Pair(__m256i, __m256i);

// SAFETY of every block below: the intrinsics need AVX2 and FMA, which `Isa::available` has found before any kernel that uses this
// type is called; loads and stores are unaligned and stay within arrays of sixteen;
// gathers mask their indices to the table's length.
macro_rules! intrinsics {
    ($e:expr) => {{
        // SAFETY: see the note above.
        unsafe { $e }
    }};
}

const HALF: usize = TILE / 2;

impl Lanes for Avx2 {
    const WIDTH: usize = TILE;
    const ROUNDOFF: f32 = f32::EPSILON / 2.0;
    type Long = f64;
    type Ints = Pair;
    type Mask = Pair;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        intrinsics!(Self(_mm256_set1_ps(x), _mm256_set1_ps(x)))
    }
    #[inline(always)]
    fn splat_int(x: i32) -> Pair {
        intrinsics!(Pair(_mm256_set1_epi32(x), _mm256_set1_epi32(x)))
    }
    #[inline(always)]
    fn load<const N: usize>(tile: &[f32; N], _: usize) -> Self {
        const { assert!(N == TILE) }
        intrinsics!(Self(_mm256_loadu_ps(tile.as_ptr()), _mm256_loadu_ps(tile.as_ptr().add(HALF))))
    }
    #[inline(always)]
    fn load_ints(tile: &[i32; TILE], _: usize) -> Pair {
        intrinsics!(Pair(_mm256_loadu_si256(tile.as_ptr().cast()), _mm256_loadu_si256(tile.as_ptr().add(HALF).cast())))
    }
    #[inline(always)]
    fn store(self, tile: &mut [f32; TILE], _: usize) {
        intrinsics!({
            _mm256_storeu_ps(tile.as_mut_ptr(), self.0);
            _mm256_storeu_ps(tile.as_mut_ptr().add(HALF), self.1);
        })
    }
    #[inline(always)]
    fn store_ints(ints: Pair, tile: &mut [i32; TILE], _: usize) {
        intrinsics!({
            _mm256_storeu_si256(tile.as_mut_ptr().cast(), ints.0);
            _mm256_storeu_si256(tile.as_mut_ptr().add(HALF).cast(), ints.1);
        })
    }
    #[inline(always)]
    fn count_from(first: usize) -> Self {
        intrinsics!({
            let ramp = _mm256_setr_ps(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0);
            Self(
                _mm256_add_ps(_mm256_set1_ps(first as f32), ramp),
                _mm256_add_ps(_mm256_set1_ps((first + HALF) as f32), ramp),
            )
        })
    }
    #[inline(always)]
    fn difference(a: Pair, b: Pair) -> Self {
        intrinsics!(Self(
            _mm256_cvtepi32_ps(_mm256_sub_epi32(a.0, b.0)),
            _mm256_cvtepi32_ps(_mm256_sub_epi32(a.1, b.1))
        ))
    }
    #[inline(always)]
    fn sub_ints(a: Pair, b: Pair) -> Pair {
        intrinsics!(Pair(_mm256_sub_epi32(a.0, b.0), _mm256_sub_epi32(a.1, b.1)))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        intrinsics!(Self(_mm256_add_ps(self.0, other.0), _mm256_add_ps(self.1, other.1)))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        intrinsics!(Self(_mm256_sub_ps(self.0, other.0), _mm256_sub_ps(self.1, other.1)))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        intrinsics!(Self(_mm256_mul_ps(self.0, other.0), _mm256_mul_ps(self.1, other.1)))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        intrinsics!(Self(_mm256_fmadd_ps(self.0, b.0, c.0), _mm256_fmadd_ps(self.1, b.1, c.1)))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        intrinsics!({
            let one = _mm256_set1_ps(1.0);
            Self(_mm256_div_ps(one, self.0), _mm256_div_ps(one, self.1))
        })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        intrinsics!({
            let sign = _mm256_set1_ps(-0.0);
            Self(_mm256_andnot_ps(sign, self.0), _mm256_andnot_ps(sign, self.1))
        })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        intrinsics!(Self(_mm256_min_ps(self.0, other.0), _mm256_min_ps(self.1, other.1)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        intrinsics!(Self(_mm256_max_ps(self.0, other.0), _mm256_max_ps(self.1, other.1)))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Pair {
        intrinsics!(Pair(
            _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GE_OQ>(self.0, other.0)),
            _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GE_OQ>(self.1, other.1))
        ))
    }
    #[inline(always)]
    fn either(a: Pair, b: Pair) -> Pair {
        intrinsics!(Pair(_mm256_or_si256(a.0, b.0), _mm256_or_si256(a.1, b.1)))
    }
    #[inline(always)]
    fn not(a: Pair) -> Pair {
        intrinsics!({
            let all = _mm256_set1_epi32(-1);
            Pair(_mm256_xor_si256(a.0, all), _mm256_xor_si256(a.1, all))
        })
    }
    #[inline(always)]
    fn mask(bits: u32) -> Pair {
        intrinsics!({
            let all = _mm256_set1_epi32(bits as i32);
            let low = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let high = _mm256_slli_epi32::<8>(low);
            Pair(
                _mm256_cmpeq_epi32(_mm256_and_si256(all, low), low),
                _mm256_cmpeq_epi32(_mm256_and_si256(all, high), high),
            )
        })
    }
    #[inline(always)]
    fn both(a: Pair, b: Pair) -> Pair {
        intrinsics!(Pair(_mm256_and_si256(a.0, b.0), _mm256_and_si256(a.1, b.1)))
    }
    #[inline(always)]
    fn select(mask: Pair, a: Self, b: Self) -> Self {
        intrinsics!(Self(
            _mm256_blendv_ps(b.0, a.0, _mm256_castsi256_ps(mask.0)),
            _mm256_blendv_ps(b.1, a.1, _mm256_castsi256_ps(mask.1))
        ))
    }
    #[inline(always)]
    fn bits(mask: Pair) -> u32 {
        intrinsics!({
            let low = _mm256_movemask_ps(_mm256_castsi256_ps(mask.0)) as u32;
            let high = _mm256_movemask_ps(_mm256_castsi256_ps(mask.1)) as u32;
            low | high << HALF
        })
    }
    #[inline(always)]
    fn ceil(self) -> Pair {
        intrinsics!(Pair(_mm256_cvtps_epi32(_mm256_ceil_ps(self.0)), _mm256_cvtps_epi32(_mm256_ceil_ps(self.1))))
    }
    #[inline(always)]
    fn floor(self) -> Pair {
        intrinsics!(Pair(_mm256_cvtps_epi32(_mm256_floor_ps(self.0)), _mm256_cvtps_epi32(_mm256_floor_ps(self.1))))
    }
    #[inline(always)]
    fn integer_below(self, by: Self) -> u32 {
        let floor = intrinsics!(Self(_mm256_floor_ps(self.0), _mm256_floor_ps(self.1)));
        Self::bits(by.ge(self.sub(floor)))
    }
    #[inline(always)]
    fn integer_above(self, by: Self) -> u32 {
        let ceil = intrinsics!(Self(_mm256_ceil_ps(self.0), _mm256_ceil_ps(self.1)));
        Self::bits(by.ge(ceil.sub(self)))
    }
    #[inline(always)]
    fn lookup(table: &Table, places: Pair) -> Self {
        let table = table.as_flattened();
        intrinsics!({
            let last = _mm256_set1_epi32(MAX_SAMPLES as i32 - 1);
            Self(
                _mm256_i32gather_ps::<4>(table.as_ptr(), _mm256_and_si256(places.0, last)),
                _mm256_i32gather_ps::<4>(table.as_ptr(), _mm256_and_si256(places.1, last)),
            )
        })
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        intrinsics!({
            let eight = _mm256_max_ps(self.0, self.1);
            let four = _mm_max_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight));
            let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_max_ss(two, _mm_movehdup_ps(two)))
        })
    }
    #[inline(always)]
    fn less(a: Pair, b: Pair) -> u32 {
        Self::bits(intrinsics!(Pair(_mm256_cmpgt_epi32(b.0, a.0), _mm256_cmpgt_epi32(b.1, a.1))))
    }
    #[inline(always)]
    fn apart<A: Apart>(work: A) -> A::Found {
        // SAFETY: whoever has these lanes was called for a processor that was found to have the instruction set.
        unsafe { apart(work) }
    }
    #[inline(always)]
    fn dots(axes: &[[f64; 3]; 3], d: &[[i32; 4]; 3]) -> [[f32; 4]; 3] {
        super::long::dots(axes, d)
    }
}

/// As [`Lanes::apart`].
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
fn apart<A: Apart>(work: A) -> A::Found {
    work.run()
}
