//! The kernels of this crate, as core's table lists its own: what shaders, executors and tests read.

use umbra4_core::kernel::{Bound, KernelInfo};

use crate::{
    kernel::stochastic::{BOUND_TRIANGLES, FILTER_LEVELS, FIND_RADII, LOOK_UP, REPROJECT, SAMPLE_LIGHT_FIELD},
    microquad::params::MicroquadParams,
    stochastic::params::LensParams,
};

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
    /// [`super::stochastic::light_field::place_triangles`].
    PlaceTriangles,
    /// [`super::stochastic::light_field::bound_triangles`].
    BoundTriangles,
    /// [`super::stochastic::light_field::bound_nodes`].
    BoundNodes,
    /// [`super::stochastic::light_field::sample_light_field`].
    SampleLightField,
    /// [`super::stochastic::tiles::mark_looked_at`].
    MarkLookedAt,
    /// [`super::stochastic::tiles::mark_active`].
    MarkActive,
    /// [`super::stochastic::tiles::mark_data`].
    MarkData,
    /// [`super::stochastic::tiles::mark_merged`].
    MarkMerged,
    /// [`super::stochastic::samples::clear_lists`].
    ClearLists,
    /// [`super::stochastic::samples::link_samples`].
    LinkSamples,
    /// [`super::stochastic::samples::merge_samples`].
    MergeSamples,
    /// [`super::stochastic::radii::find_closest`].
    FindClosest,
    /// [`super::stochastic::radii::raise_radii`].
    RaiseRadii,
    /// [`super::stochastic::radii::lend_radii`].
    LendRadii,
    /// [`super::stochastic::levels::coarsen_samples`].
    CoarsenSamples,
    /// [`super::stochastic::levels::find_widest`].
    FindWidest,
    /// [`super::stochastic::levels::gather_samples`].
    GatherSamples,
    /// [`super::stochastic::levels::resolve_level`].
    ResolveLevel,
    /// [`super::stochastic::receivers::look_up`].
    LookUp,
    /// [`super::stochastic::receivers::find_visibility`].
    FindVisibility,
}

/// What a kernel is told: the type of its binding 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum MapParamsKind {
    /// [`MicroquadParams`]
    Microquads,
    /// [`LensParams`]
    Stochastic,
}

