//! The Pareto front: methods that no other beats in time without losing in error.

/// A method's place: seconds and error.
pub type Place = (f64, f64);

/// Indices of the places that no other dominates (as fast and as good, and better in one), by rising time. Of equal
/// places the first is taken. Places with NaN are on no front.
pub fn front(places: &[Place]) -> Vec<usize> {
    let mut by_time: Vec<usize> =
        (0..places.len()).filter(|&i| !places[i].0.is_nan() && !places[i].1.is_nan()).collect();
    by_time.sort_by(|&a, &b| places[a].0.total_cmp(&places[b].0).then(places[a].1.total_cmp(&places[b].1)));
    let mut least = f64::INFINITY;
    by_time.retain(|&i| {
        let better = places[i].1 < least;
        least = least.min(places[i].1);
        better
    });
    by_time
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dominated_places_are_left_out() {
        let places = [(4.0, 0.1), (1.0, 0.5), (2.0, 0.6), (2.0, 0.3), (9.0, 0.1), (f64::NAN, 0.0)];
        assert_eq!(front(&places), [1, 3, 0]);
    }

    #[test]
    fn nothing_else_dominates_what_is_left() {
        let places: Vec<Place> = (0..40).map(|i| (f64::from(i * 17 % 41), f64::from(i * 29 % 37))).collect();
        let kept = front(&places);
        let dominates = |a: Place, b: Place| a.0 <= b.0 && a.1 <= b.1 && a != b;
        for (i, &place) in places.iter().enumerate() {
            assert_eq!(kept.contains(&i), !places.iter().any(|&other| dominates(other, place)));
        }
    }

    #[test]
    fn of_equal_places_one_is_left() {
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [0]);
        assert!(front(&[]).is_empty());
    }
}
