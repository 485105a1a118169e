//! What a GPU runs, on the processor.

// A kernel's arguments are its bindings.
#![allow(clippy::too_many_arguments)]

use umbra4_core::{
    Exact, Fast, PairWord, PrecisionMode,
    gbuffer::ViewParams,
    irradiance::PackedSample,
    jitter::Regular,
    kernel::{
        accumulate::accumulate,
        build_level::build_level,
        dispatch::{Dispatch, MaskLayout, counters, dispatches},
        face_pixels::{face_pixel, thin_facings},
        half::{thin, upsample},
        illuminate::illuminate,
        key_receivers::key_receivers,
        key_triangles::key_triangles,
        order_cloud::{
            build_box_level, key_cloud_receivers, key_cloud_triangles, order_cloud_triangles, settle_cloud_receivers,
        },
        order_triangles::order_triangles,
        pack::pack,
        pack_light::pack_light,
        probe::probe,
        reduce::reduce,
        resolve::{DeviceWord, ReceiverCounts, resolve_counted},
        resolve_cloud::{SampleTile, resolve_cloud_counted},
        resolve_cloud_by_table::TableWord,
        resolve_punctual::resolve_punctual_counted,
        settle_receivers::{settle_punctual_receivers, settle_receivers},
        snap_receivers::{snap_depth, snap_position, upwards, upwards_of},
        snap_vertices::{snap_instances, snap_vertices},
        sort::{count_digits, scan_blocks, scatter_digits, sum_blocks},
        triangles::{index_triangles, number_triangles},
        weigh::{PackedWeight, weigh},
    },
    mesh::MeshParams,
    occluder::Occluder,
    order::Entry,
    params::{CloudParams, JitteredParams, Params, PunctualParams},
    plan::{Pass, Plan},
    proj4::{KeyTile, Keys},
    shaft::BoxTile,
    surface::Upwards,
};

macro_rules! check {
    (of $params:ty: $($name:ident = $kernel:expr, ($($argument:ident: $type:ty),*);)*) => {
        $(
            #[unsafe(no_mangle)]
            pub extern "C" fn $name(id: usize, params: &$params $(, $argument: $type)*) {
                $kernel(id, params $(, $argument)*);
            }
        )*
    };
}

/// As the entry points of regular samples call it.
#[inline(always)]
fn resolve_regular<W: DeviceWord, P: PrecisionMode>(
    id: usize,
    params: &Params,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    masks: &mut [u32],
    counts: &mut [ReceiverCounts],
) {
    let samples = &Regular;
    resolve_counted::<W, P, _>(id, params, samples, receivers, keys, order, occluders, nodes, masks, counts);
}

/// As those of jittered samples do.
#[inline(always)]
fn resolve_jittered<W: DeviceWord, P: PrecisionMode>(
    id: usize,
    told: &JitteredParams,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    masks: &mut [u32],
    counts: &mut [ReceiverCounts],
) {
    let (params, samples) = (&told.params, &told.pattern);
    resolve_counted::<W, P, _>(id, params, samples, receivers, keys, order, occluders, nodes, masks, counts);
}

