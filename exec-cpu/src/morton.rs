//! Places along a Morton curve through a box: what is close on the curve is close in space.

use rayon::prelude::*;
use umbra4_core::glam::IVec3;

/// Binary digits of a place on the curve, per axis.
const DIGITS: u32 = 21;

/// A curve through a box, for points or for sums of points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curve {
    low: IVec3,
    shift: u32,
}

impl Curve {
    /// Through the box around `points`, for sums of up to `terms` of them.
    pub(crate) fn through(points: &[IVec3], terms: u64) -> Self {
        let [low, high] = around(points);
        let longest = (0..3).map(|axis| u64::from(high[axis].abs_diff(low[axis]))).max().unwrap_or(0) * terms;
        Self { low, shift: (u64::BITS - longest.leading_zeros()).saturating_sub(DIGITS) }
    }

    /// The place of a sum of points in the box.
    pub(crate) fn place<const N: usize>(&self, points: [IVec3; N]) -> u64 {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let above = |p: &IVec3| u64::from(p[axis].abs_diff(self.low[axis]));
            spread(points.iter().map(above).sum::<u64>() >> self.shift)
        });
        x << 2 | y << 1 | z
    }
}

/// The box around points; of none, a point.
pub(crate) fn around(points: &[IVec3]) -> [IVec3; 2] {
    let first = points.first().copied().unwrap_or(IVec3::ZERO);
    let both = |[low, high]: [IVec3; 2], [l, h]: [IVec3; 2]| [low.min(l), high.max(h)];
    points.par_iter().map(|&p| [p, p]).reduce(|| [first, first], both)
}

/// The indices below `count` (of fewer than 2^32), by their places; those of one place in order.
pub(crate) fn along(count: usize, place: impl Fn(usize) -> u64 + Sync) -> Vec<u32> {
    let mut order: Vec<(u64, u32)> = (0..count).into_par_iter().map(|index| (place(index), index as u32)).collect();
    order.par_sort_unstable();
    order.par_iter().map(|(_, index)| *index).collect()
}

/// Moves bit n to bit 3n; of 21 bits.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread() {
        for bit in 0..DIGITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread((1 << DIGITS) - 1).count_ones(), DIGITS);
    }

    #[test]
    fn ranges_of_all_sizes_are_placed() {
        for points in [vec![], vec![IVec3::ZERO; 3], vec![IVec3::MIN, IVec3::MAX, IVec3::ZERO]] {
            let curve = Curve::through(&points, 3);
            for p in &points {
                let [low, high] = around(&points).map(|p| curve.place([p; 3]));
                assert!(low <= curve.place([*p; 3]) && curve.place([*p; 3]) <= high);
            }
            assert_eq!(along(points.len(), |k| curve.place([points[k]; 3])).len(), points.len());
        }
    }

    #[test]
    fn what_is_close_follows() {
        let points: Vec<IVec3> = (0..64).map(|k| IVec3::new(k % 4, k / 4 % 4, k / 16) * (1 << 20)).collect();
        let curve = Curve::through(&points, 1);
        let order = along(points.len(), |k| curve.place([points[k]]));
        for cube in order.chunks(8) {
            let cube: Vec<IVec3> = cube.iter().map(|k| points[*k as usize]).collect();
            let [low, high] = around(&cube);
            assert_eq!(high - low, IVec3::splat(1 << 20));
        }
    }
}
