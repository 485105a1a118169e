//! Every error is the right one and names what is wrong: the index or field, and the value.

use umbra4_core::{
    AreaLight, Bounds, Jitter, Lattice, LatticeError, LatticeLight, Lift, LightError, SnapError,
    glam::{DVec3, IVec3, Vec3},
};
use umbra4_cpu::{CpuExecutor, ExecutorError, GridOptions, Index, Occluders, Receivers, SceneError};

fn lattice() -> Lattice {
    Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("bounds are fine")
}

const GOOD: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

/// The message names all of these.
fn names(error: &dyn std::error::Error, parts: &[&str]) {
    let text = error.to_string();
    for part in parts {
        assert!(text.contains(part), "\"{text}\" does not name {part}");
    }
    assert!(!text.contains('\n'), "one line");
}

#[test]
fn vertices_and_receivers_that_are_not_finite() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (axis, point) in
            [('x', Vec3::new(value, 0., 0.)), ('y', Vec3::new(0., value, 0.)), ('z', Vec3::new(0., 0., value))]
        {
            let mut points = GOOD;
            points[2] = point;
            let vertex = Occluders::new(&lattice(), &points, &[[0, 1, 2]]).expect_err("a vertex is not finite");
            let SceneError::Vertex { index: 2, source: SnapError::NotFinite { axis: found, value: got } } = vertex
            else {
                panic!("{vertex:?}");
            };
            assert!(found == axis && got.to_bits() == f64::from(value).to_bits());
            names(&vertex, &["vertex 2", &axis.to_string(), "finite"]);
            let f64_points = points.map(|p| p.as_dvec3());
            let same = Occluders::from_f64(&lattice(), &f64_points, &[]).expect_err("a vertex is not finite");
            assert!(matches!(same, SceneError::Vertex { index: 2, .. }), "unused vertices are checked too: {same:?}");

            let receiver = Receivers::raw(&lattice(), &points).expect_err("a receiver is not finite");
            assert!(
                matches!(&receiver, SceneError::Receiver { index: 2, source: SnapError::NotFinite { axis: a, .. } } if *a == axis),
                "{receiver:?}"
            );
            names(&receiver, &["receiver 2", &axis.to_string(), "finite"]);
            let same = Receivers::raw_f64(&lattice(), &f64_points).expect_err("a receiver is not finite");
            assert!(matches!(same, SceneError::Receiver { index: 2, .. }));
            let same = Receivers::on_surfaces(&lattice(), &points, &GOOD, Lift::NONE).expect_err("not finite");
            assert!(matches!(same, SceneError::Receiver { index: 2, .. }));
        }
    }
}

#[test]
fn the_first_of_several_bad_elements_is_named() {
    let mut points = vec![Vec3::ZERO; 10_000];
    points[7_777] = Vec3::NAN;
    points[1_234] = Vec3::splat(99.0);
    assert!(matches!(
        Receivers::raw(&lattice(), &points),
        Err(SceneError::Receiver { index: 1_234, source: SnapError::OutOfRange { axis: 'x', .. } })
    ));
}

#[test]
fn points_outside_the_lattice() {
    let points = [Vec3::ZERO, Vec3::new(0.0, -17.0, 0.0)];
    let error = Occluders::new(&lattice(), &points, &[]).expect_err("a vertex is outside");
    let SceneError::Vertex { index: 1, source: SnapError::OutOfRange { axis: 'y', value, min, max } } = error else {
        panic!("{error:?}");
    };
    assert!(value == -17.0 && value < min && min < 0.0 && max == -min);
    names(&error, &["vertex 1", "y", "-17"]);
    let error = Receivers::raw(&lattice(), &points).expect_err("a receiver is outside");
    names(&error, &["receiver 1", "y", "-17"]);
}

#[test]
fn indices_out_of_range() {
    let error = Occluders::new(&lattice(), &GOOD, &[[0, 1, 2], [2, 3, 0]]).expect_err("there is no vertex 3");
    assert_eq!(error, SceneError::IndexOutOfRange { triangle: 1, vertex: 3, vertices: 3 });
    names(&error, &["triangle 1", "vertex 3", "3"]);
    let error = Occluders::new(&lattice(), &[], &[[u32::MAX; 3]]).expect_err("there is no vertex");
    assert_eq!(error, SceneError::IndexOutOfRange { triangle: 0, vertex: u32::MAX, vertices: 0 });
}

#[test]
fn normals_that_point_nowhere() {
    for normal in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::new(1.0, f32::NAN, 0.0), Vec3::new(f32::NAN, 1.0, 0.0)]
    {
        let normals = [Vec3::Y, normal, Vec3::Y];
        let error = Receivers::on_surfaces(&lattice(), &GOOD, &normals, Lift::F32_POSITIONS).expect_err("no direction");
        assert!(matches!(error, SceneError::Normal { index: 1, .. }), "{error:?}");
        names(&error, &["normal 1"]);
    }
    let error = Receivers::on_surfaces(&lattice(), &GOOD, &[Vec3::Y], Lift::NONE).expect_err("too few normals");
    assert_eq!(error, SceneError::NormalCount { count: 1, receivers: 3 });
    names(&error, &["1", "3"]);
}

