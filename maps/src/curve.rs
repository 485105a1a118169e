//! Places along a Morton curve through a box: what is close on the curve is close in space. What is put in order by them is faster to search, and
//! means the same.

use glam::IVec3;

/// Binary digits of a place on the curve, per axis.
const DIGITS: u32 = 21;

/// A curve through a box, for points or for sums of points.
#[derive(Clone, Copy, Debug)]
pub struct Curve {
    low: IVec3,
    shift: u32,
}

impl Curve {
    /// Through a box, both corners included, for sums of up to `terms` points in it.
    pub fn through([low, high]: [IVec3; 2], terms: u32) -> Self {
        let longest = low.to_array().into_iter().zip(high.to_array()).map(|(low, high)| high.abs_diff(low)).max();
        let longest = u64::from(longest.unwrap_or(0)) * u64::from(terms);
        Self { low, shift: (u64::BITS - longest.leading_zeros()).saturating_sub(DIGITS) }
    }

    /// The place of a sum of points in the box.
    pub fn place<const N: usize>(&self, points: [IVec3; N]) -> u64 {
        let low = self.low;
        let axis = |of: fn(IVec3) -> i32| {
            spread(points.iter().map(|p| u64::from(of(*p).abs_diff(of(low)))).sum::<u64>() >> self.shift)
        };
        axis(|p| p.x) << 2 | axis(|p| p.y) << 1 | axis(|p| p.z)
    }
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
    fn boxes_of_all_sizes_are_passed_through() {
        for [low, high] in [[IVec3::ZERO; 2], [IVec3::MIN, IVec3::MAX], [IVec3::NEG_ONE, IVec3::ONE]] {
            let curve = Curve::through([low, high], 3);
            let [first, last] = [low, high].map(|p| curve.place([p; 3]));
            assert!(first == 0 && (first < last || low == high));
            let middle = curve.place([low, high, IVec3::ZERO.clamp(low, high)]);
            assert!(first <= middle && middle <= last);
        }
    }
}
