//! Comparisons of floats in plain words: rust-gpu has no instructions for those of the standard library.

/// The larger of two numbers; where one is none, `b`.
#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers; where one is none, `b`.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The number in `low..=high` that is nearest to `x`; `low` where that is none.
#[inline(always)]
pub(crate) fn within(x: f32, low: f32, high: f32) -> f32 {
    smaller(larger(x, low), high)
}
