//! How triangles and receivers meet before a cloud of samples: a triangle that blocks anything from a group of receivers
//! reaches into the shaft between the group's box R and the cloud's box B.
//!
//! Seed: the influence regions of Sintorn, Eisemann and Assarsson 2008, section 4.1, there rasterised. Here the region is turned
//! round: the convex hull of R and B holds every segment between them, and a hierarchy of boxes is asked what meets it. All
//! faces of the hull of two boxes are parallel to an axis (Haines and Wallace 1991), so it is the box of both, cut by tangents
//! of R and B as seen along each axis. Where the boxes overlap, or one lies beside the other, fewer tangents are left, or none;
//! nothing is a special case.
//!
//! # Tangents
//! Seen along an axis, in the quadrant of directions `(s_u, s_v)`, let r and b be the corners of R and B farthest that way, and
//! `d = b − r`. The hull has an edge from r to b iff `s_u·d_u` and `s_v·d_v` have opposite strict signs; its outer normal is
//! `N = (s_u·|d_v|, s_v·|d_u|)`. A box lies outside iff the least of `N·x` over it, taken at the corner
//! farthest against `(s_u, s_v)`, is above `N·r`.
//!
//! # Error bound
//! Corners are taken from the group's lowest point o, exactly, and rounded: `N_u·(x − o)_u` has a roundoff of the
//! normal, one of the difference and one of the product, and the sum one more: four, relative to
//! `M = |N_u·(x − o)_u| + |N_v·(x − o)_v|`; subtracting the bound takes a fifth. Eight are allowed, three of them
//! for M itself and second-order terms. `N·(r − o)` is exact (below 2^61), and rounded up.

use glam::IVec3;

use crate::{
    hierarchy::Question,
    lanes::{Lanes, TILE},
    proj4::NODE,
    snap::LIMIT,
};

/// Most tangents: one for each pair of axes and quadrant.
const TANGENTS: usize = 12;

/// Roundoffs allowed for, relative to M.
const ERRORS: f32 = 8.0;

/// Boxes of the entries of a node, lattice: `low[axis][entry]`, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(64))]
pub struct BoxTile {
    low: [[i32; NODE]; 3],
    high: [[i32; NODE]; 3],
}

impl BoxTile {
    /// Sixteen entries that do not exist: they meet no shaft.
    pub const NOTHING: Self = Self { low: [[LIMIT; NODE]; 3], high: [[-LIMIT; NODE]; 3] };

    /// Sets one entry, between two corners on the lattice; `entry < NODE`.
    #[inline(always)]
    pub fn set(&mut self, entry: usize, low: IVec3, high: IVec3) {
        let e = entry % NODE;
        (self.low[0][e], self.low[1][e], self.low[2][e]) = (low.x, low.y, low.z);
        (self.high[0][e], self.high[1][e], self.high[2][e]) = (high.x, high.y, high.z);
    }

    /// The box around all entries, as an entry of the level above.
    pub fn around(&self) -> [IVec3; 2] {
        let (mut low, mut high) = (IVec3::splat(LIMIT), IVec3::splat(-LIMIT));
        for e in 0..NODE {
            low = low.min(IVec3::new(self.low[0][e], self.low[1][e], self.low[2][e]));
            high = high.max(IVec3::new(self.high[0][e], self.high[1][e], self.high[2][e]));
        }
        [low, high]
    }
}

/// Tile `id` of a level, from the tiles of the level below it.
pub fn build_box_level(id: usize, below: &[BoxTile]) -> BoxTile {
    let mut tile = BoxTile::NOTHING;
    for entry in 0..NODE {
        if let Some(child) = below.get(id * NODE + entry) {
            let [low, high] = child.around();
            tile.set(entry, low, high);
        }
    }
    tile
}

/// One tangent, seen along the third axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tangent {
    /// Two of 0, 1, 2.
    axes: [usize; 2],
    /// N, squared lattice units; the sign of a component is the quadrant's.
    normal: [f32; 2],
    /// `N·(r − o)`, rounded up.
    limit: f32,
}

