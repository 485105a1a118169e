//! Elements that may be missing: no index of this crate panics.

/// Element `index`, or `absent` where there is none.
#[inline(always)]
pub(crate) fn fetch<T: Copy>(from: &[T], index: usize, absent: T) -> T {
    if index < from.len() { from[index] } else { absent }
}

/// Writes element `index`, if there is one.
#[inline(always)]
pub(crate) fn store<T: Copy>(to: &mut [T], index: usize, value: T) {
    if index < to.len() {
        to[index] = value;
    }
}
