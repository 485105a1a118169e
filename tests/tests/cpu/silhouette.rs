//! The silhouette of meshes: what is looked at for it, and that it is the same however the mesh is stored. (Its bits are compared
//! with the oracle in `conformance.rs`.)

use umbra4_core::{Counts, Jitter, LatticeLight, glam::IVec3};
use umbra4_cpu::{CpuExecutor, Index};
use umbra4_tests::{
    compare::{Amount, compare_masks},
    meshes::{Mesh, icosphere},
    rng::Rng,
    scene::Scene,
};

const HEIGHT: i32 = 1 << 22;
const SIDE: u32 = 16;

/// A finely jagged ball between a floor of receivers and a lamp.
fn ball() -> Scene {
    let mut rng = Rng::named(0, "silhouette of a ball");
    let step = HEIGHT / 64;
    let half = step * SIDE as i32 / 2;
    let light = LatticeLight {
        origin: IVec3::new(-half, HEIGHT, -half),
        step_u: IVec3::new(step, 0, 0),
        step_v: IVec3::new(0, 0, step),
        rows: SIDE,
        columns: SIDE,
        jitter: Jitter::NONE,
    };
    let receivers = (0..2000).map(|_| rng.point(HEIGHT / 2) * IVec3::new(1, 0, 1)).collect();
    let size = f64::from(HEIGHT / 8);
    let mesh = icosphere(IVec3::new(0, HEIGHT / 2, 0), 4, |_| size * (0.99 + 0.01 * rng.unit()));
    Scene { light, receivers, mesh }
}

fn run(scene: &Scene, index: Index) -> (Vec<u16>, Counts) {
    let inputs = scene.inputs(4);
    let executor = CpuExecutor::new().with_threads(2).expect("threads can be started").with_index(index);
    let (masks, statistics) =
        executor.masks::<u16>(&inputs.occluders, &inputs.light, &inputs.receivers).expect("the word fits");
    (masks.into_words(), statistics.counts)
}

#[test]
fn a_mesh_goes_by_its_silhouette() {
    let scene = ball();
    assert!(scene.mesh.triangles.len() > 5000, "fine enough");
    let (masks, counts) = run(&scene, Index::Auto);
    let oracle = scene.inputs(4).oracle();
    let compared = compare_masks(&oracle, &masks, SIDE, SIDE, Amount::Some).unwrap_or_else(|e| panic!("{e}"));
    assert!(compared.blocked > compared.bits / 50 && compared.blocked < compared.bits / 2, "{compared:?}");
    let (same, one_by_one) = run(&scene, Index::Hierarchy);
    assert_eq!(same, masks);
    assert_eq!((one_by_one.edges_tested, one_by_one.edges_kept, one_by_one.receivers_lost), (0, 0, 0));
    assert!(counts.edges_kept > 0 && counts.edges_kept <= counts.edges_tested, "{counts:?}");
    assert!(2 * (counts.edges_kept + counts.pairs_kept) < one_by_one.pairs_kept, "{counts:?} {one_by_one:?}");
    assert!(counts.receivers_lost < scene.receivers.len() as u64 / 50, "{counts:?}");
}

/// Meshes come with vertices that are stored once for every triangle, and wound either way.
#[test]
fn vertices_are_the_same_where_they_lie_in_one_place() {
    let scene = ball();
    let (masks, counts) = run(&scene, Index::Silhouette);
    let mut mesh = Mesh::default();
    for (k, triangle) in scene.mesh.triangles.iter().enumerate() {
        let mut corners = triangle.map(|vertex| scene.mesh.vertices[vertex as usize]);
        corners.rotate_left(k % 3);
        if k % 2 == 0 {
            corners.reverse();
        }
        mesh.add_triangle(corners);
    }
    let soup = Scene { mesh, ..scene };
    let (same, as_many) = run(&soup, Index::Silhouette);
    assert_eq!(same, masks);
    // (Not quite as many: of receivers that are lost the others are not counted, and they come in another order.)
    assert!(as_many.edges_kept.abs_diff(counts.edges_kept) < counts.edges_kept / 100, "{as_many:?} {counts:?}");
    // The edges that are looked at by default are counted by index: none is shared here.
    assert_eq!(run(&soup, Index::Auto).1.edges_kept, 0);
}

/// Where triangles lie on one another, an edge counts as often as they do.
#[test]
fn layers_are_counted() {
    let once = ball();
    let mut twice = once.clone();
    for _ in 0..3 {
        twice.mesh.add(&once.mesh);
    }
    assert_eq!(run(&twice, Index::Silhouette).0, run(&once, Index::Hierarchy).0);
}
