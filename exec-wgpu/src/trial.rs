//! A little work whose masks are known: whether a driver runs the kernels' threads to their end.

use umbra4_core::{
    Jitter, LatticeLight,
    exact::{self, Wide},
    glam::IVec3,
    light::MAX_SAMPLES,
    proj4::NODE,
};

use crate::{Gpu, GpuError, Lack, LatticeScene, WgpuExecutor};

/// Receivers: a workgroup and some.
const RECEIVERS: i32 = 100;
/// Of them, one in so many is compared: each takes the host a while.
const COMPARED: usize = 33;
/// Columns of the light: its masks are those of kernels that most runs need too, whose compilation drivers remember.
const COLUMNS: u32 = 32;
/// Distance of the light's samples, lattice units.
const STEP: i32 = 1 << 10;
/// Height of the light above the receivers, lattice units.
const HEIGHT: i32 = 1 << 17;

/// Runs the work on a device, and compares what it gives.
///
/// # Errors
/// What the driver does instead of running it.
pub(crate) fn run(gpu: &Gpu) -> Result<(), Lack> {
    let Trial { light, vertices, receivers } = &Trial::new();
    let triangles: Vec<[u32; 3]> = (0..NODE as u32).map(|t| [0, 1, 2].map(|corner| 3 * t + corner)).collect();
    let scene = LatticeScene { vertices, triangles: &triangles };
    let done = WgpuExecutor::new(gpu.clone()).with_counts(true).masks::<u32>(&scene, light, &receivers[..]);
    let (masks, _) = done.map_err(|error| match error {
        GpuError::Stopped { .. } => Lack::Stops,
        error => Lack::Fails { reason: error.to_string() },
    })?;
    let rows = light.rows as usize;
    let right = |(p, mask): (&IVec3, &[u32])| {
        let blocked = |triangle, row, column| exact::blocks::<Wide>(light, *p, triangle, row, column);
        let expected = |row| {
            let bit = |column| {
                vertices.chunks_exact(3).any(|corners| blocked([corners[0], corners[1], corners[2]], row, column))
            };
            (0..light.columns).fold(0, |word, column| word | u32::from(bit(column)) << column)
        };
        (0..light.rows).zip(mask).all(|(row, word)| *word == expected(row))
    };
    let all = masks.len() == rows * receivers.len();
    let right = all && receivers.iter().zip(masks.chunks_exact(rows)).step_by(COMPARED).all(right);
    if right { Ok(()) } else { Err(Lack::Wrong) }
}

/// The least that a thread can be given, the triangles of one node, with the most to do: all of them block something of the
/// light with the most rows, and never all of it, so that none is left out.
struct Trial {
    light: LatticeLight,
    /// Three a triangle.
    vertices: Vec<IVec3>,
    receivers: Vec<IVec3>,
}

impl Trial {
    fn new() -> Self {
        let half = MAX_SAMPLES as i32 / 2 * STEP;
        let light = LatticeLight {
            origin: IVec3::new(-half / 2, HEIGHT, -half),
            step_u: IVec3::X * STEP,
            step_v: IVec3::Z * STEP,
            rows: MAX_SAMPLES,
            columns: COLUMNS,
            jitter: Jitter::NONE,
        };
        // Narrow, and across the light in as many directions, half way up.
        let corners = (0..NODE as i32).flat_map(|k| {
            let (middle, tilt) = (HEIGHT / 2 + 64 * k, (k - NODE as i32 / 2) * STEP);
            [
                IVec3::new(-half, middle, tilt),
                IVec3::new(half, middle + 32, -tilt),
                IVec3::new(half, middle, STEP - tilt),
            ]
        });
        let receivers = (0..RECEIVERS).map(|k| IVec3::new(37 * k, k % 7, -29 * k));
        Self { light, vertices: corners.collect(), receivers: receivers.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_blocks_something_and_all_together_not_all() {
        let Trial { light, vertices, receivers } = Trial::new();
        for p in receivers.iter().step_by(COMPARED) {
            let samples = || (0..light.rows).flat_map(|row| (0..light.columns).map(move |column| (row, column)));
            let blocked_by = |corners: &[IVec3]| {
                let triangle = [corners[0], corners[1], corners[2]];
                samples().filter(|&(row, column)| exact::blocks::<Wide>(&light, *p, triangle, row, column)).count()
            };
            let counts: Vec<usize> = vertices.chunks_exact(3).map(blocked_by).collect();
            assert!(counts.iter().all(|count| *count > 0), "{counts:?}");
            assert!(counts.iter().sum::<usize>() < light.sample_count() as usize, "{counts:?}");
        }
    }
}
