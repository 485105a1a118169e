//! One caster, as users describe it.

use std::sync::Arc;

use rayon::prelude::*;
use thiserror::Error;
use umbra4_core::{
    Lattice, Layers, PackedCaster,
    closed::OpenEdge,
    glam::{Vec2, Vec3},
    plane_offset::MOST_OFFSET,
    stage::key_triangles::Casting,
    surface_words::SurfaceKind,
    texture::{Coordinate, TextureError, TextureSize},
    tint::{Depth, depth_of_tint},
};

use crate::{Occluders, SceneError};

/// Why a caster is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CasterError {
    /// Its texture, or its texture coordinates, are.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// It is said to be closed, and is not.
    #[error("the mesh is not closed: triangle {} has an open edge from vertex {} to {}", .0.triangle, .0.vertices[0], .0.vertices[1])]
    Open(OpenEdge),
    /// Its vertices are refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Panes have two sides, and lie where they are.
    #[error("a tinted caster has no {field}")]
    Tinted {
        /// "closed side" or "plane offset".
        field: &'static str,
    },
    /// An offset is too large.
    #[error("plane offset is {value} lattice units, more than {MOST_OFFSET}")]
    Offset {
        /// Lattice units.
        value: u32,
    },
    /// An arranged mesh has its vertices in another order than its texture coordinates.
    #[error("the mesh is arranged: texture coordinates would belong to other vertices")]
    Arranged,
}

/// What the triangles of a caster do to light, packed ([`umbra4_core::surface_words`]).
#[derive(Clone, Debug, PartialEq)]
struct Surface {
    kind: SurfaceKind,
    /// Whether it was made of tints, though all of them may be clear.
    of_panes: bool,
    texture: TextureSize,
    words: Arc<[u32]>,
}

impl Surface {
    /// Without a texture that anybody has to look up.
    fn plain(kind: SurfaceKind) -> Self {
        let words: &[u32] = if kind == SurfaceKind::Opaque { &[1] } else { &[] };
        Self { kind, of_panes: false, texture: TextureSize::ONE, words: words.into() }
    }

    /// Of a depth a texel.
    fn tinted(texture: TextureSize, mut words: Vec<u32>, depths: &[Depth]) -> Self {
        if depths.iter().all(|depth| *depth == Depth::CLEAR) {
            return Self { of_panes: true, ..Self::plain(SurfaceKind::Clear) };
        }
        words.extend(depths.iter().flat_map(|depth| depth.words()));
        Self { kind: SurfaceKind::Tinted, of_panes: true, texture, words: words.into() }
    }
}

/// A mesh that casts shadows, and how.
///
/// ```
/// use umbra4_cpu::{Caster, CpuExecutor, Occluders, Receivers};
/// use umbra4_core::{AreaLight, Bounds, Lattice, Lift, glam::{DVec3, Vec2, Vec3}};
/// use umbra4_core::texture::{TextureSize, Wrap};
///
/// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
/// let lamp = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?.snap(&lattice, Lift::NONE)?;
/// let card = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, 1.0), Vec3::new(-1.0, 1.0, 1.0)];
/// let card = Occluders::new(&lattice, &card, &[[0, 1, 2], [0, 2, 3]])?;
///
/// // One half of the card is cut away.
/// let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
/// let size = TextureSize { width: 2, height: 1, wrap: [Wrap::Clamp; 2] };
/// let leaf = Caster::cutout(card, &corners, size, &[0, 255], 128)?;
///
/// let executor = CpuExecutor::new();
/// let index = executor.index_casters(&[leaf], &lamp);
/// let receivers = Receivers::raw(&lattice, &[Vec3::new(-0.5, 0.9, 0.0), Vec3::new(0.5, 0.9, 0.0)])?;
/// let (visibility, _) = executor.caster_visibility(&index, &receivers)?;
/// assert!(visibility[0] > 0.9 && visibility[1] < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Caster {
    occluders: Occluders,
    surface: Surface,
    casting: Casting,
    /// Whether the mesh is closed by its indices, wherever its vertices are.
    closed_anywhere: bool,
    layers: Layers,
}

