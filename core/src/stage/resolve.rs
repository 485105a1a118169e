//! Stage `resolve`: the masks of a group of sixteen receivers.
//!
//! Seed: Wang et al. 2016, Algorithm 3. Lines 2 to 4 (the cells' lists) become a walk over the hierarchy for the whole
//! group; line 5 is the same test; lines 7 to 17 are `outline` where all corners rise towards the light, else `side` and
//! `edge_plane`; then `row_mask`, and `doubt` where a float cannot tell. A receiver whose mask is full drops out, and
//! the walk ends with the last of them.

// On a GPU no structure holds references: what goes together is handed on one by one.
#![allow(clippy::too_many_arguments)]

#[cfg(not(target_arch = "spirv"))]
use core::marker::PhantomData;

#[cfg(not(target_arch = "spirv"))]
use crate::lanes::Apart;
use crate::{
    bit_mask,
    doubt::PairIntegers,
    edge_plane::{LightGrid, Lines, PairPlanes, ReceiverTile},
    exact::{self, Wide},
    hierarchy::{Levels, Root},
    jitter::{Regular, Samples},
    jittered_rows::{self, Limits},
    lanes::{Lanes, TILE},
    light::LatticeLight,
    mask_word::MaskWord,
    occluder::Occluder,
    outline::{Outlines, Seen},
    precision::PrecisionMode,
    proj4::{KeyTile, Keys, NeedTile},
    real::Real,
    row_mask::{self, Ends, MASK_ROWS, MaskRows},
    side::Sides,
    stage::kept_pairs::KeptPairs,
    statistics::{Counts, Tally},
    view::View,
};

/// The triangles of a scene as one light sees them.
#[derive(Clone, Copy, Debug)]
pub struct Occlusion<'a> {
    /// The light.
    pub grid: &'a LightGrid,
    /// Layout of `nodes`.
    pub levels: &'a Levels,
    /// Keys of all levels; level 0 goes with `occluders`.
    pub nodes: &'a [KeyTile],
    /// Triangles, in the order of level 0.
    pub occluders: &'a [Occluder],
}

/// Sixteen receivers and their masks.
#[derive(Clone, Debug)]
pub struct Group<W> {
    /// Lattice positions.
    pub receivers: ReceiverTile,
    /// What each asks of the full-coverage test.
    pub needs: NeedTile,
    /// Bit l: lane l holds a receiver whose mask is not full yet.
    pub active: u32,
    /// Bit l: lane l's mask has changed since it was last compared with a full one.
    pub touched: u32,
    /// Bit l: lane l's mask may have a bit set.
    pub shadowed: u32,
    /// Whether a sample on an edge that two triangles share belongs to one of them, not to both: where they are counted.
    pub edges_once: bool,
    /// Their masks. Rows beyond the light's hold full words.
    pub masks: [MaskRows<W>; TILE],
    /// Triangles that block at least one sample of each; of a receiver that became full, those met until then.
    pub relevant: [u32; TILE],
    /// Sums over the group.
    pub counts: Counts,
}

impl<W: MaskWord> Group<W> {
    /// A group without receivers, for a light with `rows` rows.
    pub fn empty(rows: u32) -> Self {
        let mut mask = [W::below(W::BITS); MASK_ROWS];
        let mut row = 0;
        while row < rows as usize && row < MASK_ROWS {
            mask[row] = W::EMPTY;
            row += 1;
        }
        Self {
            receivers: ReceiverTile::EMPTY,
            needs: NeedTile::NOTHING,
            active: 0,
            touched: 0,
            shadowed: 0,
            edges_once: false,
            masks: [mask; TILE],
            relevant: [0; TILE],
            counts: Counts::default(),
        }
    }
}

