//! What executors run.

use umbra4_core::{
    Exact, Executor, Fast, LatticeLight, Lift, PairWord, Pass, Plan,
    edge_plane::Occluder,
    frame::LightFrame,
    glam::{IVec3, Vec3},
    jitter::{Pattern, Regular},
    lanes::Sixteen,
    order::{CodeFrame, code},
    proj4::{KeyTile, Keys, VertexKeys},
    serial::{Serial, SerialError},
    silhouette::{SilhouetteEdge, direction},
    snap::SnapParams,
    stage::{
        build_level::build_level,
        key_receivers::key_receivers,
        key_triangles::{key_between, key_triangles},
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
pub extern "C" fn check_key_between(
    id: usize,
    frame: &LightFrame,
    light: &LatticeLight,
    vertices: &[IVec3],
    vertex_keys: &[VertexKeys],
    triangles: &[[u32; 3]],
) -> Option<(Keys, Occluder)> {
    key_between(id, frame, light, vertices, vertex_keys, triangles)
}

#[unsafe(no_mangle)]
pub extern "C" fn check_vertex_keys(frame: &LightFrame, vertex: IVec3) -> (VertexKeys, Keys, Keys) {
    let keys = VertexKeys::new(frame, vertex);
    (keys, keys.for_light(), keys.for_corner())
}

#[unsafe(no_mangle)]
pub extern "C" fn check_silhouette_edge(from: IVec3, occluder: &Occluder) -> SilhouetteEdge {
    SilhouetteEdge::new(from, occluder.corner(1), direction(occluder, from))
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

/// Everything that is generic, for one word and one precision; a function of its own each, so that a name can be given.
macro_rules! instantiate {
    ($($module:ident: $word:ty, $precision:ty;)*) => {$(
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

            #[unsafe(export_name = concat!("check_resolve_sixteen_", stringify!($module)))]
            pub extern "C" fn resolve_sixteen(scene: &Occlusion<'_>, samples: &Regular, group: &mut Group<$word>) {
                resolve::<Sixteen, $word, $precision, _>(scene, samples, group);
            }

            #[unsafe(export_name = concat!("check_resolve_silhouette_sixteen_", stringify!($module)))]
            pub extern "C" fn resolve_silhouette_sixteen(
                scene: &SilhouetteScene<'_>,
                samples: &Regular,
                group: &mut Group<$word>,
                room: &mut SilhouetteRoom<$word>,
            ) {
                resolve_silhouette::<Sixteen, $word, $precision, _>(scene, samples, group, room);
            }

            #[unsafe(export_name = concat!("check_resolve_silhouette_one_", stringify!($module)))]
            pub extern "C" fn resolve_silhouette_one(
                scene: &SilhouetteScene<'_>,
                samples: &Regular,
                group: &mut Group<$word>,
                room: &mut SilhouetteRoom<$word>,
            ) {
                resolve_silhouette::<f32, $word, $precision, _>(scene, samples, group, room);
            }

            #[unsafe(export_name = concat!("check_resolve_one_", stringify!($module)))]
            pub extern "C" fn resolve_one(scene: &Occlusion<'_>, samples: &Regular, group: &mut Group<$word>) {
                resolve::<f32, $word, $precision, _>(scene, samples, group);
            }

            #[unsafe(export_name = concat!("check_reduce_", stringify!($module)))]
            pub extern "C" fn lit(rows: &[$word], light: &LatticeLight) -> f32 {
                reduce::visibility(reduce::lit_count(rows, light.columns), light.sample_count())
            }

            #[unsafe(export_name = concat!("check_serial_", stringify!($module)))]
            pub extern "C" fn serial(
                executor: &mut Serial<'_, $word, $precision>,
                pass: &Pass,
            ) -> Result<(), SerialError> {
                executor.dispatch(pass)
            }
        }
    )*};
}

instantiate! {
    u16_exact: u16, Exact;
    u32_exact: u32, Exact;
    u64_exact: u64, Exact;
    pair_exact: PairWord, Exact;
    u16_fast: u16, Fast;
    u32_fast: u32, Fast;
    u64_fast: u64, Fast;
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
