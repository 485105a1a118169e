//! The samples of a cloud in tiles of sixteen, as the planes of a pair are held against them: which samples a triangle blocks
//! from one receiver.
//!
//! A plane is placed once a pair, in [`crate::real::Real`], from the middle of the cloud; [`crate::side`] derives how well it is
//! known. Tiles are asked first, sixteen at once, by their boxes: most lie on one side of a plane, and only the others' samples are
//! looked at, sixteen at once too. What is still in doubt is decided in integers.
//!
//! # Error bound of a tile's box
//! At the box' middle, which is a float, the value is known to within `doubt`, as that of any sample. Over the box it changes
//! by `|n|·h`, of which five roundoffs are lost, and the sum of both loses one more: less than `doubt` each, since h is
//! no larger than the limit of all samples. So `3·doubt` is enough.

use glam::{DVec3, IVec3, Vec3};

use crate::{
    cloud::{CloudMask, MAX_CLOUD, MAX_CLOUD_WORDS, WORD_BITS, blocks},
    cloud_pair::{Pair, SampleTest},
    edge_plane::{cross_magnitudes, float},
    exact::{self, Wide, WideInt},
    lanes::{Lanes, TILE},
    occluder::{Facing, Occluder},
    precision::PrecisionMode,
    real::Real,
    side::Planes,
    statistics::Tally,
    view::Offsets,
};

/// Most tiles of a cloud.
const TILES: usize = MAX_CLOUD / TILE;

/// Bounds of a box' values, in units of a sample's.
const BOX_DOUBT: f32 = 3.0;

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
    low: IVec3,
    high: IVec3,
    /// All samples lie so near the middle; rounded up.
    radius: f32,
    /// Of a tile, its samples from the middle of the cloud. Places without a sample repeat the middle.
    tiles: [Offsets; TILES],
    boxes: [TileBoxes; TILES / TILE],
    /// All samples.
    full: CloudMask,
}

