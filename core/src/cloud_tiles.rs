//! The samples of a cloud in tiles of sixteen, as the planes of a pair are held against them: which samples a triangle blocks
//! from one receiver.
//!
//! A plane is placed once a pair, in [`crate::real::Real`], from the middle of the cloud; [`crate::side`] derives how well it is
//! known. Tiles are asked first, sixteen at once, by their boxes: most lie on one side of a plane, and only the others' samples are
//! looked at, sixteen at once too. What is still in doubt is decided in integers.

use glam::IVec3;

use crate::{
    cloud::{CloudMask, MAX_CLOUD, MAX_CLOUD_WORDS, WORD_BITS, blocks},
    cloud_extent::{CloudExtent, Long},
    cloud_pair::{Pair, SampleTest},
    kernel::resolve_cloud::SampleTile,
    lanes::{Lanes, TILE},
    occluder::Occluder,
    precision::PrecisionMode,
    shaft::around,
    side::Planes,
    statistics::Tally,
    view::Offsets,
};

/// Most tiles of a cloud.
const TILES: usize = MAX_CLOUD / TILE;

/// Sixteen tiles' boxes, from the middle of the cloud.
#[derive(Clone, Copy, Debug)]
struct TileBoxes {
    middle: [[f32; TILE]; 3],
    /// Half extents, rounded up.
    half: [[f32; TILE]; 3],
}

/// The samples of a cloud, made once a run.
#[derive(Clone, Debug)]
pub struct CloudTiles<'a> {
    samples: &'a [IVec3],
    extent: CloudExtent,
    offsets: Offsets,
    /// Of a tile, its samples from the middle of the cloud, axis-major. Places without a sample repeat the middle.
    tiles: [[[f32; TILE]; 3]; TILES],
    boxes: [TileBoxes; TILES / TILE],
    /// All samples.
    full: CloudMask,
}

impl<'a> CloudTiles<'a> {
    /// Of samples on the lattice, of which the first [`MAX_CLOUD`] count, in the order of a mask's bits. Sixteen that follow each
    /// other had better lie together.
    pub fn new(samples: &'a [IVec3]) -> Self {
        let samples = samples.get(..MAX_CLOUD).unwrap_or(samples);
        let extent = CloudExtent::of(samples);
        let center = extent.middle();
        let no_box = TileBoxes { middle: [[0.0; TILE]; 3], half: [[0.0; TILE]; 3] };
        let mut cloud = Self {
            samples,
            extent,
            offsets: extent.offsets(),
            tiles: [[[0.0; TILE]; 3]; TILES],
            boxes: [no_box; TILES / TILE],
            full: [0; MAX_CLOUD_WORDS],
        };
        for (t, (of_tile, tile)) in samples.chunks(TILE).zip(&mut cloud.tiles).enumerate() {
            for (lane, sample) in of_tile.iter().enumerate() {
                for (axis, at) in tile.iter_mut().enumerate() {
                    at[lane % TILE] = (sample[axis] - center[axis]) as f32;
                }
                cloud.full[t * TILE / WORD_BITS % MAX_CLOUD_WORDS] |= 1 << ((t * TILE + lane) % WORD_BITS);
            }
            let [low, high] = around(of_tile);
            let (low, high) = ((low - center).as_dvec3(), (high - center).as_dvec3());
            let middle = ((low + high) * 0.5).as_vec3();
            let half = (high - middle.as_dvec3()).max(middle.as_dvec3() - low);
            let boxes = &mut cloud.boxes[t / TILE % (TILES / TILE)];
            for axis in 0..3 {
                boxes.middle[axis][t % TILE] = middle[axis];
                boxes.half[axis][t % TILE] = (half[axis] as f32).next_up();
            }
        }
        cloud
    }

    /// Where the samples lie.
    pub fn extent(&self) -> &CloudExtent {
        &self.extent
    }

