//! How a group of receivers sees the light: the frame, sheared along one receiver's ray, in which corners are placed; and
//! what is lost there. The terms are those of the error bound of [`crate::outline`].

use glam::{IVec3, Vec3};

use crate::{
    edge_plane::{LightGrid, ReceiverTile, float},
    lanes::{Lanes, TILE},
    precision::PrecisionMode,
    real::{Axis, Real},
};

/// Heights are used where they exceed their sum over absolute values by this: relative errors stay small.
pub(crate) const LEAST_HEIGHT: f32 = 1.0 / 1024.0;

/// Second-order terms, and the bound's own arithmetic.
pub(crate) const SPARE: f32 = 1.125;

/// Sixteen receivers in the light's sheared frame.
#[derive(Clone, Copy, Debug)]
pub struct View<R> {
    /// Sheared axes: columns, rows, and minus the height.
    axes: [Axis<R>; 3],
    /// Where receivers lie; all points are placed from the base.
    pub(crate) offsets: Offsets,
    /// Receivers' columns, rows and heights.
    pub(crate) at: [[f32; TILE]; 3],
    /// Receivers along the axes, from the base.
    beside: [[f32; TILE]; 3],
    /// Lanes that are high enough above the light plane.
    pub(crate) usable: u32,
    pub(crate) last_column: f32,
    pub(crate) last_row: f32,
    pub(crate) bound: ViewBound,
}

/// Where the receivers of a group lie: from one of them, the base, as differences that floats hold well.
#[derive(Clone, Copy, Debug)]
pub struct Offsets {
    pub(crate) base: IVec3,
    /// From the base, lattice units, and their limits.
    pub(crate) at: [[f32; TILE]; 3],
    pub(crate) limit: Vec3,
}

impl Offsets {
    /// Of nothing but a base, from which what is placed lies no farther than `limit`.
    #[inline(always)]
    pub(crate) fn at_base(base: IVec3, limit: Vec3) -> Self {
        Self { base, at: [[0.0; TILE]; 3], limit }
    }

    /// Of the receivers of `active` lanes (not none). Other lanes repeat the base, and so widen no bound.
    #[inline(always)]
    pub fn new(receivers: &ReceiverTile, active: u32) -> Self {
        let base = receivers.point(active.trailing_zeros() as usize);
        let mut offsets = Self { base, at: [[0.0; TILE]; 3], limit: receivers.farthest(base, base) };
        let mut lane = 0;
        while lane < TILE {
            if active >> lane & 1 == 1 {
                let offset = float(receivers.point(lane) - base);
                (offsets.at[0][lane], offsets.at[1][lane], offsets.at[2][lane]) = (offset.x, offset.y, offset.z);
            }
            lane += 1;
        }
        offsets
    }
}

/// What the receivers contribute to δ, in units of ε.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ViewBound {
    /// Magnitudes of the axes, for what dot products lose.
    reach: Vec3,
    height: Vec3,
    /// B and B_h.
    beside: f32,
    beside_height: f32,
    /// C_h
    pub(crate) heights: f32,
    /// Terms of δ: constant, times e, times q, times e·q.
    pub(crate) constant: f32,
    pub(crate) per_e: f32,
    pub(crate) per_q: f32,
    pub(crate) per_eq: f32,
    /// Largest |j_p|, |i_p|.
    pub(crate) aside: f32,
}

