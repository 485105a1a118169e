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
}

/// A line of the table. Stages are names: of the executors' times, too.
pub type MapKernelInfo = KernelInfo<MapKernel, &'static str, MapParamsKind, MapSlot>;

/// Stage: the map is drawn.
pub const DRAW_MAP: &str = "draw_map";
/// Stage: the map's pyramid is built.
pub const BUILD_PYRAMID: &str = "build_pyramid";

const fn read(slot: MapSlot) -> Bound<MapSlot> {
    Bound::read(slot)
}

const fn write(slot: MapSlot) -> Bound<MapSlot> {
    Bound::write(slot)
}

const fn microquads(
    kernel: MapKernel,
    name: &'static str,
    stage: &'static str,
    bound: &'static [Bound<MapSlot>],
) -> MapKernelInfo {
    KernelInfo { kernel, name, stage, params: MapParamsKind::Microquads, bound }
}

/// All kernels.
pub const TABLE: [MapKernelInfo; 3] = [
    microquads(
        MapKernel::DrawMap,
        "draw_map",
        DRAW_MAP,
        &[read(MapSlot::Vertices), read(MapSlot::Triangles), write(MapSlot::Map)],
    ),
    microquads(MapKernel::BuildTiles, "build_tiles", BUILD_PYRAMID, &[read(MapSlot::Map), write(MapSlot::Nodes)]),
    microquads(MapKernel::BuildParents, "build_parents", BUILD_PYRAMID, &[write(MapSlot::Nodes)]),
];

impl MapKernel {
    /// The kernel's line in [`TABLE`].
    pub const fn info(self) -> &'static MapKernelInfo {
        &TABLE[self as usize]
    }
}
