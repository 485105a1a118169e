//! A caster as executors take it: on the lattice, its surface packed. What makes it so is the executor of the host's, or an engine.

use glam::IVec3;

use crate::{
    layers::Layers,
    stage::key_triangles::Casting,
    surface_words::{SurfaceKind, SurfaceLayout},
    texture::TextureSize,
};

/// A caster on the lattice.
#[derive(Clone, Copy, Debug)]
pub struct PackedCaster<'a> {
    /// Lattice positions of vertices.
    pub vertices: &'a [IVec3],
    /// Vertex indices of triangles.
    pub triangles: &'a [[u32; 3]],
    /// What they do to light.
    pub kind: SurfaceKind,
    /// Size of the texture; [`TextureSize::ONE`] without one.
    pub texture: TextureSize,
    /// See [`crate::surface_words`]; as many words as [`SurfaceLayout::words`] says, of an opaque caster a one: it has no texture.
    pub surface: &'a [u32],
    /// How the triangles cast; of panes only [`Casting::default`] is taken.
    pub casting: Casting,
    /// The layers of receivers it matters to.
    pub layers: Layers,
}

impl PackedCaster<'_> {
    /// How the surface is packed.
    pub fn layout(&self) -> SurfaceLayout {
        SurfaceLayout::new(self.texture, self.triangles.len() as u32)
    }

    /// The work that it makes.
    pub fn work(&self) -> CasterWork {
        match self.kind {
            SurfaceKind::Clear => CasterWork::Nothing,
            SurfaceKind::Opaque if self.casting.offset == 0 => CasterWork::Plain,
            SurfaceKind::Opaque | SurfaceKind::Cutout => CasterWork::Cutout,
            SurfaceKind::Tinted => CasterWork::Tinted,
        }
    }
}

/// Which stage a caster is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CasterWork {
    /// None: it does nothing to light.
    Nothing,
    /// [`crate::stage::Stage::Resolve`].
    Plain,
    /// [`crate::stage::Stage::ResolveCutout`].
    Cutout,
    /// [`crate::stage::Stage::AddTint`].
    Tinted,
}
