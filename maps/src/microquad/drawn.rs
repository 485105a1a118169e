//! A map that was drawn, with what goes with it.

use crate::{microquad::params::MicroquadParams, pyramid::Node};

/// A light's shadow map, with what is made of it: its pyramid, and the table of half-spaces where one is used. Whoever draws it brings the
/// memory.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnMap<W, N> {
    params: MicroquadParams,
    texels: W,
    nodes: N,
    table: W,
    beyond: u64,
}

impl<W: AsRef<[u32]>, N: AsRef<[Node]>> DrawnMap<W, N> {
    /// As kernels make it, for the parameters that they were told. `beyond`: see [`DrawnMap::receivers_beyond`].
    pub const fn new(params: MicroquadParams, texels: W, nodes: N, table: W, beyond: u64) -> Self {
        Self { params, texels, nodes, table, beyond }
    }

    /// Texels along each edge.
    pub fn size(&self) -> u32 {
        self.params.frame().size()
    }

    /// Inverse depths, row by row, in units of the inverse near distance: 1 at the near distance, 0 where nothing was drawn.
    pub fn inverse_depths(&self) -> impl Iterator<Item = f32> {
        self.texels.as_ref().iter().map(|word| f32::from_bits(*word))
    }

    /// Receivers before the light that lie beyond [`crate::microquad::MapOptions::widest`]: the map does not show what stands before
    /// them.
    pub fn receivers_beyond(&self) -> u64 {
        self.beyond
    }

    /// What kernels are told.
    pub fn params(&self) -> &MicroquadParams {
        &self.params
    }

    /// The texels' words, the pyramid, and the table: what kernels read.
    pub fn buffers(&self) -> (&[u32], &[Node], &[u32]) {
        (self.texels.as_ref(), self.nodes.as_ref(), self.table.as_ref())
    }
}
