//! What kernels could not use, counted: an engine reads it when it likes. The frame goes on without those elements.

/// Counts of refused elements, since the frame began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Status {
    /// Vertices whose position is NaN, infinite or outside the lattice. Their triangles block nothing.
    pub vertices: u32,
    /// Triangles that name a vertex which does not exist. They block nothing.
    pub triangles: u32,
    /// Pixels whose position or normal is NaN, infinite, zero or outside the lattice. No light falls on them.
    pub receivers: u32,
    /// 1 where the driver has stopped threads that ran for long, so that masks may lack bits; else 0. Software drivers do so.
    pub stopped: u32,
}