#[test]
fn lifts_have_a_range() {
    assert_eq!(Lift::f32_positions_off_by(0), None);
    assert_eq!(Lift::f32_positions_off_by(9), None);
    assert_eq!(Lift::f32_positions_off_by(8).map(Lift::steps), Some(3 * 32 * 8 + 4));
}

#[test]
fn lights_without_area() {
    let parallel = [
        (DVec3::ZERO, DVec3::Y),
        (DVec3::X, DVec3::ZERO),
        (DVec3::X, DVec3::X * -3.0),
        (DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 4.0, 6.0)),
    ];
    for (edge_u, edge_v) in parallel {
        let error = AreaLight::new(DVec3::ZERO, edge_u, edge_v, 4, 4).expect_err("no area");
        assert_eq!(error, LightError::NoArea { edge_u, edge_v });
        names(&error, &["area"]);
    }
    // Not parallel in the world, but on the lattice.
    let narrow = AreaLight::new(DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0e-12, 0.0), 1, 1).expect("it has an area");
    assert!(matches!(narrow.snap(&lattice(), Lift::NONE), Err(LightError::NoArea { .. })));
}

#[test]
fn lights_that_are_not_finite() {
    for (k, field) in ["corner", "edge_u", "edge_v"].into_iter().enumerate() {
        for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
            let mut vectors = [DVec3::ZERO, DVec3::X, DVec3::Y];
            vectors[k][axis] = f64::INFINITY;
            let [corner, u, v] = vectors;
            let error = AreaLight::new(corner, u, v, 4, 4).expect_err("a coordinate is infinite");
            assert_eq!(error, LightError::NotFinite { field, axis: name, value: f64::INFINITY });
            names(&error, &[&format!("{field}.{name}"), "inf"]);
            vectors[k][axis] = f64::NAN;
            let [corner, u, v] = vectors;
            let error = AreaLight::new(corner, u, v, 4, 4).expect_err("a coordinate is NaN");
            assert!(
                matches!(error, LightError::NotFinite { field: f, axis: a, value } if f == field && a == name && value.is_nan())
            );
        }
    }
}

#[test]
fn sample_counts() {
    for value in [0, 65, u32::MAX] {
        let rows = AreaLight::new(DVec3::ZERO, DVec3::X, DVec3::Y, value, 4).expect_err("no such number of rows");
        assert_eq!(rows, LightError::SampleCount { field: "rows", value });
        let columns = AreaLight::new(DVec3::ZERO, DVec3::X, DVec3::Y, 4, value).expect_err("no such number of columns");
        assert_eq!(columns, LightError::SampleCount { field: "columns", value });
        names(&columns, &["columns", &value.to_string(), "64"]);
    }
    for value in [1, 64] {
        assert!(AreaLight::new(DVec3::ZERO, DVec3::X, DVec3::Y, value, value).is_ok());
    }
}

#[test]
fn lights_too_fine_for_the_lattice() {
    let lattice = lattice();
    // 64 columns, 63.9 lattice units apart; then 64 exactly.
    let edge = |units: f64| DVec3::X * lattice.step() * units * 64.0;
    let light = |units| AreaLight::new(DVec3::ZERO, edge(units), DVec3::Y, 4, 64).expect("it has an area");
    let error = light(63.9).snap(&lattice, Lift::NONE).expect_err("too fine");
    let LightError::LightTooFine { field: "edge_u", step, .. } = error else { panic!("{error:?}") };
    assert!((step - 63.9).abs() < 1.0e-9);
    names(&error, &["edge_u", "63.9", "64"]);
    assert!(light(64.0).snap(&lattice, Lift::NONE).is_ok());
    let error = AreaLight::new(DVec3::ZERO, DVec3::X, DVec3::Y * 1.0e-9, 4, 4)
        .and_then(|light| light.snap(&lattice, Lift::NONE))
        .expect_err("too fine");
    assert!(matches!(error, LightError::LightTooFine { field: "edge_v", .. }), "{error:?}");
}

/// Steps are powers of two: the bounds named must be small enough for the next finer one.
#[test]
fn the_bounds_named_for_a_light_too_fine_would_do() {
    let lattice = lattice();
    let edge = DVec3::X * lattice.step() * 63.9 * 64.0;
    let light = AreaLight::new(DVec3::ZERO, edge, DVec3::Y, 4, 64).expect("it has an area");
    let Err(LightError::LightTooFine { largest_bounds, .. }) = light.snap(&lattice, Lift::NONE) else {
        unreachable!("the light is too fine")
    };
    let bounds = Bounds { min: DVec3::splat(-largest_bounds), max: DVec3::splat(largest_bounds) };
    let finer = Lattice::covering(bounds).expect("bounds are fine");
    let fits = light.snap(&finer, Lift::NONE);
    assert!(!matches!(fits, Err(LightError::LightTooFine { .. })), "{largest_bounds} would not do: {fits:?}");
}

