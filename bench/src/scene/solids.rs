//! What generated scenes are made of: bars, strands and cards, and random numbers to place them.

use std::f64::consts::TAU;

use umbra4::model::Model;
use umbra4_core::glam::DVec3;
use umbra4_tests::rng::Rng;

/// Uniform in `low..high`.
pub(super) fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.unit()
}

/// Uniform on the unit sphere.
pub(super) fn direction(rng: &mut Rng) -> DVec3 {
    let (y, angle) = (rng.real(1.0), between(rng, 0.0, TAU));
    let radius = (1.0 - y * y).sqrt();
    DVec3::new(radius * angle.cos(), y, radius * angle.sin())
}

/// Collects triangles.
#[derive(Default)]
pub(super) struct Solids {
    model: Model,
}

impl Solids {
    /// All that was added.
    pub(super) fn finish(self) -> Model {
        self.model
    }

    /// One triangle, with vertices of its own.
    pub(super) fn triangle(&mut self, corners: [DVec3; 3]) {
        let corners = corners.map(|corner| self.vertex(corner));
        self.model.triangles.push(corners);
    }

    /// A box of 12 triangles around the axis from `from` to `to`, `width` wide in both other directions.
    pub(super) fn bar(&mut self, from: DVec3, to: DVec3, width: f64) {
        let axis = to - from;
        // Sides are upright where the axis is not.
        let side = axis.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X) * (0.5 * width);
        let up = side.cross(axis).normalize() * (0.5 * width);
        let v: [u32; 8] = std::array::from_fn(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            self.vertex(if i >> 2 == 0 { from } else { to } + side * sign(0) + up * sign(1))
        });
        for [a, b, c, d] in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
            self.model.triangles.extend([[v[a], v[b], v[c]], [v[a], v[c], v[d]]]);
        }
    }

    /// A tube of three sides along `points`, open at its ends; its radius goes from the first of `radii` to the second.
    pub(super) fn strand(&mut self, points: &[DVec3], radii: [f64; 2]) {
        let pieces = points.len().saturating_sub(1);
        let mut side = None;
        let mut last: Option<[u32; 3]> = None;
        for (index, &point) in points.iter().enumerate() {
            let along = (points[(index + 1).min(pieces)] - points[index.saturating_sub(1)]).normalize_or(DVec3::Y);
            // The frame is carried along, so that the tube does not twist.
            let u = side.unwrap_or_else(|| along.any_orthonormal_vector()).reject_from_normalized(along);
            let u = u.try_normalize().unwrap_or_else(|| along.any_orthonormal_vector());
            let v = along.cross(u);
            side = Some(u);
            let radius = radii[0] + (radii[1] - radii[0]) * index as f64 / pieces.max(1) as f64;
            let ring = [0.0, 1.0, 2.0].map(|third: f64| {
                let angle = third / 3.0 * TAU;
                self.vertex(point + (u * angle.cos() + v * angle.sin()) * radius)
            });
            if let Some(last) = last {
                for (k, next) in [(0, 1), (1, 2), (2, 0)] {
                    self.model.triangles.push([last[k], last[next], ring[next]]);
                    self.model.triangles.push([last[k], ring[next], ring[k]]);
                }
            }
            last = Some(ring);
        }
    }

    fn vertex(&mut self, position: DVec3) -> u32 {
        self.model.vertices.push(position.as_vec3());
        self.model.vertices.len() as u32 - 1
    }
}
