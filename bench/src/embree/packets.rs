//! Masks by packets of shadow rays: N neighbouring light samples, seen from one receiver; or one sample, seen from N
//! neighbouring receivers.

use umbra4_core::glam::Vec3;

use super::{
    ffi::{self, IntersectContext, Rays, Valid},
    scene::TriangleScene,
};
use crate::{problem::Problem, row_word::RowWord};

/// A number of rays that Embree traces in one call.
pub trait Width<const N: usize> {
    /// Traces those of `rays` that are `valid`.
    fn occluded(scene: &TriangleScene, valid: &Valid<N>, context: &mut IntersectContext, rays: &mut Rays<N>);
}

/// The widths there are.
pub struct Widths;

impl Width<1> for Widths {
    #[inline(always)]
    fn occluded(scene: &TriangleScene, _: &Valid<1>, context: &mut IntersectContext, rays: &mut Rays<1>) {
        // SAFETY: the scene is committed, and both structures are laid out and aligned as the header says.
        unsafe { ffi::rtcOccluded1(scene.handle(), context, rays) }
    }
}

impl Width<8> for Widths {
    #[inline(always)]
    fn occluded(scene: &TriangleScene, valid: &Valid<8>, context: &mut IntersectContext, rays: &mut Rays<8>) {
        // SAFETY: the scene is committed, and all structures are laid out and aligned as the header says.
        unsafe { ffi::rtcOccluded8(valid.0.as_ptr(), scene.handle(), context, rays) }
    }
}

impl Width<16> for Widths {
    #[inline(always)]
    fn occluded(scene: &TriangleScene, valid: &Valid<16>, context: &mut IntersectContext, rays: &mut Rays<16>) {
        // SAFETY: the scene is committed, and all structures are laid out and aligned as the header says.
        unsafe { ffi::rtcOccluded16(valid.0.as_ptr(), scene.handle(), context, rays) }
    }
}

/// N light samples: `width` columns and `N / width` rows of them; lanes beyond the light's edge are not valid.
struct Packet<const N: usize> {
    x: [f32; N],
    y: [f32; N],
    z: [f32; N],
    valid: Valid<N>,
    row: usize,
    column: usize,
}

fn packets<const N: usize>(problem: &Problem<'_>, width: usize) -> Vec<Packet<N>> {
    let (rows, columns) = (problem.rows(), problem.light.columns as usize);
    let mut packets = Vec::new();
    for row in (0..rows).step_by(N / width) {
        for column in (0..columns).step_by(width) {
            let lane = |k: usize| (row + k / width, column + k % width);
            let inside = |k: usize| lane(k).0 < rows && lane(k).1 < columns;
            let sample = |k: usize| {
                let (i, j) = lane(k);
                problem.samples[i.min(rows - 1) * columns + j.min(columns - 1)]
            };
            packets.push(Packet {
                x: std::array::from_fn(|k| sample(k).x),
                y: std::array::from_fn(|k| sample(k).y),
                z: std::array::from_fn(|k| sample(k).z),
                valid: Valid(std::array::from_fn(|k| if inside(k) { -1 } else { 0 })),
                row,
                column,
            });
        }
    }
    packets
}

/// The masks of `origins`, by packets of `width` columns and `N / width` rows.
pub fn trace<const N: usize, W: RowWord>(
    scene: &TriangleScene,
    problem: &Problem<'_>,
    width: usize,
    origins: &[Vec3],
    out: &mut [W],
) where
    Widths: Width<N>,
{
    let packets = packets::<N>(problem, width);
    let row_bits = (1_u64 << width) - 1;
    let mut context =
        IntersectContext { flags: ffi::CONTEXT_COHERENT, filter: None, instances: [ffi::INVALID_GEOMETRY] };
    for (&origin, rows) in origins.iter().zip(out.chunks_exact_mut(problem.rows())) {
        if problem.behind_light(origin) {
            rows.fill(W::span(0, problem.light.columns));
            continue;
        }
        rows.fill(W::EMPTY);
        // The segment from the receiver (t = 0, which is lifted off its surface) to the sample (t = 1).
        let mut rays = Rays::<N> {
            org_x: [origin.x; N],
            org_y: [origin.y; N],
            org_z: [origin.z; N],
            tnear: [0.0; N],
            dir_x: [0.0; N],
            dir_y: [0.0; N],
            dir_z: [0.0; N],
            time: [0.0; N],
            tfar: [1.0; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
        };
        for packet in &packets {
            for k in 0..N {
                rays.dir_x[k] = packet.x[k] - origin.x;
                rays.dir_y[k] = packet.y[k] - origin.y;
                rays.dir_z[k] = packet.z[k] - origin.z;
                rays.tfar[k] = 1.0;
            }
            Widths::occluded(scene, &packet.valid, &mut context, &mut rays);
            let mut bits = 0;
            for (k, tfar) in rays.tfar.iter().enumerate() {
                bits |= u64::from(*tfar < 0.0) << k;
            }
            // Lanes that are not valid keep their tfar, and so have no bit.
            for (row, word) in rows[packet.row..].iter_mut().take(N / width).enumerate() {
                let bits = (bits >> (row * width)) & row_bits;
                *word = word.or(W::from_bits(bits << packet.column));
            }
        }
    }
}

/// The masks of `origins`, by packets of rays from N receivers that follow one another: for lights of few samples.
pub fn trace_receivers<const N: usize, W: RowWord>(
    scene: &TriangleScene,
    problem: &Problem<'_>,
    origins: &[Vec3],
    out: &mut [W],
) where
    Widths: Width<N>,
{
    let (rows, columns) = (problem.rows(), problem.light.columns as usize);
    let mut context =
        IntersectContext { flags: ffi::CONTEXT_COHERENT, filter: None, instances: [ffi::INVALID_GEOMETRY] };
    for (origins, masks) in origins.chunks(N).zip(out.chunks_mut(N * rows)) {
        masks.fill(W::EMPTY);
        let origin = |k: usize| origins[k.min(origins.len() - 1)];
        let behind: [bool; N] = std::array::from_fn(|k| problem.behind_light(origin(k)));
        let valid = Valid(std::array::from_fn(|k| if k < origins.len() && !behind[k] { -1 } else { 0 }));
        for (sample, &end) in problem.samples.iter().enumerate() {
            let direction = |k: usize| end - origin(k);
            let mut rays = Rays::<N> {
                org_x: std::array::from_fn(|k| origin(k).x),
                org_y: std::array::from_fn(|k| origin(k).y),
                org_z: std::array::from_fn(|k| origin(k).z),
                tnear: [0.0; N],
                dir_x: std::array::from_fn(|k| direction(k).x),
                dir_y: std::array::from_fn(|k| direction(k).y),
                dir_z: std::array::from_fn(|k| direction(k).z),
                time: [0.0; N],
                tfar: [1.0; N],
                mask: [u32::MAX; N],
                id: [0; N],
                flags: [0; N],
            };
            Widths::occluded(scene, &valid, &mut context, &mut rays);
            for (k, mask) in masks.chunks_exact_mut(rows).enumerate() {
                let bit = u64::from(behind[k] || rays.tfar[k] < 0.0);
                let row = &mut mask[sample / columns];
                *row = row.or(W::from_bits(bit << (sample % columns)));
            }
        }
    }
}
