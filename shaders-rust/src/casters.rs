//! The kernels of casters as SPIR-V entry points: nothing but bindings. What they do is `umbra4_core::kernel::casters`.

use spirv_std::{glam::UVec3, spirv};
use umbra4_core::{
    PairWord,
    jitter::Regular,
    kernel::{self, casters, weigh::PackedWeight},
    occluder::Occluder,
    order::Entry,
    params::{CasterParams, Params},
    proj4::{KeyTile, Keys},
    tint::Depth,
};

/// See `umbra4_core::kernel::key_triangles`.
#[spirv(compute(threads(64), entry_point_name = "key_caster_triangles"))]
pub fn key_caster_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CasterParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] vertices: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] triangles: &[[u32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] keys: &mut [Keys],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] order: &mut [Entry],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::key_triangles::key_triangles(id, params, vertices, triangles, keys, order);
}

/// See `umbra4_core::kernel::order_triangles`.
#[spirv(compute(threads(64), entry_point_name = "order_caster_triangles"))]
pub fn order_caster_triangles(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CasterParams,
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

/// See `umbra4_core::kernel::casters`.
#[spirv(compute(threads(64), entry_point_name = "select_receivers"))]
pub fn select_receivers(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &CasterParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] order: &[Entry],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] layers: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] selected: &mut [Entry],
) {
    casters::select_receivers(kernel::id(thread.to_array(), params), params, order, layers, selected);
}

macro_rules! resolve_cutout {
    ($($name:ident, $entry:tt: $word:ty, $params:ident => $samples:expr;)*) => {
        $(
            /// See `umbra4_core::kernel::casters`.
            #[spirv(compute(threads(64), entry_point_name = $entry))]
            pub fn $name(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] $params: &CasterParams,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &[Keys],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &[KeyTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] surface: &[u32],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] masks: &mut [u32],
            ) {
                let id = kernel::id(thread.to_array(), $params);
                casters::resolve_cutout::<$word, _>(
                    id, $params, $samples, receivers, keys, order, occluders, nodes, surface, masks,
                );
            }
        )*
    };
}

resolve_cutout! {
    resolve_cutout_32, "resolve_cutout_32": u32, params => &Regular;
    resolve_cutout_64, "resolve_cutout_64": PairWord, params => &Regular;
    resolve_cutout_32_jittered, "resolve_cutout_32_jittered": u32, params => &params.pattern;
    resolve_cutout_64_jittered, "resolve_cutout_64_jittered": PairWord, params => &params.pattern;
}

macro_rules! add_tint {
    ($($name:ident, $entry:tt: $params:ident => $samples:expr;)*) => {
        $(
            /// See `umbra4_core::kernel::casters`.
            #[spirv(compute(threads(64), entry_point_name = $entry))]
            pub fn $name(
                #[spirv(global_invocation_id)] thread: UVec3,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] $params: &CasterParams,
                #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] keys: &[Keys],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] order: &[Entry],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] occluders: &[Occluder],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] nodes: &[KeyTile],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] surface: &[u32],
                #[spirv(storage_buffer, descriptor_set = 0, binding = 7)] depths: &mut [Depth],
            ) {
                let id = kernel::id(thread.to_array(), $params);
                casters::add_tint(id, $params, $samples, receivers, keys, order, occluders, nodes, surface, depths);
            }
        )*
    };
}

add_tint! {
    add_tint, "add_tint": params => &Regular;
    add_tint_jittered, "add_tint_jittered": params => &params.pattern;
}

/// See `umbra4_core::kernel::weigh_tinted`.
#[spirv(compute(threads(64), entry_point_name = "weigh_tinted"))]
pub fn weigh_tinted(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &Params,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] masks: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] weights: &[PackedWeight],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] depths: &[Depth],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] table: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] light: &mut [[u32; 3]],
) {
    let id = kernel::id(thread.to_array(), params);
    kernel::weigh_tinted::weigh_tinted(id, params, masks, weights, depths, table, light);
}
