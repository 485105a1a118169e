//! Finds room for short texts beside points.

/// A rectangle: left, top, width, height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Area {
    /// The square of edge `2 · half` around a point.
    pub fn around(x: f64, y: f64, half: f64) -> Self {
        Self { x: x - half, y: y - half, width: 2.0 * half, height: 2.0 * half }
    }

    /// The area that both share.
    fn shared(&self, other: &Self) -> f64 {
        let length =
            |a: f64, a_length: f64, b: f64, b_length: f64| ((a + a_length).min(b + b_length) - a.max(b)).max(0.0);
        length(self.x, self.width, other.x, other.width) * length(self.y, self.height, other.y, other.height)
    }
}

/// What texts must not cover.
#[derive(Clone, Debug)]
pub struct Room {
    bounds: Area,
    taken: Vec<Area>,
}

/// From the point to the text.
const GAP: f64 = 8.0;

impl Room {
    /// An empty room.
    pub fn new(bounds: Area) -> Self {
        Self { bounds, taken: Vec::new() }
    }

    /// Nothing is put here any more.
    pub fn take(&mut self, area: Area) {
        self.taken.push(area);
    }

    /// Nothing is put on the line between two points.
    pub fn take_line(&mut self, (x0, y0): (f64, f64), (x1, y1): (f64, f64)) {
        let steps = ((x1 - x0).hypot(y1 - y0) / 4.0).ceil().max(1.0);
        for k in 0..=steps as u32 {
            let t = f64::from(k) / steps;
            self.take(Area::around(x0 + (x1 - x0) * t, y0 + (y1 - y0) * t, 1.5));
        }
    }

    /// A free place of `width` × `height` beside (`x`, `y`), which is then taken; `None` where there is none.
    pub fn beside(&mut self, (x, y): (f64, f64), (width, height): (f64, f64)) -> Option<Area> {
        let (left, right) = (x - GAP - width, x + GAP);
        let (above, below) = (y - GAP - height, y + GAP);
        let (middle_x, middle_y) = (x - width / 2.0, y - height / 2.0);
        let (near_left, near_right) = (x - GAP / 2.0 - width, x + GAP / 2.0);
        let (near_above, near_below) = (y - GAP / 2.0 - height, y + GAP / 2.0);
        let places = [
            (right, middle_y),
            (near_right, near_above),
            (middle_x, above),
            (left, middle_y),
            (near_left, near_below),
            (middle_x, below),
            (near_right, near_below),
            (near_left, near_above),
        ];
        let area = places.map(|(x, y)| Area { x, y, width, height }).into_iter().find(|area| self.free(area))?;
        self.take(area);
        Some(area)
    }

    fn free(&self, area: &Area) -> bool {
        let inside = area.shared(&self.bounds) >= area.width * area.height * 0.999;
        inside && self.taken.iter().all(|other| area.shared(other) == 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_do_not_overlap_and_stay_inside() {
        let bounds = Area { x: 0.0, y: 0.0, width: 100.0, height: 60.0 };
        let mut room = Room::new(bounds);
        let mut placed: Vec<Area> = (0..20).filter_map(|_| room.beside((50.0, 30.0), (20.0, 10.0))).collect();
        assert!(placed.len() >= 4);
        while let Some(area) = placed.pop() {
            assert!(placed.iter().all(|other| other.shared(&area) == 0.0));
            assert!((area.shared(&bounds) - 200.0).abs() < 1e-9);
        }
    }

    #[test]
    fn lines_are_left_free() {
        let mut room = Room::new(Area { x: 0.0, y: 0.0, width: 100.0, height: 100.0 });
        room.take_line((0.0, 50.0), (100.0, 50.0));
        let area = room.beside((50.0, 50.0), (20.0, 10.0)).unwrap();
        assert!(area.y + area.height < 49.0 || area.y > 51.0);
    }
}
