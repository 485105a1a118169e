//! Triangles as a light sees them: on which side of their plane it lies, and their corners in that order.

#[cfg(not(target_arch = "spirv"))]
use crate::{
    edge_plane::{cross_magnitudes, dot, float},
    lanes::{Lanes, TILE},
    real::Real,
};
use crate::{
    exact::{self, Wide},
    light::LatticeLight,
};
use glam::IVec3;

/// On which side of a triangle's plane the light's samples lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(target_arch = "spirv"), repr(u8))]
#[cfg_attr(target_arch = "spirv", repr(u32))]
pub enum Facing {
    /// The plane holds every sample, or there is none: the triangle blocks nothing.
    Nothing,
    /// All on the positive side.
    Front,
    /// All on the negative side.
    Back,
    /// On both: the plane meets the light's sample grid.
    Mixed,
}

impl Facing {
    /// Of a triangle with these corners.
    pub fn of(light: &LatticeLight, corners: [IVec3; 3]) -> Self {
        #[cfg(not(target_arch = "spirv"))]
        if let Some(facing) = long_facing(light, corners) {
            return facing;
        }
        let fine = light.fine();
        let form = exact::triangle_form::<Wide>(fine, corners);
        let (row, column) = (fine.rows as i32 - 1, fine.columns as i32 - 1);
        let signs = [form.sign_at(0, 0), form.sign_at(0, column), form.sign_at(row, 0), form.sign_at(row, column)];
        // The form is linear: its extremes over the grid are at the corners.
        let (mut lowest, mut highest) = (1, -1);
        let mut k = 0;
        while k < 4 {
            lowest = if signs[k] < lowest { signs[k] } else { lowest };
            highest = if signs[k] > highest { signs[k] } else { highest };
            k += 1;
        }
        match (lowest, highest) {
            (0, 0) => Self::Nothing,
            (1, _) => Self::Front,
            (_, -1) => Self::Back,
            _ => Self::Mixed,
        }
    }

    /// Of a triangle on whose plane's positive side the samples lie by `lowest` to `highest`, both known to within `doubt`.
    #[cfg(not(target_arch = "spirv"))]
    #[inline(always)]
    fn between(lowest: f64, highest: f64, doubt: f64) -> Option<Self> {
        if lowest > doubt {
            Some(Self::Front)
        } else if highest < -doubt {
            Some(Self::Back)
        } else if lowest < -doubt && highest > doubt {
            Some(Self::Mixed)
        } else {
            None
        }
    }

    /// The triangle with these corners, oriented towards the light. `None` where it blocks nothing.
    #[inline(always)]
    pub fn occluder(self, [a, b, c]: [IVec3; 3]) -> Option<Occluder> {
        match self {
            Self::Nothing => None,
            Self::Front => Some(Occluder::new([a, b, c], 0)),
            Self::Back => Some(Occluder::new([a, c, b], Occluder::SWAPPED)),
            Self::Mixed => Some(Occluder::new([a, b, c], Occluder::MIXED)),
        }
    }

    /// The same of a triangle of a closed mesh ([`crate::closed`]): it blocks only what lies behind it. (Sintorn, Eisemann and Assarsson
    /// 2008, section 3.3, there by the light's centre; here for every sample.)
    #[inline(always)]
    pub fn closed_occluder(self, [a, b, c]: [IVec3; 3]) -> Option<Occluder> {
        match self {
            Self::Nothing | Self::Front => None,
            Self::Back => self.occluder([a, b, c]),
            Self::Mixed => Some(Occluder::new([a, b, c], Occluder::MIXED | Occluder::ONE_SIDED)),
        }
    }

    /// How the triangle's edges count in the chain of [`crate::silhouette`]: 1 if they run as its vertex indices do, −1 if the
    /// other way; 0 where it is no part of the chain.
    #[inline(always)]
    pub fn direction(self) -> i32 {
        match self {
            Self::Nothing | Self::Mixed => 0,
            Self::Front => 1,
            Self::Back => -1,
        }
    }
}

