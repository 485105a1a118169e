//! Kernels that make triangles of an engine's meshes: vertex indices among all snapped vertices.

use crate::{
    kernel::{fetch, store},
    mesh::MeshParams,
};

/// A triangle that blocks nothing.
const NONE: [u32; 3] = [u32::MAX; 3];

/// The mesh's own vertex that corner `corner` names; `None` where there is no such vertex.
#[inline(always)]
fn indexed(params: &MeshParams, indices: &[u32], corner: u32) -> Option<u32> {
    let place = params.index_first.wrapping_add(corner);
    let index = if params.index_bits == 16 {
        let pair = fetch(indices, (place / 2) as usize, u32::MAX);
        if place & 1 == 0 { pair & 0xffff } else { pair >> 16 }
    } else {
        fetch(indices, place as usize, u32::MAX)
    };
    let vertex = index.wrapping_add(params.index_offset as u32);
    let wrapped = if params.index_offset < 0 { vertex > index } else { vertex < index };
    if wrapped || vertex >= params.vertices { None } else { Some(vertex) }
}

#[inline(always)]
fn triangle(params: &MeshParams, indices: &[u32], own: u32) -> Option<[u32; 3]> {
    let first = own.wrapping_mul(3);
    Some([
        indexed(params, indices, first)?,
        indexed(params, indices, first.wrapping_add(1))?,
        indexed(params, indices, first.wrapping_add(2))?,
    ])
}

/// Place of the first snapped vertex of the instance that triangle `id` belongs to, and its number there.
#[inline(always)]
fn place(id: usize, params: &MeshParams) -> (u32, u32) {
    let (instance, own) = (id as u32 / params.triangles, id as u32 % params.triangles);
    (params.vertex_base.wrapping_add(instance.wrapping_mul(params.vertices)), own)
}

/// Triangle `id` of all instances of an indexed mesh. Returns whether it is refused.
#[inline(always)]
pub fn index_triangles(id: usize, params: &MeshParams, indices: &[u32], triangles: &mut [[u32; 3]]) -> bool {
    if id >= params.count as usize || params.triangles == 0 {
        return false;
    }
    let (base, own) = place(id, params);
    let mut made = NONE;
    if let Some([a, b, c]) = triangle(params, indices, own) {
        made = [base.wrapping_add(a), base.wrapping_add(b), base.wrapping_add(c)];
    }
    store(triangles, params.triangle_base.wrapping_add(id as u32) as usize, made);
    made[0] == u32::MAX
}

/// Triangle `id` of all instances of a mesh without indices: three vertices after the other.
#[inline(always)]
pub fn number_triangles(id: usize, params: &MeshParams, triangles: &mut [[u32; 3]]) {
    if id >= params.count as usize || params.triangles == 0 {
        return;
    }
    let (base, own) = place(id, params);
    let first = base.wrapping_add(own.wrapping_mul(3));
    let made = [first, first.wrapping_add(1), first.wrapping_add(2)];
    store(triangles, params.triangle_base.wrapping_add(id as u32) as usize, made);
}
