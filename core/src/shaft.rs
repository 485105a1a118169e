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
    exact::{Wide, WideInt},
    hierarchy::Question,
    lanes::Lanes,
    proj4::NODE,
    snap::LIMIT,
};

/// Most tangents: one for each pair of axes and quadrant.
const TANGENTS: usize = 12;

/// Roundoffs allowed for, relative to M.
const ERRORS: f32 = 8.0;

/// Boxes of the entries of a node, lattice: `low[axis][entry]`, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[cfg_attr(not(target_arch = "spirv"), repr(C, align(64)))]
#[cfg_attr(target_arch = "spirv", repr(C))]
pub struct BoxTile {
    low: [[i32; NODE]; 3],
    high: [[i32; NODE]; 3],
}

impl BoxTile {
    /// Corners of an entry that does not exist.
    pub const NO_ENTRY: [IVec3; 2] = [IVec3::splat(LIMIT), IVec3::splat(-LIMIT)];

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
        let [mut low, mut high] = Self::NO_ENTRY;
        let mut e = 0;
        while e < NODE {
            low = low.min(IVec3::new(self.low[0][e], self.low[1][e], self.low[2][e]));
            high = high.max(IVec3::new(self.high[0][e], self.high[1][e], self.high[2][e]));
            e += 1;
        }
        [low, high]
    }
}

/// The box around a triangle, between its lowest and highest corners.
#[inline(always)]
pub fn box_of([a, b, c]: [IVec3; 3]) -> [IVec3; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// The box around points; of none, a point.
#[cfg(not(target_arch = "spirv"))]
pub fn around(points: &[IVec3]) -> [IVec3; 2] {
    let first = points.first().copied().unwrap_or(IVec3::ZERO);
    points.iter().fold([first, first], |[low, high], &p| [low.min(p), high.max(p)])
}

/// Whether two boxes have a point in common.
#[inline(always)]
pub fn meet([low, high]: [IVec3; 2], [from, to]: [IVec3; 2]) -> bool {
    low.x <= to.x && low.y <= to.y && low.z <= to.z && from.x <= high.x && from.y <= high.y && from.z <= high.z
}

/// Tile `id` of a level, from the tiles of the level below it.
#[cfg(not(target_arch = "spirv"))]
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
    base: [i32; 3],
    low: [i32; 3],
    high: [i32; 3],
    tangents: [Tangent; TANGENTS],
    count: usize,
}

impl Shaft {
    /// Between two boxes on the lattice, by their lowest and highest corners. On a GPU that of the receivers is a point.
    #[inline(always)]
    pub fn between(receivers: [IVec3; 2], cloud: [IVec3; 2]) -> Self {
        let none = Tangent { axes: [0; 2], normal: [0.0; 2], limit: 0.0 };
        let mut shaft = Self {
            base: receivers[0].to_array(),
            low: receivers[0].min(cloud[0]).to_array(),
            high: receivers[1].max(cloud[1]).to_array(),
            tangents: [none; TANGENTS],
            count: 0,
        };
        let receivers = [receivers[0].to_array(), receivers[1].to_array()];
        let cloud = [cloud[0].to_array(), cloud[1].to_array()];
        let mut k = 0;
        while k < TANGENTS {
            // Of each pair of axes, four quadrants: 0 is negative.
            let axis = k / 4;
            shaft.add([axis, (axis + 1) % 3], [k / 2 % 2, k % 2], &receivers, &cloud);
            k += 1;
        }
        shaft
    }

    /// Adds the tangent of a quadrant, where there is one.
    #[inline(always)]
    fn add(&mut self, axes: [usize; 2], quadrant: [usize; 2], receivers: &[[i32; 3]; 2], cloud: &[[i32; 3]; 2]) {
        let (r, normal) = edge(axes, quadrant, receivers, cloud);
        if normal[0] == 0 {
            return;
        }
        let [u, v] = [axes[0] % 3, axes[1] % 3];
        let limit = limit(normal, [r[0] - receivers[0][u], r[1] - receivers[0][v]]);
        let place = self.count % TANGENTS;
        self.tangents[place] = Tangent { axes: [u, v], normal: [normal[0] as f32, normal[1] as f32], limit };
        self.count += 1;
    }

    /// Lanes whose box is not certainly beyond a tangent.
    #[inline(always)]
    fn within<L: Lanes>(&self, tangent: &Tangent, tile: &BoxTile, first: usize) -> L::Mask {
        let zero = L::splat(0.0);
        let (side, size) = self.term::<L>(tangent, 0, tile, first, (zero, zero));
        let (side, size) = self.term::<L>(tangent, 1, tile, first, (side, size));
        L::splat(tangent.limit).ge(size.mul_add(L::splat(-ERRORS * L::ROUNDOFF), side))
    }