/// A triangle as the resolve stage meets it. Unless its plane is mixed, its corners are ordered so that all light samples
/// lie on the positive side of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Occluder {
    /// Lattice coordinates, axis-major, so that one load brings an axis of all corners. The fourth entries are no corner:
    /// they are flags, the triangle's number, and 0.
    axes: [[i32; 4]; 3],
}

impl Occluder {
    /// Stands where there is no triangle: blocks nothing.
    pub const NONE: Self = Self { axes: [[0; 4]; 3] };

    /// The plane is mixed.
    const MIXED: i32 = 1;
    /// Only samples behind the triangle are blocked.
    const ONE_SIDED: i32 = 2;
    /// The last two corners have changed places.
    const SWAPPED: i32 = 4;

    /// Orients a triangle towards the light. `None` where it blocks nothing.
    pub fn facing(light: &LatticeLight, corners: [IVec3; 3]) -> Option<Self> {
        Facing::of(light, corners).occluder(corners)
    }

    fn new([a, b, c]: [IVec3; 3], flags: i32) -> Self {
        Self { axes: [[a.x, b.x, c.x, flags], [a.y, b.y, c.y, 0], [a.z, b.z, c.z, 0]] }
    }

    /// The same, as triangle `index` of its mesh.
    #[inline(always)]
    #[must_use]
    pub fn numbered(mut self, index: u32) -> Self {
        self.axes[1][3] = index as i32;
        self
    }

    /// Which triangle of its mesh it is, where [`Occluder::numbered`] has told.
    #[inline(always)]
    pub fn index(&self) -> u32 {
        self.axes[1][3] as u32
    }

    /// Whether the last two corners have changed places, so that it faces the light.
    #[inline(always)]
    pub fn is_swapped(&self) -> bool {
        self.axes[0][3] & Self::SWAPPED != 0
    }

    /// Whether only samples behind the triangle are blocked, though its plane is mixed. (Others of closed meshes are oriented.)
    #[inline(always)]
    pub fn is_one_sided(&self) -> bool {
        self.axes[0][3] & Self::ONE_SIDED != 0
    }

    /// Whether the triangle's plane meets the light's sample grid, so that it cuts masks as a fourth plane.
    #[inline(always)]
    pub fn is_mixed(&self) -> bool {
        self.axes[0][3] & Self::MIXED != 0
    }

    /// Corner k; `k < 3`.
    #[inline(always)]
    pub fn corner(&self, k: usize) -> IVec3 {
        let k = k % 3;
        IVec3::new(self.axes[0][k], self.axes[1][k], self.axes[2][k])
    }

    /// The corners, in order.
    #[inline(always)]
    pub fn corners(&self) -> [IVec3; 3] {
        [self.corner(0), self.corner(1), self.corner(2)]
    }

    /// Axis-major differences of the corners from a point; the fourth entries mean nothing.
    #[inline(always)]
    pub(crate) fn from(&self, base: IVec3) -> [[i32; 4]; 3] {
        let mut out = [[0; 4]; 3];
        let mut c = 0;
        while c < 4 {
            out[0][c] = self.axes[0][c].wrapping_sub(base.x);
            out[1][c] = self.axes[1][c].wrapping_sub(base.y);
            out[2][c] = self.axes[2][c].wrapping_sub(base.z);
            c += 1;
        }
        out
    }
}

/// On which side of the triangle's plane the samples surely lie, in f64.
#[cfg(not(target_arch = "spirv"))]
#[inline]
fn long_facing(light: &LatticeLight, [a, b, c]: [IVec3; 3]) -> Option<Facing> {
    let (e, f, d) = (b - a, c - a, light.origin - a);
    let (rows, columns) = (light.last_row(), light.last_column());
    let normal = <f64 as Real>::cross(e, f);
    let at = <f64 as Real>::dot(&normal, d);
    let across = <f64 as Real>::dot(&normal, light.step_u) * f64::from(columns);
    let along = <f64 as Real>::dot(&normal, light.step_v) * f64::from(rows);
    let extent = float(light.step_u).abs() * columns + float(light.step_v).abs() * rows;
    // Twice the error of the terms: for their sum, and for the bound's own arithmetic.
    let doubt = 2.0 * <f64 as Real>::SIDE_ERROR * cross_magnitudes(float(e), float(f)).dot(float(d).abs() + extent);
    let (lowest, highest) = (at + across.min(0.0) + along.min(0.0), at + across.max(0.0) + along.max(0.0));
    Facing::between(lowest, highest, f64::from(doubt))
}

