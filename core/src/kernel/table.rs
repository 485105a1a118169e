use crate::stage::Stage;

/// Threads of a workgroup, in every kernel.
pub const WORKGROUP: u32 = 64;

/// A kernel: an entry point of the shader crate, by the name in [`TABLE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Kernel {
    /// [`super::key_triangles`].
    KeyTriangles,
    /// [`super::key_receivers`].
    KeyReceivers,
    /// [`super::settle_receivers::settle_receivers`].
    SettleReceivers,
    /// [`super::sort::count_digits`].
    CountDigits,
    /// [`super::sort::sum_blocks`].
    SumBlocks,
    /// [`super::sort::scan_blocks`].
    ScanBlocks,
    /// [`super::sort::scatter_digits`].
    ScatterDigits,
    /// [`super::order_triangles`].
    OrderTriangles,
    /// [`super::build_level`].
    BuildLevel,
    /// [`super::resolve`], lights of up to 32 columns, certified.
    Resolve32Exact,
    /// The same, plain f32.
    Resolve32Fast,
    /// Up to 64 columns, certified.
    Resolve64Exact,
    /// The same, plain f32.
    Resolve64Fast,
    /// [`super::resolve::resolve_counted`], up to 32 columns, certified.
    Resolve32ExactCounted,
    /// The same, plain f32.
    Resolve32FastCounted,
    /// Up to 64 columns, certified.
    Resolve64ExactCounted,
    /// The same, plain f32.
    Resolve64FastCounted,
    /// [`Kernel::Resolve32Exact`], of jittered samples.
    Resolve32ExactJittered,
    /// [`Kernel::Resolve32Fast`], of jittered samples.
    Resolve32FastJittered,
    /// [`Kernel::Resolve64Exact`], of jittered samples.
    Resolve64ExactJittered,
    /// [`Kernel::Resolve64Fast`], of jittered samples.
    Resolve64FastJittered,
    /// [`Kernel::Resolve32ExactCounted`], of jittered samples.
    Resolve32ExactJitteredCounted,
    /// [`Kernel::Resolve32FastCounted`], of jittered samples.
    Resolve32FastJitteredCounted,
    /// [`Kernel::Resolve64ExactCounted`], of jittered samples.
    Resolve64ExactJitteredCounted,
    /// [`Kernel::Resolve64FastCounted`], of jittered samples.
    Resolve64FastJitteredCounted,
    /// [`super::key_triangles`], of a light without extent.
    KeyPunctualTriangles,
    /// [`super::key_receivers`], of a light without extent.
    KeyPunctualReceivers,
    /// [`super::settle_receivers::settle_punctual_receivers`].
    SettlePunctualReceivers,
    /// [`super::order_triangles`], of a light without extent.
    OrderPunctualTriangles,
    /// [`super::resolve_punctual`], certified.
    ResolvePunctualExact,
    /// The same, plain f32.
    ResolvePunctualFast,
    /// [`Kernel::ResolvePunctualExact`], counted.
    ResolvePunctualExactCounted,
    /// [`Kernel::ResolvePunctualFast`], counted.
    ResolvePunctualFastCounted,
    /// [`super::order_cloud::key_cloud_triangles`].
    KeyCloudTriangles,
    /// [`super::order_cloud::key_cloud_receivers`].
    KeyCloudReceivers,
    /// [`super::order_cloud::settle_cloud_receivers`].
    SettleCloudReceivers,
    /// [`super::order_cloud::order_cloud_triangles`].
    OrderCloudTriangles,
    /// [`super::order_cloud::build_box_level`].
    BuildBoxLevel,
    /// [`super::resolve_cloud`], certified.
    ResolveCloudExact,
    /// The same, plain f32.
    ResolveCloudFast,
    /// [`Kernel::ResolveCloudExact`], counted.
    ResolveCloudExactCounted,
    /// [`Kernel::ResolveCloudFast`], counted.
    ResolveCloudFastCounted,
    /// [`super::resolve_cloud_by_table`].
    ResolveCloudByTable,
    /// The same, counted.
    ResolveCloudByTableCounted,
    /// [`super::key_triangles`], of a caster.
    KeyCasterTriangles,
    /// [`super::order_triangles`], of a caster.
    OrderCasterTriangles,
    /// [`super::casters::select_receivers`].
    SelectReceivers,
    /// [`super::casters::resolve_cutout`], lights of up to 32 columns.
    ResolveCutout32,
    /// Up to 64 columns.
    ResolveCutout64,
    /// [`Kernel::ResolveCutout32`], of jittered samples.
    ResolveCutout32Jittered,
    /// [`Kernel::ResolveCutout64`], of jittered samples.
    ResolveCutout64Jittered,
    /// [`super::casters::add_tint`].
    AddTint,
    /// The same, of jittered samples.
    AddTintJittered,
    /// [`super::reduce`].
    Reduce,
    /// [`super::weigh`].
    Weigh,
    /// [`super::weigh_tinted`].
    WeighTinted,
    /// [`super::pack`].
    Pack,
    /// [`super::pack_light`].
    PackLight,
    /// [`super::accumulate`].
    Accumulate,
    /// [`super::snap_vertices::snap_vertices`].
    SnapVertices,
    /// [`super::snap_vertices::snap_instances`].
    SnapInstances,
    /// [`super::triangles::index_triangles`].
    IndexTriangles,
    /// [`super::triangles::number_triangles`].
    NumberTriangles,
    /// [`super::snap_receivers::snap_position`].
    SnapPositions,
    /// The same, one sample of multisampled textures.
    SnapPositionSamples,
    /// [`super::snap_receivers::snap_depth`].
    SnapDepths,
    /// The same, one sample of multisampled textures.
    SnapDepthSamples,
    /// [`Kernel::SnapPositions`], lifted by the normals of the triangles that are seen.
    SnapOwnedPositions,
    /// [`Kernel::SnapPositionSamples`], the same.
    SnapOwnedPositionSamples,
    /// [`Kernel::SnapDepths`], the same.
    SnapOwnedDepths,
    /// [`Kernel::SnapDepthSamples`], the same.
    SnapOwnedDepthSamples,
    /// [`super::face_pixels::face_pixel`].
    FacePixels,
    /// The same, one sample of multisampled textures.
    FacePixelSamples,
    /// [`super::half::thin`].
    Thin,
    /// [`super::face_pixels::thin_facings`].
    ThinFacings,
    /// [`super::half::upsample`], of lit samples.
    Upsample,
    /// The same, of sums of their weights.
    UpsampleLight,
    /// [`super::probe`], for tests.
    Probe,
    /// [`super::illuminate`].
    Illuminate,
}

