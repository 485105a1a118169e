//! Kernels of `umbra4_maps::kernel::microquads`.

use spirv_std::{
    arch::atomic_u_max,
    glam::UVec3,
    memory::{Scope, Semantics},
    spirv,
};
use umbra4_core::{PairWord, kernel};
use umbra4_maps::{
    kernel::microquads,
    microquad::{
        gather::{Rectangles, Rows, Table},
        params::MicroquadParams,
    },
    pyramid::Node,
};

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

macro_rules! gather {
    ($($name:ident: $entry:literal, $word:ty, $footprints:ty;)*) => {$(
        /// See `umbra4_maps::kernel::microquads`. The table is not read.
        #[spirv(compute(threads(64), entry_point_name = $entry))]
        pub fn $name(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MicroquadParams,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &[u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] map: &[u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &[Node],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] masks: &mut [u32],
        ) {
            let id = kernel::id(thread.to_array(), params);
            microquads::gather_masks::<$word, $footprints>(id, params, receivers, facings, map, nodes, map, masks);
        }
    )*};
}

gather! {
    gather_rows_32: "gather_rows_32", u32, Rows;
    gather_rows_64: "gather_rows_64", PairWord, Rows;
    gather_rectangles_32: "gather_rectangles_32", u32, Rectangles;
    gather_rectangles_64: "gather_rectangles_64", PairWord, Rectangles;
}

macro_rules! gather_by_table {
    ($($name:ident: $entry:literal, $word:ty;)*) => {$(
        /// See `umbra4_maps::kernel::microquads`.
        #[spirv(compute(threads(64), entry_point_name = $entry))]
        pub fn $name(
            #[spirv(global_invocation_id)] thread: UVec3,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MicroquadParams,
            #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &[u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] map: &[u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &[Node],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] masks: &mut [u32],
            #[spirv(storage_buffer, descriptor_set = 0, binding = 6)] table: &[u32],
        ) {
            let id = kernel::id(thread.to_array(), params);
            microquads::gather_masks::<$word, Table>(id, params, receivers, facings, map, nodes, table, masks);
        }
    )*};
}

gather_by_table! {
    gather_table_32: "gather_table_32", u32;
    gather_table_64: "gather_table_64", PairWord;
}

/// See `umbra4_maps::kernel::microquads`.
#[spirv(compute(threads(64), entry_point_name = "gather_areas"))]
pub fn gather_areas(
    #[spirv(global_invocation_id)] thread: UVec3,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 0)] params: &MicroquadParams,
    #[spirv(storage_buffer, descriptor_set = 0, binding = 1)] receivers: &[[i32; 3]],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 2)] facings: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 3)] map: &[u32],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 4)] nodes: &[Node],
    #[spirv(storage_buffer, descriptor_set = 0, binding = 5)] areas: &mut [u32],
) {
    let id = kernel::id(thread.to_array(), params);
    microquads::gather_areas(id, params, receivers, facings, map, nodes, areas);
}
