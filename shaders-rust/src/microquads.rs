//! Kernels of `umbra4_maps::kernel::microquads`.

use spirv_std::{
    arch::atomic_u_max,
    glam::UVec3,
    memory::{Scope, Semantics},
    spirv,
};
use umbra4_core::kernel;
use umbra4_maps::{kernel::microquads, microquad::params::MicroquadParams, pyramid::Node};

/// The greater of a word and itself.
fn keep(texel: &mut u32, word: u32) {
    // SAFETY: the texel lies in a storage buffer, and is touched by atomics only.
    unsafe { atomic_u_max::<u32, { Scope::QueueFamily as u32 }, { Semantics::NONE.bits() }>(texel, word) };
}

/// See `umbra4_maps::kernel::microquads`.
#[spirv(compute(threads(64), entry_point_name = "draw_map"))]
pub fn draw_map(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MicroquadParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] map: &mut [u32],
) {
    let id = kernel::id(thread.to_array(), params);
    microquads::draw_map(id, params, vertices, triangles, map, keep);
}

/// See `umbra4_maps::kernel::microquads`.
#[spirv(compute(threads(64), entry_point_name = "build_tiles"))]
pub fn build_tiles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MicroquadParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] map: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] nodes: &mut [Node],
) {
    microquads::build_tiles(kernel::id(thread.to_array(), params), params, map, nodes);
}

/// See `umbra4_maps::kernel::microquads`.
#[spirv(compute(threads(64), entry_point_name = "build_parents"))]
pub fn build_parents(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MicroquadParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &mut [Node],
) {
    microquads::build_parents(kernel::id(thread.to_array(), params), params, nodes);
}