/// What a kernel is told: the type of its binding 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ParamsKind {
    /// [`crate::params::Params`]
    Light,
    /// [`crate::params::CasterParams`]
    Caster,
    /// [`crate::params::JitteredParams`]
    JitteredLight,
    /// [`crate::params::PunctualParams`]
    PunctualLight,
    /// [`crate::params::CloudParams`]
    Cloud,
    /// [`crate::mesh::MeshParams`]
    Mesh,
    /// [`crate::gbuffer::ViewParams`]
    View,
}

impl ParamsKind {
    /// Bytes of the type.
    pub const fn size(self) -> usize {
        match self {
            Self::Light => size_of::<crate::params::Params>(),
            Self::Caster => size_of::<crate::params::CasterParams>(),
            Self::JitteredLight => size_of::<crate::params::JitteredParams>(),
            Self::PunctualLight => size_of::<crate::params::PunctualParams>(),
            Self::Cloud => size_of::<crate::params::CloudParams>(),
            Self::Mesh => size_of::<crate::mesh::MeshParams>(),
            Self::View => size_of::<crate::gbuffer::ViewParams>(),
        }
    }
}

/// What a kernel is bound to, by role.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Slot {
    /// Lattice positions of vertices, i32 × 3.
    Vertices,
    /// Vertex indices of triangles, u32 × 3.
    Triangles,
    /// Lattice positions of receivers, i32 × 3.
    Receivers,
    /// [`crate::facing::Facing`]s of receivers, as words.
    Facings,
    /// [`crate::proj4::Keys`] of triangles or receivers.
    Keys,
    /// [`crate::order::Entry`]s of triangles or receivers.
    Order,
    /// The same, in the order of the digits sorted by so far.
    Sorted,
    /// Counters of the sort, and their sums.
    Counters,
    /// [`crate::occluder::Occluder`]s, in order.
    Occluders,
    /// [`crate::proj4::KeyTile`]s of all levels.
    Nodes,
    /// [`crate::shaft::BoxTile`]s of all levels.
    Boxes,
    /// The samples of a cloud: [`super::resolve_cloud::SampleTile`]s.
    Samples,
    /// A table of planes: [`super::resolve_cloud_by_table::TableWord`]s.
    Planes,
    /// Words of 32 bits, receiver-major.
    Masks,
    /// [`super::resolve::ReceiverCounts`].
    Counts,
    /// [`crate::layers::Layers`] of receivers, u32.
    Layers,
    /// A caster's surface: [`crate::surface_words`].
    Surface,
    /// [`crate::tint::Depth`]s of all samples of receivers.
    SampleDepths,
    /// [`crate::tint::TRANSMITTANCES`].
    Transmittances,
    /// Lit samples, u32.
    LitCounts,
    /// Lit samples over frames, u32.
    Sums,
    /// Weights of the light's samples: [`super::weigh::PackedWeight`].
    Weights,
    /// Sums of the weights of lit samples, u32 × 3.
    WeighedLight,
    /// Lit count → visibility, in the format of the image.
    VisibilityTable,
    /// Visibility, or light, of every pixel, packed into words of 32 bits.
    Image,
    /// The engine's vertices, words of 32 bits.
    WorldVertices,
    /// The engine's instances, words of 32 bits.
    Instances,
    /// The engine's indices, words of 32 bits.
    Indices,
    /// World positions of pixels.
    Positions,
    /// Depths of pixels.
    Depths,
    /// Normals of pixels.
    Normals,
    /// Triangles that pixels show, one more than their index.
    Owners,
    /// Receivers of half pixels, i32 × 3.
    ThinReceivers,
    /// Facings of half pixels, as words.
    ThinFacings,
    /// [`super::status::Status`], counted by atomics.
    Status,
    /// What [`super::probe`] is given, u32 × 8.
    Probes,
    /// What it makes of it, u32 × 8.
    Probed,
    /// Unit normals of receivers, f32 × 3.
    UnitNormals,
    /// Places and weights of the light's samples: [`crate::irradiance::PackedSample`].
    Emitters,
    /// Irradiance of receivers, f32 × 3.
    Irradiance,
}

