//! Squares of texels.

/// Column and row of texel `id` of a square that is `size` texels wide; 0 is taken for 1.
#[inline(always)]
pub(crate) fn column_and_row(id: usize, size: u32) -> (i32, i32) {
    let size = if size > 0 { size } else { 1 };
    ((id as u32 % size) as i32, (id as u32 / size) as i32)
}
