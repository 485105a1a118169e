//! The stages of the pipeline, one file each: pure functions of an id, parameters and typed slices.
//!
//! Data flows one way: lattice → keys → order → hierarchy → masks → visibility. [`TABLE`] lists every stage with what it
//! reads and writes; executors and tests read that table, so none of it is written twice.

pub mod add_tint;
pub mod build_level;
mod cover;
mod kept_pairs;
pub mod key_receivers;
pub mod key_triangles;
pub mod reduce;
pub mod resolve;
#[cfg(not(target_arch = "spirv"))]
pub mod resolve_cells;
#[cfg(not(target_arch = "spirv"))]
pub mod resolve_cloud;
pub mod resolve_cutout;
pub mod resolve_punctual;
#[cfg(not(target_arch = "spirv"))]
pub mod resolve_silhouette;
pub mod snap_receivers;
pub mod snap_vertices;

/// A stage. Executors run it for the ids `0..count` of a [`crate::plan::Pass`], in any order and in parallel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Stage {
    /// World → lattice, vertices.
    SnapVertices,
    /// World → lattice, receivers, with their self-shadow lift.
    SnapReceivers,
    /// Keys and orientation of every triangle; those that block nothing drop out.
    KeyTriangles,
    /// Triangles along the curve of [`crate::order`].
    OrderTriangles,
    /// One level of the hierarchy from the one below.
    BuildLevel,
    /// Edges at which the triangles end that face the light ([`crate::silhouette`]), and their hierarchy; that of the
    /// triangles before the light's first sample.
    FindSilhouette,
    /// Keys of every receiver; those behind the light are settled.
    KeyReceivers,
    /// Receivers that face away from the light ([`crate::facing`]): their masks are full.
    SettleReceivers,
    /// Receivers along the curve of [`crate::order`], in groups of sixteen.
    OrderReceivers,
    /// Receivers that a caster matters to, by their layers ([`crate::layers`]).
    SelectReceivers,
    /// Masks of a group of receivers.
    Resolve,
    /// What alpha-tested casters add to them, and casters with an offset.
    ResolveCutout,
    /// What tinted casters put before the light samples of a group of receivers.
    AddTint,
    /// Which receivers of a group a light without extent does not reach.
    ResolvePunctual,
    /// Which samples of a cloud a group of receivers does not see.
    ResolveCloud,
    /// Plane and extent of the frame buffer of [`crate::grid`].
    DefineFrame,
    /// Receivers into the cells of the frame buffer.
    BinReceivers,
    /// Triangles into the cells of the frame buffer.
    BinTriangles,
    /// Masks of the receivers of a cell.
    ResolveCells,
    /// Mask → lit count → visibility.
    Reduce,
    /// Mask → irradiance ([`crate::irradiance`]).
    Illuminate,
}

/// A buffer that stages share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Binding {
    /// World positions of vertices, f32 × 3.
    WorldVertices,
    /// Lattice positions of vertices, i32 × 3.
    Vertices,
    /// World positions of receivers, f32 × 3.
    WorldReceivers,
    /// Normals of the receivers' surfaces, f32 × 3.
    Normals,
    /// Lattice positions of receivers, i32 × 3.
    Receivers,
    /// Vertex indices of triangles, u32 × 3.
    Triangles,
    /// Keys and code of every triangle.
    TriangleKeys,
    /// [`crate::occluder::Occluder`]s, in order.
    Occluders,
    /// [`crate::proj4::KeyTile`]s of all levels.
    Nodes,
    /// What [`resolve_silhouette::SilhouetteScene`] holds.
    Silhouette,
    /// [`crate::facing::Facing`]s of all receivers.
    Facings,
    /// Keys and code of every receiver.
    ReceiverKeys,
    /// Receivers in order.
    Groups,
    /// [`crate::layers::Layers`] of all receivers.
    Layers,
    /// For every caster, the receivers it matters to.
    Selected,
    /// [`crate::texture::TexturedTriangle`]s of a caster.
    TexturedTriangles,
    /// Texels of a caster: a bit each, or a [`crate::tint::Depth`].
    Texels,
    /// [`crate::tint::Depth`]s of all samples of receivers.
    Depths,
    /// The [`crate::grid::FrameBuffer`].
    FrameBuffer,
    /// Receivers cell by cell.
    ReceiverCells,
    /// Triangles cell by cell.
    TriangleCells,
    /// Mask words, receiver-major.
    Masks,
    /// Lit samples of every receiver.
    LitCounts,
    /// Lit count → visibility.
    VisibilityTable,
    /// Fraction of lit samples, f32.
    Visibility,
    /// Places and weights of the light's samples.
    Emitters,
    /// Irradiance of receivers, f32 × 3.
    Irradiance,
}

/// One line of the stage table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageInfo {
    /// The stage.
    pub stage: Stage,
    /// Its name: of the file, of the kernel, in tables.
    pub name: &'static str,
    /// What one id stands for.
    pub id: &'static str,
    /// Buffers it reads.
    pub reads: &'static [Binding],
    /// Buffers it writes.
    pub writes: &'static [Binding],
    /// Ids a workgroup (on a CPU: the least number of ids worth a job).
    pub workgroup: u32,
}

