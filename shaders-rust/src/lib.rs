//! The kernels of umbra4 as SPIR-V entry points: nothing but bindings. What they do is `umbra4_core::kernel`, or `umbra4_maps::kernel`;
//! what they are bound to is the table there, against which the compiled modules are checked.
#![no_std]
#![allow(clippy::too_many_arguments)]

use spirv_std::{
    Image,
    arch::atomic_i_add,
    glam::{UVec2, UVec3},
    image::{ImageWithMethods, sample_with},
    memory::{Scope, Semantics},
    spirv,
};
use umbra4_core::{
    Exact, Fast, PairWord,
    gbuffer::ViewParams,
    irradiance::PackedSample,
    jitter::{Pattern, Regular},
    kernel::{
        self, order_cloud, resolve::ReceiverCounts, resolve_cloud::SampleTile, resolve_cloud_by_table::TableWord,
        snap_receivers, status::Status, weigh::PackedWeight,
    },
    mesh::MeshParams,
    occluder::Occluder,
    order::Entry,
    params::{CloudParams, JitteredParams, Params, PunctualParams},
    proj4::{KeyTile, Keys},
    shaft::BoxTile,
};

pub mod casters;
pub mod microquads;
pub mod stochastic;

/// Kernels that make keys, of one kind of light.
macro_rules! keys {
    ($params:ty: $triangles:ident, $receivers:ident, $order:ident) => {
        /// See `umbra4_core::kernel::key_triangles`.
        #[spirv(compute(threads(64)))]
        pub fn $triangles(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &$params,
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
        pub fn $receivers(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &$params,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &mut [Keys],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &mut [Entry],
        ) {
            let id = kernel::id(thread.to_array(), params);
            kernel::key_receivers::key_receivers(id, params, receivers, keys, order);
        }

        /// See `umbra4_core::kernel::order_triangles`.
        #[spirv(compute(threads(64)))]
        pub fn $order(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &$params,
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
    };
}

keys!(Params: key_triangles, key_receivers, order_triangles);
keys!(PunctualParams: key_punctual_triangles, key_punctual_receivers, order_punctual_triangles);

/// See `umbra4_core::kernel::settle_receivers`.
#[spirv(compute(threads(64)))]
pub fn settle_receivers(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &mut [Entry],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::settle_receivers::settle_receivers(id, params, receivers, facings, order);
}

/// See `umbra4_core::kernel::settle_receivers`.
#[spirv(compute(threads(64)))]
pub fn settle_punctual_receivers(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &PunctualParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &mut [Entry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] masks: &mut [u32],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::settle_receivers::settle_punctual_receivers(id, params, receivers, facings, order, masks);
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
                kernel::resolve::resolve::<$word, $precision, Regular>(
                    id, params, &Regular, receivers, keys, order, occluders, nodes, masks,
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
                kernel::resolve::resolve_counted::<$word, $precision, Regular>(
                    id, params, &Regular, receivers, keys, order, occluders, nodes, masks, counts,
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

macro_rules! resolve_jittered {
    ($($name:ident, $counted:ident: $word:ty, $precision:ty;)*) => {
        $(
            /// See `umbra4_core::kernel::resolve`.
            #[spirv(compute(threads(64)))]
            pub fn $name(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] jittered: &JitteredParams,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &[Keys],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &[KeyTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] masks: &mut [u32],
            ) {
                let id = kernel::id(thread.to_array(), jittered);
                kernel::resolve::resolve::<$word, $precision, Pattern>(
                    id, &jittered.params, &jittered.pattern, receivers, keys, order, occluders, nodes, masks,
                );
            }

            /// See `umbra4_core::kernel::resolve`.
            #[spirv(compute(threads(64)))]
            pub fn $counted(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] jittered: &JitteredParams,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &[Keys],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &[KeyTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] masks: &mut [u32],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] counts: &mut [ReceiverCounts],
            ) {
                let id = kernel::id(thread.to_array(), jittered);
                kernel::resolve::resolve_counted::<$word, $precision, Pattern>(
                    id, &jittered.params, &jittered.pattern, receivers, keys, order, occluders, nodes, masks, counts,
                );
            }
        )*
    };
}

resolve_jittered! {
    resolve_32_exact_jittered, resolve_32_exact_jittered_counted: u32, Exact;
    resolve_32_fast_jittered, resolve_32_fast_jittered_counted: u32, Fast;
    resolve_64_exact_jittered, resolve_64_exact_jittered_counted: PairWord, Exact;
    resolve_64_fast_jittered, resolve_64_fast_jittered_counted: PairWord, Fast;
}

macro_rules! resolve_punctual {
    ($($name:ident, $counted:ident: $precision:ty;)*) => {
        $(
            /// See `umbra4_core::kernel::resolve_punctual`.
            #[spirv(compute(threads(64)))]
            pub fn $name(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &PunctualParams,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &[Keys],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &[KeyTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] masks: &mut [u32],
            ) {
                let id = kernel::id(thread.to_array(), params);
                kernel::resolve_punctual::resolve_punctual::<$precision>(
                    id, params, receivers, keys, order, occluders, nodes, masks,
                );
            }

            /// See `umbra4_core::kernel::resolve_punctual`.
            #[spirv(compute(threads(64)))]
            pub fn $counted(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &PunctualParams,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &[Keys],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &[KeyTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] masks: &mut [u32],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] counts: &mut [ReceiverCounts],
            ) {
                let id = kernel::id(thread.to_array(), params);
                kernel::resolve_punctual::resolve_punctual_counted::<$precision>(
                    id, params, receivers, keys, order, occluders, nodes, masks, counts,
                );
            }
        )*
    };
}

resolve_punctual! {
    resolve_punctual_exact, resolve_punctual_exact_counted: Exact;
    resolve_punctual_fast, resolve_punctual_fast_counted: Fast;
}

/// See `umbra4_core::kernel::order_cloud`.
#[spirv(compute(threads(64)))]
pub fn key_cloud_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CloudParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &mut [Entry],
) {
    let id = kernel::id(thread.to_array(), params);
    order_cloud::key_cloud_triangles(id, params, vertices, triangles, order);
}