/// Whether a kernel writes a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Access {
    /// It only reads.
    Read,
    /// It writes, and may read.
    Write,
    /// A texture, read texel by texel.
    Texture,
    /// The same, multisampled.
    Samples,
    /// A texture of integers.
    Ids,
    /// The same, multisampled.
    IdSamples,
}

/// A storage buffer or texture of a kernel. The k-th has binding k + 1, in set 0; binding 0 are the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bound<S = Slot> {
    /// What it holds.
    pub slot: S,
    /// What is done to it.
    pub access: Access,
}

impl<S> Bound<S> {
    /// A buffer that is only read.
    pub const fn read(slot: S) -> Self {
        Self { slot, access: Access::Read }
    }

    /// A buffer that is written.
    pub const fn write(slot: S) -> Self {
        Self { slot, access: Access::Write }
    }
}

/// One line of a table of kernels: of this crate's, or of another crate's with kernels, stages, parameters and buffers of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelInfo<K = Kernel, G = Stage, P = ParamsKind, S: 'static = Slot> {
    /// The kernel.
    pub kernel: K,
    /// Name of its entry point.
    pub name: &'static str,
    /// The stage that it belongs to; the sort's kernels belong to both that order, and no stage runs the probe.
    pub stage: G,
    /// What it is told.
    pub params: P,
    /// Its storage buffers and textures.
    pub bound: &'static [Bound<S>],
}

const fn read(slot: Slot) -> Bound {
    Bound::read(slot)
}

const fn write(slot: Slot) -> Bound {
    Bound::write(slot)
}

const RESOLVE_COUNTED: &[Bound] = &[
    read(Slot::Receivers),
    read(Slot::Keys),
    read(Slot::Order),
    read(Slot::Occluders),
    read(Slot::Nodes),
    write(Slot::Masks),
    write(Slot::Counts),
];

const RESOLVE: &[Bound] = but_counts(RESOLVE_COUNTED);

const KEY_TRIANGLES: &[Bound] = &[read(Slot::Vertices), read(Slot::Triangles), write(Slot::Keys), write(Slot::Order)];

const KEY_RECEIVERS: &[Bound] = &[read(Slot::Receivers), write(Slot::Keys), write(Slot::Order)];

