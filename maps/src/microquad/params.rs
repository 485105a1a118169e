//! What kernels are told, besides their buffers. All members are vectors of four, so that the layout is the same in Rust, SPIR-V
//! and WGSL.

use glam::{IVec3, IVec4, UVec4, Vec4};
use umbra4_core::{LatticeLight, jitter::Jitter, params::Dispatched};

use crate::{arithmetic::Arithmetic, shadow_map::MapFrame};

/// The light, the map, and the pass.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MicroquadParams {
    /// See [`MapPass`]: ids; ids a row; the kernel's own number; and 0 ([`Arithmetic`]).
    pub(crate) pass: UVec4,
    /// See [`MapPass`]: first element; words of a mask; first tile and number of tiles.
    pub(crate) part: UVec4,
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

/// What is different in every pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapPass {
    /// Ids there are: `0..count`. Threads beyond do nothing.
    pub count: u32,
    /// What each kernel reads in its own way.
    pub number: u32,
    /// The receiver, or triangle, that the first id stands for.
    pub first: u32,
    /// Words of 32 bits that a receiver's mask takes.
    pub stride: u32,
    /// First of the tiles of its search area that a receiver looks at, row by row.
    pub tile: u32,
    /// How many.
    pub tiles: u32,
}

impl Dispatched for MicroquadParams {
    #[inline(always)]
    fn count(&self) -> u32 {
        self.pass.x
    }

    #[inline(always)]
    fn row(&self) -> u32 {
        self.pass.y
    }

    fn with_row(mut self, row: u32) -> Self {
        self.pass.y = row;
        self
    }
}

/// Kinds of micro-occluders, as kernels are told.
pub(crate) const PATCHES: u32 = 0;
pub(crate) const QUADS: u32 = 1;
pub(crate) const TRIS: u32 = 2;

impl MicroquadParams {
    /// The same for one pass. How its ids are laid out in rows is told by [`Dispatched::with_row`].
    #[must_use]
    pub fn with_pass(self, pass: &MapPass) -> Self {
        let MapPass { count, number, first, stride, tile, tiles } = *pass;
        Self { pass: UVec4::new(count, u32::MAX, number, 0), part: UVec4::new(first, stride, tile, tiles), ..self }
    }

    /// The pass.
    #[inline(always)]
    pub fn pass(&self) -> MapPass {
        let (pass, part) = (self.pass, self.part);
        MapPass { count: pass.x, number: pass.z, first: part.x, stride: part.y, tile: part.z, tiles: part.w }
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
