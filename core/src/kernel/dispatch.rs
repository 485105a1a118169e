//! Which kernels a stage is, in which order, over which buffers: written once, for every executor that runs kernels.

use crate::{
    hierarchy::Levels,
    kernel::{
        Kernel,
        sort::{BLOCK, CODE_BITS, DIGIT_BITS, DIGITS, level_above, runs},
    },
    params::PassParams,
    plan::{IndexKind, Pass, Plan, Work},
    proj4::NODE,
    stage::Stage,
};

/// A buffer of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Role {
    /// Lattice positions of vertices.
    Vertices,
    /// Vertex indices of triangles.
    Triangles,
    /// Keys of triangles.
    TriangleKeys,
    /// Triangles along the curve.
    TriangleOrder,
    /// Triangles, or receivers of a block, while they are sorted.
    SpareOrder,
    /// Counters of the sort, and their sums.
    Counters,
    /// Triangles in order, oriented.
    Occluders,
    /// Nodes of all levels.
    Nodes,
    /// Samples of a cloud.
    Samples,
    /// A table of planes before it.
    Planes,
    /// Lattice positions of receivers.
    Receivers,
    /// Which way all receivers face: words of [`crate::facing::Facing`].
    Facings,
    /// Keys of a block's receivers.
    ReceiverKeys,
    /// A block's receivers along the curve.
    ReceiverOrder,
    /// Masks of a block, and one more word: see [`crate::kernel::resolve::resolve`].
    Masks,
    /// Counts of a block.
    Counts,
    /// Lit samples of all receivers.
    LitCounts,
    /// Weights of the light's samples.
    Weights,
    /// Sums of the weights of lit samples, of all receivers.
    WeighedLight,
    /// Unit normals of all receivers.
    UnitNormals,
    /// Places and weights of the light's samples.
    Emitters,
    /// Irradiance of all receivers.
    Irradiance,
}

/// One kernel to be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dispatch<'a> {
    /// The kernel.
    pub kernel: Kernel,
    /// What it is told.
    pub pass: PassParams,
    /// What it is bound to, in the order of its bindings.
    pub roles: &'a [Role],
}

/// How masks are computed and stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaskLayout {
    /// Kernel of stage resolve.
    pub resolve: Kernel,
    /// Words of 32 bits that a receiver's mask takes.
    pub stride: u32,
    /// Whether the kernel counts.
    pub counted: bool,
    /// Triangles that a dispatch looks at, at most: some drivers stop threads that run for long.
    pub slice: u32,
    /// What stage reduce makes of masks.
    pub reduction: Reduction,
}

/// What stage reduce makes of masks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reduction {
    /// Lit samples.
    #[default]
    LitCounts,
    /// Sums of the weights of lit samples: an emission.
    WeighedLight,
    /// Both.
    Both,
}

impl Reduction {
    /// What is asked for; `None` where that is nothing.
    pub const fn of(lit_counts: bool, weighed_light: bool) -> Option<Self> {
        match (lit_counts, weighed_light) {
            (true, false) => Some(Self::LitCounts),
            (false, true) => Some(Self::WeighedLight),
            (true, true) => Some(Self::Both),
            (false, false) => None,
        }
    }

    /// Whether lit samples are counted.
    pub const fn counts(self) -> bool {
        matches!(self, Self::LitCounts | Self::Both)
    }

    /// Whether their weights are added up.
    pub const fn weighs(self) -> bool {
        matches!(self, Self::WeighedLight | Self::Both)
    }
}

const SORT_PASSES: u32 = CODE_BITS.div_ceil(DIGIT_BITS);
/// Most levels of sums.
const SUM_LEVELS: usize = 6;

const RESOLVE: [Role; 7] =
    [Role::Receivers, Role::ReceiverKeys, Role::ReceiverOrder, Role::Occluders, Role::Nodes, Role::Masks, Role::Counts];

/// What tells the samples that a pair blocks is read from `elements`.
const fn resolve_cloud(elements: Role) -> [Role; 7] {
    [Role::Receivers, Role::ReceiverOrder, Role::Occluders, Role::Nodes, elements, Role::Masks, Role::Counts]
}

/// What a light is, as kernels tell lights apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Area,
    Punctual,
    Cloud,
}

