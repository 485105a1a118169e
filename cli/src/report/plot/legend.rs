//! What the signs of a plot mean: rows of signs and names, as many as they need.

use crate::report::{methods::Family, plot::canvas::length};

/// Size of the letters.
pub const SIZE: f64 = 13.0;
/// From a sign's left edge to its name.
pub const INDENT: f64 = 22.0;
/// From row to row.
const ROW: f64 = 22.0;
/// Between two items.
const GAP: f64 = 26.0;

/// A sign and its name.
pub struct Item {
    /// Whose; of none, the Pareto front's.
    pub family: Option<Family>,
    /// Its name.
    pub name: &'static str,
    /// Left end of its base line.
    pub at: (f64, f64),
}

/// Where the items are, with the first at `start` and none beyond `right`.
pub fn items(families: impl Iterator<Item = Family>, start: (f64, f64), right: f64) -> Vec<Item> {
    let named = families.map(|family| (Some(family), family.name()));
    let (mut x, mut y) = start;
    let place = |(family, name)| {
        let width = INDENT + SIZE * length(name);
        if x + width > right && x > start.0 {
            (x, y) = (start.0, y + ROW);
        }
        let at = (x, y);
        x += width + GAP;
        Item { family, name, at }
    };
    named.chain([(None, "Pareto front: nothing is both faster and better")]).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_stay_inside_and_apart() {
        let items = items(Family::ALL.into_iter(), (80.0, 30.0), 930.0);
        assert_eq!(items.len(), Family::ALL.len() + 1);
        let end = |item: &Item| item.at.0 + INDENT + SIZE * length(item.name);
        assert!(items.iter().all(|item| item.at.0 >= 80.0 && end(item) <= 930.0));
        for pair in items.windows(2) {
            assert!(pair[1].at.1 > pair[0].at.1 || pair[1].at.0 > end(&pair[0]));
        }
    }
}
