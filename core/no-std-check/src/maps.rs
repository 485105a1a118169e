//! umbra4-maps: its kernels, as a GPU runs them and a processor may, and what fits a map to a light.

// A kernel's arguments are its bindings.
#![allow(clippy::too_many_arguments)]

use umbra4_core::{LatticeLight, PairWord, glam::IVec3};
use umbra4_maps::{
    kernel::{
        microquads::{build_parents, build_tiles, draw_map, gather_areas, gather_masks},
        stochastic::{levels, light_field, radii, receivers, samples, tiles},
    },
    microquad::{
        Footprint, HalfSpaces, MicroquadError, MicroquadOptions, fit,
        gather::{Rectangles, Rows, Table},
        half_spaces::write_table,
        params::MicroquadParams,
    },
    pyramid,
    stochastic::{
        StochasticError, StochasticOptions,
        elementary::Elementary,
        fit::Fit,
        gather::Gathered,
        params::LensParams,
        trace::{Corners, Node},
    },
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

fn keep(word: &mut u32, own: u32) {
    *word = own.max(*word);
}

fn set(word: &mut u32, bits: u32) {
    *word |= bits;
}

check! {
    of MicroquadParams:
    check_draw_map = |id, params, vertices, triangles, map| draw_map(id, params, vertices, triangles, map, keep),
        (vertices: &[[i32; 3]], triangles: &[[u32; 3]], map: &mut [u32]);
    check_build_tiles = build_tiles, (map: &[u32], nodes: &mut [pyramid::Node]);
    check_build_parents = build_parents, (nodes: &mut [pyramid::Node]);
    check_gather_rows_32 = gather_masks::<u32, Rows>,
        (receivers: &[[i32; 3]], facings: &[u32], map: &[u32], nodes: &[pyramid::Node], table: &[u32], masks: &mut [u32]);
    check_gather_rows_64 = gather_masks::<PairWord, Rows>,
        (receivers: &[[i32; 3]], facings: &[u32], map: &[u32], nodes: &[pyramid::Node], table: &[u32], masks: &mut [u32]);
    check_gather_table_32 = gather_masks::<u32, Table>,
        (receivers: &[[i32; 3]], facings: &[u32], map: &[u32], nodes: &[pyramid::Node], table: &[u32], masks: &mut [u32]);
    check_gather_table_64 = gather_masks::<PairWord, Table>,
        (receivers: &[[i32; 3]], facings: &[u32], map: &[u32], nodes: &[pyramid::Node], table: &[u32], masks: &mut [u32]);
    check_gather_rectangles_32 = gather_masks::<u32, Rectangles>,
        (receivers: &[[i32; 3]], facings: &[u32], map: &[u32], nodes: &[pyramid::Node], table: &[u32], masks: &mut [u32]);
    check_gather_areas = gather_areas,
        (receivers: &[[i32; 3]], facings: &[u32], map: &[u32], nodes: &[pyramid::Node], areas: &mut [u32]);
}

check! {
    of LensParams:
    check_place_triangles = light_field::place_triangles,
        (vertices: &[[i32; 3]], triangles: &[[u32; 3]], order: &[u32], placed: &mut [Corners]);
    check_bound_triangles = light_field::bound_triangles, (placed: &[Corners], nodes: &mut [Node]);
    check_bound_nodes = light_field::bound_nodes, (nodes: &mut [Node]);
    check_sample_light_field = light_field::sample_light_field,
        (placed: &[Corners], nodes: &[Node], depths: &mut [f32]);
    check_mark_looked_at = |id, params, receivers, tiles| tiles::mark_looked_at(id, params, receivers, tiles, set),
        (receivers: &[[i32; 3]], tiles: &mut [u32]);
    check_mark_active = |id, params, tiles| tiles::mark_active(id, params, tiles, set), (tiles: &mut [u32]);
    check_mark_data = |id, params, tiles| tiles::mark_data(id, params, tiles, set), (tiles: &mut [u32]);
    check_mark_merged = |id, params, tiles| tiles::mark_merged(id, params, tiles, set), (tiles: &mut [u32]);
    check_clear_lists = samples::clear_lists, (heads: &mut [u32]);
    check_link_samples = |id, params, heads, next| samples::link_samples(id, params, heads, next, core::mem::replace),
        (heads: &mut [u32], next: &mut [u32]);
    check_merge_samples = samples::merge_samples,
        (tiles: &[u32], heads: &[u32], next: &[u32], depths: &[f32], samples: &mut [Elementary]);
    check_find_closest = radii::find_closest, (tiles: &[u32], samples: &[Elementary], found: &mut [f32]);
    check_raise_radii = radii::raise_radii,
        (tiles: &[u32], samples: &[Elementary], found: &[f32], raised: &mut [f32]);
    check_lend_radii = radii::lend_radii, (raised: &[f32], samples: &mut [Elementary]);
    check_coarsen_samples = levels::coarsen_samples, (tiles: &[u32], samples: &mut [Elementary]);
    check_find_widest = levels::find_widest, (samples: &[Elementary], widest: &mut [f32]);
    check_gather_samples = levels::gather_samples,
        (tiles: &[u32], widest: &[f32], samples: &[Elementary], gathered: &mut [Gathered]);
    check_resolve_level = levels::resolve_level, (tiles: &[u32], gathered: &[Gathered], resolved: &mut [Gathered]);
    check_look_up = receivers::look_up, (receivers: &[[i32; 3]], plane: &[Gathered], sums: &mut [Gathered]);
    check_find_visibility = receivers::find_visibility,
        (receivers: &[[i32; 3]], facings: &[u32], sums: &[Gathered], visibility: &mut [f32]);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_fit_microquads(
    options: &MicroquadOptions,
    light: &LatticeLight,
    receivers: &[IVec3],
    corners: &[[IVec3; 3]],
) -> Result<(MicroquadParams, u64), MicroquadError> {
    options.check(light)?;
    Ok(fit::fitted(options, light, receivers.iter().copied(), corners.iter().copied()))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_write_table(light: &LatticeLight, fineness: HalfSpaces, words: &mut [u32]) -> Footprint {
    write_table(light, fineness, words);
    Footprint::Table(fineness)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_fit_stochastic(
    light: &LatticeLight,
    receivers: &[IVec3],
    options: &StochasticOptions,
) -> Result<Option<(Fit, LensParams)>, StochasticError> {
    Ok(Fit::new(light, receivers, options)?.map(|fit| (fit, fit.params(options, 1))))
}
