//! The rival from the registry: obvhs, a BVH library with SIMD traversal; one shadow ray per light sample.

use std::time::{Duration, Instant};

use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, builder::build_bvh2_from_tris},
    cwbvh::{CwBvh, builder::build_cwbvh_from_tris},
    ray::Ray,
    rt_triangle::RtTriangle,
};
use umbra4_core::glam::Vec3;

use crate::{
    contender::{Contender, ContenderError, Run},
    primary::rival_triangles,
    problem::Problem,
    row_word::RowWord,
};

/// A way of using obvhs.
#[derive(Clone, Copy, Debug)]
pub struct BvhRival {
    /// Eight compressed children a node instead of two.
    eight_wide: bool,
    params: BvhBuildParams,
}

impl BvhRival {
    /// `obvhs[-cwbvh][-fast|-medium]`: two children a node and the slow build unless said otherwise, which together
    /// take the least time, building included, on an image's worth of shadow rays.
    pub fn named(name: &str) -> Option<Self> {
        let mut rival = Self { eight_wide: false, params: BvhBuildParams::slow_build() };
        for option in name.strip_prefix("obvhs")?.split('-').skip(1) {
            match option {
                "cwbvh" => rival.eight_wide = true,
                "fast" => rival.params = BvhBuildParams::fast_build(),
                "medium" => rival.params = BvhBuildParams::medium_build(),
                _ => return None,
            }
        }
        Some(rival)
    }
}

/// A hierarchy that answers shadow rays; triangles lie in its own order.
enum Hierarchy {
    Two(Bvh2, Vec<RtTriangle>),
    Eight(CwBvh, Vec<RtTriangle>),
}

impl Hierarchy {
    fn build(rival: &BvhRival, problem: &Problem<'_>) -> Self {
        let triangles = rival_triangles(problem.model);
        let ordered = |indices: &[u32]| indices.iter().map(|&i| (&triangles[i as usize]).into()).collect();
        if rival.eight_wide {
            let bvh = build_cwbvh_from_tris(&triangles, rival.params, &mut Duration::default());
            let ordered = ordered(&bvh.primitive_indices);
            Self::Eight(bvh, ordered)
        } else {
            let bvh = build_bvh2_from_tris(&triangles, rival.params, &mut Duration::default());
            let ordered = ordered(&bvh.primitive_indices);
            Self::Two(bvh, ordered)
        }
    }

    #[inline(always)]
    fn blocked(&self, ray: Ray) -> bool {
        match self {
            Self::Two(bvh, triangles) => !bvh.ray_traverse_miss(ray, |ray, id| triangles[id].intersect(ray)),
            Self::Eight(bvh, triangles) => !bvh.ray_traverse_miss(ray, |ray, id| triangles[id].intersect(ray)),
        }
    }

    fn masks<W: RowWord>(&self, problem: &Problem<'_>, origins: &[Vec3], out: &mut [W]) {
        let columns = problem.light.columns as usize;
        for (&origin, rows) in origins.iter().zip(out.chunks_exact_mut(problem.rows())) {
            if problem.behind_light(origin) {
                rows.fill(W::span(0, problem.light.columns));
                continue;
            }
            for (word, samples) in rows.iter_mut().zip(problem.samples.chunks_exact(columns)) {
                let mut bits = 0;
                for (column, &sample) in samples.iter().enumerate() {
                    let ray = Ray::new(origin.into(), (sample - origin).into(), 0.0, 1.0);
                    bits |= u64::from(self.blocked(ray)) << column;
                }
                *word = W::from_bits(bits);
            }
        }
    }
}

impl<W: RowWord> Contender<W> for BvhRival {
    fn run(&self, problem: &Problem<'_>, threads: usize, out: &mut [W]) -> Result<Run, ContenderError> {
        let start = Instant::now();
        let hierarchy = Hierarchy::build(self, problem);
        let build = start.elapsed().as_secs_f64();
        let start = Instant::now();
        problem.for_blocks(threads, out, |origins, rows| hierarchy.masks(problem, origins, rows));
        Ok(Run { build, masks: start.elapsed().as_secs_f64(), counts: None })
    }
}
