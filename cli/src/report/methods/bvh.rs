//! The index of the ray tracer: obvhs, a BVH library with SIMD traversal, two children a node.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, builder::build_bvh2_from_tris},
    ray::Ray,
    rt_triangle::RtTriangle,
    triangle::Triangle,
};
use rayon::prelude::*;
use umbra4_core::glam::{DVec3, IVec3, Vec3};

use crate::{error::ProgramError, report::problem::Problem};

/// What rays meet, where they begin, and the light: in a frame of lattice coordinates over 2^29, so that f32 serves
/// worlds of any size.
pub struct Bvh {
    /// The same triangles, built fast and built well.
    pub builds: [Arc<Build>; 2],
    /// The receivers, lifted as umbra4's are.
    pub origins: Arc<Vec<Vec3>>,
    /// The light's corner and edges.
    pub light: [Vec3; 3],
}

/// A hierarchy.
pub struct Build {
    /// What it is called.
    pub name: &'static str,
    /// Seconds that it took, on one thread.
    pub seconds: f64,
    hierarchy: Bvh2,
    /// In the order of its leaves.
    triangles: Vec<RtTriangle>,
}

/// The least of so many builds counts.
const BUILDS: u32 = 2;

/// Lattice coordinates are below it.
const LATTICE: f64 = (1_u32 << 29) as f64;

impl Bvh {
    /// Builds the hierarchies, timed.
    ///
    /// # Errors
    /// A receiver that cannot be snapped.
    pub fn new(problem: &Problem) -> Result<Self, ProgramError> {
        let triangles: Vec<Triangle> = (0..problem.scene.model.triangles.len())
            .filter_map(|t| problem.scene.model.corners(t))
            .map(|corners| {
                let [v0, v1, v2] = corners.map(|corner| in_frame(problem, corner).into());
                Triangle { v0, v1, v2 }
            })
            .collect();
        let built = |name, params| Arc::new(Build::new(name, &triangles, params));
        let light = &problem.scene.light;
        let [corner, edge_u, edge_v] = [light.corner, light.edge_u, light.edge_v].map(DVec3::from_array);
        let at = |point| in_frame(problem, point);
        Ok(Self {
            builds: [built("fast", BvhBuildParams::fast_build()), built("slow", BvhBuildParams::slow_build())],
            origins: Arc::new(problem.on_lattice()?.points().iter().map(|&p| point_in_frame(p)).collect()),
            light: [at(corner), at(corner + edge_u) - at(corner), at(corner + edge_v) - at(corner)],
        })
    }
}

impl Build {
    fn new(name: &'static str, triangles: &[Triangle], params: BvhBuildParams) -> Self {
        let mut least: Option<Self> = None;
        for _ in 0..BUILDS {
            let start = Instant::now();
            let hierarchy = build_bvh2_from_tris(triangles, params, &mut Duration::default());
            let triangles = hierarchy.primitive_indices.iter().map(|&i| (&triangles[i as usize]).into()).collect();
            let seconds = start.elapsed().as_secs_f64();
            if least.as_ref().is_none_or(|least| seconds < least.seconds) {
                least = Some(Self { name, seconds, hierarchy, triangles });
            }
        }
        least.unwrap_or_else(|| unreachable!("there is at least one build"))
    }

    /// The share of `samples` that each of `origins` sees. `samples(place, out)` puts the samples of the receiver at that
    /// place into `out`; `behind` tells who sees none.
    pub fn visibility(
        &self,
        origins: &[Vec3],
        samples: impl Fn(usize, &mut Vec<Vec3>) + Sync,
        behind: impl Fn(Vec3) -> bool + Sync,
    ) -> Vec<f32> {
        let one = |out: &mut Vec<Vec3>, (place, &origin): (usize, &Vec3)| {
            if behind(origin) {
                return 0.0;
            }
            out.clear();
            samples(place, out);
            let lit = out.iter().filter(|&&sample| self.sees(origin, sample)).count();
            lit as f32 / out.len().max(1) as f32
        };
        origins.par_iter().enumerate().with_min_len(64).map_init(Vec::new, one).collect()
    }

    #[inline]
    fn sees(&self, origin: Vec3, sample: Vec3) -> bool {
        let ray = Ray::new(origin.into(), (sample - origin).into(), 0.0, 1.0);
        self.hierarchy.ray_traverse_miss(ray, |ray, id| self.triangles[id].intersect(ray))
    }
}

/// A point of the world.
fn in_frame(problem: &Problem, point: DVec3) -> Vec3 {
    ((point - problem.lattice.origin()) / (problem.lattice.step() * LATTICE)).as_vec3()
}

/// A point of the lattice.
pub fn point_in_frame(point: IVec3) -> Vec3 {
    (point.as_dvec3() / LATTICE).as_vec3()
}