impl MapParamsKind {
    /// Bytes of the type.
    pub const fn size(self) -> usize {
        match self {
            Self::Microquads => size_of::<MicroquadParams>(),
            Self::Stochastic => size_of::<LensParams>(),
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
    /// Triangles, in the order in which they are taken, u32.
    Order,
    /// Their [`Corners`](crate::stochastic::trace::Corners).
    Corners,
    /// [`crate::stochastic::trace::Node`]s of all levels.
    Bounds,
    /// The depth of every texel's nearest hit, f32.
    Depths,
    /// What is needed of every tile: bits of a word.
    Tiles,
    /// Of every texel of a plane, the first sample that has landed there.
    Heads,
    /// Of every sample, the next one in the same texel.
    Next,
    /// [`crate::stochastic::elementary::Elementary`] occluders, of all levels.
    Samples,
    /// Radii of closest occluders, f32.
    Found,
    /// Radii that texels are filtered with, f32.
    Raised,
    /// The widest radius in every tile, f32.
    Widest,
    /// What every texel has gathered, of all levels: [`crate::stochastic::gather::Gathered`].
    Gathered,
    /// The same, levels put together.
    Resolved,
    /// The same, of receivers, over planes.
    Sums,
    /// The fraction of the light that receivers see, f32.
    Visibility,
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

const fn stochastic(
    kernel: MapKernel,
    name: &'static str,
    stage: &'static str,
    bound: &'static [Bound<MapSlot>],
) -> MapKernelInfo {
    KernelInfo { kernel, name, stage, params: MapParamsKind::Stochastic, bound }
}

/// All kernels.
pub const TABLE: [MapKernelInfo; 30] = [
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
    stochastic(
        MapKernel::PlaceTriangles,
        "place_triangles",
        BOUND_TRIANGLES,
        &[read(MapSlot::Vertices), read(MapSlot::Triangles), read(MapSlot::Order), write(MapSlot::Corners)],
    ),
    stochastic(
        MapKernel::BoundTriangles,
        "bound_triangles",
        BOUND_TRIANGLES,
        &[read(MapSlot::Corners), write(MapSlot::Bounds)],
    ),
    stochastic(MapKernel::BoundNodes, "bound_nodes", BOUND_TRIANGLES, &[write(MapSlot::Bounds)]),
    stochastic(
        MapKernel::SampleLightField,
        "sample_light_field",
        SAMPLE_LIGHT_FIELD,
        &[read(MapSlot::Corners), read(MapSlot::Bounds), write(MapSlot::Depths)],
    ),
    stochastic(
        MapKernel::MarkLookedAt,
        "mark_looked_at",
        REPROJECT,
        &[read(MapSlot::Receivers), write(MapSlot::Tiles)],
    ),
    stochastic(MapKernel::MarkActive, "mark_active", REPROJECT, &[write(MapSlot::Tiles)]),
    stochastic(MapKernel::MarkData, "mark_data", REPROJECT, &[write(MapSlot::Tiles)]),
    stochastic(MapKernel::MarkMerged, "mark_merged", REPROJECT, &[write(MapSlot::Tiles)]),
    stochastic(MapKernel::ClearLists, "clear_lists", REPROJECT, &[write(MapSlot::Heads)]),
    stochastic(MapKernel::LinkSamples, "link_samples", REPROJECT, &[write(MapSlot::Heads), write(MapSlot::Next)]),
    stochastic(
        MapKernel::MergeSamples,
        "merge_samples",
        REPROJECT,
        &[
            read(MapSlot::Tiles),
            read(MapSlot::Heads),
            read(MapSlot::Next),
            read(MapSlot::Depths),
            write(MapSlot::Samples),
        ],
    ),
    stochastic(
        MapKernel::FindClosest,
        "find_closest",
        FIND_RADII,
        &[read(MapSlot::Tiles), read(MapSlot::Samples), write(MapSlot::Found)],
    ),
    stochastic(
        MapKernel::RaiseRadii,
        "raise_radii",
        FIND_RADII,
        &[read(MapSlot::Tiles), read(MapSlot::Samples), read(MapSlot::Found), write(MapSlot::Raised)],
    ),
    stochastic(MapKernel::LendRadii, "lend_radii", FIND_RADII, &[read(MapSlot::Raised), write(MapSlot::Samples)]),
    stochastic(
        MapKernel::CoarsenSamples,
        "coarsen_samples",
        FIND_RADII,
        &[read(MapSlot::Tiles), write(MapSlot::Samples)],
    ),
    stochastic(MapKernel::FindWidest, "find_widest", FIND_RADII, &[read(MapSlot::Samples), write(MapSlot::Widest)]),
    stochastic(
        MapKernel::GatherSamples,
        "gather_samples",
        FILTER_LEVELS,
        &[read(MapSlot::Tiles), read(MapSlot::Widest), read(MapSlot::Samples), write(MapSlot::Gathered)],
    ),
    stochastic(
        MapKernel::ResolveLevel,
        "resolve_level",
        FILTER_LEVELS,
        &[read(MapSlot::Tiles), read(MapSlot::Gathered), write(MapSlot::Resolved)],
    ),
    stochastic(
        MapKernel::LookUp,
        "look_up",
        LOOK_UP,
        &[read(MapSlot::Receivers), read(MapSlot::Resolved), write(MapSlot::Sums)],
    ),
    stochastic(
        MapKernel::FindVisibility,
        "find_visibility",
        LOOK_UP,
        &[read(MapSlot::Receivers), read(MapSlot::Facings), read(MapSlot::Sums), write(MapSlot::Visibility)],
    ),
];

impl MapKernel {
    /// The kernel's line in [`TABLE`].
    pub const fn info(self) -> &'static MapKernelInfo {
        &TABLE[self as usize]
    }
}