impl<R: Real> View<R> {
    /// The receivers of `active` lanes (not none) as the light sees them.
    #[inline(always)]
    pub fn new<L: Lanes, P: PrecisionMode>(grid: &LightGrid, receivers: &ReceiverTile, active: u32) -> Self {
        let [u, v, down] = R::axes(grid);
        let offsets = Offsets::new(receivers, active);
        let base = offsets.base;
        let middle = base - grid.light.origin;
        let frame = &grid.frame;
        let depth = R::from_f32(Lanes::min(R::dot(&down, middle).to_f32(), -1.0));
        let shear_u = R::dot(&u, middle).minus(R::from_f32(0.5), R::from_f32(frame.last_column)).over(depth);
        let shear_v = R::dot(&v, middle).minus(R::from_f32(0.5), R::from_f32(frame.last_row)).over(depth);
        let mut view = Self {
            axes: [sheared(&u, shear_u, &down), sheared(&v, shear_v, &down), down],
            offsets,
            at: [[0.0; TILE]; 3],
            beside: [[0.0; TILE]; 3],
            usable: active,
            last_column: frame.last_column,
            last_row: frame.last_row,
            bound: ViewBound::default(),
        };
        let mut lane = 0;
        while lane < TILE {
            // Lanes without a receiver repeat one that is there, and so widen no bound.
            let p = if active >> lane & 1 == 1 { receivers.point(lane) } else { base };
            view.at[0][lane] = R::dot(&view.axes[0], p - grid.light.origin).to_f32();
            view.at[1][lane] = R::dot(&view.axes[1], p - grid.light.origin).to_f32();
            view.at[2][lane] = R::dot(&view.axes[2], grid.light.origin - p).to_f32();
            let mut k = 0;
            while k < 3 {
                view.beside[k][lane] = R::dot(&view.axes[k], p - base).to_f32();
                k += 1;
            }
            lane += 1;
        }
        if P::CERTIFIED {
            let normal = frame.normal.abs();
            let reach_u = frame.along_u.abs() + normal * Lanes::abs(shear_u.to_f32());
            let reach_v = frame.along_v.abs() + normal * Lanes::abs(shear_v.to_f32());
            view.certify::<L>(grid, receivers, reach_u.max(reach_v), normal);
        }
        view
    }

    #[inline(always)]
    fn certify<L: Lanes>(&mut self, grid: &LightGrid, receivers: &ReceiverTile, reach: Vec3, height: Vec3) {
        let farthest = receivers.farthest(grid.light.origin, grid.light.origin);
        let steps = float(grid.light.step_u).abs() + float(grid.light.step_v).abs();
        let heights = R::DOT_ERRORS * height.dot(farthest);
        let least = Lanes::max(heights * LEAST_HEIGHT, 1.0);
        let zero = L::splat(0.0);
        let (mut negative_lowest, mut aside, mut beside, mut beside_height) = (L::splat(f32::MIN), zero, zero, zero);
        let mut first = 0;
        while first < TILE {
            let high = L::load(&self.at[2], first);
            let all = (1 << L::WIDTH) - 1;
            self.usable &= !((L::bits(high.ge(L::splat(least))) ^ all) << first);
            negative_lowest = negative_lowest.max(zero.sub(high.max(L::splat(least))));
            aside = aside.max(L::load(&self.at[0], first).abs()).max(L::load(&self.at[1], first).abs());
            beside = beside.max(L::load(&self.beside[0], first).abs()).max(L::load(&self.beside[1], first).abs());
            beside_height = beside_height.max(L::load(&self.beside[2], first).abs());
            first += L::WIDTH;
        }
        let (lowest, aside) = (-negative_lowest.largest(), aside.largest());
        let axis = R::AXIS_ERRORS * reach.dot(steps);
        self.bound = ViewBound {
            reach: reach * R::DOT_ERRORS,
            height: height * R::DOT_ERRORS,
            beside: 2.0 * beside.largest(),
            beside_height: 2.0 * beside_height.largest(),
            heights,
            constant: aside + R::DOT_ERRORS * reach.dot(farthest) + 8.0 + grid.skew / f32::EPSILON * 2.0,
            per_e: 18.0 + axis,
            per_q: heights / lowest + 9.0,
            per_eq: R::AXIS_ERRORS * height.dot(steps) / lowest,
            aside,
        };
    }