impl<W: MaskWord> Group<W> {
    /// Takes all receivers out. Only masks that have a bit are written.
    #[inline(always)]
    pub fn clear(&mut self, rows: u32) {
        let mut left = self.shadowed;
        while left != 0 {
            let mask = &mut self.masks[left.trailing_zeros() as usize % TILE];
            left &= left - 1;
            let mut row = 0;
            while row < rows as usize && row < MASK_ROWS {
                mask[row] = W::EMPTY;
                row += 1;
            }
        }
        self.receivers = ReceiverTile::EMPTY;
        self.needs = NeedTile::NOTHING;
        (self.active, self.touched, self.shadowed) = (0, 0, 0);
        self.relevant = [0; TILE];
        self.counts = Counts::default();
    }

    /// Puts a receiver into a lane. `lane < TILE`.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, point: glam::IVec3, keys: &Keys) {
        let lane = lane % TILE;
        self.receivers.set(lane, point);
        self.needs.set(lane, keys);
        self.active |= 1 << lane;
    }

    /// Puts a receiver behind the light into a lane: its mask is full at once. `lane < TILE`.
    #[inline(always)]
    pub fn set_behind(&mut self, lane: usize, light: &LatticeLight) {
        self.masks[lane % TILE] = [W::below(light.columns); MASK_ROWS];
        self.shadowed |= 1 << (lane % TILE);
    }
}

impl<W> Group<W> {
    /// Adds up what [`Group::tell`] was told.
    #[inline(always)]
    pub(crate) fn sum_relevant(&mut self) {
        let (mut sum, mut lane) = (0, 0);
        while lane < TILE {
            sum += Tally::from(self.relevant[lane]);
            lane += 1;
        }
        self.counts.pairs_relevant = sum;
    }

    /// Books one pair. `lane < TILE`.
    #[inline(always)]
    pub(crate) fn tell(&mut self, lane: usize, relevant: bool) {
        self.relevant[lane % TILE] += relevant as u32;
        self.touched |= (relevant as u32) << lane;
        self.shadowed |= (relevant as u32) << lane;
    }
}

/// Fills the masks of a group.
#[inline(always)]
pub fn resolve<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
    scene: &Occlusion<'_>,
    samples: &S,
    group: &mut Group<W>,
) {
    let Occlusion { grid, levels, nodes, occluders } = scene;
    resolve_among::<L, W, P, S>(grid, samples, levels, Root::top(levels), nodes, occluders, group);
}

/// As [`resolve`], with the triangles below `root`. (On a GPU no structure holds slices.)
#[inline(always)]
pub fn resolve_among<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
    grid: &LightGrid,
    samples: &S,
    levels: &Levels,
    root: Root,
    nodes: &[KeyTile],
    occluders: &[Occluder],
    group: &mut Group<W>,
) {
    if group.active != 0 {
        descend::<L, W, P, S>(grid, samples, levels, root, nodes, occluders, group);
    }
    group.sum_relevant();
}

/// Walks the hierarchy until no node is left, or no receiver.
#[inline(always)]
pub(crate) fn descend<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
    grid: &LightGrid,
    samples: &S,
    levels: &Levels,
    root: Root,
    nodes: &[KeyTile],
    occluders: &[Occluder],
    group: &mut Group<W>,
) {
    let mut pairs = KeptPairs::new::<L, W>(levels, root, nodes, group);
    if !pairs.is_open() {
        return;
    }
    let mut meeting = Meeting::<L::Long>::new::<L, W, P>(grid, group);
    while let Some(tile) = pairs.next_tile::<L, W>(grid.light.columns, nodes, group) {
        if tile >= nodes.len() {
            return;
        }
        let keys = &nodes[tile];
        while let Some((place, kept)) = pairs.next::<L, W>(keys, group) {
            if place >= occluders.len() {
                return;
            }
            meeting.meet::<L, W, P, S>(grid, samples, &occluders[place], kept, group);
        }
    }
}

