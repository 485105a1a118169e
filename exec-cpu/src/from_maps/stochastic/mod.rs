//! Stochastic soft shadow maps on CPU threads: see [`umbra4_maps::stochastic`].

mod run;

use umbra4_core::{LatticeLight, glam::IVec3};
use umbra4_maps::stochastic::{
    StochasticOptions,
    area_frame::AreaFrame,
    fit::{Fit, unmapped},
};

use crate::{
    CpuExecutor, ExecutorError, Occluders, Receivers, Statistics,
    morton::{along, curve_through},
};
use run::{Clock, Input, STAGES};

/// What a stochastic soft shadow map says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StochasticShadows {
    /// Of every receiver, the fraction of the light that it sees, about.
    pub visibility: Vec<f32>,
    /// Receivers before the light that the map does not cover: see [`StochasticOptions::reach`]. They are taken as lit.
    pub outside: usize,
    /// Depths of the filter planes, from the nearest to the farthest, in halves of the light's longer edge.
    pub planes: Vec<f32>,
    /// Times of stages; there is nothing to count.
    pub statistics: Statistics,
}

impl CpuExecutor {
    /// The fraction of the light that every receiver sees, by a stochastic soft shadow map (Liktor et al. 2015): approximate, and filtered. Give receivers
    /// their [`Receivers::facing`]: those that face away are dark then, where the map alone leaks light through the surface that they lie on.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
    /// use umbra4_core::{glam::{DVec3, Vec3}, AreaLight, Bounds, Lattice, Lift};
    /// use umbra4_maps::stochastic::StochasticOptions;
    ///
    /// let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?; // X × Z = −Y: shines down
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
    ///
    /// let options = StochasticOptions { size: 128, planes: 1, ..StochasticOptions::default() };
    /// let light = light.snap(&lattice, Lift::NONE)?;
    /// let shadows = CpuExecutor::new().stochastic_shadows(&occluders, &light, &receivers, &options)?;
    /// assert!(shadows.visibility[0] < 0.5 && shadows.visibility[1] > 0.9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Options outside their ranges.
    pub fn stochastic_shadows(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        options: &StochasticOptions,
    ) -> Result<StochasticShadows, ExecutorError> {
        options.check()?;
        let work = || {
            let mut clock = Clock::default();
            let points = receivers.points();
            let Some(fit) = clock.time(0, || Fit::new(light, points, options))? else {
                return Ok(nothing_mapped(light, receivers));
            };
            let params = fit.params(options, occluders.triangles().len() as u32);
            let order = clock.time(1, || ordered(occluders));
            let (vertices, triangles) = (occluders.vertices(), occluders.triangles());
            let input = Input { vertices, triangles, order: &order, points, facings: receivers.facings() };
            let depths = run::sample_light_field(&input, &params, &mut clock);
            let (visibility, outside) = run::visibility(&input, &fit, &params, &depths, &mut clock);
            let planes = fit.planes().iter().map(|inverse| 1.0 / inverse).collect();
            let seconds_by_stage = STAGES.into_iter().zip(clock.0).collect();
            let statistics = Statistics { seconds_by_stage, ..Statistics::default() };
            Ok(StochasticShadows { visibility, outside, planes, statistics })
        };
        self.install(work)
    }
}

/// Where no receiver is within reach.
fn nothing_mapped(light: &LatticeLight, receivers: &Receivers) -> StochasticShadows {
    let (frame, points) = (AreaFrame::new(light), receivers.points());
    let seen = |(index, point): (usize, &IVec3)| unmapped(light, &frame, *point, receivers.facing_of(index));
    let visibility = points.iter().enumerate().map(seen).collect();
    let outside = points.iter().filter(|point| frame.place(**point).z > 0.0).count();
    StochasticShadows { visibility, outside, ..StochasticShadows::default() }
}

/// Triangles along a curve through space; those of an arranged mesh are already.
fn ordered(occluders: &Occluders) -> Vec<u32> {
    let count = occluders.triangles().len();
    if occluders.arrangement().is_some() {
        return (0..count as u32).collect();
    }
    let curve = curve_through(occluders.vertices(), 3);
    along(count, |id| occluders.corners(id).map_or(u64::MAX, |corners| curve.place(corners)))
}
