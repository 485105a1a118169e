//! What a GPU runs, on the processor.

use umbra4_core::{
    Exact, Fast, PairWord,
    edge_plane::Occluder,
    kernel::{
        build_level::build_level,
        key_receivers::key_receivers,
        key_triangles::key_triangles,
        order_triangles::order_triangles,
        reduce::reduce,
        resolve::{ReceiverCounts, resolve_counted},
        sort::{count_digits, scan_blocks, scatter_digits, sum_blocks},
    },
    order::Entry,
    params::Params,
    proj4::{KeyTile, Keys},
};

macro_rules! check {
    ($($name:ident = $kernel:expr, ($($argument:ident: $type:ty),*);)*) => {
        $(
            #[unsafe(no_mangle)]
            pub extern "C" fn $name(id: usize, params: &Params $(, $argument: $type)*) {
                $kernel(id, params $(, $argument)*);
            }
        )*
    };
}

check! {
    check_kernel_key_triangles = key_triangles,
        (vertices: &[[i32; 3]], triangles: &[[u32; 3]], keys: &mut [Keys], order: &mut [Entry]);
    check_kernel_key_receivers = key_receivers, (receivers: &[[i32; 3]], keys: &mut [Keys], order: &mut [Entry]);
    check_kernel_count_digits = count_digits, (order: &[Entry], counters: &mut [u32]);
    check_kernel_sum_blocks = sum_blocks, (counters: &mut [u32]);
    check_kernel_scan_blocks = scan_blocks, (counters: &mut [u32]);
    check_kernel_scatter_digits = scatter_digits, (counters: &[u32], order: &[Entry], sorted: &mut [Entry]);
    check_kernel_order_triangles = order_triangles,
        (vertices: &[[i32; 3]], triangles: &[[u32; 3]], keys: &[Keys], order: &[Entry], occluders: &mut [Occluder],
        nodes: &mut [KeyTile]);
    check_kernel_build_level = build_level, (nodes: &mut [KeyTile]);
    check_kernel_resolve_32 = resolve_counted::<u32, Exact>,
        (receivers: &[[i32; 3]], keys: &[Keys], order: &[Entry], occluders: &[Occluder], nodes: &[KeyTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
    check_kernel_resolve_64 = resolve_counted::<PairWord, Fast>,
        (receivers: &[[i32; 3]], keys: &[Keys], order: &[Entry], occluders: &[Occluder], nodes: &[KeyTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
    check_kernel_reduce = reduce, (masks: &[u32], table: &[f32], visibility: &mut [f32]);
}
