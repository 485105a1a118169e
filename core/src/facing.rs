//! Receivers that face away from a whole light: it gives them no light, whatever lies between, so that their masks are full
//! without a triangle being looked at.
//!
//! Seed: Sintorn, Eisemann and Assarsson 2008, section 4.3, who leave out what needs no visibility. Departure: a normal is kept in
//! one word, and the test is one of integers: it holds of every normal that the word may stand for, and of every sample, so
//! that nothing that faces a light is ever taken for turned away, and all executors settle the same receivers.

use glam::{IVec3, Vec3};

#[cfg(not(target_arch = "spirv"))]
use crate::any_light::AnyLight;
use crate::{
    exact::{Wide, WideInt},
    light::LatticeLight,
    punctual::Punctual,
    snap::is_finite,
};

/// Bits of a component.
const BITS: u32 = 10;

/// The largest component.
const MOST: f32 = ((1 << (BITS - 1)) - 1) as f32;

/// Normals below are as good as zero, and those above as infinite: products with 1023 have to be floats.
const LEAST: f32 = 1.0e-30;
/// See [`LEAST`].
const GREATEST: f32 = 1.0e30;

/// The side that a receiver's surface is seen from, in one word: its normal's direction, with a largest component of 511.
///
/// ```
/// use umbra4_core::{facing::Facing, glam::{IVec3, Vec3}, Jitter, LatticeLight};
///
/// let (step_u, step_v) = (IVec3::X * 8, IVec3::Z * 8);
/// let light = LatticeLight { origin: IVec3::Y * 900, step_u, step_v, rows: 8, columns: 8, jitter: Jitter::NONE };
/// assert!(!Facing::of(Vec3::Y).is_away_from(&light, IVec3::ZERO));
/// assert!(Facing::of(Vec3::NEG_Y).is_away_from(&light, IVec3::ZERO));
/// assert!(!Facing::UNKNOWN.is_away_from(&light, IVec3::ZERO));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Facing(u32);

impl Facing {
    /// Of a receiver that may look to any side: it faces every light.
    pub const UNKNOWN: Self = Self(0);

    /// By a normal of any length, towards the side that is seen; unknown where its largest component is
    /// outside 1e-30..1e30, or one is not finite.
    #[inline]
    pub fn of(normal: Vec3) -> Self {
        let size = normal.abs();
        let largest = if size.y > size.x { size.y } else { size.x };
        let largest = if size.z > largest { size.z } else { largest };
        if !(is_finite(normal.x) && is_finite(normal.y) && is_finite(normal.z) && largest > LEAST && largest < GREATEST)
        {
            return Self::UNKNOWN;
        }
        let (x, y, z) = (component(normal.x, largest), component(normal.y, largest), component(normal.z, largest));
        Self(x | y << BITS | z << (2 * BITS))
    }

    /// The word, as buffers hold it.
    pub const fn word(self) -> u32 {
        self.0
    }

    /// The inverse of [`Facing::word`].
    pub const fn from_word(word: u32) -> Self {
        Self(word)
    }

    /// The components, each less than one off those of the normal at that length.
    #[inline(always)]
    fn components(self) -> IVec3 {
        let component = |k: u32| (self.0 << (32 - BITS * (k + 1))) as i32 >> (32 - BITS);
        IVec3::new(component(0), component(1), component(2))
    }

    /// Whether a receiver at `p` sees the light where nothing lies between: it lies before it, and does not face away. One that is
    /// where a point is sees it, though no triangle matters to it.
    #[cfg(not(target_arch = "spirv"))]
    pub fn sees(self, light: &AnyLight, p: IVec3) -> bool {
        match light {
            AnyLight::Area(light) => light.reaches(&[p]) && !self.is_away_from(light, p),
            AnyLight::Punctual(light) => !self.is_away_from_punctual(*light, p),
        }
    }

    /// Whether a receiver at `p`, on the lattice, faces away from every sample of the light.
    #[cfg_attr(not(target_arch = "spirv"), inline)]
    #[cfg_attr(target_arch = "spirv", inline(never))]
    pub fn is_away_from(self, light: &LatticeLight, p: IVec3) -> bool {
        if self == Self::UNKNOWN {
            return false;
        }
        // Places are linear over the light: where its four corners lie below the surface, all do.
        let fine = light.fine();
        let (along, across) = (fine.step_u * (fine.columns as i32 - 1), fine.step_v * (fine.rows as i32 - 1));
        let first = fine.origin - p;
        let n = self.components();
        is_below(n, first)
            && is_below(n, first + along)
            && is_below(n, first + across)
            && is_below(n, first + along + across)
    }

    /// The same of a box of samples, both corners included.
    #[cfg_attr(not(target_arch = "spirv"), inline)]
    #[cfg_attr(target_arch = "spirv", inline(never))]
    pub fn is_away_from_box(self, [low, high]: [IVec3; 2], p: IVec3) -> bool {
        let (n, mut is_away, mut k) = (self.components(), self != Self::UNKNOWN, 0);
        while is_away && k < 8 {
            let corner = IVec3::new(
                if k & 1 == 0 { low.x } else { high.x },
                if k & 2 == 0 { low.y } else { high.y },
                if k & 4 == 0 { low.z } else { high.z },
            );
            is_away = is_below(n, corner - p);
            k += 1;
        }
        is_away
    }

    /// The same of a light without extent; of a point that is where the light is, never.
    #[inline]
    pub fn is_away_from_punctual(self, light: Punctual, p: IVec3) -> bool {
        let toward = light.seen_from(p);
        let is_there = toward.x == 0 && toward.y == 0 && toward.z == 0;
        self != Self::UNKNOWN && !is_there && is_below(self.components(), toward)
    }
}

/// `v·511 / largest`, to the nearest integer, as the bits of a word. Divisions differ from device to device, products do not: the
/// quotient is a first guess.
#[inline]
fn component(v: f32, largest: f32) -> u32 {
    let (twice, mut k) = (2.0 * MOST * v, (MOST * (v / largest)) as i32);
    let mut tries = 0;
    while tries < 3 {
        if (2 * k + 1) as f32 * largest <= twice {
            k += 1;
        } else if (2 * k - 1) as f32 * largest > twice {
            k -= 1;
        }
        tries += 1;
    }
    k as u32 & ((1 << BITS) - 1)
}

/// Whether `d` points to the inner side of every surface whose normal is less than one a component from `n`:
/// `n·d + |d_x| + |d_y| + |d_z| ≤ 0`.
#[inline(always)]
fn is_below(n: IVec3, d: IVec3) -> bool {
    let upwards = |n: i32, d: i32| if d < 0 { n - 1 } else { n + 1 };
    let (x, y, z) = (upwards(n.x, d.x), upwards(n.y, d.y), upwards(n.z, d.z));
    Wide::product(x, d.x).plus(Wide::product(y, d.y)).plus(Wide::product(z, d.z)).sign() <= 0
}
