//! The kernels of umbra4 as SPIR-V entry points: nothing but bindings. What they do is `umbra4_core::kernel`; what they are
//! bound to is its table, against which the compiled modules are checked.
#![no_std]
#![allow(clippy::too_many_arguments)]

use spirv_std::{glam::UVec3, spirv};
use umbra4_core::{
    Exact, Fast, PairWord,
    edge_plane::Occluder,
    kernel::{self, resolve::ReceiverCounts},
    order::Entry,
    params::Params,
    proj4::{KeyTile, Keys},
};

/// See `umbra4_core::kernel::key_triangles`.
#[spirv(compute(threads(64)))]
pub fn key_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] keys: &mut [Keys],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] order: &mut [Entry],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::key_triangles::key_triangles(id, params, vertices, triangles, keys, order);
}

/// See `umbra4_core::kernel::key_receivers`.
#[spirv(compute(threads(64)))]
pub fn key_receivers(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &mut [Keys],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &mut [Entry],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::key_receivers::key_receivers(id, params, receivers, keys, order);
}

/// See `umbra4_core::kernel::sort`.
#[spirv(compute(threads(64)))]
pub fn count_digits(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] order: &[Entry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] counters: &mut [u32],
) {
    kernel::sort::count_digits(kernel::id(thread.to_array(), params), params, order, counters);
}

/// See `umbra4_core::kernel::sort`.
#[spirv(compute(threads(64)))]
pub fn sum_blocks(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] counters: &mut [u32],
) {
    kernel::sort::sum_blocks(kernel::id(thread.to_array(), params), params, counters);
}

/// See `umbra4_core::kernel::sort`.
#[spirv(compute(threads(64)))]
pub fn scan_blocks(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] counters: &mut [u32],
) {
    kernel::sort::scan_blocks(kernel::id(thread.to_array(), params), params, counters);
}

/// See `umbra4_core::kernel::sort`.
#[spirv(compute(threads(64)))]
pub fn scatter_digits(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] counters: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] order: &[Entry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] sorted: &mut [Entry],
) {
    kernel::sort::scatter_digits(kernel::id(thread.to_array(), params), params, counters, order, sorted);
}

/// See `umbra4_core::kernel::order_triangles`.
#[spirv(compute(threads(64)))]
pub fn order_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] keys: &[Keys],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] order: &[Entry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] occluders: &mut [Occluder],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] nodes: &mut [KeyTile],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::order_triangles::order_triangles(id, params, vertices, triangles, keys, order, occluders, nodes);
}

/// See `umbra4_core::kernel::build_level`.
#[spirv(compute(threads(64)))]
pub fn build_level(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &mut [KeyTile],
) {
    kernel::build_level::build_level(kernel::id(thread.to_array(), params), params, nodes);
}

macro_rules! resolve {
    ($($name:ident, $counted:ident: $word:ty, $precision:ty;)*) => {
        $(
            /// See `umbra4_core::kernel::resolve`.
            #[spirv(compute(threads(64)))]
            pub fn $name(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &[Keys],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &[KeyTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] masks: &mut [u32],
            ) {
                let id = kernel::id(thread.to_array(), params);
                kernel::resolve::resolve::<$word, $precision>(
                    id, params, receivers, keys, order, occluders, nodes, masks,
                );
            }

            /// See `umbra4_core::kernel::resolve`.
            #[spirv(compute(threads(64)))]
            pub fn $counted(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &[Keys],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &[KeyTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] masks: &mut [u32],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] counts: &mut [ReceiverCounts],
            ) {
                let id = kernel::id(thread.to_array(), params);
                kernel::resolve::resolve_counted::<$word, $precision>(
                    id, params, receivers, keys, order, occluders, nodes, masks, counts,
                );
            }
        )*
    };
}

resolve! {
    resolve_32_exact, resolve_32_exact_counted: u32, Exact;
    resolve_32_fast, resolve_32_fast_counted: u32, Fast;
    resolve_64_exact, resolve_64_exact_counted: PairWord, Exact;
    resolve_64_fast, resolve_64_fast_counted: PairWord, Fast;
}

/// See `umbra4_core::kernel::reduce`.
#[spirv(compute(threads(64)))]
pub fn reduce(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] masks: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] table: &[f32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] visibility: &mut [f32],
) {
    kernel::reduce::reduce(kernel::id(thread.to_array(), params), params, masks, table, visibility);
}
