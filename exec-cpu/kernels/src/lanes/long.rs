//! Dot products in f64, four at once: what both AVX kernels place corners with.

use core::arch::x86_64::*;

// SAFETY of every block below: the intrinsics need AVX2 and FMA, which `Isa::available` has found before any kernel that
// calls this is run; loads and stores are unaligned and stay within arrays of four.
macro_rules! intrinsics {
    ($e:expr) => {{
        // SAFETY: see the note above.
        unsafe { $e }
    }};
}

/// As [`umbra4_core::Lanes::dots`].
#[inline(always)]
pub(super) fn dots(axes: &[[f64; 3]; 3], d: &[[i32; 4]; 3]) -> [[f32; 4]; 3] {
    let (x, y, z) = (widen(&d[0]), widen(&d[1]), widen(&d[2]));
    [dot(&axes[0], x, y, z), dot(&axes[1], x, y, z), dot(&axes[2], x, y, z)]
}

#[inline(always)]
fn widen(d: &[i32; 4]) -> __m256d {
    intrinsics!(_mm256_cvtepi32_pd(_mm_loadu_si128(d.as_ptr().cast())))
}

#[inline(always)]
fn dot(axis: &[f64; 3], x: __m256d, y: __m256d, z: __m256d) -> [f32; 4] {
    let mut out = [0.0; 4];
    intrinsics!({
        let xy = _mm256_fmadd_pd(_mm256_set1_pd(axis[1]), y, _mm256_mul_pd(_mm256_set1_pd(axis[0]), x));
        let sum = _mm256_fmadd_pd(_mm256_set1_pd(axis[2]), z, xy);
        _mm_storeu_ps(out.as_mut_ptr(), _mm256_cvtpd_ps(sum));
    });
    out
}
