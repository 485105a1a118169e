//! A map that fits a light and what it shines on: its window, its range of depths and its planes. On the host, once a run.

use glam::{IVec3, Vec2, Vec3};
use umbra4_core::{Facing, LatticeLight};

use crate::stochastic::{
    area_frame::AreaFrame,
    options::{MOST_PLANES, StochasticError, StochasticOptions},
    params::{DepthRange, LensParams},
    placement::{self, BINS},
    thin_lens::ThinLens,
};

/// A map for a light and receivers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The light.
    pub light: LatticeLight,
    /// Its frame.
    pub frame: AreaFrame,
    /// The camera: it holds, for every receiver within reach, all rays from the light to it.
    pub lens: ThinLens,
    /// Depths of the receivers within reach.
    pub depths: DepthRange,
    planes: [f32; MOST_PLANES as usize],
    count: usize,
}

impl Fit {
    /// For receivers at `points`, lattice. `None` where none lies before the light within [`StochasticOptions::reach`]: there is nothing to map.
    ///
    /// # Errors
    /// Options outside their ranges.
    pub fn new(
        light: &LatticeLight,
        points: &[IVec3],
        options: &StochasticOptions,
    ) -> Result<Option<Self>, StochasticError> {
        options.check()?;
        let frame = AreaFrame::new(light);
        let longer = frame.half_edges[0].max(frame.half_edges[1]);
        let reach = Vec2::splat(options.reach * longer) / Vec2::from_array(frame.half_edges);
        let within = || {
            points.iter().map(|p| frame.place(*p)).filter(move |p| {
                // NaN and infinite quotients are not within.
                p.z > 0.0 && (p.x / p.z).abs() <= reach.x && (p.y / p.z).abs() <= reach.y
            })
        };
        let Some(depths) = depth_range(within()) else { return Ok(None) };

        let mut histogram = [0_u32; BINS];
        for p in within() {
            let bin = &mut histogram[placement::bin(depths, 1.0 / p.z) % BINS];
            *bin = bin.saturating_add(1);
        }
        let mut planes = [0.0; MOST_PLANES as usize];
        let count = options.planes.min(MOST_PLANES) as usize;
        let (planes_asked, _) = planes.split_at_mut(count.min(MOST_PLANES as usize));
        placement::place(planes_asked, options.placement, depths, &histogram);
        let count = without_equals(planes_asked);

        // In focus in the middle, so that samples move as little as can be.
        let focus = planes.get(count / 2).copied().unwrap_or(1.0 / depths.far);
        let mut tangents = [Vec2::INFINITY, Vec2::NEG_INFINITY];
        for p in within() {
            let (tangent, away) = (Vec2::new(p.x / p.z, p.y / p.z), Vec2::splat((1.0 / p.z - focus).abs()));
            tangents = [tangents[0].min(tangent - away), tangents[1].max(tangent + away)];
        }
        let lens = ThinLens::covering(tangents, focus, options.size);
        Ok(Some(Self { light: *light, frame, lens, depths, planes, count }))
    }

    /// Inverse depths of the planes, from the nearest to the farthest; no two are the same.
    pub fn planes(&self) -> &[f32] {
        self.planes.get(..self.count).unwrap_or(&[])
    }

    /// What kernels are told.
    pub fn params(&self, options: &StochasticOptions, triangles: u32) -> LensParams {
        LensParams::new(&self.light, &self.lens, self.depths, options, triangles)
    }
}

/// What a receiver sees where none is within reach: nothing from behind the light, or through its own surface; else all, about.
pub fn unmapped(light: &LatticeLight, frame: &AreaFrame, point: IVec3, facing: Facing) -> f32 {
    if frame.place(point).z > 0.0 && !facing.is_away_from(light, point) { 1.0 } else { 0.0 }
}

fn depth_range(places: impl Iterator<Item = Vec3>) -> Option<DepthRange> {
    places.fold(None, |range: Option<DepthRange>, p| {
        let range = range.unwrap_or(DepthRange { near: p.z, far: p.z });
        Some(DepthRange { near: range.near.min(p.z), far: range.far.max(p.z) })
    })
}

/// Moves what differs from its predecessor to the front; returns how many.
fn without_equals(planes: &mut [f32]) -> usize {
    let mut count = 0_usize;
    for index in 0..planes.len() {
        let own = planes.get(index).copied().unwrap_or(0.0);
        let last = count.checked_sub(1).and_then(|last| planes.get(last)).copied();
        if last.is_none_or(|last| own < last) {
            if let Some(place) = planes.get_mut(count) {
                *place = own;
            }
            count += 1;
        }
    }
    count
}