/// Receivers whose mask is full take no further part. Looked at once a tile of triangles: it costs as much as a pair.
#[inline(always)]
pub(crate) fn drop_full<W: MaskWord>(columns: u32, group: &mut Group<W>) {
    let mut touched = core::mem::take(&mut group.touched) & group.active;
    while touched != 0 {
        let lane = touched.trailing_zeros() as usize % TILE;
        touched &= touched - 1;
        if row_mask::is_full(&group.masks[lane], columns) {
            group.active &= !(1 << lane);
        }
    }
}

/// What one group needs to meet triangles: how its receivers see the light, and room for lines.
#[derive(Clone, Debug)]
pub struct Meeting<R> {
    view: View<R>,
    three: Room<3>,
    four: Room<4>,
}

impl<R: Real> Meeting<R> {
    /// Of the receivers that are active now.
    #[inline(always)]
    pub fn new<L: Lanes, W: MaskWord, P: PrecisionMode>(grid: &LightGrid, group: &Group<W>) -> Self {
        let view = View::new::<L, P>(grid, &group.receivers, group.active);
        Self { view, three: Room::EMPTY, four: Room::EMPTY }
    }

    /// One triangle against the receivers in `kept`: rows at once.
    #[inline(always)]
    pub fn meet<L: Lanes<Long = R>, W: MaskWord, P: PrecisionMode, S: Samples>(
        &mut self,
        grid: &LightGrid,
        samples: &S,
        occluder: &Occluder,
        kept: u32,
        group: &mut Group<W>,
    ) {
        #[cfg(not(target_arch = "spirv"))]
        {
            let (Self { view, three, four }, mode) = (self, PhantomData);
            if occluder.is_mixed() {
                let kept = before(&group.receivers, occluder, kept);
                if kept != 0 {
                    L::apart(Met::<L, W, P, S, 4> { room: four, grid, samples, view, occluder, kept, group, mode });
                }
            } else {
                L::apart(Met::<L, W, P, S, 3> { room: three, grid, samples, view, occluder, kept, group, mode });
            }
        }
        #[cfg(target_arch = "spirv")]
        {
            let Self { view, four, .. } = self;
            let kept = before(&group.receivers, occluder, kept);
            if kept != 0 {
                // One code for both: a kernel of half the size.
                four.meet::<L, W, P, S>(grid, samples, view, occluder, occluder.is_mixed(), kept, group);
            }
        }
    }

    /// As [`Meeting::meet`], one light sample at a time, of regular samples. For measurements: the bits are the same.
    #[inline(always)]
    pub fn meet_bits<L: Lanes<Long = R>, W: MaskWord, P: PrecisionMode>(
        &mut self,
        grid: &LightGrid,
        occluder: &Occluder,
        kept: u32,
        group: &mut Group<W>,
    ) {
        let fallbacks = &mut group.counts.fallbacks;
        let sides = Sides::of::<L, P>(&self.view, &group.receivers, occluder, kept, fallbacks);
        let planes = PairPlanes::new(&group.receivers, occluder);
        if occluder.is_mixed() {
            let alive = planes.lines::<L, P, 4>(grid, &group.receivers, sides, true, &mut self.four.lines);
            fill_bits_by_planes::<L, W, P, 4>(grid, occluder, alive, &self.four.lines, group);
        } else {
            let alive = planes.lines::<L, P, 3>(grid, &group.receivers, sides, false, &mut self.three.lines);
            fill_bits_by_planes::<L, W, P, 3>(grid, occluder, alive, &self.three.lines, group);
        }
    }
}

/// The receivers among `kept` from which the triangle may be met: of a one-sided one, those before it, so that only samples behind it are
/// blocked. In integers: few triangles are both one-sided and mixed.
#[inline(always)]
fn before(receivers: &ReceiverTile, occluder: &Occluder, kept: u32) -> u32 {
    if !occluder.is_one_sided() {
        return kept;
    }
    let (mut found, mut left) = (0, kept);
    while left != 0 {
        let lane = left.trailing_zeros();
        left &= left - 1;
        let far = exact::far_side::<Wide>(receivers.point(lane as usize), occluder.corners());
        found |= ((far < 0) as u32) << lane;
    }
    found
}

