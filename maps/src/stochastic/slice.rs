//! Elements that may be missing: no index of this crate panics.

/// Element `index`, or `absent` where there is none.
#[inline(always)]
pub(crate) fn fetch<T: Copy>(from: &[T], index: usize, absent: T) -> T {
    if index < from.len() { from[index] } else { absent }
}
