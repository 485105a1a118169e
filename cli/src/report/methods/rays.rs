//! One shadow ray a light sample.

use std::{sync::Arc, time::Instant};

use umbra4_core::{Lift, glam::Vec3};

use crate::{
    error::ProgramError,
    report::{
        methods::{
            Family, Method, Run,
            bvh::{Build, Bvh, point_in_frame},
        },
        problem::Problem,
        tiles::Choice,
    },
};

/// Where the samples lie on the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Where umbra4's do: the same for all receivers.
    Regular,
    /// One at random in each cell of a grid, other ones for every receiver.
    Jittered,
}

/// Shadow rays to `side` × `side` samples.
pub struct Rays {
    pattern: Pattern,
    side: u32,
    build: Arc<Build>,
    origins: Vec<Vec3>,
    light: [Vec3; 3],
    /// The regular samples.
    samples: Vec<Vec3>,
    choice: Choice,
    /// Receivers of the picture ÷ those that rays are traced from.
    scale: f64,
}

/// Seconds that a method may take before it runs on fewer receivers.
const MOST_SECONDS: f64 = 3.0;
/// Receivers, and rays each, by which the speed of a hierarchy is told.
const PROBED: usize = 2048;
const PROBE_SIDE: u32 = 6;

impl Rays {
    /// Takes the hierarchy that will take the least time, its own building included, and as many receivers as time
    /// allows.
    ///
    /// # Errors
    /// A light too fine for the lattice.
    pub fn new(problem: &Problem, bvh: &Bvh, pattern: Pattern, side: u32) -> Result<Self, ProgramError> {
        let light = problem.light(side)?.snap(&problem.lattice, Lift::F32_POSITIONS)?;
        let samples = (0..side * side).map(|k| point_in_frame(light.sample(k / side, k % side))).collect();
        let mut rays = Self {
            pattern,
            side,
            build: bvh.builds[0].clone(),
            origins: Vec::new(),
            light: bvh.light,
            samples,
            choice: Choice::everyone(problem.receivers()),
            scale: 1.0,
        };
        let mut trace = f64::INFINITY;
        for build in &bvh.builds {
            let seconds = rays.estimate(build, &bvh.origins);
            if build.seconds + seconds < rays.build.seconds + trace {
                (rays.build, trace) = (build.clone(), seconds);
            }
        }
        let (mut one_in, most) = (1, Choice::sparsest(&problem.seen));
        while trace / f64::from(one_in) > MOST_SECONDS && one_in < most {
            one_in *= 2;
        }
        let choice = Choice::new(&problem.seen, one_in);
        if !choice.receivers.is_empty() {
            rays.choice = choice;
        }
        rays.origins = rays.choice.receivers.iter().map(|&i| bvh.origins[i as usize]).collect();
        rays.scale = problem.receivers() as f64 / rays.origins.len().max(1) as f64;
        Ok(rays)
    }

    /// Seconds that all receivers will take with `build`, told from some.
    fn estimate(&self, build: &Build, origins: &[Vec3]) -> f64 {
        let probe: Vec<Vec3> = origins.iter().step_by(origins.len() / PROBED + 1).copied().collect();
        let probe_once = || {
            let start = Instant::now();
            build.visibility(&probe, |place, out| self.jittered(place, PROBE_SIDE, out), |origin| self.behind(origin));
            start.elapsed().as_secs_f64()
        };
        let seconds = probe_once().min(probe_once());
        let rays = |receivers: usize, side: u32| receivers as f64 * f64::from(side * side);
        seconds * rays(origins.len(), self.side) / rays(probe.len().max(1), PROBE_SIDE)
    }

    fn behind(&self, origin: Vec3) -> bool {
        let [corner, u, v] = self.light;
        u.normalize_or_zero().cross(v.normalize_or_zero()).dot(origin - corner) <= 0.0
    }

    /// One sample in each of `side` × `side` cells; the same on every run.
    fn jittered(&self, receiver: usize, side: u32, out: &mut Vec<Vec3>) {
        let [corner, u, v] = self.light;
        let mut random = Random::new((receiver as u64) << 32 | u64::from(side));
        let cell = 1.0 / side as f32;
        out.extend((0..side * side).map(|k| {
            let [x, y] = random.pair();
            corner + u * (((k % side) as f32 + x) * cell) + v * (((k / side) as f32 + y) * cell)
        }));
    }
}

impl Method for Rays {
    fn family(&self) -> Family {
        match self.pattern {
            Pattern::Regular => Family::RegularRays,
            Pattern::Jittered => Family::JitteredRays,
        }
    }

    fn side(&self) -> u32 {
        self.side
    }

    fn choice(&self) -> &Choice {
        &self.choice
    }

    fn run(&self, _: &Problem) -> Result<Vec<Run>, ProgramError> {
        let samples = |place: usize, out: &mut Vec<Vec3>| match self.pattern {
            Pattern::Regular => out.extend_from_slice(&self.samples),
            Pattern::Jittered => self.jittered(self.choice.receivers[place] as usize, self.side, out),
        };
        let start = Instant::now();
        let visibility = self.build.visibility(&self.origins, samples, |origin| self.behind(origin));
        let seconds = start.elapsed().as_secs_f64() * self.scale;
        let build = format!("BVH ({})", self.build.name);
        let seconds_by_stage = vec![(build, self.build.seconds), ("trace".to_owned(), seconds)];
        Ok(vec![Run { visibility, frames: 1, seconds_by_stage, index_seconds: self.build.seconds, counts: None }])
    }
}

/// Steele, Lea and Flood's SplitMix64.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Two numbers in 0..1.
    fn pair(&mut self) -> [f32; 2] {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        [(z >> 40) as f32, (z & 0xff_ffff) as f32].map(|n| n / (1 << 24) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_numbers_fill_the_unit_square() {
        let mut random = Random::new(7);
        let pairs: Vec<[f32; 2]> = (0..4000).map(|_| random.pair()).collect();
        assert!(pairs.iter().flatten().all(|n| (0.0..1.0).contains(n)));
        for axis in 0..2 {
            let mean = pairs.iter().map(|pair| pair[axis]).sum::<f32>() / 4000.0;
            assert!((mean - 0.5).abs() < 0.03, "{mean}");
        }
    }
}
