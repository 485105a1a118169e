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
    /// [`super::reduce`].
    Reduce,
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
    /// [`crate::proj4::Keys`] of triangles or receivers.
    Keys,
    /// [`crate::order::Entry`]s of triangles or receivers.
    Order,
    /// The same, in the order of the digits sorted by so far.
    Sorted,
    /// Counters of the sort, and their sums.
    Counters,
    /// [`crate::edge_plane::Occluder`]s, in order.
    Occluders,
    /// [`crate::proj4::KeyTile`]s of all levels.
    Nodes,
    /// Words of 32 bits, receiver-major.
    Masks,
    /// [`super::resolve::ReceiverCounts`].
    Counts,
    /// Lit count → visibility, f32.
    VisibilityTable,
    /// Fraction of lit samples, f32.
    Visibility,
}

/// Whether a kernel writes a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Access {
    /// It only reads.
    Read,
    /// It writes, and may read.
    Write,
}

/// A storage buffer of a kernel. The k-th of a kernel has binding k + 1, in set 0; binding 0 is [`crate::params::Params`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bound {
    /// What it holds.
    pub slot: Slot,
    /// What is done to it.
    pub access: Access,
}

/// One line of the table of kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelInfo {
    /// The kernel.
    pub kernel: Kernel,
    /// Name of its entry point.
    pub name: &'static str,
    /// The stage that it belongs to; the sort's kernels belong to both that order.
    pub stage: Stage,
    /// Its storage buffers.
    pub bound: &'static [Bound],
}

const fn read(slot: Slot) -> Bound {
    Bound { slot, access: Access::Read }
}

const fn write(slot: Slot) -> Bound {
    Bound { slot, access: Access::Write }
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

/// The same but the counts, which come last.
const RESOLVE: &[Bound] = match RESOLVE_COUNTED {
    [but_counts @ .., _] => but_counts,
    [] => &[],
};

const fn line(kernel: Kernel, name: &'static str, stage: Stage, bound: &'static [Bound]) -> KernelInfo {
    KernelInfo { kernel, name, stage, bound }
}

/// All kernels.
pub const TABLE: [KernelInfo; 17] = [
    line(
        Kernel::KeyTriangles,
        "key_triangles",
        Stage::KeyTriangles,
        &[read(Slot::Vertices), read(Slot::Triangles), write(Slot::Keys), write(Slot::Order)],
    ),
    line(
        Kernel::KeyReceivers,
        "key_receivers",
        Stage::KeyReceivers,
        &[read(Slot::Receivers), write(Slot::Keys), write(Slot::Order)],
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
    line(
        Kernel::OrderTriangles,
        "order_triangles",
        Stage::OrderTriangles,
        &[
            read(Slot::Vertices),
            read(Slot::Triangles),
            read(Slot::Keys),
            read(Slot::Order),
            write(Slot::Occluders),
            write(Slot::Nodes),
        ],
    ),
    line(Kernel::BuildLevel, "build_level", Stage::BuildLevel, &[write(Slot::Nodes)]),
    line(Kernel::Resolve32Exact, "resolve_32_exact", Stage::Resolve, RESOLVE),
    line(Kernel::Resolve32Fast, "resolve_32_fast", Stage::Resolve, RESOLVE),
    line(Kernel::Resolve64Exact, "resolve_64_exact", Stage::Resolve, RESOLVE),
    line(Kernel::Resolve64Fast, "resolve_64_fast", Stage::Resolve, RESOLVE),
    line(Kernel::Resolve32ExactCounted, "resolve_32_exact_counted", Stage::Resolve, RESOLVE_COUNTED),
    line(Kernel::Resolve32FastCounted, "resolve_32_fast_counted", Stage::Resolve, RESOLVE_COUNTED),
    line(Kernel::Resolve64ExactCounted, "resolve_64_exact_counted", Stage::Resolve, RESOLVE_COUNTED),
    line(Kernel::Resolve64FastCounted, "resolve_64_fast_counted", Stage::Resolve, RESOLVE_COUNTED),
    line(
        Kernel::Reduce,
        "reduce",
        Stage::Reduce,
        &[read(Slot::Masks), read(Slot::VisibilityTable), write(Slot::Visibility)],
    ),
];

impl Kernel {
    /// The kernel's line in [`TABLE`].
    pub const fn info(self) -> &'static KernelInfo {
        &TABLE[self as usize]
    }
}