/// Hands the dispatches of a pass to `record`, in order.
///
/// # Errors
/// The first of `record`'s.
pub fn dispatches<E>(
    plan: &Plan,
    layout: &MaskLayout,
    pass: &Pass,
    record: &mut impl FnMut(&Dispatch<'_>) -> Result<(), E>,
) -> Result<(), E> {
    let facts = plan.facts();
    let mut one = |kernel, pass, roles: &[Role]| record(&Dispatch { kernel, pass, roles });
    let kind = match facts.index {
        _ if facts.punctual => Kind::Punctual,
        IndexKind::Shafts => Kind::Cloud,
        _ => Kind::Area,
    };
    let by_id = PassParams { count: pass.count, first: pass.first, ..PassParams::default() };
    // Passes of stages whose ids are groups name their first receiver.
    let block = facts.block.min(facts.receivers.saturating_sub(pass.first));
    match pass.stage {
        Stage::KeyTriangles => {
            let keyed = [Role::Vertices, Role::Triangles, Role::TriangleKeys, Role::TriangleOrder];
            match kind {
                Kind::Area if facts.work == Work::Index => one(Kernel::KeyCasterTriangles, by_id, &keyed),
                Kind::Area => one(Kernel::KeyTriangles, by_id, &keyed),
                Kind::Punctual => one(Kernel::KeyPunctualTriangles, by_id, &keyed),
                Kind::Cloud => {
                    one(Kernel::KeyCloudTriangles, by_id, &[Role::Vertices, Role::Triangles, Role::TriangleOrder])
                }
            }
        }
        Stage::OrderTriangles => {
            sort(pass.count, Role::TriangleOrder, &mut one)?;
            // Places beyond the last triangle are written too, up to the end of its node.
            let places = pass.count.div_ceil(NODE as u32).saturating_mul(NODE as u32);
            let pass = PassParams { count: places, elements: pass.count, ..PassParams::default() };
            let [vertices, triangles, order] = [Role::Vertices, Role::Triangles, Role::TriangleOrder];
            let [occluders, nodes] = [Role::Occluders, Role::Nodes];
            let keyed = [vertices, triangles, Role::TriangleKeys, order, occluders, nodes];
            match kind {
                Kind::Area if facts.work == Work::Index => one(Kernel::OrderCasterTriangles, pass, &keyed),
                Kind::Area => one(Kernel::OrderTriangles, pass, &keyed),
                Kind::Punctual => one(Kernel::OrderPunctualTriangles, pass, &keyed),
                Kind::Cloud => one(Kernel::OrderCloudTriangles, pass, &[vertices, triangles, order, occluders, nodes]),
            }
        }
        Stage::BuildLevel => {
            let kernel = if kind == Kind::Cloud { Kernel::BuildBoxLevel } else { Kernel::BuildLevel };
            one(kernel, level(plan.levels(), pass.first as usize), &[Role::Nodes])
        }
        Stage::KeyReceivers => {
            let keyed = [Role::Receivers, Role::ReceiverKeys, Role::ReceiverOrder];
            match kind {
                Kind::Area => one(Kernel::KeyReceivers, by_id, &keyed),
                Kind::Punctual => one(Kernel::KeyPunctualReceivers, by_id, &keyed),
                Kind::Cloud => one(Kernel::KeyCloudReceivers, by_id, &[Role::Receivers, Role::ReceiverOrder]),
            }
        }
        Stage::SettleReceivers => {
            let roles = [Role::Receivers, Role::Facings, Role::ReceiverOrder, Role::Masks];
            match kind {
                Kind::Area => one(Kernel::SettleReceivers, by_id, &roles[..3]),
                Kind::Punctual => one(Kernel::SettlePunctualReceivers, by_id, &roles),
                Kind::Cloud => one(Kernel::SettleCloudReceivers, by_id, &roles[..3]),
            }
        }
        Stage::OrderReceivers => sort(pass.count, Role::ReceiverOrder, &mut one),
        Stage::Resolve | Stage::ResolvePunctual | Stage::ResolveCloud => {
            let all = match kind {
                Kind::Cloud if facts.table => resolve_cloud(Role::Planes),
                Kind::Cloud => resolve_cloud(Role::Samples),
                _ => RESOLVE,
            };
            let roles = match &all {
                all if layout.counted => &all[..],
                [but_counts @ .., _] => but_counts,
            };
            let pass = PassParams {
                count: block,
                first: pass.first,
                stride: layout.stride,
                rounds: 2,
                ..PassParams::default()
            };
            slices(plan.levels(), layout.slice).try_for_each(|(level, base)| {
                one(layout.resolve, PassParams { level, base, elements: base.min(1), ..pass }, roles)
            })
        }
        Stage::Reduce => {
            let pass = PassParams { stride: layout.stride, ..by_id };
            if layout.reduction.counts() {
                one(Kernel::Reduce, pass, &[Role::Masks, Role::LitCounts])?;
            }
            if layout.reduction.weighs() {
                one(Kernel::Weigh, pass, &[Role::Masks, Role::Weights, Role::WeighedLight])?;
            }
            Ok(())
        }
        Stage::Illuminate => {
            let roles = [Role::Masks, Role::Receivers, Role::UnitNormals, Role::Emitters, Role::Irradiance];
            one(Kernel::Illuminate, PassParams { stride: layout.stride, ..by_id }, &roles)
        }
        // How vertices and receivers come is the executor's; the hierarchy is the index of those that run kernels.
        Stage::SnapVertices
        | Stage::SnapReceivers
        | Stage::FindSilhouette
        | Stage::SelectReceivers
        | Stage::ResolveCutout
        | Stage::AddTint
        | Stage::DefineFrame
        | Stage::BinReceivers
        | Stage::BinTriangles
        | Stage::ResolveCells => Ok(()),
    }
}

fn level(levels: &Levels, level: usize) -> PassParams {
    let (own, below) = (levels.range(level), levels.range(level.saturating_sub(1)));
    PassParams {
        count: (own.len() * NODE) as u32,
        first: own.start as u32,
        base: below.start as u32,
        elements: below.len() as u32,
        ..PassParams::default()
    }
}

/// One slice of the triangles after the other: those under each node of one level, by level and place; at least one.
pub fn slices(levels: &Levels, slice: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
    let level = slice_level(levels, slice);
    (0..levels.range(level).len().max(1) as u32).map(move |base| (level as u32, base))
}

/// The highest level whose nodes stand for no more than `slice` triangles.
fn slice_level(levels: &Levels, slice: u32) -> usize {
    let (mut level, mut triangles) = (0, NODE as u64);
    while level + 1 < levels.count() && triangles * NODE as u64 <= u64::from(slice) {
        level += 1;
        triangles *= NODE as u64;
    }
    level
}

/// Lengths of the levels of sums over the counters of `entries` entries, and where each starts; the counters first.
fn sums(entries: u32) -> impl DoubleEndedIterator<Item = (u32, u32)> {
    let mut levels = [(0, 0); SUM_LEVELS];
    let (mut length, mut base) = (runs(entries).saturating_mul(DIGITS as u32), 0_u32);
    for level in &mut levels {
        *level = (length, base);
        base = base.saturating_add(length);
        length = level_above(length);
    }
    levels.into_iter().filter(|(length, _)| *length > 0)
}

/// Counters that sorting `entries` entries takes, with their sums.
pub fn counters(entries: u32) -> u64 {
    sums(entries).map(|(length, _)| u64::from(length)).sum()
}

/// Sorts `count` entries. An even number of digits: the result is where they were.
fn sort<E>(
    count: u32,
    order: Role,
    one: &mut impl FnMut(Kernel, PassParams, &[Role]) -> Result<(), E>,
) -> Result<(), E> {
    const { assert!(SORT_PASSES.is_multiple_of(2)) }
    let (mut from, mut to) = (order, Role::SpareOrder);
    for digit in 0..SORT_PASSES {
        let shift = digit * DIGIT_BITS;
        let by_run = PassParams { count: runs(count), elements: count, shift, ..PassParams::default() };
        one(Kernel::CountDigits, by_run, &[from, Role::Counters])?;
        let blocks = |(length, base): (u32, u32)| PassParams {
            count: length.div_ceil(BLOCK),
            elements: length,
            base,
            ..PassParams::default()
        };
        // The sum of the last level's only block is asked by none.
        for level in sums(count).filter(|(length, _)| level_above(*length) > 0) {
            one(Kernel::SumBlocks, blocks(level), &[Role::Counters])?;
        }
        for level in sums(count).rev() {
            one(Kernel::ScanBlocks, blocks(level), &[Role::Counters])?;
        }
        one(Kernel::ScatterDigits, by_run, &[Role::Counters, from, to])?;
        (from, to) = (to, from);
    }
    Ok(())
}
