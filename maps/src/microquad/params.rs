//! What kernels are told, besides their buffers. All members are vectors of four, so that the layout is the same in Rust, SPIR-V
//! and WGSL.

use glam::{IVec3, IVec4, UVec4, Vec4};
use umbra4_core::{LatticeLight, jitter::Jitter};

use crate::{arithmetic::Arithmetic, shadow_map::MapFrame};

/// The light, the map, and the pass.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MicroquadParams {
    /// Ids; ids a row; a number that each kernel reads in its own way; and 0 ([`Arithmetic`]).
    pub(crate) pass: UVec4,
    /// Rows and columns of samples; kind of micro-occluders; directions of the table.
    pub(crate) counts: UVec4,
    /// Distances of the table, and words of 32 bits that a row takes there; the others are 0.
    pub(crate) table: UVec4,
    /// World and map.
    pub(crate) frame: MapFrame,
    /// The light around the map's centre, in steps: first column and row, end column and row.
    pub(crate) light: Vec4,
    /// Column and row of samples at the map's centre; steps per texel and inverse depth, along both.
    pub(crate) samples: Vec4,
    /// Column and row of samples at the light's middle; and 2 over the columns and rows.
    pub(crate) grid: Vec4,
    /// An occluder's inverse depth exceeds the receiver's by this factor.
    pub(crate) bias: Vec4,
    /// The light on the lattice: first sample and both steps.
    pub(crate) origin: IVec4,
    pub(crate) step_u: IVec4,
    pub(crate) step_v: IVec4,
}

/// Kinds of micro-occluders, as kernels are told.
pub(crate) const PATCHES: u32 = 0;
pub(crate) const QUADS: u32 = 1;
pub(crate) const TRIS: u32 = 2;

impl MicroquadParams {
    /// The same for a pass of `count` ids in rows of `row`; `number` is the kernel's own.
    #[must_use]
    pub fn with_pass(self, count: u32, row: u32, number: u32) -> Self {
        Self { pass: UVec4::new(count, row, number, 0), ..self }
    }

    /// Ids of the pass.
    #[inline(always)]
    pub fn count(&self) -> u32 {
        self.pass.x
    }

    /// The kernel's own number.
    #[inline(always)]
    pub fn number(&self) -> u32 {
        self.pass.z
    }

    /// The id of a thread.
    #[inline(always)]
    pub fn id(&self, thread: [u32; 3]) -> u32 {
        thread[1].wrapping_mul(self.pass.y).wrapping_add(thread[0])
    }

    /// Sums and products.
    #[inline(always)]
    pub fn arithmetic(&self) -> Arithmetic {
        Arithmetic::new(self.pass.w)
    }

    /// World and map.
    #[inline(always)]
    pub fn frame(&self) -> &MapFrame {
        &self.frame
    }

    /// Rows of samples.
    #[inline(always)]
    pub fn rows(&self) -> u32 {
        self.counts.x
    }

    /// Samples a row.
    #[inline(always)]
    pub fn columns(&self) -> u32 {
        self.counts.y
    }

    /// The light, but for its jitter: what tells who is behind it.
    #[inline(always)]
    pub fn lattice_light(&self) -> LatticeLight {
        let three = |v: IVec4| IVec3::new(v.x, v.y, v.z);
        LatticeLight {
            origin: three(self.origin),
            step_u: three(self.step_u),
            step_v: three(self.step_v),
            rows: self.counts.x,
            columns: self.counts.y,
            jitter: Jitter::NONE,
        }
    }
}