/// One triangle of `E` planes that meets the receivers in `kept`. All stages, for all kinds of casters, share this code.
#[cfg(not(target_arch = "spirv"))]
struct Met<'a, L: Lanes, W, P, S, const E: usize> {
    room: &'a mut Room<E>,
    grid: &'a LightGrid,
    samples: &'a S,
    view: &'a View<L::Long>,
    occluder: &'a Occluder,
    kept: u32,
    group: &'a mut Group<W>,
    mode: PhantomData<P>,
}

#[cfg(not(target_arch = "spirv"))]
impl<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples, const E: usize> Apart for Met<'_, L, W, P, S, E> {
    type Found = ();

    #[inline(always)]
    fn run(self) {
        let Self { room, grid, samples, view, occluder, kept, group, .. } = self;
        room.meet::<L, W, P, S>(grid, samples, view, occluder, E > 3, kept, group);
    }
}

/// Room for the lines of one triangle with `E` planes. (Here and below all is inlined: a function of its own would be
/// compiled without the instruction set that the executor chose.)
#[derive(Clone, Debug)]
struct Room<const E: usize> {
    outlines: Outlines<E>,
    lines: Lines<E>,
}

impl<const E: usize> Room<E> {
    const EMPTY: Self = Self { outlines: Outlines::EMPTY, lines: Lines::EMPTY };

    /// One triangle against the receivers in `kept`: by its outline, and where that says nothing by its planes. `mixed` tells
    /// whether its own plane is one of them (a constant, where the room has no other use).
    #[inline(always)]
    fn meet<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples>(
        &mut self,
        grid: &LightGrid,
        samples: &S,
        view: &View<L::Long>,
        occluder: &Occluder,
        mixed: bool,
        kept: u32,
        group: &mut Group<W>,
    ) {
        let Self { outlines, lines } = self;
        let planes = 3 + mixed as usize;
        let Seen { mut outlined, unknown } = outlines.outline::<L, P, S>(grid, view, occluder, mixed, kept);
        if TILE > 1 || S::JITTERED {
            // What is taken over below lies in the same room. A single lane is either outlined or unknown.
            fill_outlines::<L, W, P, S, E>(grid, samples, occluder, planes, outlined, outlines, group);
            outlined = 0;
        }
        let mut alive = 0;
        if unknown != 0 {
            let sides = Sides::of::<L, P>(view, &group.receivers, occluder, unknown, &mut group.counts.fallbacks);
            if sides.positive != 0 || (mixed && sides.negative != 0) {
                let found = PairPlanes::new(&group.receivers, occluder);
                alive = found.lines::<L, P, E>(grid, &group.receivers, sides, mixed, lines);
            }
            if alive != 0 && !S::JITTERED {
                outlined |= outlines.take_over::<L, P>(lines, &grid.light, planes, alive);
            }
        }
        if !S::JITTERED && (TILE == 1 || unknown != 0) {
            fill_outlines::<L, W, P, S, E>(grid, samples, occluder, planes, outlined, outlines, group);
        }
        if TILE == 1 || unknown != 0 {
            fill_by_planes::<L, W, P, S, E>(grid, samples, occluder, planes, alive & !outlined, lines, group);
        }
    }
}

/// The receivers in `outlined`, by lines with one band.
#[inline(always)]
fn fill_outlines<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples, const E: usize>(
    grid: &LightGrid,
    samples: &S,
    occluder: &Occluder,
    planes: usize,
    mut outlined: u32,
    outlines: &Outlines<E>,
    group: &mut Group<W>,
) {
    let ends = Ends::new(grid.light.columns);
    while outlined != 0 {
        let lane = outlined.trailing_zeros() as usize % TILE;
        outlined &= outlined - 1;
        if S::JITTERED {
            let rows = [outlines.first[lane] as usize, outlines.count[lane] as usize];
            fill_jittered::<L, W, P, S, _, E>(grid, samples, occluder, planes, lane, rows, outlines, group);
            continue;
        }
        let filled = row_mask::fill_outline::<L, W, P, E>(outlines, planes, lane, &ends, &mut group.masks[lane]);
        let mut relevant = filled.relevant;
        if P::CERTIFIED && filled.is_unsure() {
            let mut pair = PairIntegers::new::<S>(&grid.light, &group.receivers, occluder, lane, group.edges_once);
            relevant |=
                row_mask::settle_outline(outlines, planes, lane, &mut pair, filled.unsure, &mut group.masks[lane]);
            group.counts.fallbacks += pair.fallbacks;
        }
        group.tell(lane, relevant);
    }
}

