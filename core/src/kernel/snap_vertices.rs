//! Kernels that snap an engine's vertices, where they lie. Both return whether the vertex is refused.

use glam::Vec3;

use crate::{
    kernel::{NOWHERE, fetch, store},
    mesh::{Matrix, MeshParams, to_world},
    snap::snap_point,
};

/// What is read where a buffer has no such word: it is refused.
const ABSENT: u32 = u32::MAX;

#[inline(always)]
fn float(words: &[u32], index: u32) -> f32 {
    f32::from_bits(fetch(words, index as usize, ABSENT))
}

#[inline(always)]
fn position(params: &MeshParams, vertices: &[u32], vertex: u32) -> Vec3 {
    let first = params.vertex_first.wrapping_add(vertex.wrapping_mul(params.vertex_stride));
    let (second, third) = (first.wrapping_add(1), first.wrapping_add(2));
    Vec3::new(float(vertices, first), float(vertices, second), float(vertices, third))
}

#[inline(always)]
fn snap(id: usize, params: &MeshParams, world: Vec3, snapped: &mut [[i32; 3]]) -> bool {
    let mut point = NOWHERE;
    if let Some(p) = snap_point(&params.snap, world) {
        point = [p.x, p.y, p.z];
    }
    store(snapped, params.vertex_base.wrapping_add(id as u32) as usize, point);
    point[0] == i32::MIN
}

/// Vertex `id` of a mesh in world space.
#[inline(always)]
pub fn snap_vertices(id: usize, params: &MeshParams, vertices: &[u32], snapped: &mut [[i32; 3]]) -> bool {
    if id >= params.count as usize {
        return false;
    }
    snap(id, params, position(params, vertices, id as u32), snapped)
}

/// Vertex `id` of all instances, those of the first one first.
#[inline(always)]
pub fn snap_instances(
    id: usize,
    params: &MeshParams,
    vertices: &[u32],
    instances: &[u32],
    snapped: &mut [[i32; 3]],
) -> bool {
    if id >= params.count as usize || params.vertices == 0 {
        return false;
    }
    let (instance, vertex) = (id as u32 / params.vertices, id as u32 % params.vertices);
    let first = params.instance_first.wrapping_add(instance.wrapping_mul(params.instance_stride));
    let mut matrix: Matrix = [[0.0; 4]; 4];
    let mut k = 0;
    while k < 16 {
        matrix[k / 4][k % 4] = float(instances, first.wrapping_add(k as u32));
        k += 1;
    }
    snap(id, params, to_world(&matrix, position(params, vertices, vertex)), snapped)
}
