//! Kernels of `umbra4_maps::kernel::stochastic`.

use spirv_std::{
    arch::{atomic_exchange, atomic_or},
    glam::UVec3,
    memory::{Scope, Semantics},
    spirv,
};
use umbra4_core::kernel;
use umbra4_maps::{
    kernel::stochastic::{
        levels, light_field, radii, receivers as of_receivers, samples as of_samples, tiles as of_tiles,
    },
    stochastic::{
        elementary::Elementary,
        gather::Gathered,
        params::LensParams,
        trace::{Corners, Node},
    },
};

const SCOPE: u32 = Scope::QueueFamily as u32;
const SEMANTICS: u32 = Semantics::NONE.bits();

/// Sets bits of a word.
fn set(word: &mut u32, bits: u32) {
    // SAFETY: the word lies in a storage buffer.
    unsafe { atomic_or::<u32, SCOPE, SEMANTICS>(word, bits) };
}

/// Puts a value into a word; returns what was there.
fn exchange(word: &mut u32, value: u32) -> u32 {
    // SAFETY: the word lies in a storage buffer, and is touched by atomics only.
    unsafe { atomic_exchange::<u32, SCOPE, SEMANTICS>(word, value) }
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "place_triangles"))]
pub fn place_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] placed: &mut [Corners],
) {
    let id = kernel::id(thread.to_array(), params);
    light_field::place_triangles(id, params, vertices, triangles, order, placed);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "bound_triangles"))]
pub fn bound_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] placed: &[Corners],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] nodes: &mut [Node],
) {
    light_field::bound_triangles(kernel::id(thread.to_array(), params), params, placed, nodes);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "bound_nodes"))]
pub fn bound_nodes(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &mut [Node],
) {
    light_field::bound_nodes(kernel::id(thread.to_array(), params), params, nodes);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "sample_light_field"))]
pub fn sample_light_field(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] placed: &[Corners],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] depths: &mut [f32],
) {
    light_field::sample_light_field(kernel::id(thread.to_array(), params), params, placed, nodes, depths);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "mark_looked_at"))]
pub fn mark_looked_at(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] tiles: &mut [u32],
) {
    of_tiles::mark_looked_at(kernel::id(thread.to_array(), params), params, receivers, tiles, set);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "mark_active"))]
pub fn mark_active(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &mut [u32],
) {
    of_tiles::mark_active(kernel::id(thread.to_array(), params), params, tiles, set);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "mark_data"))]
pub fn mark_data(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &mut [u32],
) {
    of_tiles::mark_data(kernel::id(thread.to_array(), params), params, tiles, set);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "mark_merged"))]
pub fn mark_merged(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &mut [u32],
) {
    of_tiles::mark_merged(kernel::id(thread.to_array(), params), params, tiles, set);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "clear_lists"))]
pub fn clear_lists(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] heads: &mut [u32],
) {
    of_samples::clear_lists(kernel::id(thread.to_array(), params), params, heads);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "link_samples"))]
pub fn link_samples(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] heads: &mut [u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] next: &mut [u32],
) {
    of_samples::link_samples(kernel::id(thread.to_array(), params), params, heads, next, exchange);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "merge_samples"))]
pub fn merge_samples(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] heads: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] next: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] depths: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] samples: &mut [Elementary],
) {
    of_samples::merge_samples(kernel::id(thread.to_array(), params), params, tiles, heads, next, depths, samples);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "find_closest"))]
pub fn find_closest(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] samples: &[Elementary],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] found: &mut [f32],
) {
    radii::find_closest(kernel::id(thread.to_array(), params), params, tiles, samples, found);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "raise_radii"))]
pub fn raise_radii(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] samples: &[Elementary],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] found: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] raised: &mut [f32],
) {
    radii::raise_radii(kernel::id(thread.to_array(), params), params, tiles, samples, found, raised);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "lend_radii"))]
pub fn lend_radii(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] raised: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] samples: &mut [Elementary],
) {
    radii::lend_radii(kernel::id(thread.to_array(), params), params, raised, samples);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "coarsen_samples"))]
pub fn coarsen_samples(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] samples: &mut [Elementary],
) {
    levels::coarsen_samples(kernel::id(thread.to_array(), params), params, tiles, samples);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "find_widest"))]
pub fn find_widest(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] samples: &[Elementary],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] widest: &mut [f32],
) {
    levels::find_widest(kernel::id(thread.to_array(), params), params, samples, widest);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "gather_samples"))]
pub fn gather_samples(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] widest: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] samples: &[Elementary],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] gathered: &mut [Gathered],
) {
    levels::gather_samples(kernel::id(thread.to_array(), params), params, tiles, widest, samples, gathered);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "resolve_level"))]
pub fn resolve_level(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] tiles: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] gathered: &[Gathered],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] resolved: &mut [Gathered],
) {
    levels::resolve_level(kernel::id(thread.to_array(), params), params, tiles, gathered, resolved);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "look_up"))]
pub fn look_up(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] resolved: &[Gathered],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] sums: &mut [Gathered],
) {
    of_receivers::look_up(kernel::id(thread.to_array(), params), params, receivers, resolved, sums);
}

/// See `umbra4_maps::kernel::stochastic`.
#[spirv(compute(threads(64), entry_point_name = "find_visibility"))]
pub fn find_visibility(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &LensParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] sums: &[Gathered],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] visibility: &mut [f32],
) {
    let id = kernel::id(thread.to_array(), params);
    of_receivers::find_visibility(id, params, receivers, facings, sums, visibility);
}
