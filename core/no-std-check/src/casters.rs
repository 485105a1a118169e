//! Casters: what hosts pack, what executors run, and the kernels.

use umbra4_core::{
    CasterWork, Layers, PackedCaster, PairWord,
    edge_plane::LightGrid,
    emission::{Emission, Weight},
    glam::{IVec3, Vec2},
    jitter::{Pattern, Regular},
    kernel::{self, weigh::PackedWeight},
    lanes::Four,
    layers::LayerError,
    occluder::Occluder,
    order::Entry,
    params::{CasterParams, Params, PassParams},
    proj4::{KeyTile, Keys},
    stage::{
        add_tint::{TintScene, add_tint},
        key_triangles::{Casting, keys_of_caster},
        resolve::Group,
        resolve_cutout::{CutoutScene, resolve_cutout},
    },
    surface_words::{SurfaceKind, SurfaceLayout},
    texture::{Coordinate, TextureError, TextureSize, TexturedTriangle},
    tint::{Depth, depth_of_tint},
};

#[unsafe(no_mangle)]
pub extern "C" fn check_layers(numbers: &[u32]) -> Result<Layers, LayerError> {
    Layers::of(numbers)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_texture(
    size: TextureSize,
    texels: usize,
    coordinates: [Vec2; 3],
) -> Result<TexturedTriangle, TextureError> {
    size.check(texels)?;
    let [a, b, c] = coordinates;
    size.triangle(texels, [Coordinate::snap(0, a)?, Coordinate::snap(1, b)?, Coordinate::snap(2, c)?])
}

#[unsafe(no_mangle)]
pub extern "C" fn check_tint(index: usize, tint: [f32; 3]) -> Result<Depth, TextureError> {
    depth_of_tint(index, tint)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_caster(caster: &PackedCaster<'_>, params: &Params) -> (CasterWork, CasterParams) {
    (caster.work(), CasterParams::new(*params, caster))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_surface(texture: TextureSize, triangles: u32, kind: SurfaceKind) -> Option<u32> {
    SurfaceLayout::new(texture, triangles).words(kind)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_keys_of_caster(
    grid: &LightGrid,
    corners: [IVec3; 3],
    casting: Casting,
) -> Option<(Keys, Occluder)> {
    keys_of_caster(grid, corners, casting)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_lit_through(emission: &Emission<&[Weight]>, rows: &[u64], depths: &[Depth]) -> [u32; 3] {
    emission.lit_through(rows, depths)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_resolve_cutout(
    scene: &CutoutScene<'_>,
    samples: &Regular,
    group: &mut Group<u64>,
    room: &mut Group<u64>,
) {
    resolve_cutout::<Four, u64, _>(scene, samples, group, room);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_add_tint(
    scene: &TintScene<'_>,
    samples: &Regular,
    group: &mut Group<u32>,
    room: &mut Group<u32>,
    depths: &mut [Depth],
    tinted: &mut u32,
) {
    add_tint::<Four, u32, _>(scene, samples, group, room, depths, tinted);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_kernel_key_caster_triangles(
    id: usize,
    params: &CasterParams,
    pass: &PassParams,
    vertices: &[[i32; 3]],
    triangles: &[[u32; 3]],
    keys: &mut [Keys],
    order: &mut [Entry],
) {
    kernel::key_triangles::key_triangles(id, &params.with_pass(pass), vertices, triangles, keys, order);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_kernel_select_receivers(
    id: usize,
    params: &CasterParams,
    order: &[Entry],
    layers: &[u32],
    selected: &mut [Entry],
) {
    kernel::casters::select_receivers(id, params, order, layers, selected);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_kernel_resolve_cutout(
    id: usize,
    params: &CasterParams,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    surface: &[u32],
    masks: &mut [u32],
) {
    let samples: &Pattern = &params.pattern;
    kernel::casters::resolve_cutout::<PairWord, _>(
        id, params, samples, receivers, keys, order, occluders, nodes, surface, masks,
    );
}

#[unsafe(no_mangle)]
pub extern "C" fn check_kernel_add_tint(
    id: usize,
    params: &CasterParams,
    receivers: &[[i32; 3]],
    keys: &[Keys],
    order: &[Entry],
    occluders: &[Occluder],
    nodes: &[KeyTile],
    surface: &[u32],
    depths: &mut [Depth],
) {
    kernel::casters::add_tint(id, params, &Regular, receivers, keys, order, occluders, nodes, surface, depths);
}

#[unsafe(no_mangle)]
pub extern "C" fn check_kernel_weigh_tinted(
    id: usize,
    params: &Params,
    masks: &[u32],
    weights: &[PackedWeight],
    depths: &[Depth],
    table: &[u32],
    light: &mut [[u32; 3]],
) {
    kernel::weigh_tinted::weigh_tinted(id, params, masks, weights, depths, table, light);
}