impl Caster {
    /// Triangles that block what they cover, from both sides.
    pub fn opaque(occluders: Occluders) -> Self {
        Self::of(occluders, Surface::plain(SurfaceKind::Opaque))
    }

    fn of(occluders: Occluders, surface: Surface) -> Self {
        let casting = Casting::default();
        Self { occluders, surface, casting, closed_anywhere: false, layers: Layers::ALL }
    }

    /// Triangles that block light where a texture is opaque: where its alpha is `threshold` or more, at the nearest texel. Which texel
    /// a light sample is seen through is decided exactly, and so is the mask.
    ///
    /// `coordinates`: a texture coordinate a vertex. `alphas`: row by row, the first at v = 0. Where all texels are opaque, or none,
    /// no texture is kept, and none looked up.
    ///
    /// # Errors
    /// A texture of no texels, or too many, or of another number; texture coordinates that are missing, not finite, or too large; a
    /// triangle that reaches over too many texels; a mesh that is arranged.
    pub fn cutout(
        occluders: Occluders,
        coordinates: &[Vec2],
        size: TextureSize,
        alphas: &[u8],
        threshold: u8,
    ) -> Result<Self, CasterError> {
        size.check(alphas.len())?;
        let mut words = textured(&occluders, coordinates, size)?;
        let opaque = alphas.iter().filter(|alpha| **alpha >= threshold).count();
        let surface = if opaque == 0 {
            Surface::plain(SurfaceKind::Clear)
        } else if opaque == alphas.len() {
            Surface::plain(SurfaceKind::Opaque)
        } else {
            let bits =
                |part: &[u8]| part.iter().rev().fold(0, |bits, alpha| bits << 1 | u32::from(*alpha >= threshold));
            words.extend(alphas.chunks(32).map(bits));
            Surface { kind: SurfaceKind::Cutout, of_panes: false, texture: size, words: words.into() }
        };
        Ok(Self::of(occluders, surface))
    }

    /// Panes of one tint, which let the fractions `tint` of red, green and blue through, each in `0.0..=1.0`. A light sample that is
    /// seen through an edge of two panes is seen through one of them.
    ///
    /// # Errors
    /// A tint that is no fraction.
    pub fn tinted(occluders: Occluders, tint: [f32; 3]) -> Result<Self, CasterError> {
        let surface = Surface::tinted(TextureSize::ONE, Vec::new(), &[depth_of_tint(0, tint)?]);
        Ok(Self::of(occluders, surface))
    }

    /// Panes that are tinted by a texture, at the nearest texel: as [`Caster::tinted`], and [`Caster::cutout`] for the rest.
    ///
    /// # Errors
    /// As those two.
    pub fn stained(
        occluders: Occluders,
        coordinates: &[Vec2],
        size: TextureSize,
        tints: &[[f32; 3]],
    ) -> Result<Self, CasterError> {
        size.check(tints.len())?;
        let words = textured(&occluders, coordinates, size)?;
        let depths = tints.iter().enumerate().map(|(index, tint)| depth_of_tint(index, *tint));
        let surface = Surface::tinted(size, words, &depths.collect::<Result<Vec<_>, _>>()?);
        Ok(Self::of(occluders, surface))
    }

    /// The same mesh as one that is closed: only triangles cast that face away from the light, told for every light sample (Sintorn,
    /// Eisemann and Assarsson 2008, section 3.3). Half the triangles, and the same masks for receivers outside of the mesh (samples
    /// that are seen exactly through an edge aside); receivers inside see out through its back. With a texture that
    /// is cut out the masks are others: light that falls in through the near side leaves by a hole in the far one.
    ///
    /// Whether the mesh is closed is found out, exactly: vertices at the same place of the lattice are one.
    /// [`Occluders::closed_parts`] tells which parts of a mesh are.
    ///
    /// # Errors
    /// An edge at which the mesh is open; a tinted caster.
    pub fn closed(mut self) -> Result<Self, CasterError> {
        if self.surface.of_panes {
            return Err(CasterError::Tinted { field: "closed side" });
        }
        check_closed(&self.occluders)?;
        self.closed_anywhere = check_closed(&self.occluders.by_indices()).is_ok();
        self.casting.closed = true;
        Ok(self)
    }