/// The receivers in `alive`, by the lines of a triangle's planes, each with its own doubt.
#[inline(always)]
fn fill_by_planes<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples, const E: usize>(
    grid: &LightGrid,
    samples: &S,
    occluder: &Occluder,
    planes: usize,
    mut alive: u32,
    lines: &Lines<E>,
    group: &mut Group<W>,
) {
    while alive != 0 {
        let lane = alive.trailing_zeros() as usize % TILE;
        alive &= alive - 1;
        if S::JITTERED {
            let rows = [0, grid.light.rows as usize];
            fill_jittered::<L, W, P, S, _, E>(grid, samples, occluder, planes, lane, rows, lines, group);
            continue;
        }
        let filled = row_mask::fill::<L, W, P, E>(lines, planes, lane, &grid.light, &mut group.masks[lane]);
        let mut relevant = filled.relevant;
        if P::CERTIFIED && filled.is_unsure() {
            let mut pair = PairIntegers::new::<S>(&grid.light, &group.receivers, occluder, lane, group.edges_once);
            relevant |= row_mask::settle_rows(lines, planes, lane, &mut pair, filled.unsure, &mut group.masks[lane]);
            group.counts.fallbacks += pair.fallbacks;
        }
        group.tell(lane, relevant);
    }
}

/// One receiver, in `rows` (the first, and how many), where samples are jittered.
#[inline(always)]
fn fill_jittered<L: Lanes, W: MaskWord, P: PrecisionMode, S: Samples, M: Limits, const E: usize>(
    grid: &LightGrid,
    samples: &S,
    occluder: &Occluder,
    planes: usize,
    lane: usize,
    rows: [usize; 2],
    lines: &M,
    group: &mut Group<W>,
) {
    let columns = grid.light.columns;
    let mask = &mut group.masks[lane % TILE];
    let filled = jittered_rows::fill::<L, W, P, S, M, E>(lines, planes, lane, rows, columns, samples, mask);
    let mut relevant = filled.relevant;
    if P::CERTIFIED && filled.is_unsure() {
        let mut pair = PairIntegers::new::<S>(&grid.light, &group.receivers, occluder, lane, group.edges_once);
        let unsure = filled.unsure;
        relevant |= jittered_rows::settle(lines, planes, lane, rows[0], unsure, columns, samples, &mut pair, mask);
        group.counts.fallbacks += pair.fallbacks;
    }
    group.tell(lane, relevant);
}

/// As [`fill_by_planes`], one light sample at a time.
#[inline(always)]
fn fill_bits_by_planes<L: Lanes, W: MaskWord, P: PrecisionMode, const E: usize>(
    grid: &LightGrid,
    occluder: &Occluder,
    mut alive: u32,
    lines: &Lines<E>,
    group: &mut Group<W>,
) {
    while alive != 0 {
        let lane = alive.trailing_zeros() as usize % TILE;
        alive &= alive - 1;
        let mut pair = PairIntegers::new::<Regular>(&grid.light, &group.receivers, occluder, lane, false);
        let relevant = bit_mask::fill_bits::<L, W, P, E>(lines, lane, &mut pair, &mut group.masks[lane]);
        group.counts.fallbacks += pair.fallbacks;
        group.tell(lane, relevant);
    }
}
