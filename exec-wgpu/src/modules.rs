//! The kernels' SPIR-V, as compiled from `shaders-rust`.

use umbra4_core::kernel::Kernel;
use umbra4_maps::kernel::MapKernel;

use crate::DeviceKernel;

macro_rules! modules {
    ($name:ident, $type:ident: $($kernel:ident: $file:literal),* $(,)?) => {
        const fn $name(kernel: $type) -> &'static [u8] {
            match kernel {
                $($type::$kernel => include_bytes!(concat!("../shaders/", $file, ".spv")),)*
            }
        }
    };
}

modules! {
    exact, Kernel:
    KeyTriangles: "key_triangles",
    KeyReceivers: "key_receivers",
    SettleReceivers: "settle_receivers",
    CountDigits: "count_digits",
    SumBlocks: "sum_blocks",
    ScanBlocks: "scan_blocks",
    ScatterDigits: "scatter_digits",
    OrderTriangles: "order_triangles",
    BuildLevel: "build_level",
    Resolve32Exact: "resolve_32_exact",
    Resolve32Fast: "resolve_32_fast",
    Resolve64Exact: "resolve_64_exact",
    Resolve64Fast: "resolve_64_fast",
    Resolve32ExactCounted: "resolve_32_exact_counted",
    Resolve32FastCounted: "resolve_32_fast_counted",
    Resolve64ExactCounted: "resolve_64_exact_counted",
    Resolve64FastCounted: "resolve_64_fast_counted",
    Resolve32ExactJittered: "resolve_32_exact_jittered",
    Resolve32FastJittered: "resolve_32_fast_jittered",
    Resolve64ExactJittered: "resolve_64_exact_jittered",
    Resolve64FastJittered: "resolve_64_fast_jittered",
    Resolve32ExactJitteredCounted: "resolve_32_exact_jittered_counted",
    Resolve32FastJitteredCounted: "resolve_32_fast_jittered_counted",
    Resolve64ExactJitteredCounted: "resolve_64_exact_jittered_counted",
    Resolve64FastJitteredCounted: "resolve_64_fast_jittered_counted",
    KeyPunctualTriangles: "key_punctual_triangles",
    KeyPunctualReceivers: "key_punctual_receivers",
    SettlePunctualReceivers: "settle_punctual_receivers",
    OrderPunctualTriangles: "order_punctual_triangles",
    ResolvePunctualExact: "resolve_punctual_exact",
    ResolvePunctualFast: "resolve_punctual_fast",
    ResolvePunctualExactCounted: "resolve_punctual_exact_counted",
    ResolvePunctualFastCounted: "resolve_punctual_fast_counted",
    KeyCloudTriangles: "key_cloud_triangles",
    KeyCloudReceivers: "key_cloud_receivers",
    SettleCloudReceivers: "settle_cloud_receivers",
    OrderCloudTriangles: "order_cloud_triangles",
    BuildBoxLevel: "build_box_level",
    ResolveCloudExact: "resolve_cloud_exact",
    ResolveCloudFast: "resolve_cloud_fast",
    ResolveCloudExactCounted: "resolve_cloud_exact_counted",
    ResolveCloudFastCounted: "resolve_cloud_fast_counted",
    ResolveCloudByTable: "resolve_cloud_by_table",
    ResolveCloudByTableCounted: "resolve_cloud_by_table_counted",
    KeyCasterTriangles: "key_caster_triangles",
    OrderCasterTriangles: "order_caster_triangles",
    SelectReceivers: "select_receivers",
    ResolveCutout32: "resolve_cutout_32",
    ResolveCutout64: "resolve_cutout_64",
    ResolveCutout32Jittered: "resolve_cutout_32_jittered",
    ResolveCutout64Jittered: "resolve_cutout_64_jittered",
    AddTint: "add_tint",
    AddTintJittered: "add_tint_jittered",
    Reduce: "reduce",
    Weigh: "weigh",
    WeighTinted: "weigh_tinted",
    Pack: "pack",
    PackLight: "pack_light",
    Accumulate: "accumulate",
    SnapVertices: "snap_vertices",
    SnapInstances: "snap_instances",
    IndexTriangles: "index_triangles",
    NumberTriangles: "number_triangles",
    SnapPositions: "snap_positions",
    SnapPositionSamples: "snap_position_samples",
    SnapDepths: "snap_depths",
    SnapDepthSamples: "snap_depth_samples",
    SnapOwnedPositions: "snap_owned_positions",
    SnapOwnedPositionSamples: "snap_owned_position_samples",
    SnapOwnedDepths: "snap_owned_depths",
    SnapOwnedDepthSamples: "snap_owned_depth_samples",
    FacePixels: "face_pixels",
    FacePixelSamples: "face_pixel_samples",
    Thin: "thin",
    ThinFacings: "thin_facings",
    Upsample: "upsample",
    UpsampleLight: "upsample_light",
    Probe: "probe",
    Illuminate: "illuminate",
}

modules! {
    of_maps, MapKernel:
    DrawMap: "draw_map",
    BuildTiles: "build_tiles",
    BuildParents: "build_parents",
    GatherRows32: "gather_rows_32",
    GatherRows64: "gather_rows_64",
    GatherTable32: "gather_table_32",
    GatherTable64: "gather_table_64",
    GatherRectangles32: "gather_rectangles_32",
    GatherRectangles64: "gather_rectangles_64",
    GatherAreas: "gather_areas",
    PlaceTriangles: "place_triangles",
    BoundTriangles: "bound_triangles",
    BoundNodes: "bound_nodes",
    SampleLightField: "sample_light_field",
    MarkLookedAt: "mark_looked_at",
    MarkActive: "mark_active",
    MarkData: "mark_data",
    MarkMerged: "mark_merged",
    ClearLists: "clear_lists",
    LinkSamples: "link_samples",
    MergeSamples: "merge_samples",
    FindClosest: "find_closest",
    RaiseRadii: "raise_radii",
    LendRadii: "lend_radii",
    CoarsenSamples: "coarsen_samples",
    FindWidest: "find_widest",
    GatherSamples: "gather_samples",
    ResolveLevel: "resolve_level",
    LookUp: "look_up",
    FindVisibility: "find_visibility",
}

/// The SPIR-V module of a kernel: one entry point, named as in its table.
pub fn code(kernel: impl Into<DeviceKernel>) -> &'static [u8] {
    match kernel.into() {
        DeviceKernel::Exact(kernel) => exact(kernel),
        DeviceKernel::Maps(kernel) => of_maps(kernel),
    }
}

/// The manifest of the modules, JSON: compiler, hash of the sources, and of each module its bindings and hash.
pub fn manifest() -> &'static str {
    include_str!("../shaders/manifest.json")
}
