//! What executors run.

use umbra4_core::{
    Exact, Executor, Fast, LatticeLight, Lift, PairWord, Pass, Plan,
    frame::LightFrame,
    glam::{IVec3, Vec3},
    jitter::{Pattern, Regular},
    keyed_mesh::{KeyedMesh, VertexKeys},
    lanes::Four,
    occluder::{Facing, Occluder},
    order::{CodeFrame, code},
    proj4::{KeyTile, Keys},
    serial::{Serial, SerialError},
    silhouette::SilhouetteEdge,
    snap::SnapParams,
    stage::{
        build_level::build_level,
        key_receivers::key_receivers,
        key_triangles::key_triangles,
        reduce,
        resolve::{Group, Occlusion, resolve},
        resolve_silhouette::{SilhouetteRoom, SilhouetteScene, resolve_silhouette},
        snap_receivers::snap_receivers,
        snap_vertices::snap_vertices,
    },
};

#[unsafe(no_mangle)]
pub extern "C" fn check_snap_vertices(id: usize, params: &SnapParams, world: &[Vec3]) -> Option<IVec3> {
    snap_vertices(id, params, world)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_snap_receivers(
    id: usize,
    params: &SnapParams,
    lift: Lift,
    world: &[Vec3],
    normals: &[Vec3],
) -> Option<IVec3> {
    snap_receivers(id, params, lift, world, normals)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_key_triangles(
    id: usize,
    frame: &LightFrame,
    light: &LatticeLight,
    vertices: &[IVec3],
    triangles: &[[u32; 3]],
) -> Option<(Keys, Occluder)> {
    key_triangles(id, frame, light, vertices, triangles)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_keyed_tile(
    mesh: &KeyedMesh<'_>,
    ids: core::ops::Range<usize>,
    corner: &LightFrame,
) -> ([KeyTile; 2], Option<Occluder>) {
    let tile = mesh.tile(ids);
    let keys = mesh.light_keys(&tile);
    let [first, ..] = mesh.facings(&tile, &keys);
    ([keys, mesh.corner_keys(&tile, corner)], tile.occluder(0, first))
}

#[unsafe(no_mangle)]
pub extern "C" fn check_keyed_edge(mesh: &KeyedMesh<'_>, from: u32, to: u32) -> Keys {
    mesh.edge_keys(from, to)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_vertex_keys(frame: &LightFrame, vertex: IVec3) -> VertexKeys {
    VertexKeys::new(frame, vertex)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_silhouette_edge(from: IVec3, to: IVec3, facing: Facing) -> SilhouetteEdge {
    SilhouetteEdge::new(from, to, facing.direction())
}

#[unsafe(no_mangle)]
pub extern "C" fn check_key_receivers(
    id: usize,
    frame: &LightFrame,
    light: &LatticeLight,
    receivers: &[IVec3],
) -> Option<Keys> {
    key_receivers(id, frame, light, receivers)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_code(frame: &CodeFrame, keys: &Keys) -> u32 {
    code(frame, keys)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_build_level(id: usize, below: &[KeyTile]) -> KeyTile {
    build_level(id, below)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_plan(plan: &Plan, executor: &mut Counting) {
    let Ok(()) = plan.run(executor);
}

/// Takes whatever passes come.
pub struct Counting(u64);

impl Executor for Counting {
    type Error = core::convert::Infallible;

    #[inline(never)]
    fn dispatch(&mut self, pass: &Pass) -> Result<(), Self::Error> {
        self.0 = self.0.wrapping_add(u64::from(pass.count)).wrapping_add(pass.stage.info().name.len() as u64);
        Ok(())
    }
}

/// What is generic over words and precisions, for one of each; a function of its own each, so that a name can be given.
macro_rules! instantiate {
    ($($module:ident: $word:ty, $precision:ty $(, in $lanes:ident)?;)*) => {$(
        pub mod $module {
            use super::*;

            #[unsafe(export_name = concat!("check_empty_", stringify!($module)))]
            pub extern "C" fn empty(rows: u32) -> Group<$word> {
                Group::empty(rows)
            }

            #[unsafe(export_name = concat!("check_set_", stringify!($module)))]
            pub extern "C" fn set(
                group: &mut Group<$word>,
                lane: usize,
                point: IVec3,
                keys: Option<&Keys>,
                light: &LatticeLight,
            ) {
                match keys {
                    Some(keys) => group.set(lane, point, keys),
                    None => group.set_behind(lane, light),
                }
            }

            #[unsafe(export_name = concat!("check_reduce_", stringify!($module)))]
            pub extern "C" fn lit(rows: &[$word], light: &LatticeLight) -> f32 {
                reduce::visibility(reduce::lit_count(rows, light.columns), light.sample_count())
            }

            // One receiver at a time.
            #[unsafe(export_name = concat!("check_serial_", stringify!($module)))]
            pub extern "C" fn serial(
                executor: &mut Serial<'_, $word, $precision>,
                pass: &Pass,
            ) -> Result<(), SerialError> {
                executor.dispatch(pass)
            }

            $(
                #[unsafe(export_name = concat!("check_resolve_", stringify!($module)))]
                pub extern "C" fn resolve_group(scene: &Occlusion<'_>, samples: &Regular, group: &mut Group<$word>) {
                    resolve::<$lanes, $word, $precision, _>(scene, samples, group);
                }

                #[unsafe(export_name = concat!("check_resolve_silhouette_", stringify!($module)))]
                pub extern "C" fn resolve_group_by_silhouette(
                    scene: &SilhouetteScene<'_>,
                    samples: &Regular,
                    group: &mut Group<$word>,
                    room: &mut SilhouetteRoom<$word>,
                ) {
                    resolve_silhouette::<$lanes, $word, $precision, _>(scene, samples, group, room);
                }
            )?
        }
    )*};
}

// Pairs are words of GPUs, which have no lanes.
instantiate! {
    u16_exact: u16, Exact, in Four;
    u32_exact: u32, Exact, in Four;
    u64_exact: u64, Exact, in Four;
    pair_exact: PairWord, Exact;
    u16_fast: u16, Fast, in Four;
    u32_fast: u32, Fast, in Four;
    u64_fast: u64, Fast, in Four;
    pair_fast: PairWord, Fast;
}

// Jittered samples one by one are among GPUs' kernels.

#[unsafe(no_mangle)]
pub extern "C" fn check_resolve_silhouette_jittered(
    scene: &SilhouetteScene<'_>,
    samples: &Pattern,
    group: &mut Group<u32>,
    room: &mut SilhouetteRoom<u32>,
) {
    resolve_silhouette::<f32, u32, Exact, _>(scene, samples, group, room);
}
