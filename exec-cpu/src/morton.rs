//! Points, and what is made of several, in order along a Morton curve.

use rayon::prelude::*;
use umbra4_core::glam::IVec3;
use umbra4_maps::curve::Curve;

/// A curve through the box around `points`, for sums of up to `terms` of them.
pub(crate) fn curve_through(points: &[IVec3], terms: u32) -> Curve {
    Curve::through(around(points), terms)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_all_sizes_are_placed() {
        for points in [vec![], vec![IVec3::ZERO; 3], vec![IVec3::MIN, IVec3::MAX, IVec3::ZERO]] {
            let curve = curve_through(&points, 3);
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
        let curve = curve_through(&points, 1);
        let order = along(points.len(), |k| curve.place([points[k]]));
        for cube in order.chunks(8) {
            let cube: Vec<IVec3> = cube.iter().map(|k| points[*k as usize]).collect();
            let [low, high] = around(&cube);
            assert_eq!(high - low, IVec3::splat(1 << 20));
        }
    }
}