#[test]
fn lights_outside_the_lattice() {
    let corner = DVec3::new(0.0, 20.0, 0.0);
    let error = AreaLight::new(corner, DVec3::X, DVec3::Z, 4, 4)
        .and_then(|light| light.snap(&lattice(), Lift::NONE))
        .expect_err("the light is outside");
    assert!(matches!(error, LightError::OutOfRange { row: 0, column: 0, axis: 'y', value: 20.0 }), "{error:?}");
    names(&error, &["row 0", "column 0", "y", "20"]);
    let huge = AreaLight::new(DVec3::ZERO, DVec3::X * 1.0e30, DVec3::Z, 1, 1).expect("it has an area");
    assert!(matches!(huge.snap(&lattice(), Lift::NONE), Err(LightError::OutOfRange { .. })));
}

#[test]
fn lattices_that_cannot_be() {
    let (one, nan) = (DVec3::ONE, f64::NAN);
    let bounds = |min, max| Bounds { min, max };
    assert_eq!(
        Lattice::covering(bounds(DVec3::new(0.0, 2.0, 0.0), one)),
        Err(LatticeError::Empty { axis: 'y', min: 2.0, max: 1.0 })
    );
    let empty = Lattice::covering(Bounds::EMPTY).expect_err("nothing there");
    names(&empty, &["empty", "x"]);
    let error = Lattice::covering(bounds(DVec3::new(0.0, 0.0, nan), one)).expect_err("NaN");
    assert!(matches!(error, LatticeError::NotFinite { field: "bounds.min.z", value } if value.is_nan()), "{error:?}");
    let error = Lattice::covering(bounds(-one, DVec3::new(f64::INFINITY, 1.0, 1.0))).expect_err("infinite");
    assert_eq!(error, LatticeError::NotFinite { field: "bounds.max.x", value: f64::INFINITY });
    names(&error, &["bounds.max.x", "inf"]);
    let error = Lattice::covering_about(bounds(-one, one), DVec3::new(0.0, nan, 0.0)).expect_err("NaN");
    assert!(matches!(error, LatticeError::NotFinite { field: "origin.y", .. }), "{error:?}");
    let error = Lattice::covering(bounds(-one, DVec3::splat(2.0e38))).expect_err("too large");
    assert_eq!(error, LatticeError::TooLarge { value: 2.0e38 });
    names(&error, &["2e38"]);
    assert!(Lattice::covering(bounds(-one, DVec3::splat(1.6e38))).is_ok());
    assert!(matches!(
        Lattice::covering(bounds(DVec3::splat(-f64::MAX), DVec3::splat(f64::MAX))),
        Err(LatticeError::TooLarge { .. })
    ));
}

#[test]
fn words_too_narrow() {
    let light = |columns| LatticeLight {
        origin: IVec3::new(0, 1000, 0),
        step_u: IVec3::X * 64,
        step_v: IVec3::Z * 64,
        rows: 2,
        columns,
        jitter: Jitter::NONE,
    };
    let receivers = Receivers::raw(&lattice(), &[Vec3::ZERO]).expect("receivers are fine");
    let (executor, occluders) = (CpuExecutor::new(), Occluders::default());
    let error = executor.masks::<u16>(&occluders, &light(17), &receivers).expect_err("17 columns do not fit 16 bits");
    assert_eq!(error, ExecutorError::WordTooNarrow { columns: 17, bits: 16 });
    names(&error, &["17", "16"]);
    let error = executor.visit::<u32>(&occluders, &light(33), &receivers, |_, _| ()).expect_err("too narrow");
    assert_eq!(error, ExecutorError::WordTooNarrow { columns: 33, bits: 32 });
    assert!(executor.masks::<u16>(&occluders, &light(16), &receivers).is_ok());
    assert!(executor.masks::<u64>(&occluders, &light(64), &receivers).is_ok());
}

#[test]
fn grids_that_cannot_be() {
    let light = LatticeLight {
        origin: IVec3::new(0, 1000, 0),
        step_u: IVec3::X * 64,
        step_v: IVec3::Z * 64,
        rows: 2,
        columns: 2,
        jitter: Jitter::NONE,
    };
    let receivers = Receivers::raw(&lattice(), &[Vec3::ZERO]).expect("receivers are fine");
    let run = |cells| {
        let index = Index::Grid(GridOptions { cells, ..GridOptions::default() });
        CpuExecutor::new().with_index(index).masks::<u16>(&Occluders::default(), &light, &receivers)
    };
    for (cells, field, value) in [([0, 1], "cells[0]", 0), ([1, 0], "cells[1]", 0), ([1, 4097], "cells[1]", 4097)] {
        let error = run(cells).expect_err("no such grid");
        assert_eq!(error, ExecutorError::GridCells { field, value });
        names(&error, &[field, &value.to_string(), "1..=4096"]);
    }
    assert!(run([1, 4096]).is_ok());
}
