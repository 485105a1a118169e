//! Meshes that are arranged once and then move: what is spared, what is refused. (Their bits are compared with the oracle in
//! `conformance.rs`, too.)

use umbra4_core::{
    AreaLight, Bounds, Lattice, LatticeLight, Lift, SnapError,
    glam::{DVec3, Vec3},
    stage::Stage,
};
use umbra4_cpu::{CpuExecutor, Index, Occluders, Receivers, SceneError};
use umbra4_tests::{
    compare::{Amount, compare_masks},
    meshes::{Mesh, icosphere},
    oracle::oracle_masks,
    rng::Rng,
};

const SIDE: u32 = 16;

fn lattice() -> Lattice {
    Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("bounds are fine")
}

fn light(lattice: &Lattice) -> LatticeLight {
    let light = AreaLight::new(DVec3::new(-1.0, 6.0, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0, SIDE, SIDE);
    light.and_then(|light| light.snap(lattice, Lift::NONE)).expect("the light is fine")
}

/// Points on the floor.
fn receivers(lattice: &Lattice) -> Receivers {
    let mut rng = Rng::named(0, "floor");
    let mut along = || (rng.unit() * 8.0 - 4.0) as f32;
    let points: Vec<Vec3> = (0..600).map(|_| Vec3::new(along(), 0.0, along())).collect();
    Receivers::raw(lattice, &points).expect("the floor is inside")
}

/// A ball and a half, with vertices stored once for every triangle: (vertices, triangles).
fn balls() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut mesh = Mesh::default();
    for (x, size) in [(-1, 1 << 20), (1, 1 << 19)] {
        let center = umbra4_core::glam::IVec3::new(x << 21, 1 << 22, 0);
        let ball = icosphere(center, 3, |_| f64::from(size));
        let half = if x < 0 { ball.triangles.len() } else { ball.triangles.len() / 2 };
        for triangle in &ball.triangles[..half] {
            mesh.add_triangle(triangle.map(|vertex| ball.vertices[vertex as usize]));
        }
    }
    let vertices = mesh.vertices.iter().map(|p| p.as_vec3() / (1 << 21) as f32).collect();
    (vertices, mesh.triangles)
}

/// Where the balls are in a frame: the first falls apart, triangle by triangle, the other is squeezed and moves.
fn placed(rest: &[Vec3], frame: usize) -> Vec<Vec3> {
    let place = |(index, p): (usize, &Vec3)| {
        let (t, triangle) = (frame as f32 / 4.0, index / 3);
        if p.x < 0.0 {
            *p + Vec3::Y * t * ((triangle * 7 % 11) as f32 / 40.0)
        } else {
            *p * (1.0 - 0.3 * t) + Vec3::Z * t
        }
    };
    rest.iter().enumerate().map(place).collect()
}

#[test]
fn a_mesh_that_moves_keeps_its_arrangement() {
    let (lattice, (rest, triangles)) = (lattice(), balls());
    let (light, receivers) = (light(&lattice), receivers(&lattice));
    let executor = CpuExecutor::new().with_threads(2).expect("threads can be started");
    let mut arranged = Occluders::new(&lattice, &rest, &triangles).expect("the balls are inside").arranged();
    let mut kept = Vec::new();
    // The last frame is as the first: what parted has come together again.
    for frame in [0, 1, 2, 3, 0] {
        let vertices = placed(&rest, frame);
        arranged.move_vertices(&lattice, &vertices).expect("the balls stay inside");
        let anew = Occluders::new(&lattice, &vertices, &triangles).expect("the balls stay inside");
        let corners: Vec<_> = (0..triangles.len()).filter_map(|t| anew.corners(t)).collect();
        let oracle = oracle_masks(&light, receivers.points(), &corners);
        for index in [Index::Auto, Index::Hierarchy, Index::Silhouette] {
            let executor = executor.clone().with_index(index);
            let (masks, statistics) = executor.masks::<u16>(&arranged, &light, &receivers).expect("the word fits");
            compare_masks(&oracle, masks.words(), SIDE, SIDE, Amount::Some)
                .unwrap_or_else(|error| panic!("frame {frame}, {index:?}: {error}"));
            if index == Index::Silhouette {
                kept.push(statistics.counts.edges_kept);
            }
        }
    }
    // Neighbours were found by place at first, and those that parted stay apart.
    assert!(2 * kept[0] < kept[1], "{kept:?}");
    assert!(kept[4] > kept[0], "{kept:?}");
}

#[test]
fn an_arranged_mesh_is_not_put_in_order_again() {
    let (lattice, (rest, triangles)) = (lattice(), balls());
    let (light, receivers) = (light(&lattice), receivers(&lattice));
    let executor = CpuExecutor::new();
    let occluders = Occluders::new(&lattice, &rest, &triangles).expect("the balls are inside");
    let runs =
        |occluders: &Occluders| executor.plan(occluders, &light, &receivers, false).reason(Stage::OrderTriangles);
    assert_eq!(runs(&occluders), (true, "triangles to index"));
    let arranged = occluders.clone().arranged();
    assert_eq!(runs(&arranged), (false, "the mesh is arranged"));
    assert_eq!(arranged.clone().arranged(), arranged, "once is enough");
    // By place, neighbours are known here; by index, there are none.
    let edges = |occluders: &Occluders| {
        let (_, statistics) = executor.masks::<u16>(occluders, &light, &receivers).expect("the word fits");
        statistics.counts.edges_kept
    };
    assert!(edges(&occluders) == 0 && edges(&arranged) > 0);
}

#[test]
fn a_bad_move_moves_nothing() {
    let (lattice, (rest, triangles)) = (lattice(), balls());
    for arrange in [false, true] {
        let occluders = Occluders::new(&lattice, &rest, &triangles).expect("the balls are inside");
        let occluders = if arrange { occluders.arranged() } else { occluders };
        let mut moved = occluders.clone();
        let error = moved.move_vertices(&lattice, &rest[1..]).expect_err("a vertex is missing");
        assert_eq!(error, SceneError::VertexCount { count: rest.len() - 1, vertices: rest.len() });
        let text = error.to_string();
        assert!(text.contains(&rest.len().to_string()) && text.contains(&(rest.len() - 1).to_string()), "{text}");
        let mut bad = placed(&rest, 2);
        bad[17].y = f32::NAN;
        bad[99].x = 17.0;
        let error = moved.move_vertices(&lattice, &bad).expect_err("a vertex is not finite");
        assert!(
            matches!(error, SceneError::Vertex { index: 17, source: SnapError::NotFinite { axis: 'y', .. } }),
            "{error:?}"
        );
        let bad: Vec<DVec3> = bad.iter().map(|p| p.as_dvec3()).collect();
        assert!(moved.move_vertices_f64(&lattice, &bad).is_err());
        assert_eq!(moved, occluders, "nothing has moved");
    }
}

#[test]
fn a_mesh_without_triangles_can_be_arranged() {
    let lattice = lattice();
    for vertices in [&[][..], &[Vec3::X, Vec3::Y]] {
        let mut arranged = Occluders::new(&lattice, vertices, &[]).expect("nothing is fine").arranged();
        arranged.move_vertices(&lattice, vertices).expect("nothing moves");
        let (masks, _) =
            CpuExecutor::new().masks::<u32>(&arranged, &light(&lattice), &receivers(&lattice)).expect("the word fits");
        assert!(masks.words().iter().all(|word| *word == 0));
    }
}
