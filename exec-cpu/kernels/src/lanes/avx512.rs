//! [`Lanes`] on AVX-512: one register a vector.

use core::arch::x86_64::*;

use umbra4_core::lanes::{Apart, Lanes, TILE, Table};

/// Sixteen f32 in one register. Only kernels compiled for AVX-512 use it, and those run only where it was detected.
#[derive(Clone, Copy)]
pub struct Avx512(__m512);

// SAFETY of every block below: the intrinsics need AVX-512 F and DQ, which `Isa::available` has found before any kernel that uses
// this type is called; loads and stores are unaligned and stay within arrays of sixteen.
macro_rules! intrinsics {
    ($e:expr) => {{
        // SAFETY: see the note above.
        unsafe { $e }
    }};
}

impl Lanes for Avx512 {
    const WIDTH: usize = TILE;
    const ROUNDOFF: f32 = f32::EPSILON / 2.0;
    type Long = f64;
    type Ints = __m512i;
    type Mask = __mmask16;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        intrinsics!(Self(_mm512_set1_ps(x)))
    }
    #[inline(always)]
    fn splat_int(x: i32) -> __m512i {
        intrinsics!(_mm512_set1_epi32(x))
    }
    #[inline(always)]
    fn load<const N: usize>(tile: &[f32; N], _: usize) -> Self {
        const { assert!(N == TILE) }
        intrinsics!(Self(_mm512_loadu_ps(tile.as_ptr())))
    }
    #[inline(always)]
    fn load_ints(tile: &[i32; TILE], _: usize) -> __m512i {
        intrinsics!(_mm512_loadu_epi32(tile.as_ptr()))
    }
    #[inline(always)]
    fn store(self, tile: &mut [f32; TILE], _: usize) {
        intrinsics!(_mm512_storeu_ps(tile.as_mut_ptr(), self.0))
    }
    #[inline(always)]
    fn store_ints(ints: __m512i, tile: &mut [i32; TILE], _: usize) {
        intrinsics!(_mm512_storeu_epi32(tile.as_mut_ptr(), ints))
    }
    #[inline(always)]
    fn count_from(first: usize) -> Self {
        intrinsics!({
            let ramp =
                _mm512_setr_ps(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0);
            Self(_mm512_add_ps(_mm512_set1_ps(first as f32), ramp))
        })
    }
    #[inline(always)]
    fn difference(a: __m512i, b: __m512i) -> Self {
        intrinsics!(Self(_mm512_cvtepi32_ps(_mm512_sub_epi32(a, b))))
    }
    #[inline(always)]
    fn sub_ints(a: __m512i, b: __m512i) -> __m512i {
        intrinsics!(_mm512_sub_epi32(a, b))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        intrinsics!(Self(_mm512_add_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        intrinsics!(Self(_mm512_sub_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        intrinsics!(Self(_mm512_mul_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        intrinsics!(Self(_mm512_fmadd_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        // An estimate to 2^-14 and one step of Newton's: 2^-28, and two roundings.
        intrinsics!({
            let estimate = _mm512_rcp14_ps(self.0);
            let rest = _mm512_fnmadd_ps(self.0, estimate, _mm512_set1_ps(1.0));
            Self(_mm512_fmadd_ps(estimate, rest, estimate))
        })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        intrinsics!(Self(_mm512_abs_ps(self.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        intrinsics!(Self(_mm512_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        intrinsics!(Self(_mm512_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> __mmask16 {
        intrinsics!(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(self.0, other.0))
    }
    #[inline(always)]
    fn either(a: __mmask16, b: __mmask16) -> __mmask16 {
        a | b
    }
    #[inline(always)]
    fn not(a: __mmask16) -> __mmask16 {
        !a
    }
    #[inline(always)]
    fn mask(bits: u32) -> __mmask16 {
        bits as __mmask16
    }
    #[inline(always)]
    fn both(a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }
    #[inline(always)]
    fn select(mask: __mmask16, a: Self, b: Self) -> Self {
        intrinsics!(Self(_mm512_mask_blend_ps(mask, b.0, a.0)))
    }
    #[inline(always)]
    fn bits(mask: __mmask16) -> u32 {
        u32::from(mask)
    }
    #[inline(always)]
    fn ceil(self) -> __m512i {
        intrinsics!(_mm512_cvt_roundps_epi32::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(self.0))
    }
    #[inline(always)]
    fn floor(self) -> __m512i {
        intrinsics!(_mm512_cvt_roundps_epi32::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0))
    }
    #[inline(always)]
    fn integer_below(self, by: Self) -> u32 {
        intrinsics!({
            let rest = _mm512_reduce_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0);
            u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(rest, by.0))
        })
    }
    #[inline(always)]
    fn integer_above(self, by: Self) -> u32 {
        intrinsics!({
            let rest = _mm512_reduce_ps::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(self.0);
            u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(_mm512_sub_ps(_mm512_setzero_ps(), by.0), rest))
        })
    }
    #[inline(always)]
    fn integer_beside(below: Self, above: Self, by: Self) -> u32 {
        intrinsics!({
            let rest = _mm512_reduce_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(below.0);
            let missing = _mm512_reduce_ps::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(above.0);
            // The smaller magnitude, without its sign.
            let nearer = _mm512_range_ps::<0b1010>(rest, missing);
            u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(nearer, by.0))
        })
    }
    #[inline(always)]
    fn lookup(table: &Table, places: __m512i) -> Self {
        let [a, b, c, d] = table;
        intrinsics!({
            let low = _mm512_permutex2var_ps(_mm512_loadu_ps(a.as_ptr()), places, _mm512_loadu_ps(b.as_ptr()));
            let high = _mm512_permutex2var_ps(_mm512_loadu_ps(c.as_ptr()), places, _mm512_loadu_ps(d.as_ptr()));
            let upper = _mm512_test_epi32_mask(places, _mm512_set1_epi32(2 * TILE as i32));
            Self(_mm512_mask_blend_ps(upper, low, high))
        })
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        intrinsics!(_mm512_reduce_max_ps(self.0))
    }
    #[inline(always)]
    fn less(a: __m512i, b: __m512i) -> u32 {
        intrinsics!(u32::from(_mm512_cmplt_epi32_mask(a, b)))
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
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
fn apart<A: Apart>(work: A) -> A::Found {
    work.run()
}
