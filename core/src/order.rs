//! The order in which receivers are grouped and triangles are packed into the hierarchy: along a Morton curve through
//! the light's view, with depth. Order decides speed, never a bit.

#[cfg(not(target_arch = "spirv"))]
use glam::IVec3;

#[cfg(not(target_arch = "spirv"))]
use crate::{frame::LightFrame, snap::LIMIT};
use crate::{lanes::Lanes, proj4::Keys};

/// A triangle or receiver to be put in order: by code, then by index, so that the order is the same everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Entry {
    /// Place on the curve; [`Entry::ABSENT`] for what takes no part.
    pub code: u32,
    /// Index of the triangle or receiver.
    pub index: u32,
}

impl Entry {
    /// Code of what takes no part: comes last.
    pub const ABSENT: u32 = u32::MAX;
}

/// Sorts in place, on one thread.
pub fn sort(entries: &mut [Entry]) {
    sort_by(entries, &|a, b| a < b);
}

/// Sorts in place, on one thread. A heap sort: the library's own sorts can panic, and nothing here may.
pub(crate) fn sort_by<T: Copy>(entries: &mut [T], is_less: &impl Fn(&T, &T) -> bool) {
    let mut root = entries.len() / 2;
    while root > 0 {
        root -= 1;
        sift(entries, root, is_less);
    }
    let mut rest = entries;
    while let [first, .., last] = rest {
        core::mem::swap(first, last);
        let Some((_, shorter)) = rest.split_last_mut() else { return };
        rest = shorter;
        sift(rest, 0, is_less);
    }
}

/// Lets the entry at `place` sink in a heap whose largest entry comes first.
fn sift<T: Copy>(heap: &mut [T], mut place: usize, is_less: &impl Fn(&T, &T) -> bool) {
    while let Some(&left) = heap.get(2 * place + 1) {
        let (child, larger) = match heap.get(2 * place + 2) {
            Some(&right) if is_less(&left, &right) => (2 * place + 2, right),
            _ => (2 * place + 1, left),
        };
        let Some(entry) = heap.get_mut(place).filter(|entry| is_less(entry, &larger)) else { return };
        let sinking = core::mem::replace(entry, larger);
        if let Some(entry) = heap.get_mut(child) {
            *entry = sinking;
        }
        place = child;
    }
}

/// Maps the slopes that occur in a scene to the range of a code.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct CodeFrame {
    /// Tangents in the middle of the scene, along columns and rows.
    pub center: [f32; 2],
    /// One over the typical distance from the middle, tangents.
    pub inverse_spread: f32,
    /// Lattice units per column and per row.
    pub scale: [f32; 2],
}

impl CodeFrame {
    /// The frame for slopes around a middle, with their typical distance from it.
    pub fn new(scale: [f32; 2], center: [f32; 2], spread: f32) -> Self {
        Self { center, inverse_spread: 1.0 / Lanes::max(spread, 1.0e-6), scale }
    }
}

#[cfg(not(target_arch = "spirv"))]
impl CodeFrame {
    /// The frame for everything in a box, given by its corners, lattice: the slopes of what lies in the light's half of
    /// space, nearer parts of which are seen at slopes without bound, count from a tenth of the box' height on.
    pub fn around(frame: &LightFrame, [min, max]: [IVec3; 2]) -> Self {
        let inside = |p: IVec3| p.clamp(IVec3::splat(-LIMIT), IVec3::splat(LIMIT));
        let (min, max) = (inside(min.min(max)), inside(min.max(max)));
        let corner = |k: usize| {
            let pick = |bit: usize, low: i32, high: i32| if k >> bit & 1 == 0 { low } else { high };
            frame.place(IVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z)))
        };
        let highest = (0..8).map(|k| corner(k).w).fold(1.0, f32::max);
        let seen = |k: usize| {
            let p = corner(k);
            let height = Lanes::max(p.w, 0.1 * highest);
            [(p.a - 0.5 * frame.last_column) / height, (p.b - 0.5 * frame.last_row) / height]
        };
        let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
        for k in 0..8 {
            for (axis, slope) in seen(k).into_iter().enumerate() {
                let tangent = slope * frame.scale[axis];
                low[axis] = Lanes::min(low[axis], tangent);
                high[axis] = Lanes::max(high[axis], tangent);
            }
        }
        let spread = Lanes::max(high[0] - low[0], high[1] - low[1]);
        Self::new(frame.scale, [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])], 0.5 * spread)
    }
}

/// The tangents of the middle of an entry, seen from the light's middle.
#[inline(always)]
pub fn tangents(keys: &Keys, scale: [f32; 2]) -> [f32; 2] {
    [(keys[0] - keys[1]) * 0.5 * scale[0], (keys[2] - keys[3]) * 0.5 * scale[1]]
}

/// The code of an entry: 10 bits each of both tangents, squeezed so that all of space fits, and of the logarithm of the
/// height, interleaved.
#[inline(always)]
pub fn code(frame: &CodeFrame, keys: &Keys) -> u32 {
    let t = tangents(keys, frame.scale);
    let squeeze = |t: f32, center: f32| {
        let x = (t - center) * frame.inverse_spread;
        let unit = 0.5 + 0.5 * x / (1.0 + x.abs());
        let cell = (unit * 1024.0) as u32;
        if cell < 1023 { cell } else { 1023 }
    };
    // Heights from 1 to 2^32 lattice units: five bits of exponent, five of mantissa.
    let height = if keys[4] < -1.0 { -keys[4] } else { 1.0 };
    let depth = height.to_bits().wrapping_sub(0x3f80_0000) >> 18;
    let depth = if depth < 1023 { depth } else { 1023 };
    spread(squeeze(t[0], frame.center[0])) << 2 | spread(squeeze(t[1], frame.center[1])) << 1 | spread(depth)
}

/// A Morton curve through a box, for lights that are seen from all sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct BoxCurve {
    /// The box' lowest corner, lattice.
    pub low: [i32; 3],
    /// Cells along the curve are 2^shift lattice units wide.
    pub shift: u32,
}

impl BoxCurve {
    /// Through a box between its lowest and highest corners; of one that holds nothing, through a point.
    #[cfg(not(target_arch = "spirv"))]
    pub fn through([low, high]: [IVec3; 2]) -> Self {
        let longest = low.to_array().into_iter().zip(high.to_array());
        let longest = longest.map(|(low, high)| if low < high { high.abs_diff(low) } else { 0 }).fold(0, u32::max);
        Self { low: low.to_array(), shift: (u32::BITS - longest.leading_zeros()).saturating_sub(CELL_BITS) }
    }

    /// The code of a point: that of the nearest in the box.
    #[inline(always)]
    pub fn code(&self, [x, y, z]: [i32; 3]) -> u32 {
        spread(self.cell(x, 0)) << 2 | spread(self.cell(y, 1)) << 1 | spread(self.cell(z, 2))
    }

    #[inline(always)]
    fn cell(&self, x: i32, axis: usize) -> u32 {
        let low = self.low[axis];
        let cell = if x > low { x.wrapping_sub(low) as u32 >> (self.shift % u32::BITS) } else { 0 };
        if cell < CELLS { cell } else { CELLS - 1 }
    }
}

/// Binary digits of a place on a curve, per axis.
const CELL_BITS: u32 = 10;
/// Places per axis.
const CELLS: u32 = 1 << CELL_BITS;

/// Moves bit n to bit 3n; of 10 bits.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}
