//! Stage `resolve_cloud`: which samples of a cloud sixteen receivers do not see.

use glam::IVec3;

use crate::{
    cloud::{CloudMask, MAX_CLOUD_WORDS},
    cloud_pair::{Pair, Reach, SampleTest},
    cloud_tiles::CloudTiles,
    edge_plane::ReceiverTile,
    hierarchy::{Levels, Root, Walk},
    lanes::{Lanes, TILE},
    occluder::Occluder,
    precision::PrecisionMode,
    proj4::NODE,
    shaft::{BoxTile, Shaft},
    side::Sides,
    statistics::{Counts, Tally},
    view::Offsets,
};

/// The triangles of a scene, and the light.
#[derive(Debug)]
pub struct CloudScene<'a, T> {
    /// The light.
    pub cloud: &'a CloudTiles<'a>,
    /// What tells blocked samples from others: the light itself, or a table of it.
    pub test: &'a T,
    /// Layout of `nodes`.
    pub levels: &'a Levels,
    /// Boxes of all levels; level 0 goes with `occluders`.
    pub nodes: &'a [BoxTile],
    /// Triangles, in the order of level 0, as [`CloudTiles::occluder`] orients them.
    pub occluders: &'a [Occluder],
}

/// Sixteen receivers.
#[derive(Clone, Debug)]
pub struct CloudGroup {
    receivers: ReceiverTile,
    low: IVec3,
    high: IVec3,
    active: u32,
    /// Of each lane.
    pub masks: [CloudMask; TILE],
    /// Samples of each lane that are not blocked; 0 in lanes without a receiver.
    pub lit: [u32; TILE],
    /// Sums over the group.
    pub counts: Counts,
}

impl Default for CloudGroup {
    fn default() -> Self {
        Self {
            receivers: ReceiverTile::EMPTY,
            low: IVec3::MAX,
            high: IVec3::MIN,
            active: 0,
            masks: [[0; MAX_CLOUD_WORDS]; TILE],
            lit: [0; TILE],
            counts: Counts::default(),
        }
    }
}

impl CloudGroup {
    /// Puts a receiver into a lane, `lane < 16`, before a light of `samples` samples.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, point: IVec3, samples: usize) {
        self.receivers.set(lane, point);
        (self.low, self.high) = (self.low.min(point), self.high.max(point));
        self.active |= 1 << (lane % TILE);
        self.lit[lane % TILE] = samples as u32;
    }

    /// Adds what a triangle blocks from the receivers in `kept`; `N` as in [`SampleTest::mark`].
    #[inline(always)]
    fn mark<L: Lanes, P: PrecisionMode, T: SampleTest, const N: usize>(
        &mut self,
        scene: &CloudScene<'_, T>,
        occluder: &Occluder,
        reach: &Reach,
        negative: u32,
    ) {
        let mut kept = reach.alive;
        self.counts.pairs_kept += kept.count_ones() as Tally;
        while kept != 0 {
            let lane = kept.trailing_zeros() as usize % TILE;
            kept &= kept - 1;
            let cuts = reach.cuts_of(lane, occluder.is_mixed());
            let found = if cuts == 0 {
                self.masks[lane] = *scene.cloud.full();
                self.lit[lane]
            } else {
                let flipped = negative >> lane & 1 == 1;
                let pair = Pair { receiver: self.receivers.point(lane), corners: occluder.corners(), flipped, cuts };
                scene.test.mark::<L, P, N>(&pair, &mut self.masks[lane], &mut self.counts.fallbacks)
            };
            self.counts.pairs_relevant += (found > 0) as Tally;
            self.lit[lane] = self.lit[lane].saturating_sub(found);
            if self.lit[lane] == 0 {
                self.active &= !(1 << lane);
            }
        }
    }
}

/// Fills the masks of a group. A receiver of which all samples are blocked drops out, and the walk ends with the last of them.
#[inline(always)]
pub fn resolve_cloud<L: Lanes, P: PrecisionMode, T: SampleTest>(scene: &CloudScene<'_, T>, group: &mut CloudGroup) {
    if group.active == 0 {
        return;
    }
    let shaft = Shaft::between([group.low, group.high], scene.cloud.extent().bounds());
    let mut walk = Walk::new::<L>(scene.levels, Root::top(scene.levels), scene.nodes, &shaft);
    let offsets = Offsets::new(&group.receivers, group.active);
    while let Some((tile, mut bits)) = walk.next::<L>(scene.nodes, &shaft) {
        while bits != 0 {
            let entry = bits.trailing_zeros() as usize;
            bits &= bits.wrapping_sub(1);
            let Some(occluder) = scene.occluders.get(tile as usize * NODE + entry) else { continue };
            group.counts.pairs_tested += group.active.count_ones() as Tally;
            let (receivers, fallbacks) = (&group.receivers, &mut group.counts.fallbacks);
            let sides = Sides::seen_from::<L, P>(&offsets, receivers, occluder, group.active, fallbacks);
            let reach = Reach::of::<L, P>(scene.cloud.extent(), receivers, occluder, sides);
            if occluder.is_mixed() {
                group.mark::<L, P, T, 4>(scene, occluder, &reach, sides.negative);
            } else {
                group.mark::<L, P, T, 3>(scene, occluder, &reach, 0);
            }
            if group.active == 0 {
                return;
            }
        }
    }
}