const ORDER_TRIANGLES: &[Bound] = &[
    read(Slot::Vertices),
    read(Slot::Triangles),
    read(Slot::Keys),
    read(Slot::Order),
    write(Slot::Occluders),
    write(Slot::Nodes),
];

/// What tells the samples that a pair blocks is read from `elements`.
const fn resolve_cloud_counted(elements: Slot) -> [Bound; 7] {
    [
        read(Slot::Receivers),
        read(Slot::Order),
        read(Slot::Occluders),
        read(Slot::Boxes),
        read(elements),
        write(Slot::Masks),
        write(Slot::Counts),
    ]
}

const RESOLVE_CLOUD_COUNTED: &[Bound] = &resolve_cloud_counted(Slot::Samples);
const RESOLVE_CLOUD_BY_TABLE_COUNTED: &[Bound] = &resolve_cloud_counted(Slot::Planes);

/// What a caster's triangles are met by, and what that changes.
const fn with_surface(changed: Slot) -> [Bound; 7] {
    [
        read(Slot::Receivers),
        read(Slot::Keys),
        read(Slot::Order),
        read(Slot::Occluders),
        read(Slot::Nodes),
        read(Slot::Surface),
        write(changed),
    ]
}

const RESOLVE_CUTOUT: &[Bound] = &with_surface(Slot::Masks);
const ADD_TINT: &[Bound] = &with_surface(Slot::SampleDepths);

/// All but the counts, which come last.
const fn but_counts(counted: &[Bound]) -> &[Bound] {
    match counted {
        [but_counts @ .., _] => but_counts,
        [] => &[],
    }
}

const RESOLVE_CLOUD: &[Bound] = but_counts(RESOLVE_CLOUD_COUNTED);
const RESOLVE_CLOUD_BY_TABLE: &[Bound] = but_counts(RESOLVE_CLOUD_BY_TABLE_COUNTED);

const fn line(kernel: Kernel, name: &'static str, stage: Stage, bound: &'static [Bound]) -> KernelInfo {
    KernelInfo { kernel, name, stage, params: ParamsKind::Light, bound }
}

const fn jittered(kernel: Kernel, name: &'static str, bound: &'static [Bound]) -> KernelInfo {
    KernelInfo { kernel, name, stage: Stage::Resolve, params: ParamsKind::JitteredLight, bound }
}

const fn punctual(kernel: Kernel, name: &'static str, stage: Stage, bound: &'static [Bound]) -> KernelInfo {
    KernelInfo { kernel, name, stage, params: ParamsKind::PunctualLight, bound }
}

const fn cloud(kernel: Kernel, name: &'static str, stage: Stage, bound: &'static [Bound]) -> KernelInfo {
    KernelInfo { kernel, name, stage, params: ParamsKind::Cloud, bound }
}

const fn caster(kernel: Kernel, name: &'static str, stage: Stage, bound: &'static [Bound]) -> KernelInfo {
    KernelInfo { kernel, name, stage, params: ParamsKind::Caster, bound }
}

const fn mesh(kernel: Kernel, name: &'static str, bound: &'static [Bound]) -> KernelInfo {
    KernelInfo { kernel, name, stage: Stage::SnapVertices, params: ParamsKind::Mesh, bound }
}

const fn view(kernel: Kernel, name: &'static str, bound: &'static [Bound]) -> KernelInfo {
    KernelInfo { kernel, name, stage: Stage::SnapReceivers, params: ParamsKind::View, bound }
}

const fn texture(slot: Slot) -> Bound {
    Bound { slot, access: Access::Texture }
}

const fn samples(slot: Slot) -> Bound {
    Bound { slot, access: Access::Samples }
}

const fn owned(surface: Bound, normals: Bound, owners: Access) -> [Bound; 7] {
    [
        surface,
        normals,
        Bound { slot: Slot::Owners, access: owners },
        read(Slot::Vertices),
        read(Slot::Triangles),
        write(Slot::Receivers),
        write(Slot::Status),
    ]
}

const OWNED_POSITIONS: &[Bound] = &owned(texture(Slot::Positions), texture(Slot::Normals), Access::Ids);
const OWNED_POSITION_SAMPLES: &[Bound] = &owned(samples(Slot::Positions), samples(Slot::Normals), Access::IdSamples);
const OWNED_DEPTHS: &[Bound] = &owned(texture(Slot::Depths), texture(Slot::Normals), Access::Ids);
const OWNED_DEPTH_SAMPLES: &[Bound] = &owned(samples(Slot::Depths), samples(Slot::Normals), Access::IdSamples);