    /// Adds one of the two terms of `N·(x − o)`, and its magnitude.
    #[inline(always)]
    fn term<L: Lanes>(
        &self,
        tangent: &Tangent,
        k: usize,
        tile: &BoxTile,
        first: usize,
        (side, size): (L, L),
    ) -> (L, L) {
        let (axis, normal) = (tangent.axes[k] % 3, tangent.normal[k]);
        let nearest = if normal > 0.0 { ints::<L>(&tile.low[axis], first) } else { ints::<L>(&tile.high[axis], first) };
        let x = L::difference(nearest, L::splat_int(self.base[axis]));
        (x.mul_add(L::splat(normal), side), x.abs().mul_add(L::splat(Lanes::abs(normal)), size))
    }

    /// Lanes whose box lies beside that of the shaft, along an axis.
    #[inline(always)]
    fn outside<L: Lanes>(&self, axis: usize, tile: &BoxTile, first: usize) -> u32 {
        let [low, high] = [ints::<L>(&tile.low[axis], first), ints::<L>(&tile.high[axis], first)];
        L::less(L::splat_int(self.high[axis]), low) | L::less(high, L::splat_int(self.low[axis]))
    }
}

/// The edge that the hull has in a quadrant, as seen along the third axis: a point of it, and its outer normal N, whose components
/// are all zero where there is no edge.
#[inline(always)]
fn edge(
    axes: [usize; 2],
    quadrant: [usize; 2],
    receivers: &[[i32; 3]; 2],
    cloud: &[[i32; 3]; 2],
) -> ([i32; 2], [i32; 2]) {
    let [u, v] = [axes[0] % 3, axes[1] % 3];
    let [s, t] = [quadrant[0] % 2, quadrant[1] % 2];
    let r = [receivers[s][u], receivers[t][v]];
    let d = [cloud[s][u] - r[0], cloud[t][v] - r[1]];
    // Both towards the quadrant, or both away from it, or one of them zero: no edge.
    if d[0] == 0 || d[1] == 0 || ((d[0] > 0) == (s == 1)) == ((d[1] > 0) == (t == 1)) {
        return (r, [0; 2]);
    }
    let magnitude = [d[1].wrapping_abs(), d[0].wrapping_abs()];
    (r, [if s == 1 { magnitude[0] } else { -magnitude[0] }, if t == 1 { magnitude[1] } else { -magnitude[1] }])
}

/// Whether a box reaches into the shaft between one receiver and a cloud's box, decided in integers: as seen along each axis,
/// the box and the hull have a point in common. Then it does into the shaft of every group with that receiver, and every
/// walk comes by.
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
#[cfg_attr(target_arch = "spirv", inline(never))]
pub(crate) fn reaches(receiver: IVec3, cloud: [IVec3; 2], of_triangle: [IVec3; 2]) -> bool {
    let hull = [receiver.min(cloud[0]), receiver.max(cloud[1])];
    if !meet(hull, of_triangle) {
        return false;
    }
    let p = receiver.to_array();
    let cloud = [cloud[0].to_array(), cloud[1].to_array()];
    let [low, high] = [of_triangle[0].to_array(), of_triangle[1].to_array()];
    let (mut inside, mut k) = (true, 0);
    while inside && k < TANGENTS {
        let axes = [k / 4, (k / 4 + 1) % 3];
        let (r, normal) = edge(axes, [k / 2 % 2, k % 2], &[p, p], &cloud);
        let x = if normal[0] > 0 { low[axes[0] % 3] } else { high[axes[0] % 3] };
        let y = if normal[1] > 0 { low[axes[1] % 3] } else { high[axes[1] % 3] };
        inside = Wide::product(normal[0], x - r[0]).plus(Wide::product(normal[1], y - r[1])).sign() <= 0;
        k += 1;
    }
    inside
}

/// `N·(r − o)`, rounded up.
#[inline(always)]
fn limit(normal: [i32; 2], from_base: [i32; 2]) -> f32 {
    // A GPU, which has one receiver a thread, has no integers as long as that.
    #[cfg(target_arch = "spirv")]
    {
        let _ = (normal, from_base);
        0.0
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        let term = |k: usize| i64::from(normal[k]) * i64::from(from_base[k]);
        ((term(0) + term(1)) as f32).next_up()
    }
}

/// Entries `first..first + WIDTH` of a node.
#[inline(always)]
fn ints<L: Lanes>(entries: &[i32; NODE], first: usize) -> L::Ints {
    // There a tile is a single lane.
    #[cfg(target_arch = "spirv")]
    {
        L::splat_int(entries[first % NODE])
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        L::load_ints(entries, first)
    }
}

impl Question for Shaft {
    type Tile = BoxTile;

    #[inline(always)]
    fn open<L: Lanes>(&self, tile: &BoxTile) -> u32 {
        let (mut bits, mut first) = (0, 0);
        while first < NODE {
            let outside = self.outside::<L>(0, tile, first)
                | self.outside::<L>(1, tile, first)
                | self.outside::<L>(2, tile, first);
            let all = (1 << L::WIDTH) - 1;
            let (mut inside, mut k) = (!outside & all, 0);
            while k < self.count && k < TANGENTS && inside != 0 {
                inside &= L::bits(self.within::<L>(&self.tangents[k], tile, first));
                k += 1;
            }
            bits |= inside << first;
            first += L::WIDTH;
        }
        bits
    }
}