/// See `umbra4_core::kernel::order_cloud`.
#[spirv(compute(threads(64)))]
pub fn key_cloud_receivers(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CloudParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] order: &mut [Entry],
) {
    order_cloud::key_cloud_receivers(kernel::id(thread.to_array(), params), params, receivers, order);
}

/// See `umbra4_core::kernel::order_cloud`.
#[spirv(compute(threads(64)))]
pub fn settle_cloud_receivers(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CloudParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &mut [Entry],
) {
    let id = kernel::id(thread.to_array(), params);
    order_cloud::settle_cloud_receivers(id, params, receivers, facings, order);
}

/// See `umbra4_core::kernel::order_cloud`.
#[spirv(compute(threads(64)))]
pub fn order_cloud_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CloudParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &mut [Occluder],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &mut [BoxTile],
) {
    let id = kernel::id(thread.to_array(), params);
    order_cloud::order_cloud_triangles(id, params, vertices, triangles, order, occluders, nodes);
}

/// See `umbra4_core::kernel::order_cloud`.
#[spirv(compute(threads(64)))]
pub fn build_box_level(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] nodes: &mut [BoxTile],
) {
    order_cloud::build_box_level(kernel::id(thread.to_array(), params), params, nodes);
}

macro_rules! resolve_cloud {
    ($($name:ident, $counted:ident: $precision:ty, $element:ty;)*) => {
        $(
            /// See `umbra4_core::kernel::resolve_cloud`.
            #[spirv(compute(threads(64)))]
            pub fn $name(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CloudParams,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &[BoxTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] elements: &[$element],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] masks: &mut [u32],
            ) {
                let id = kernel::id(thread.to_array(), params);
                kernel::resolve_cloud::resolve_cloud::<$precision, $element>(
                    id, params, receivers, order, occluders, nodes, elements, masks,
                );
            }

            /// See `umbra4_core::kernel::resolve_cloud`.
            #[spirv(compute(threads(64)))]
            pub fn $counted(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CloudParams,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &[BoxTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] elements: &[$element],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] masks: &mut [u32],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] counts: &mut [ReceiverCounts],
            ) {
                let id = kernel::id(thread.to_array(), params);
                kernel::resolve_cloud::resolve_cloud_counted::<$precision, $element>(
                    id, params, receivers, order, occluders, nodes, elements, masks, counts,
                );
            }
        )*
    };
}