    /// Moves the triangles' planes towards the light by `units` lattice units, along the axis of their normals' largest components: what
    /// lies before a triangle, but nearer to its plane, is in its shadow ([`umbra4_core::plane_offset`]). Nothing needs it: masks are
    /// exact. Receivers on the caster itself fall into its shadow, unless it is closed.
    ///
    /// # Errors
    /// More units than [`MOST_OFFSET`]; a tinted caster.
    pub fn with_plane_offset(mut self, units: u32) -> Result<Self, CasterError> {
        if units > MOST_OFFSET {
            return Err(CasterError::Offset { value: units });
        }
        if units > 0 && self.surface.of_panes {
            return Err(CasterError::Tinted { field: "plane offset" });
        }
        self.casting.offset = units;
        Ok(self)
    }

    /// The same caster, which casts on receivers that have a layer in common with it ([`crate::Receivers::on_layers`]).
    #[must_use]
    pub fn on_layers(mut self, layers: Layers) -> Self {
        self.layers = layers;
        self
    }

    /// Moves its vertices: see [`Occluders::move_vertices`]. Indices of this caster are those of where it was until
    /// [`crate::CpuExecutor::index_caster`] has seen it again.
    ///
    /// # Errors
    /// Vertices that are refused; a closed mesh that comes apart, where its vertices were one only by their places. Nothing has moved
    /// then.
    pub fn move_vertices(&mut self, lattice: &Lattice, vertices: &[Vec3]) -> Result<(), CasterError> {
        let mut moved = self.occluders.clone();
        moved.move_vertices(lattice, vertices)?;
        if self.casting.closed && !self.closed_anywhere {
            check_closed(&moved)?;
        }
        self.occluders = moved;
        Ok(())
    }

    /// Its mesh.
    pub fn occluders(&self) -> &Occluders {
        &self.occluders
    }

    /// Its layers.
    pub fn layers(&self) -> Layers {
        self.layers
    }

    /// How its triangles cast.
    pub fn casting(&self) -> Casting {
        self.casting
    }

    /// As executors take it.
    pub fn packed(&self) -> PackedCaster<'_> {
        PackedCaster {
            vertices: self.occluders.vertices(),
            triangles: self.occluders.triangles(),
            kind: self.surface.kind,
            texture: self.surface.texture,
            surface: &self.surface.words,
            casting: self.casting,
            layers: self.layers,
        }
    }

    pub(crate) fn words(&self) -> Arc<[u32]> {
        Arc::clone(&self.surface.words)
    }
}

fn check_closed(occluders: &Occluders) -> Result<(), CasterError> {
    occluders.closed_parts().open_edge().map_or(Ok(()), |edge| Err(CasterError::Open(edge)))
}

/// How the triangles of a mesh lie in a texture; nothing where that has one texel.
fn textured(occluders: &Occluders, coordinates: &[Vec2], size: TextureSize) -> Result<Vec<u32>, CasterError> {
    if occluders.arrangement().is_some() {
        return Err(CasterError::Arranged);
    }
    let vertices = occluders.vertices().len();
    if coordinates.len() != vertices {
        return Err(TextureError::CoordinateCount { count: coordinates.len(), vertices }.into());
    }
    // Errors name the first element, whatever the number of threads: those of parallel iterators do not.
    let snapped = coordinates.iter().enumerate().map(|(index, coordinate)| Coordinate::snap(index, *coordinate));
    let snapped = snapped.collect::<Result<Vec<_>, _>>()?;
    if size.is_one() {
        return Ok(Vec::new());
    }
    let found: Vec<_> = occluders
        .triangles()
        .par_iter()
        .enumerate()
        .map(|(id, triangle)| size.triangle(id, triangle.map(|vertex| snapped[vertex as usize])))
        .collect();
    let found = found.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(found.into_iter().flatten().collect())
}
