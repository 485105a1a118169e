//! Writes to places of one slice from many threads, each place by one of them.

use std::{marker::PhantomData, slice};

/// A slice whose disjoint parts are written in parallel, in an order that only the jobs know.
pub(crate) struct Scatter<'a, T> {
    start: *mut T,
    length: usize,
    slice: PhantomData<&'a mut [T]>,
}

// SAFETY: parts are handed out by `part`, whose caller promises that no two overlap; T may move between threads.
unsafe impl<T: Send> Sync for Scatter<'_, T> {}

impl<'a, T> Scatter<'a, T> {
    pub(crate) fn new(slice: &'a mut [T]) -> Self {
        Self { start: slice.as_mut_ptr(), length: slice.len(), slice: PhantomData }
    }

    /// Elements `first..first + count`.
    ///
    /// # Safety
    /// No two calls on one `Scatter` may overlap.
    #[allow(clippy::mut_from_ref, reason = "the caller promises disjoint parts")]
    pub(crate) unsafe fn part(&self, first: usize, count: usize) -> &mut [T] {
        assert!(first.checked_add(count).is_some_and(|end| end <= self.length), "a part lies inside its slice");
        // SAFETY: in bounds by the check above, exclusive by the caller's promise, alive as long as the borrow.
        unsafe { slice::from_raw_parts_mut(self.start.add(first), count) }
    }
}