/// The convex hull of a group's box and a cloud's, or a little more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaft {
    /// o
    base: IVec3,
    low: IVec3,
    high: IVec3,
    tangents: [Tangent; TANGENTS],
    count: usize,
}

impl Shaft {
    /// Between two boxes on the lattice, by their lowest and highest corners.
    pub fn between(receivers: [IVec3; 2], cloud: [IVec3; 2]) -> Self {
        let none = Tangent { axes: [0; 2], normal: [0.0; 2], limit: 0.0 };
        let mut shaft = Self {
            base: receivers[0],
            low: receivers[0].min(cloud[0]),
            high: receivers[1].max(cloud[1]),
            tangents: [none; TANGENTS],
            count: 0,
        };
        for axes in [[0, 1], [1, 2], [2, 0]] {
            for quadrant in [[0, 0], [0, 1], [1, 0], [1, 1]] {
                shaft.add(axes, quadrant, receivers, cloud);
            }
        }
        shaft
    }

    /// Adds the tangent of a quadrant (0 is negative), where there is one.
    fn add(&mut self, axes: [usize; 2], quadrant: [usize; 2], receivers: [IVec3; 2], cloud: [IVec3; 2]) {
        let sign = quadrant.map(|high| if high == 1 { 1_i64 } else { -1 });
        let corner = |of: &[IVec3; 2], k: usize| of[quadrant[k] % 2].to_array()[axes[k] % 3];
        let r = [corner(&receivers, 0), corner(&receivers, 1)];
        let d = [0, 1].map(|k| i64::from(corner(&cloud, k)) - i64::from(r[k]));
        if d[0].signum() * sign[0] * d[1].signum() * sign[1] >= 0 {
            return;
        }
        let normal = [sign[0] * d[1].abs(), sign[1] * d[0].abs()];
        let base = self.base.to_array();
        let limit: i64 = (0..2).map(|k| normal[k] * (i64::from(r[k]) - i64::from(base[axes[k] % 3]))).sum();
        if let Some(place) = self.tangents.get_mut(self.count) {
            *place = Tangent { axes, normal: normal.map(|n| n as f32), limit: (limit as f32).next_up() };
            self.count += 1;
        }
    }

    /// Lanes whose box is not certainly beyond a tangent.
    #[inline(always)]
    fn within<L: Lanes>(&self, tangent: &Tangent, tile: &BoxTile, first: usize) -> L::Mask {
        let (mut side, mut size, mut k) = (L::splat(0.0), L::splat(0.0), 0);
        while k < 2 {
            let (axis, normal) = (tangent.axes[k] % 3, tangent.normal[k]);
            let nearest = if normal > 0.0 { &tile.low[axis] } else { &tile.high[axis] };
            let x = L::difference(L::load_ints(nearest, first), L::splat_int(self.base[axis]));
            side = x.mul_add(L::splat(normal), side);
            size = x.abs().mul_add(L::splat(normal.abs()), size);
            k += 1;
        }
        L::splat(tangent.limit).ge(size.mul_add(L::splat(-ERRORS * L::ROUNDOFF), side))
    }
}

impl Question for Shaft {
    type Tile = BoxTile;

    #[inline(always)]
    fn open<L: Lanes>(&self, tile: &BoxTile) -> u32 {
        let (mut bits, mut first) = (0, 0);
        while first < TILE {
            let (mut outside, mut axis) = (0, 0);
            while axis < 3 {
                outside |= L::less(L::splat_int(self.high[axis]), L::load_ints(&tile.low[axis], first));
                outside |= L::less(L::load_ints(&tile.high[axis], first), L::splat_int(self.low[axis]));
                axis += 1;
            }
            let all = (1 << L::WIDTH) - 1;
            let (mut inside, mut k) = (!outside & all, 0);
            while k < self.count % (TANGENTS + 1) && inside != 0 {
                inside &= L::bits(self.within::<L>(&self.tangents[k], tile, first));
                k += 1;
            }
            bits |= inside << first;
            first += L::WIDTH;
        }
        bits
    }
}