/// All kernels.
pub const TABLE: [KernelInfo; 79] = [
    line(Kernel::KeyTriangles, "key_triangles", Stage::KeyTriangles, KEY_TRIANGLES),
    line(Kernel::KeyReceivers, "key_receivers", Stage::KeyReceivers, KEY_RECEIVERS),
    line(
        Kernel::SettleReceivers,
        "settle_receivers",
        Stage::SettleReceivers,
        &[read(Slot::Receivers), read(Slot::Facings), write(Slot::Order)],
    ),
    line(Kernel::CountDigits, "count_digits", Stage::OrderTriangles, &[read(Slot::Order), write(Slot::Counters)]),
    line(Kernel::SumBlocks, "sum_blocks", Stage::OrderTriangles, &[write(Slot::Counters)]),
    line(Kernel::ScanBlocks, "scan_blocks", Stage::OrderTriangles, &[write(Slot::Counters)]),
    line(
        Kernel::ScatterDigits,
        "scatter_digits",
        Stage::OrderTriangles,
        &[read(Slot::Counters), read(Slot::Order), write(Slot::Sorted)],
    ),
    line(Kernel::OrderTriangles, "order_triangles", Stage::OrderTriangles, ORDER_TRIANGLES),
    line(Kernel::BuildLevel, "build_level", Stage::BuildLevel, &[write(Slot::Nodes)]),
    line(Kernel::Resolve32Exact, "resolve_32_exact", Stage::Resolve, RESOLVE),
    line(Kernel::Resolve32Fast, "resolve_32_fast", Stage::Resolve, RESOLVE),
    line(Kernel::Resolve64Exact, "resolve_64_exact", Stage::Resolve, RESOLVE),
    line(Kernel::Resolve64Fast, "resolve_64_fast", Stage::Resolve, RESOLVE),
    line(Kernel::Resolve32ExactCounted, "resolve_32_exact_counted", Stage::Resolve, RESOLVE_COUNTED),
    line(Kernel::Resolve32FastCounted, "resolve_32_fast_counted", Stage::Resolve, RESOLVE_COUNTED),
    line(Kernel::Resolve64ExactCounted, "resolve_64_exact_counted", Stage::Resolve, RESOLVE_COUNTED),
    line(Kernel::Resolve64FastCounted, "resolve_64_fast_counted", Stage::Resolve, RESOLVE_COUNTED),
    jittered(Kernel::Resolve32ExactJittered, "resolve_32_exact_jittered", RESOLVE),
    jittered(Kernel::Resolve32FastJittered, "resolve_32_fast_jittered", RESOLVE),
    jittered(Kernel::Resolve64ExactJittered, "resolve_64_exact_jittered", RESOLVE),
    jittered(Kernel::Resolve64FastJittered, "resolve_64_fast_jittered", RESOLVE),
    jittered(Kernel::Resolve32ExactJitteredCounted, "resolve_32_exact_jittered_counted", RESOLVE_COUNTED),
    jittered(Kernel::Resolve32FastJitteredCounted, "resolve_32_fast_jittered_counted", RESOLVE_COUNTED),
    jittered(Kernel::Resolve64ExactJitteredCounted, "resolve_64_exact_jittered_counted", RESOLVE_COUNTED),
    jittered(Kernel::Resolve64FastJitteredCounted, "resolve_64_fast_jittered_counted", RESOLVE_COUNTED),
    punctual(Kernel::KeyPunctualTriangles, "key_punctual_triangles", Stage::KeyTriangles, KEY_TRIANGLES),
    punctual(Kernel::KeyPunctualReceivers, "key_punctual_receivers", Stage::KeyReceivers, KEY_RECEIVERS),
    punctual(
        Kernel::SettlePunctualReceivers,
        "settle_punctual_receivers",
        Stage::SettleReceivers,
        &[read(Slot::Receivers), read(Slot::Facings), write(Slot::Order), write(Slot::Masks)],
    ),
    punctual(Kernel::OrderPunctualTriangles, "order_punctual_triangles", Stage::OrderTriangles, ORDER_TRIANGLES),
    punctual(Kernel::ResolvePunctualExact, "resolve_punctual_exact", Stage::ResolvePunctual, RESOLVE),
    punctual(Kernel::ResolvePunctualFast, "resolve_punctual_fast", Stage::ResolvePunctual, RESOLVE),
    punctual(
        Kernel::ResolvePunctualExactCounted,
        "resolve_punctual_exact_counted",
        Stage::ResolvePunctual,
        RESOLVE_COUNTED,
    ),
    punctual(
        Kernel::ResolvePunctualFastCounted,
        "resolve_punctual_fast_counted",
        Stage::ResolvePunctual,
        RESOLVE_COUNTED,
    ),
    cloud(
        Kernel::KeyCloudTriangles,
        "key_cloud_triangles",
        Stage::KeyTriangles,
        &[read(Slot::Vertices), read(Slot::Triangles), write(Slot::Order)],
    ),
    cloud(
        Kernel::KeyCloudReceivers,
        "key_cloud_receivers",
        Stage::KeyReceivers,
        &[read(Slot::Receivers), write(Slot::Order)],
    ),
    cloud(
        Kernel::SettleCloudReceivers,
        "settle_cloud_receivers",
        Stage::SettleReceivers,
        &[read(Slot::Receivers), read(Slot::Facings), write(Slot::Order)],
    ),
    cloud(
        Kernel::OrderCloudTriangles,
        "order_cloud_triangles",
        Stage::OrderTriangles,
        &[read(Slot::Vertices), read(Slot::Triangles), read(Slot::Order), write(Slot::Occluders), write(Slot::Boxes)],
    ),
    line(Kernel::BuildBoxLevel, "build_box_level", Stage::BuildLevel, &[write(Slot::Boxes)]),
    cloud(Kernel::ResolveCloudExact, "resolve_cloud_exact", Stage::ResolveCloud, RESOLVE_CLOUD),
    cloud(Kernel::ResolveCloudFast, "resolve_cloud_fast", Stage::ResolveCloud, RESOLVE_CLOUD),
    cloud(Kernel::ResolveCloudExactCounted, "resolve_cloud_exact_counted", Stage::ResolveCloud, RESOLVE_CLOUD_COUNTED),
    cloud(Kernel::ResolveCloudFastCounted, "resolve_cloud_fast_counted", Stage::ResolveCloud, RESOLVE_CLOUD_COUNTED),
    cloud(Kernel::ResolveCloudByTable, "resolve_cloud_by_table", Stage::ResolveCloud, RESOLVE_CLOUD_BY_TABLE),
    cloud(
        Kernel::ResolveCloudByTableCounted,
        "resolve_cloud_by_table_counted",
        Stage::ResolveCloud,
        RESOLVE_CLOUD_BY_TABLE_COUNTED,
    ),
    caster(Kernel::KeyCasterTriangles, "key_caster_triangles", Stage::KeyTriangles, KEY_TRIANGLES),
    caster(Kernel::OrderCasterTriangles, "order_caster_triangles", Stage::OrderTriangles, ORDER_TRIANGLES),
    caster(
        Kernel::SelectReceivers,
        "select_receivers",
        Stage::SelectReceivers,
        &[read(Slot::Order), read(Slot::Layers), write(Slot::Sorted)],
    ),
    caster(Kernel::ResolveCutout32, "resolve_cutout_32", Stage::ResolveCutout, RESOLVE_CUTOUT),
    caster(Kernel::ResolveCutout64, "resolve_cutout_64", Stage::ResolveCutout, RESOLVE_CUTOUT),
    caster(Kernel::ResolveCutout32Jittered, "resolve_cutout_32_jittered", Stage::ResolveCutout, RESOLVE_CUTOUT),
    caster(Kernel::ResolveCutout64Jittered, "resolve_cutout_64_jittered", Stage::ResolveCutout, RESOLVE_CUTOUT),
    caster(Kernel::AddTint, "add_tint", Stage::AddTint, ADD_TINT),
    caster(Kernel::AddTintJittered, "add_tint_jittered", Stage::AddTint, ADD_TINT),
    line(Kernel::Reduce, "reduce", Stage::Reduce, &[read(Slot::Masks), write(Slot::LitCounts)]),
    line(Kernel::Weigh, "weigh", Stage::Reduce, &[read(Slot::Masks), read(Slot::Weights), write(Slot::WeighedLight)]),
    line(
        Kernel::WeighTinted,
        "weigh_tinted",
        Stage::Reduce,
        &[
            read(Slot::Masks),
            read(Slot::Weights),
            read(Slot::SampleDepths),
            read(Slot::Transmittances),
            write(Slot::WeighedLight),
        ],
    ),
    line(
        Kernel::Pack,
        "pack",
        Stage::Reduce,
        &[read(Slot::LitCounts), read(Slot::VisibilityTable), write(Slot::Image)],
    ),
    line(Kernel::PackLight, "pack_light", Stage::Reduce, &[read(Slot::WeighedLight), write(Slot::Image)]),
    line(
        Kernel::Accumulate,
        "accumulate",
        Stage::Reduce,
        &[read(Slot::LitCounts), write(Slot::Sums), write(Slot::Image)],
    ),
    mesh(
        Kernel::SnapVertices,
        "snap_vertices",
        &[read(Slot::WorldVertices), write(Slot::Vertices), write(Slot::Status)],
    ),
    mesh(
        Kernel::SnapInstances,
        "snap_instances",
        &[read(Slot::WorldVertices), read(Slot::Instances), write(Slot::Vertices), write(Slot::Status)],
    ),
    mesh(
        Kernel::IndexTriangles,
        "index_triangles",
        &[read(Slot::Indices), write(Slot::Triangles), write(Slot::Status)],
    ),
    mesh(Kernel::NumberTriangles, "number_triangles", &[write(Slot::Triangles)]),
    view(
        Kernel::SnapPositions,
        "snap_positions",
        &[texture(Slot::Positions), texture(Slot::Normals), write(Slot::Receivers), write(Slot::Status)],
    ),
    view(
        Kernel::SnapPositionSamples,
        "snap_position_samples",
        &[samples(Slot::Positions), samples(Slot::Normals), write(Slot::Receivers), write(Slot::Status)],
    ),
    view(
        Kernel::SnapDepths,
        "snap_depths",
        &[texture(Slot::Depths), texture(Slot::Normals), write(Slot::Receivers), write(Slot::Status)],
    ),
    view(
        Kernel::SnapDepthSamples,
        "snap_depth_samples",
        &[samples(Slot::Depths), samples(Slot::Normals), write(Slot::Receivers), write(Slot::Status)],
    ),
    view(Kernel::SnapOwnedPositions, "snap_owned_positions", OWNED_POSITIONS),
    view(Kernel::SnapOwnedPositionSamples, "snap_owned_position_samples", OWNED_POSITION_SAMPLES),
    view(Kernel::SnapOwnedDepths, "snap_owned_depths", OWNED_DEPTHS),
    view(Kernel::SnapOwnedDepthSamples, "snap_owned_depth_samples", OWNED_DEPTH_SAMPLES),
    view(Kernel::FacePixels, "face_pixels", &[texture(Slot::Normals), write(Slot::Facings)]),
    view(Kernel::FacePixelSamples, "face_pixel_samples", &[samples(Slot::Normals), write(Slot::Facings)]),
    view(Kernel::Thin, "thin", &[read(Slot::Receivers), write(Slot::ThinReceivers)]),
    view(Kernel::ThinFacings, "thin_facings", &[read(Slot::Receivers), read(Slot::Facings), write(Slot::ThinFacings)]),
    view(
        Kernel::Upsample,
        "upsample",
        &[read(Slot::Receivers), read(Slot::ThinReceivers), read(Slot::LitCounts), write(Slot::LitCounts)],
    ),
    view(
        Kernel::UpsampleLight,
        "upsample_light",
        &[read(Slot::Receivers), read(Slot::ThinReceivers), read(Slot::WeighedLight), write(Slot::WeighedLight)],
    ),
    line(Kernel::Probe, "probe", Stage::Resolve, &[read(Slot::Probes), write(Slot::Probed)]),
    line(
        Kernel::Illuminate,
        "illuminate",
        Stage::Illuminate,
        &[
            read(Slot::Masks),
            read(Slot::Receivers),
            read(Slot::UnitNormals),
            read(Slot::Emitters),
            write(Slot::Irradiance),
        ],
    ),
];

impl Kernel {
    /// The kernel's line in [`TABLE`].
    pub const fn info(self) -> &'static KernelInfo {
        &TABLE[self as usize]
    }
}