impl<'a> CloudTiles<'a> {
    /// Of samples on the lattice, of which the first [`MAX_CLOUD`] count, in the order of a mask's bits. Sixteen that follow each
    /// other had better lie together.
    pub fn new(samples: &'a [IVec3]) -> Self {
        let samples = samples.get(..MAX_CLOUD).unwrap_or(samples);
        let (low, high) = around(samples);
        let center = low + (high - low) / 2;
        let limit = float((high - center).max(center - low));
        let nothing = Offsets { base: center, at: [[0.0; TILE]; 3], limit };
        let no_box = TileBoxes { middle: [[0.0; TILE]; 3], half: [[0.0; TILE]; 3] };
        let mut cloud = Self {
            samples,
            low,
            high,
            radius: 0.0,
            tiles: [nothing; TILES],
            boxes: [no_box; TILES / TILE],
            full: [0; MAX_CLOUD_WORDS],
        };
        for (t, (of_tile, tile)) in samples.chunks(TILE).zip(&mut cloud.tiles).enumerate() {
            for (lane, sample) in of_tile.iter().enumerate() {
                let away = (sample - center).as_dvec3().length() as f32;
                cloud.radius = Lanes::max(cloud.radius, away.next_up());
                for (axis, at) in tile.at.iter_mut().enumerate() {
                    at[lane % TILE] = (sample[axis] - center[axis]) as f32;
                }
                cloud.full[t * TILE / WORD_BITS % MAX_CLOUD_WORDS] |= 1 << ((t * TILE + lane) % WORD_BITS);
            }
            let (low, high) = around(of_tile);
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

    /// The box around all samples.
    pub fn bounds(&self) -> [IVec3; 2] {
        [self.low, self.high]
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

    /// The middle of the samples' box.
    #[inline(always)]
    pub(crate) fn middle(&self) -> IVec3 {
        self.tiles[0].base
    }

    /// The half extents of the samples' box, rounded to the nearest float: whoever compares with them has to count that.
    #[inline(always)]
    pub(crate) fn half(&self) -> Vec3 {
        self.tiles[0].limit
    }

    /// How far samples may lie from the middle.
    #[inline(always)]
    pub(crate) fn radius(&self) -> f32 {
        self.radius
    }

    /// The triangle, with its corners in such an order that the samples lie on the positive side of its plane, unless that
    /// meets their box. `None` where it blocks nothing.
    pub fn occluder(&self, corners: [IVec3; 3]) -> Option<Occluder> {
        let [a, b, c] = corners;
        let (center, half) = (self.middle(), self.half());
        let (e, f, d) = (b - a, c - a, center - a);
        let normal = <f64 as Real>::cross(e, f);
        let at = <f64 as Real>::dot(&normal, d);
        // From the integers: a half extent that is rounded down would leave samples beyond it.
        let exact_half = (self.high - center).max(center - self.low).as_dvec3();
        let spread = DVec3::from_array(normal).abs().dot(exact_half);
        // Twice the error of the terms: for their sum, and for the bound's own arithmetic.
        let size = cross_magnitudes(float(e), float(f)).dot(float(d).abs() + half);
        let doubt = f64::from(2.0 * <f64 as Real>::SIDE_ERROR * size);
        let facing = if at - spread > doubt {
            Facing::Front
        } else if at + spread < -doubt {
            Facing::Back
        } else if exact::cross::<Wide>(e, f).components().iter().all(|n| n.sign() == 0) {
            Facing::Nothing
        } else {
            Facing::Mixed
        };
        facing.occluder(corners)
    }

    /// Tiles whose boxes may reach to the inner side of all planes in `cuts`, and those that surely lie there; bit t is tile t.
    #[inline(always)]
    fn reached<L: Lanes, const N: usize>(&self, planes: &Planes<N>, cuts: u32) -> (u64, u64) {
        let (mut open, mut within, mut tile) = (0, 0, 0);
        while tile * TILE < self.samples.len() {
            let boxes = &self.boxes[tile / TILE % (TILES / TILE)];
            let mut first = 0;
            while first < TILE {
                let (mut least, mut most) = (L::splat(f32::MAX), L::splat(f32::MAX));
                let mut k = 0;
                while k < N {
                    if cuts >> k & 1 == 1 {
                        let (mut value, mut spread, mut axis) = (L::splat(planes.at_base[k]), L::splat(0.0), 0);
                        while axis < 3 {
                            let normal = planes.normals[axis][k];
                            value = L::load(&boxes.middle[axis], first).mul_add(L::splat(-normal), value);
                            let half = L::load(&boxes.half[axis], first);
                            spread = half.mul_add(L::splat(Lanes::abs(normal)), spread);
                            axis += 1;
                        }
                        let doubt = L::splat(BOX_DOUBT * planes.doubt[k]);
                        most = most.min(value.add(spread).add(doubt));
                        least = least.min(value.sub(spread).sub(doubt));
                    }
                    k += 1;
                }
                open |= u64::from(L::bits(most.ge(L::splat(0.0)))) << (tile + first);
                within |= u64::from(L::bits(least.ge(L::splat(f32::MIN_POSITIVE)))) << (tile + first);
                first += L::WIDTH;
            }
            tile += TILE;
        }
        (open & tile_bits(self.samples.len()), within)
    }

    /// Samples of a tile that are surely, and those that may be, on the inner side of all planes in `cuts`. A sum of two
    /// floats has the sign of the exact sum, so that it tells which is larger.
    #[inline(always)]
    fn inside<L: Lanes, const N: usize>(&self, planes: &Planes<N>, cuts: u32, tile: usize) -> (u32, u32) {
        let at = &self.tiles[tile % TILES].at;
        let (mut sure, mut possible, mut first) = (0, 0, 0);
        while first < TILE {
            let [x, y, z] = [L::load(&at[0], first), L::load(&at[1], first), L::load(&at[2], first)];
            let (mut least, mut most) = (L::splat(f32::MAX), L::splat(f32::MAX));
            let mut k = 0;
            while k < N {
                if cuts >> k & 1 == 1 {
                    let value = x.mul_add(L::splat(-planes.normals[0][k]), L::splat(planes.at_base[k]));
                    let value = y.mul_add(L::splat(-planes.normals[1][k]), value);
                    let value = z.mul_add(L::splat(-planes.normals[2][k]), value);
                    let doubt = L::splat(planes.doubt[k]);
                    least = least.min(value.sub(doubt));
                    most = most.min(value.add(doubt));
                }
                k += 1;
            }
            sure |= L::bits(least.ge(L::splat(f32::MIN_POSITIVE))) << first;
            possible |= L::bits(most.ge(L::splat(0.0))) << first;
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
        let planes = pair.planes::<L, P, N>(&self.tiles[0]);
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

/// The box around points; of none, a point.
fn around(points: &[IVec3]) -> (IVec3, IVec3) {
    let first = points.first().copied().unwrap_or(IVec3::ZERO);
    points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
}

// A mask's bits follow each other tile by tile, two to a word.
const _: () = assert!(WORD_BITS == 2 * TILE && TILES == 64);