resolve_cloud! {
    resolve_cloud_exact, resolve_cloud_exact_counted: Exact, SampleTile;
    resolve_cloud_fast, resolve_cloud_fast_counted: Fast, SampleTile;
    resolve_cloud_by_table, resolve_cloud_by_table_counted: Exact, TableWord;
}

/// See `umbra4_core::kernel::weigh`.
#[spirv(compute(threads(64)))]
pub fn weigh(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] masks: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] weights: &[PackedWeight],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] light: &mut [[u32; 3]],
) {
    kernel::weigh::weigh(kernel::id(thread.to_array(), params), params, masks, weights, light);
}

/// See `umbra4_core::kernel::illuminate`.
#[spirv(compute(threads(64)))]
pub fn illuminate(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] masks: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] normals: &[[f32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] samples: &[PackedSample],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] irradiance: &mut [[f32; 3]],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::illuminate::illuminate(id, params, masks, receivers, normals, samples, irradiance);
}

/// See `umbra4_core::kernel::reduce`.
#[spirv(compute(threads(64)))]
pub fn reduce(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] masks: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] lit: &mut [u32],
) {
    kernel::reduce::reduce(kernel::id(thread.to_array(), params), params, masks, lit);
}

/// See `umbra4_core::kernel::pack`.
#[spirv(compute(threads(64)))]
pub fn pack(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] lit: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] table: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] image: &mut [u32],
) {
    kernel::pack::pack(kernel::id(thread.to_array(), params), params, lit, table, image);
}

/// See `umbra4_core::kernel::pack_light`.
#[spirv(compute(threads(64)))]
pub fn pack_light(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] light: &[[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] image: &mut [u32],
) {
    kernel::pack_light::pack_light(kernel::id(thread.to_array(), params), params, light, image);
}

/// See `umbra4_core::kernel::accumulate`.
#[spirv(compute(threads(64)))]
pub fn accumulate(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] lit: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] sums: &mut [u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] image: &mut [u32],
) {
    kernel::accumulate::accumulate(kernel::id(thread.to_array(), params), params, lit, sums, image);
}

/// One more, where something is refused.
fn count(refused: bool, counter: &mut u32) {
    if refused {
        // SAFETY: the counter lies in a storage buffer, and is touched by atomics only.
        unsafe { atomic_i_add::<u32, { Scope::QueueFamily as u32 }, { Semantics::NONE.bits() }>(counter, 1) };
    }
}

/// See `umbra4_core::kernel::snap_vertices`.
#[spirv(compute(threads(64)))]
pub fn snap_vertices(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MeshParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] snapped: &mut [[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] status: &mut Status,
) {
    let id = kernel::id(thread.to_array(), params);
    count(kernel::snap_vertices::snap_vertices(id, params, vertices, snapped), &mut status.vertices);
}

/// See `umbra4_core::kernel::snap_vertices`.
#[spirv(compute(threads(64)))]
pub fn snap_instances(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MeshParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] instances: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] snapped: &mut [[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] status: &mut Status,
) {
    let id = kernel::id(thread.to_array(), params);
    count(kernel::snap_vertices::snap_instances(id, params, vertices, instances, snapped), &mut status.vertices);
}