    /// The mask in which all samples are blocked.
    pub fn full(&self) -> &CloudMask {
        &self.full
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// True where there are none: of no [`crate::cloud::Cloud`].
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// See [`CloudExtent::occluder`].
    pub fn occluder(&self, corners: [IVec3; 3]) -> Option<Occluder> {
        self.extent.occluder::<Long>(corners)
    }

    /// The tiles as the kernel takes them, as many as there are: [`CloudTiles::len`] sixteenths.
    pub fn sample_tiles(&self) -> impl Iterator<Item = SampleTile> {
        self.samples.chunks(TILE).zip(0..).map(|(of_tile, t): (_, usize)| {
            let mut samples = [self.extent.middle().to_array(); TILE];
            samples.iter_mut().zip(of_tile).for_each(|(place, sample)| *place = sample.to_array());
            let TileBoxes { middle, half } = &self.boxes[t / TILE % (TILES / TILE)];
            let of = |axes: &[[f32; TILE]; 3]| [axes[0][t % TILE], axes[1][t % TILE], axes[2][t % TILE]];
            SampleTile { samples, middle: of(middle), half: of(half) }
        })
    }

    /// Tiles whose boxes may reach to the inner side of all planes in `cuts`, and those that surely lie there; bit t is tile t.
    #[inline(always)]
    fn reached<L: Lanes, const N: usize>(&self, planes: &Planes<N>, cuts: u32) -> (u64, u64) {
        let (mut open, mut within, mut tile) = (0, 0, 0);
        while tile * TILE < self.samples.len() {
            let TileBoxes { middle, half } = &self.boxes[tile / TILE % (TILES / TILE)];
            let mut first = 0;
            while first < TILE {
                let middle = [L::load(&middle[0], first), L::load(&middle[1], first), L::load(&middle[2], first)];
                let half = [L::load(&half[0], first), L::load(&half[1], first), L::load(&half[2], first)];
                let (surely, maybe) = planes.hold_box(cuts, &middle, &half);
                within |= u64::from(L::bits(surely)) << (tile + first);
                open |= u64::from(L::bits(maybe)) << (tile + first);
                first += L::WIDTH;
            }
            tile += TILE;
        }
        (open & tile_bits(self.samples.len()), within)
    }

    /// Samples of a tile that are surely, and those that may be, on the inner side of all planes in `cuts`.
    #[inline(always)]
    fn inside<L: Lanes, const N: usize>(&self, planes: &Planes<N>, cuts: u32, tile: usize) -> (u32, u32) {
        let at = &self.tiles[tile % TILES];
        let (mut sure, mut possible, mut first) = (0, 0, 0);
        while first < TILE {
            let at = [L::load(&at[0], first), L::load(&at[1], first), L::load(&at[2], first)];
            let (surely, maybe) = planes.hold(cuts, &at);
            sure |= L::bits(surely) << first;
            possible |= L::bits(maybe) << first;
            first += L::WIDTH;
        }
        (sure, possible)
    }

    /// Decides the samples in `unsure` of a tile. Out of line: few come here.
    #[inline(never)]
    fn settle(&self, pair: &Pair, tile: usize, mut inside: u32, mut unsure: u32, fallbacks: &mut Tally) -> u32 {
        while unsure != 0 {
            let lane = unsure.trailing_zeros() as usize;
            unsure &= unsure - 1;
            *fallbacks += 1;
            if !self.samples.get(tile * TILE + lane).is_some_and(|&s| blocks(s, pair.receiver, pair.corners)) {
                inside &= !(1 << lane);
            }
        }
        inside
    }
}

impl SampleTest for CloudTiles<'_> {
    #[inline(always)]
    fn mark<L: Lanes, P: PrecisionMode, const N: usize>(
        &self,
        pair: &Pair,
        mask: &mut CloudMask,
        fallbacks: &mut Tally,
    ) -> u32 {
        let planes = pair.planes::<L, P, N>(&self.offsets);
        let (mut open, within) = self.reached::<L, N>(&planes, pair.cuts);
        let mut found = 0;
        while open != 0 {
            let tile = open.trailing_zeros() as usize % TILES;
            open &= open - 1;
            let (word, shift) = (tile * TILE / WORD_BITS % MAX_CLOUD_WORDS, tile * TILE % WORD_BITS);
            let mut inside = (self.full[word] & !mask[word]) >> shift & 0xffff;
            if within >> tile & 1 == 0 && inside != 0 {
                let (sure, possible) = self.inside::<L, N>(&planes, pair.cuts, tile);
                let unsure = inside & possible & !sure;
                inside &= sure | possible;
                if !P::CERTIFIED {
                    inside &= sure;
                } else if unsure != 0 {
                    inside = self.settle(pair, tile, inside, unsure, fallbacks);
                }
            }
            found += inside.count_ones();
            mask[word] |= inside << shift;
        }
        found
    }
}

/// A bit for every tile of `samples` samples.
#[inline(always)]
fn tile_bits(samples: usize) -> u64 {
    let tiles = samples.div_ceil(TILE);
    if tiles >= TILES { u64::MAX } else { (1 << tiles) - 1 }
}

// A mask's bits follow each other tile by tile, two to a word.
const _: () = assert!(WORD_BITS == 2 * TILE && TILES == 64);