    /// Corners along the axes, given by their differences from the base, and what is lost in the worst of the first three,
    /// beside and in height.
    #[inline(always)]
    pub(crate) fn corners<L: Lanes<Long = R>, P: PrecisionMode>(&self, d: &[[i32; 4]; 3]) -> ([[f32; 4]; 3], f32, f32) {
        let out = L::dots(&self.axes, d);
        let (mut lost, mut lost_height) = (self.bound.beside, self.bound.beside_height);
        if P::CERTIFIED && R::DOT_ERRORS > 0.0 {
            let mut c = 0;
            while c < 3 {
                let far = float(IVec3::new(d[0][c], d[1][c], d[2][c])).abs();
                lost = Lanes::max(lost, self.bound.beside + self.bound.reach.dot(far));
                lost_height = Lanes::max(lost_height, self.bound.beside_height + self.bound.height.dot(far));
                c += 1;
            }
        }
        (out, lost, lost_height)
    }

    /// δ of [`crate::outline`], columns or rows: how well corners are known that lie at most `e` from sample (0, 0), the
    /// lowest of them at a height above the receiver of which `inverse` is the reciprocal. `height` is the receivers', `lost`
    /// and `lost_height` come from [`View::corners`].
    #[inline(always)]
    pub(crate) fn uncertainty<L: Lanes>(&self, height: L, e: L, inverse: L, lost: f32, lost_height: f32) -> L {
        let unit = SPARE * L::ROUNDOFF;
        let v = &self.bound;
        // δ as in the notes, sorted by what it is multiplied with.
        let lost_height = lost_height * unit;
        let of_e = (v.per_e + v.per_q) * unit;
        let constant = (v.constant + v.aside * v.per_q) * unit;
        let off = e.mul_add(L::splat(of_e), L::splat(constant));
        let per_inverse = height.mul_add(L::splat(lost * unit), L::splat(v.aside * lost_height));
        let off = inverse.mul_add(e.mul_add(L::splat(lost_height), per_inverse), off);
        if R::AXIS_ERRORS > 0.0 {
            return e.mul(e.add(L::splat(v.aside))).mul_add(L::splat(v.per_eq * unit), off);
        }
        off
    }

    /// Projects a corner. Lanes of which it is not clearly above the receiver leave `front`; their corner is finite.
    #[inline(always)]
    pub(crate) fn corner<L: Lanes>(
        &self,
        first: usize,
        at: &[L; 3],
        corners: &[[f32; 4]; 3],
        c: usize,
        least: L,
        front: &mut u32,
    ) -> Corner<L> {
        let [along, across, rise] = self.offset_of::<L>(first, corners, c);
        *front &= L::bits(rise.ge(least));
        let inverse = rise.max(least).recip();
        let s = at[2].mul(inverse);
        Corner { column: along.mul_add(s, at[0]), row: across.mul_add(s, at[1]), rise, inverse }
    }

    /// Of one lane's receiver, how much lower than the base it lies.
    #[cfg(not(target_arch = "spirv"))]
    #[inline(always)]
    pub(crate) fn beside_height(&self, lane: usize) -> f32 {
        self.beside[2][lane % TILE]
    }

    /// A corner from the receivers, along the axes: columns, rows, and height above them.
    #[inline(always)]
    pub(crate) fn offset_of<L: Lanes>(&self, first: usize, corners: &[[f32; 4]; 3], c: usize) -> [L; 3] {
        [
            L::splat(corners[0][c]).sub(L::load(&self.beside[0], first)),
            L::splat(corners[1][c]).sub(L::load(&self.beside[1], first)),
            L::splat(corners[2][c]).sub(L::load(&self.beside[2], first)),
        ]
    }
}

/// `axis − shear·down`
#[inline(always)]
fn sheared<R: Real>(axis: &Axis<R>, shear: R, down: &Axis<R>) -> Axis<R> {
    [axis[0].minus(shear, down[0]), axis[1].minus(shear, down[1]), axis[2].minus(shear, down[2])]
}

/// A corner as sixteen receivers see it.
#[derive(Clone, Copy)]
pub(crate) struct Corner<L> {
    pub(crate) column: L,
    pub(crate) row: L,
    /// −d_h
    pub(crate) rise: L,
    /// Its reciprocal.
    pub(crate) inverse: L,
}
