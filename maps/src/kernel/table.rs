//! The kernels of this crate, as core's table lists its own: what shaders, executors and tests read.

use umbra4_core::kernel::{Bound, KernelInfo};

use crate::microquad::params::MicroquadParams;

/// A kernel: an entry point of the shader crate, by the name in [`TABLE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum MapKernel {
    /// [`super::microquads::draw_map`].
    DrawMap,
    /// [`super::microquads::build_tiles`].
    BuildTiles,
    /// [`super::microquads::build_parents`].
    BuildParents,
    /// [`super::microquads::gather_masks`], by exact rows, up to 32 columns.
    GatherRows32,
    /// The same, up to 64 columns.
    GatherRows64,
    /// By a table of half-spaces, up to 32 columns.
    GatherTable32,
    /// The same, up to 64 columns.
    GatherTable64,
    /// By rectangles, up to 32 columns.
    GatherRectangles32,
    /// The same, up to 64 columns.
    GatherRectangles64,
    /// [`super::microquads::gather_areas`].
    GatherAreas,
}

/// What a kernel is told: the type of its binding 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum MapParamsKind {
    /// [`MicroquadParams`]
    Microquads,
}

impl MapParamsKind {
    /// Bytes of the type.
    pub const fn size(self) -> usize {
        match self {
            Self::Microquads => size_of::<MicroquadParams>(),
        }
    }
}

/// What a kernel is bound to, by role.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum MapSlot {
    /// Lattice positions of vertices, i32 × 3.
    Vertices,
    /// Vertex indices of triangles, u32 × 3.
    Triangles,
    /// Texels of a map, as words.
    Map,
    /// [`crate::pyramid::Node`]s of all levels.
    Nodes,
    /// Lattice positions of receivers, i32 × 3.
    Receivers,
    /// [`umbra4_core::facing::Facing`]s of receivers, as words; of those beyond its end nothing is known.
    Facings,
    /// A table of half-spaces: [`crate::microquad::half_spaces`].
    HalfSpaces,
    /// Words of 32 bits, receiver-major; and one more, which says whether a thread was stopped.
    Masks,
    /// Areas that are occluded, one float a receiver; and one more word, the same.
    Areas,
}

/// A line of the table. Stages are names: of the executors' times, too.
pub type MapKernelInfo = KernelInfo<MapKernel, &'static str, MapParamsKind, MapSlot>;

/// Stage: the map is drawn.
pub const DRAW_MAP: &str = "draw_map";
/// Stage: the map's pyramid is built.
pub const BUILD_PYRAMID: &str = "build_pyramid";
/// Stage: masks, or areas, are gathered from the map.
pub const GATHER: &str = "gather";

const fn read(slot: MapSlot) -> Bound<MapSlot> {
    Bound::read(slot)
}

const fn write(slot: MapSlot) -> Bound<MapSlot> {
    Bound::write(slot)
}

const GATHER_BY_TABLE: &[Bound<MapSlot>] = &[
    read(MapSlot::Receivers),
    read(MapSlot::Facings),
    read(MapSlot::Map),
    read(MapSlot::Nodes),
    write(MapSlot::Masks),
    read(MapSlot::HalfSpaces),
];

/// The same but the table, which comes last.
const GATHER_MASKS: &[Bound<MapSlot>] = match GATHER_BY_TABLE {
    [but_table @ .., _] => but_table,
    [] => &[],
};

const GATHER_AREAS: &[Bound<MapSlot>] = &[
    read(MapSlot::Receivers),
    read(MapSlot::Facings),
    read(MapSlot::Map),
    read(MapSlot::Nodes),
    write(MapSlot::Areas),
];

const fn microquads(
    kernel: MapKernel,
    name: &'static str,
    stage: &'static str,
    bound: &'static [Bound<MapSlot>],
) -> MapKernelInfo {
    KernelInfo { kernel, name, stage, params: MapParamsKind::Microquads, bound }
}

/// All kernels.
pub const TABLE: [MapKernelInfo; 10] = [
    microquads(
        MapKernel::DrawMap,
        "draw_map",
        DRAW_MAP,
        &[read(MapSlot::Vertices), read(MapSlot::Triangles), write(MapSlot::Map)],
    ),
    microquads(MapKernel::BuildTiles, "build_tiles", BUILD_PYRAMID, &[read(MapSlot::Map), write(MapSlot::Nodes)]),
    microquads(MapKernel::BuildParents, "build_parents", BUILD_PYRAMID, &[write(MapSlot::Nodes)]),
    microquads(MapKernel::GatherRows32, "gather_rows_32", GATHER, GATHER_MASKS),
    microquads(MapKernel::GatherRows64, "gather_rows_64", GATHER, GATHER_MASKS),
    microquads(MapKernel::GatherTable32, "gather_table_32", GATHER, GATHER_BY_TABLE),
    microquads(MapKernel::GatherTable64, "gather_table_64", GATHER, GATHER_BY_TABLE),
    microquads(MapKernel::GatherRectangles32, "gather_rectangles_32", GATHER, GATHER_MASKS),
    microquads(MapKernel::GatherRectangles64, "gather_rectangles_64", GATHER, GATHER_MASKS),
    microquads(MapKernel::GatherAreas, "gather_areas", GATHER, GATHER_AREAS),
];

impl MapKernel {
    /// The kernel's line in [`TABLE`].
    pub const fn info(self) -> &'static MapKernelInfo {
        &TABLE[self as usize]
    }
}