check! { of Params:
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
    check_kernel_build_box_level = build_box_level, (nodes: &mut [BoxTile]);
    check_kernel_resolve_32 = resolve_regular::<u32, Exact>,
        (receivers: &[[i32; 3]], keys: &[Keys], order: &[Entry], occluders: &[Occluder], nodes: &[KeyTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
    check_kernel_resolve_64 = resolve_regular::<PairWord, Fast>,
        (receivers: &[[i32; 3]], keys: &[Keys], order: &[Entry], occluders: &[Occluder], nodes: &[KeyTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
    check_kernel_settle_receivers = settle_receivers,
        (receivers: &[[i32; 3]], facings: &[u32], order: &mut [Entry]);
    check_kernel_reduce = reduce, (masks: &[u32], lit: &mut [u32]);
    check_kernel_weigh = weigh, (masks: &[u32], weights: &[PackedWeight], light: &mut [[u32; 3]]);
    check_kernel_illuminate = illuminate,
        (masks: &[u32], receivers: &[[i32; 3]], normals: &[[f32; 3]], samples: &[PackedSample],
        irradiance: &mut [[f32; 3]]);
    check_kernel_pack = pack, (lit: &[u32], table: &[u32], image: &mut [u32]);
    check_kernel_pack_light = pack_light, (light: &[[u32; 3]], image: &mut [u32]);
    check_kernel_accumulate = accumulate, (lit: &[u32], sums: &mut [u32], image: &mut [u32]);
    check_kernel_probe = probe, (words: &[[u32; 8]], out: &mut [[u32; 8]]);
}

check! { of JitteredParams:
    check_kernel_resolve_32_jittered = resolve_jittered::<u32, Exact>,
        (receivers: &[[i32; 3]], keys: &[Keys], order: &[Entry], occluders: &[Occluder], nodes: &[KeyTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
    check_kernel_resolve_64_jittered = resolve_jittered::<PairWord, Fast>,
        (receivers: &[[i32; 3]], keys: &[Keys], order: &[Entry], occluders: &[Occluder], nodes: &[KeyTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
}

check! { of PunctualParams:
    check_kernel_key_punctual_triangles = key_triangles,
        (vertices: &[[i32; 3]], triangles: &[[u32; 3]], keys: &mut [Keys], order: &mut [Entry]);
    check_kernel_key_punctual_receivers = key_receivers,
        (receivers: &[[i32; 3]], keys: &mut [Keys], order: &mut [Entry]);
    check_kernel_settle_punctual_receivers = settle_punctual_receivers,
        (receivers: &[[i32; 3]], facings: &[u32], order: &mut [Entry], masks: &mut [u32]);
    check_kernel_order_punctual_triangles = order_triangles,
        (vertices: &[[i32; 3]], triangles: &[[u32; 3]], keys: &[Keys], order: &[Entry], occluders: &mut [Occluder],
        nodes: &mut [KeyTile]);
    check_kernel_resolve_punctual_exact = resolve_punctual_counted::<Exact>,
        (receivers: &[[i32; 3]], keys: &[Keys], order: &[Entry], occluders: &[Occluder], nodes: &[KeyTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
    check_kernel_resolve_punctual_fast = resolve_punctual_counted::<Fast>,
        (receivers: &[[i32; 3]], keys: &[Keys], order: &[Entry], occluders: &[Occluder], nodes: &[KeyTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
}

check! { of CloudParams:
    check_kernel_key_cloud_triangles = key_cloud_triangles,
        (vertices: &[[i32; 3]], triangles: &[[u32; 3]], order: &mut [Entry]);
    check_kernel_key_cloud_receivers = key_cloud_receivers, (receivers: &[[i32; 3]], order: &mut [Entry]);
    check_kernel_settle_cloud_receivers = settle_cloud_receivers,
        (receivers: &[[i32; 3]], facings: &[u32], order: &mut [Entry]);
    check_kernel_order_cloud_triangles = order_cloud_triangles,
        (vertices: &[[i32; 3]], triangles: &[[u32; 3]], order: &[Entry], occluders: &mut [Occluder],
        nodes: &mut [BoxTile]);
    check_kernel_resolve_cloud_exact = resolve_cloud_counted::<Exact, SampleTile>,
        (receivers: &[[i32; 3]], order: &[Entry], occluders: &[Occluder], nodes: &[BoxTile], samples: &[SampleTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
    check_kernel_resolve_cloud_fast = resolve_cloud_counted::<Fast, SampleTile>,
        (receivers: &[[i32; 3]], order: &[Entry], occluders: &[Occluder], nodes: &[BoxTile], samples: &[SampleTile],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
    check_kernel_resolve_cloud_by_table = resolve_cloud_counted::<Exact, TableWord>,
        (receivers: &[[i32; 3]], order: &[Entry], occluders: &[Occluder], nodes: &[BoxTile], table: &[TableWord],
        masks: &mut [u32], counts: &mut [ReceiverCounts]);
}

check! { of MeshParams:
    check_kernel_snap_vertices = snap_vertices, (vertices: &[u32], snapped: &mut [[i32; 3]]);
    check_kernel_snap_instances = snap_instances, (vertices: &[u32], instances: &[u32], snapped: &mut [[i32; 3]]);
    check_kernel_index_triangles = index_triangles, (indices: &[u32], triangles: &mut [[u32; 3]]);
    check_kernel_number_triangles = number_triangles, (triangles: &mut [[u32; 3]]);
}

check! { of ViewParams:
    check_kernel_snap_position = snap_position, (position: [f32; 4], up: Upwards, receivers: &mut [[i32; 3]]);
    check_kernel_snap_depth = snap_depth, (texel: [u32; 2], depth: f32, up: Upwards, receivers: &mut [[i32; 3]]);
    check_kernel_thin = thin, (receivers: &[[i32; 3]], thinned: &mut [[i32; 3]]);
    check_kernel_upsample = upsample::<1>,
        (receivers: &[[i32; 3]], thinned: &[[i32; 3]], lit: &[[u32; 1]], upsampled: &mut [[u32; 1]]);
    check_kernel_upsample_light = upsample::<3>,
        (receivers: &[[i32; 3]], thinned: &[[i32; 3]], lit: &[[u32; 3]], upsampled: &mut [[u32; 3]]);
    check_kernel_face_pixel = face_pixel, (normal: [f32; 4], facings: &mut [u32]);
    check_kernel_thin_facings = thin_facings, (receivers: &[[i32; 3]], facings: &[u32], thinned: &mut [u32]);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_upwards(
    params: &ViewParams,
    normal: [f32; 4],
    owner: u32,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
) -> [Upwards; 2] {
    [upwards(params, normal), upwards_of(params, normal, owner, vertices, triangles)]
}

/// What the kernels of a pass are.
#[unsafe(no_mangle)]
pub extern "C" fn check_dispatches(plan: &Plan, layout: &MaskLayout, pass: &Pass, record: fn(&Dispatch<'_>)) -> u64 {
    let recorded: Result<(), core::convert::Infallible> = dispatches(plan, layout, pass, &mut |dispatch| {
        record(dispatch);
        Ok(())
    });
    recorded.map_or(0, |()| counters(pass.count))
}