/// See `umbra4_core::kernel::triangles`.
#[spirv(compute(threads(64)))]
pub fn index_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MeshParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] indices: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &mut [[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] status: &mut Status,
) {
    let id = kernel::id(thread.to_array(), params);
    count(kernel::triangles::index_triangles(id, params, indices, triangles), &mut status.triangles);
}

/// See `umbra4_core::kernel::triangles`.
#[spirv(compute(threads(64)))]
pub fn number_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MeshParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] triangles: &mut [[u32; 3]],
) {
    kernel::triangles::number_triangles(kernel::id(thread.to_array(), params), params, triangles);
}

type Texture = Image!(2D, type=f32, sampled);
type Samples = Image!(2D, type=f32, sampled, multisampled);

type Ids = Image!(2D, type=u32, sampled);
type IdSamples = Image!(2D, type=u32, sampled, multisampled);

fn id_of(image: &Ids, texel: [u32; 2], _: &ViewParams) -> u32 {
    image.fetch(UVec2::from_array(texel)).x
}

fn id_sample_of(image: &IdSamples, texel: [u32; 2], params: &ViewParams) -> u32 {
    image.fetch_with(UVec2::from_array(texel), sample_with::sample_index(params.sample)).x
}

fn texel_of(image: &Texture, texel: [u32; 2], _: &ViewParams) -> [f32; 4] {
    image.fetch(UVec2::from_array(texel)).to_array()
}

fn sample_of(image: &Samples, texel: [u32; 2], params: &ViewParams) -> [f32; 4] {
    image.fetch_with(UVec2::from_array(texel), sample_with::sample_index(params.sample)).to_array()
}

macro_rules! receivers {
    ($positions:ident, $depths:ident: $image:ty, $fetch:ident) => {
        /// See `umbra4_core::kernel::snap_receivers`.
        #[spirv(compute(threads(64)))]
        pub fn $positions(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &ViewParams,
            #[spirv(descriptor_set = 0, binding = 1)] positions: &$image,
            #[spirv(descriptor_set = 0, binding = 2)] normals: &$image,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] receivers: &mut [[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] status: &mut Status,
        ) {
            let id = kernel::id(thread.to_array(), params);
            if let Some(texel) = snap_receivers::texel(id, params) {
                let up = snap_receivers::upwards(params, $fetch(normals, texel, params));
                let position = $fetch(positions, texel, params);
                count(snap_receivers::snap_position(id, params, position, up, receivers), &mut status.receivers);
            }
        }

        /// See `umbra4_core::kernel::snap_receivers`.
        #[spirv(compute(threads(64)))]
        pub fn $depths(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &ViewParams,
            #[spirv(descriptor_set = 0, binding = 1)] depths: &$image,
            #[spirv(descriptor_set = 0, binding = 2)] normals: &$image,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] receivers: &mut [[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] status: &mut Status,
        ) {
            let id = kernel::id(thread.to_array(), params);
            if let Some(texel) = snap_receivers::texel(id, params) {
                let up = snap_receivers::upwards(params, $fetch(normals, texel, params));
                let depth = $fetch(depths, texel, params)[0];
                count(snap_receivers::snap_depth(id, params, texel, depth, up, receivers), &mut status.receivers);
            }
        }
    };
}