use Binding as B;

/// All stages, in the order in which data flows.
pub const TABLE: [StageInfo; 21] = [
    StageInfo {
        stage: Stage::SnapVertices,
        name: "snap_vertices",
        id: "vertex",
        reads: &[B::WorldVertices],
        writes: &[B::Vertices],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::SnapReceivers,
        name: "snap_receivers",
        id: "receiver",
        reads: &[B::WorldReceivers, B::Normals],
        writes: &[B::Receivers],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::KeyTriangles,
        name: "key_triangles",
        id: "triangle",
        reads: &[B::Vertices, B::Triangles],
        writes: &[B::TriangleKeys],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::OrderTriangles,
        name: "order_triangles",
        id: "triangle",
        reads: &[B::Vertices, B::Triangles, B::TriangleKeys],
        writes: &[B::Occluders, B::Nodes],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::BuildLevel,
        name: "build_level",
        id: "node",
        reads: &[B::Nodes],
        writes: &[B::Nodes],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::FindSilhouette,
        name: "find_silhouette",
        id: "triangle",
        reads: &[B::Vertices, B::Triangles, B::TriangleKeys],
        writes: &[B::Silhouette],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::KeyReceivers,
        name: "key_receivers",
        id: "receiver",
        reads: &[B::Receivers],
        writes: &[B::ReceiverKeys],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::SettleReceivers,
        name: "settle_receivers",
        id: "receiver",
        reads: &[B::Receivers, B::Facings],
        writes: &[B::ReceiverKeys],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::OrderReceivers,
        name: "order_receivers",
        id: "receiver",
        reads: &[B::ReceiverKeys],
        writes: &[B::Groups],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::SelectReceivers,
        name: "select_receivers",
        id: "receiver",
        reads: &[B::Groups, B::Layers],
        writes: &[B::Selected],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::Resolve,
        name: "resolve",
        id: "group of sixteen receivers",
        reads: &[B::Receivers, B::Groups, B::Occluders, B::Nodes, B::Silhouette],
        writes: &[B::Masks],
        workgroup: 16,
    },
    StageInfo {
        stage: Stage::ResolveCutout,
        name: "resolve_cutout",
        id: "group of sixteen receivers",
        reads: &[B::Receivers, B::Groups, B::Occluders, B::Nodes, B::TexturedTriangles, B::Texels],
        writes: &[B::Masks],
        workgroup: 16,
    },
    StageInfo {
        stage: Stage::AddTint,
        name: "add_tint",
        id: "group of sixteen receivers",
        reads: &[B::Receivers, B::Groups, B::Masks, B::Occluders, B::Nodes, B::TexturedTriangles, B::Texels],
        writes: &[B::Depths],
        workgroup: 16,
    },
    StageInfo {
        stage: Stage::ResolvePunctual,
        name: "resolve_punctual",
        id: "group of sixteen receivers",
        reads: &[B::Receivers, B::Groups, B::Occluders, B::Nodes],
        writes: &[B::Masks],
        workgroup: 16,
    },
    StageInfo {
        stage: Stage::ResolveCloud,
        name: "resolve_cloud",
        id: "group of sixteen receivers",
        reads: &[B::Receivers, B::Groups, B::Occluders, B::Nodes],
        writes: &[B::Masks],
        workgroup: 16,
    },
    StageInfo {
        stage: Stage::DefineFrame,
        name: "define_frame",
        id: "receiver",
        reads: &[B::ReceiverKeys],
        writes: &[B::FrameBuffer],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::BinReceivers,
        name: "bin_receivers",
        id: "receiver",
        reads: &[B::ReceiverKeys, B::FrameBuffer],
        writes: &[B::ReceiverCells],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::BinTriangles,
        name: "bin_triangles",
        id: "triangle",
        reads: &[B::TriangleKeys, B::FrameBuffer],
        writes: &[B::TriangleCells],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::ResolveCells,
        name: "resolve_cells",
        id: "receiver",
        reads: &[B::Receivers, B::ReceiverCells, B::TriangleKeys, B::TriangleCells],
        writes: &[B::Masks],
        workgroup: 16,
    },
    StageInfo {
        stage: Stage::Reduce,
        name: "reduce",
        id: "receiver",
        reads: &[B::Masks, B::VisibilityTable],
        writes: &[B::LitCounts, B::Visibility],
        workgroup: 64,
    },
    StageInfo {
        stage: Stage::Illuminate,
        name: "illuminate",
        id: "receiver",
        reads: &[B::Masks, B::Receivers, B::Normals, B::Emitters],
        writes: &[B::Irradiance],
        workgroup: 64,
    },
];

impl Stage {
    /// The stage's line in [`TABLE`].
    pub const fn info(self) -> &'static StageInfo {
        &TABLE[self as usize]
    }
}
