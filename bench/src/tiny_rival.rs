//! The rival behind a Rust binding: tinybvh, an eight-wide BVH for AVX2; one ray per light sample.
//!
//! The binding has no occlusion query: the nearest hit is searched for, which costs some of the time.

use std::time::Instant;

use tinybvh_rs::{Intersector, Ray, bvh, bvh8_cpu, mbvh};
use umbra4_core::glam::Vec3;

use crate::{
    contender::{Contender, ContenderError, Run},
    problem::Problem,
    row_word::RowWord,
};

/// Most triangles in a leaf of the eight-wide layout.
const LEAF: u32 = 4;

/// A way of using tinybvh.
#[derive(Clone, Copy, Debug)]
pub struct TinyRival {
    /// Build with spatial splits.
    high_quality: bool,
}

impl TinyRival {
    /// `tinybvh[-high]`
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "tinybvh" => Some(Self { high_quality: false }),
            "tinybvh-high" => Some(Self { high_quality: true }),
            _ => None,
        }
    }

    fn build(self, problem: &Problem<'_>) -> Result<bvh8_cpu::BVH, ContenderError> {
        let vertex = |index: u32| problem.model.vertices[index as usize].extend(0.0).to_array();
        let corners: Vec<[f32; 4]> = problem.model.triangles.iter().flatten().map(|&index| vertex(index)).collect();
        let corners = corners.as_slice().into();
        let mut two = if self.high_quality { bvh::BVH::new_hq(corners)? } else { bvh::BVH::new(corners)? };
        two.split_leaves(LEAF);
        let eight = mbvh::BVH::new(&two);
        Ok(bvh8_cpu::BVH::new(&eight)?)
    }
}

fn masks<W: RowWord>(bvh: &bvh8_cpu::BVH, problem: &Problem<'_>, out: &mut [W]) {
    let columns = problem.light.columns as usize;
    for (&origin, rows) in problem.origins.iter().zip(out.chunks_exact_mut(problem.rows())) {
        if problem.behind_light(origin) {
            rows.fill(W::span(0, problem.light.columns));
            continue;
        }
        for (word, samples) in rows.iter_mut().zip(problem.samples.chunks_exact(columns)) {
            let mut bits = 0;
            for (column, &sample) in samples.iter().enumerate() {
                bits |= u64::from(blocked(bvh, origin, sample)) << column;
            }
            *word = W::from_bits(bits);
        }
    }
}

#[inline(always)]
fn blocked(bvh: &bvh8_cpu::BVH, origin: Vec3, sample: Vec3) -> bool {
    let direction = sample - origin;
    // Filled here and not by `Ray::new`, which would make the direction a unit vector.
    let mut ray = Ray {
        origin: origin.to_array(),
        dir: direction.to_array(),
        r_d: direction.recip().to_array(),
        ..Default::default()
    };
    ray.hit.t = 1.0;
    bvh.intersect(&mut ray);
    ray.hit.t < 1.0
}

impl<W: RowWord> Contender<W> for TinyRival {
    /// Runs on one thread, whatever `threads` is: the binding's hierarchies cannot be shared.
    fn run(&self, problem: &Problem<'_>, _threads: usize, out: &mut [W]) -> Result<Run, ContenderError> {
        let start = Instant::now();
        let bvh = self.build(problem)?;
        let build = start.elapsed().as_secs_f64();
        let start = Instant::now();
        masks(&bvh, problem, out);
        Ok(Run { build, masks: start.elapsed().as_secs_f64(), counts: None })
    }
}