macro_rules! owned_receivers {
    ($positions:ident, $depths:ident: $image:ty, $fetch:ident, $ids:ty, $fetch_id:ident) => {
        /// See `umbra4_core::kernel::snap_receivers`.
        #[spirv(compute(threads(64)))]
        pub fn $positions(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &ViewParams,
            #[spirv(descriptor_set = 0, binding = 1)] positions: &$image,
            #[spirv(descriptor_set = 0, binding = 2)] normals: &$image,
            #[spirv(descriptor_set = 0, binding = 3)] owners: &$ids,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] vertices: &[[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] triangles: &[[u32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] receivers: &mut [[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] status: &mut Status,
        ) {
            let id = kernel::id(thread.to_array(), params);
            if let Some(texel) = snap_receivers::texel(id, params) {
                let (normal, owner) = ($fetch(normals, texel, params), $fetch_id(owners, texel, params));
                let up = snap_receivers::upwards_of(params, normal, owner, vertices, triangles);
                let position = $fetch(positions, texel, params);
                count(snap_receivers::snap_position(id, params, position, up, receivers), &mut status.receivers);
            }
        }

        /// See `umbra4_core::kernel::snap_receivers`.
        #[spirv(compute(threads(64)))]
        pub fn $depths(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &ViewParams,
            #[spirv(descriptor_set = 0, binding = 1)] depths: &$image,
            #[spirv(descriptor_set = 0, binding = 2)] normals: &$image,
            #[spirv(descriptor_set = 0, binding = 3)] owners: &$ids,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] vertices: &[[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] triangles: &[[u32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] receivers: &mut [[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] status: &mut Status,
        ) {
            let id = kernel::id(thread.to_array(), params);
            if let Some(texel) = snap_receivers::texel(id, params) {
                let (normal, owner) = ($fetch(normals, texel, params), $fetch_id(owners, texel, params));
                let up = snap_receivers::upwards_of(params, normal, owner, vertices, triangles);
                let depth = $fetch(depths, texel, params)[0];
                count(snap_receivers::snap_depth(id, params, texel, depth, up, receivers), &mut status.receivers);
            }
        }
    };
}

receivers!(snap_positions, snap_depths: Texture, texel_of);
receivers!(snap_position_samples, snap_depth_samples: Samples, sample_of);
owned_receivers!(snap_owned_positions, snap_owned_depths: Texture, texel_of, Ids, id_of);
owned_receivers!(snap_owned_position_samples, snap_owned_depth_samples: Samples, sample_of, IdSamples, id_sample_of);

/// See `umbra4_core::kernel::half`.
#[spirv(compute(threads(64)))]
pub fn thin(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &ViewParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] thinned: &mut [[i32; 3]],
) {
    kernel::half::thin(kernel::id(thread.to_array(), params), params, receivers, thinned);
}

macro_rules! facings {
    ($($name:ident: $image:ty, $fetch:ident;)*) => {$(
        /// See `umbra4_core::kernel::face_pixels`.
        #[spirv(compute(threads(64)))]
        pub fn $name(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &ViewParams,
            #[spirv(descriptor_set = 0, binding = 1)] normals: &$image,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &mut [u32],
        ) {
            let id = kernel::id(thread.to_array(), params);
            if let Some(texel) = snap_receivers::texel(id, params) {
                kernel::face_pixels::face_pixel(id, params, $fetch(normals, texel, params), facings);
            }
        }
    )*};
}

facings! {
    face_pixels: Texture, texel_of;
    face_pixel_samples: Samples, sample_of;
}

/// See `umbra4_core::kernel::face_pixels`.
#[spirv(compute(threads(64)))]
pub fn thin_facings(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &ViewParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] thinned: &mut [u32],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::face_pixels::thin_facings(id, params, receivers, facings, thinned);
}

macro_rules! upsample {
    ($($name:ident: $channels:literal;)*) => {$(
        /// See `umbra4_core::kernel::half`.
        #[spirv(compute(threads(64)))]
        pub fn $name(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &ViewParams,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] thinned: &[[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] lit: &[[u32; $channels]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] upsampled: &mut [[u32; $channels]],
        ) {
            kernel::half::upsample(kernel::id(thread.to_array(), params), params, receivers, thinned, lit, upsampled);
        }
    )*};
}

upsample! {
    upsample: 1;
    upsample_light: 3;
}

/// See `umbra4_core::kernel::probe`.
#[spirv(compute(threads(64)))]
pub fn probe(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] words: &[[u32; 8]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] out: &mut [[u32; 8]],
) {
    kernel::probe::probe(kernel::id(thread.to_array(), params), params, words, out);
}