/// A light as the planes of sixteen triangles are held against it, in f32.
#[cfg(not(target_arch = "spirv"))]
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSides {
    origin: [i32; 3],
    /// From the first column to the last, and from the first row to the last.
    across: [f32; 3],
    along: [f32; 3],
    /// Sums of the magnitudes of both.
    extent: [f32; 3],
}

#[cfg(not(target_arch = "spirv"))]
impl LightSides {
    /// Once a light.
    pub(crate) fn new(light: &LatticeLight) -> Self {
        let across = float(light.step_u) * light.last_column();
        let along = float(light.step_v) * light.last_row();
        Self {
            origin: light.origin.to_array(),
            across: across.to_array(),
            along: along.to_array(),
            extent: (across.abs() + along.abs()).to_array(),
        }
    }

    /// Triangles with the samples surely in front, behind, or on both sides, a bit a lane: `corners[corner][axis][lane]`.
    #[inline(always)]
    pub(crate) fn sure<L: Lanes>(&self, corners: &[[[i32; TILE]; 3]; 3]) -> [u32; 3] {
        let [mut front, mut back, mut mixed] = [0; 3];
        let mut first = 0;
        while first < TILE {
            let corner = |c: usize, axis: usize| L::load_ints(&corners[c][axis], first);
            let side = |c: usize| {
                let axis = |axis: usize| L::difference(corner(c, axis), corner(0, axis));
                [axis(0), axis(1), axis(2)]
            };
            let light = |axis: usize| L::difference(L::splat_int(self.origin[axis]), corner(0, axis));
            let (e, f, d) = (side(1), side(2), [light(0), light(1), light(2)]);
            let normal = cross(e, f, |more, less| more.sub(less));
            let magnitude = cross(e, f, |more, less| more.abs().add(less.abs()));
            let splat = |a: [f32; 3]| [L::splat(a[0]), L::splat(a[1]), L::splat(a[2])];
            let extent = splat(self.extent);
            let reach = [d[0].abs().add(extent[0]), d[1].abs().add(extent[1]), d[2].abs().add(extent[2])];
            let (at, zero) = (dot(&normal, &d), L::splat(0.0));
            let (across, along) = (dot(&normal, &splat(self.across)), dot(&normal, &splat(self.along)));
            // Twice the error of the terms, and a quarter more: for their sum, the bound's own arithmetic, and since signs
            // are taken as sure at the bound itself.
            let doubt = dot(&magnitude, &reach).mul(L::splat(2.5 * <f32 as Real>::SIDE_ERROR));
            let lowest = at.add(across.min(zero)).add(along.min(zero));
            let highest = at.add(across.max(zero)).add(along.max(zero));
            let least = zero.sub(doubt);
            front |= L::bits(lowest.ge(doubt)) << first;
            back |= L::bits(least.ge(highest)) << first;
            mixed |= L::bits(L::both(least.ge(lowest), highest.ge(doubt))) << first;
            first += L::WIDTH;
        }
        [front, back, mixed]
    }
}

/// `a × b`, both products of each axis put together by `sum`.
#[cfg(not(target_arch = "spirv"))]
#[inline(always)]
fn cross<L: Lanes>(a: [L; 3], b: [L; 3], sum: impl Fn(L, L) -> L) -> [L; 3] {
    [sum(a[1].mul(b[2]), a[2].mul(b[1])), sum(a[2].mul(b[0]), a[0].mul(b[2])), sum(a[0].mul(b[1]), a[1].mul(b[0]))]
}
