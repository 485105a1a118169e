//! Lights with a volume: their samples look evenly spread from everywhere, and what is refused is named.

use umbra4_core::{
    Bounds, EllipsoidLight, Lattice, SnapError, SphereLight, TubeLight, VolumeLightError,
    cloud::{Cloud, CloudError, MAX_CLOUD},
    cloud_table::{CloudTable, TableError, TableSize},
    glam::{DVec3, IVec3},
    volume_light::{LEAST_EXTENT, snap_points},
};
use umbra4_tests::{ledger::say, rng::Rng};

fn lattice() -> Lattice {
    Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("bounds are fine")
}

fn room(count: usize) -> Vec<IVec3> {
    vec![IVec3::ZERO; count]
}

fn direction(rng: &mut Rng) -> DVec3 {
    loop {
        let v = DVec3::new(rng.real(1.0), rng.real(1.0), rng.real(1.0));
        if v.length() < 1.0 && v.length() > 0.1 {
            return v.normalize();
        }
    }
}

/// The part of a disk of radius 1 beyond a line at distance t from its middle.
fn segment(t: f64) -> f64 {
    (t.acos() - t * (1.0 - t * t).sqrt()) / std::f64::consts::PI
}

/// Over edges of shadows in all places and directions: the error of the lit part (root of the mean square, largest).
fn errors(points: &[DVec3], rng: &mut Rng) -> (f64, f64) {
    let (mut squares, mut largest, cuts) = (0.0, 0.0_f64, 4000);
    for _ in 0..cuts {
        let (along, t) = (direction(rng), rng.real(0.95));
        let beyond = points.iter().filter(|p| p.dot(along) > t).count() as f64 / points.len() as f64;
        squares += (beyond - segment(t)).powi(2);
        largest = largest.max((beyond - segment(t)).abs());
    }
    ((squares / f64::from(cuts)).sqrt(), largest)
}

/// A bright ball looks like a bright disk: an edge that hides all beyond a line hides that part of a disk, from wherever it is
/// seen.
#[test]
fn a_sphere_looks_like_a_disk() {
    let (lattice, center) = (lattice(), DVec3::new(1.0, -2.0, 0.5));
    let mut rng = Rng::named(0, "disk");
    let axes = [DVec3::new(0.5, 0.25, 0.0), DVec3::new(-0.25, 1.0, 0.0), DVec3::new(0.0, 0.5, 0.75)];
    for count in [32, 64, 128, 256, 512, 1024] {
        let in_ball = |cloud: &Cloud<Vec<IVec3>>, to_ball: &dyn Fn(DVec3) -> DVec3| -> Vec<DVec3> {
            cloud.samples().iter().map(|s| to_ball(lattice.to_world(*s) - center)).collect()
        };
        let sphere = SphereLight { center, radius: 0.5 }.snap(&lattice, room(count)).expect("it fits");
        let ellipsoid = EllipsoidLight { center, axes }.snap(&lattice, room(count)).expect("it fits");
        let [a, b, c] = axes;
        let volume = a.cross(b).dot(c);
        let coordinates = |v: DVec3| DVec3::new(v.dot(b.cross(c)), v.dot(c.cross(a)), v.dot(a.cross(b))) / volume;
        for points in [in_ball(&sphere, &|v| v / 0.5), in_ball(&ellipsoid, &coordinates)] {
            assert!(points.iter().all(|p| p.length() < 1.0 + 1e-6));
            let (error, largest) = errors(&points, &mut rng);
            // Of random points it would be the root of p(1 − p)/n, which is 0.41/√n over these cuts.
            let random = 0.41 / (count as f64).sqrt();
            assert!(error < 0.6 * random && largest < 3.0 * random, "{count}: {error}, {largest}, {random}");
            say(&format!(
                "{count} samples of a ball: error {error:.4}, largest {largest:.4}; of random ones {random:.4}"
            ));
        }
    }
}

/// A tube looks like a bright rectangle from the side.
#[test]
fn a_tube_looks_like_a_strip() {
    let (lattice, mut rng) = (lattice(), Rng::named(0, "strip"));
    for count in [64, 256, 1024] {
        for _ in 0..20 {
            let (from, along, radius) = (direction(&mut rng), direction(&mut rng) * 3.0, 0.25);
            let tube = TubeLight { from, to: from + along, radius }.snap(&lattice, room(count)).expect("it fits");
            let axis = along.normalize();
            let across = axis.cross(direction(&mut rng)).normalize();
            for t in [-0.9, -0.5, -0.1, 0.3, 0.7] {
                let seen = |s: &IVec3| lattice.to_world(*s) - from;
                let beyond = tube.samples().iter().filter(|s| seen(s).dot(across) / radius > t).count() as f64;
                let error = beyond / count as f64 - 0.5 * (1.0 - t);
                assert!(error.abs() < 1.0 / (count as f64).sqrt(), "{count} {t}: {error}");
                let part = 0.5 * (1.0 + t);
                let beyond = tube.samples().iter().filter(|s| seen(s).dot(axis) / 3.0 > part).count() as f64;
                assert!((beyond - count as f64 * (1.0 - part)).abs() <= 1.0, "{count} {t}: {beyond}");
            }
            for s in tube.samples() {
                let v = lattice.to_world(*s) - from;
                assert!((v - axis * v.dot(axis)).length() < radius + 1e-6, "{v}");
            }
        }
    }
}

#[test]
fn flat_lights_are_lights() {
    let lattice = lattice();
    let disk = EllipsoidLight { center: DVec3::ZERO, axes: [DVec3::X, DVec3::Y * 0.5, DVec3::ZERO] };
    let disk = disk.snap(&lattice, room(200)).expect("a disk");
    assert!(disk.samples().iter().all(|s| s.z == 0) && disk.bounds()[1].x > disk.bounds()[1].y);
    let points = [DVec3::X, DVec3::Y, DVec3::X];
    let free = snap_points(&lattice, &points, [IVec3::ZERO; 3]).expect("they are inside");
    assert_eq!(lattice.to_world(free.samples()[1]), DVec3::Y);
}

#[test]
fn bad_lights_are_refused() {
    let lattice = lattice();
    let unit = lattice.step();
    let sphere = |center, radius| SphereLight { center, radius }.snap(&lattice, room(16));
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = sphere(DVec3::ZERO, radius).expect_err("no radius");
        assert!(matches!(error, VolumeLightError::Radius { value } if value.to_bits() == radius.to_bits()), "{error}");
        let error = TubeLight { from: DVec3::ZERO, to: DVec3::X, radius }.snap(&lattice, room(16));
        assert!(matches!(error, Err(VolumeLightError::Radius { .. })));
    }
    for bad in [f64::NAN, f64::NEG_INFINITY] {
        let error = sphere(DVec3::new(0.0, bad, 0.0), 1.0).expect_err("not finite");
        assert!(
            matches!(error, VolumeLightError::NotFinite { field: "center", .. })
                && error.to_string().contains("center")
        );
        let mut axes = DVec3::AXES;
        axes[2].x = bad;
        let error = EllipsoidLight { center: DVec3::ZERO, axes }.snap(&lattice, room(16)).expect_err("not finite");
        assert!(matches!(error, VolumeLightError::NotFinite { field: "axes[2]", .. }), "{error}");
        let error = TubeLight { from: DVec3::X, to: DVec3::splat(bad), radius: 1.0 }.snap(&lattice, room(16));
        assert!(matches!(error, Err(VolumeLightError::NotFinite { field: "to", .. })));
    }
    let error = TubeLight { from: DVec3::X, to: DVec3::X, radius: 1.0 }.snap(&lattice, room(16)).expect_err("no axis");
    assert_eq!(error, VolumeLightError::NoLength { at: DVec3::X });
    // Just too small, and what would do: a finer lattice.
    let small = SphereLight { center: DVec3::ZERO, radius: 0.49 * LEAST_EXTENT * unit };
    let error = small.snap(&lattice, room(16)).expect_err("too small");
    let VolumeLightError::TooSmall { largest_bounds, .. } = error else { panic!("{error}") };
    let bounds = DVec3::splat(largest_bounds);
    let finer = Lattice::covering(Bounds { min: -bounds, max: bounds }).expect("bounds are fine");
    assert!(small.snap(&finer, room(16)).is_ok());
    assert!(sphere(DVec3::ZERO, 0.51 * LEAST_EXTENT * unit).is_ok());
    for axes in [[DVec3::ZERO; 3], [DVec3::X * unit; 3]] {
        let error = EllipsoidLight { center: DVec3::ZERO, axes }.snap(&lattice, room(16));
        assert!(matches!(error, Err(VolumeLightError::TooSmall { .. })));
    }
    let error = sphere(DVec3::new(0.0, 0.0, 16.0), 1.0).expect_err("outside");
    assert!(
        matches!(error, VolumeLightError::Sample { source: SnapError::OutOfRange { axis: 'z', .. }, .. }),
        "{error}"
    );
    assert!(sphere(DVec3::ZERO, 1e300).is_err() && sphere(DVec3::splat(1e308), 1e308).is_err());
    let endless = TubeLight { from: DVec3::splat(-1e308), to: DVec3::splat(1e308), radius: 1.0 };
    assert!(endless.snap(&lattice, room(16)).is_err());
    for count in [0, MAX_CLOUD + 1] {
        let error = SphereLight { center: DVec3::ZERO, radius: 1.0 }.snap(&lattice, room(count)).expect_err("no room");
        assert_eq!(error, VolumeLightError::Cloud(CloudError::Count { count }));
    }
    let error = snap_points(&lattice, &[DVec3::X, DVec3::NAN], room(2)).expect_err("not a number");
    assert!(matches!(error, VolumeLightError::Sample { index: 1, source: SnapError::NotFinite { .. } }));
    let error = snap_points(&lattice, &[DVec3::X], room(2)).expect_err("too much room");
    assert_eq!(error, VolumeLightError::Room { room: 2, points: 1 });
    assert!(matches!(
        snap_points(&lattice, &[], room(0)),
        Err(VolumeLightError::Cloud(CloudError::Count { count: 0 }))
    ));
}

#[test]
fn bad_tables_are_refused() {
    let cloud = Cloud::new(vec![IVec3::ZERO; 40]).expect("samples are inside");
    for (field, size) in [
        ("directions", TableSize { directions: 0, distances: 4 }),
        ("directions", TableSize { directions: 1025, distances: 4 }),
        ("distances", TableSize { directions: 4, distances: 0 }),
        ("distances", TableSize { directions: 4, distances: 4097 }),
    ] {
        let error = CloudTable::words_of(&cloud, size).expect_err("a size out of range");
        assert!(matches!(error, TableError::Size { field: f, .. } if f == field), "{error}");
        assert!(error.to_string().contains(field) && CloudTable::new(&cloud, size, [0; 8]).is_err());
    }
    let size = TableSize { directions: 2, distances: 4 };
    assert_eq!(CloudTable::words_of(&cloud, size), Ok(32));
    for got in [0, 31, 33] {
        let error = CloudTable::new(&cloud, size, vec![0; got]).expect_err("another length");
        assert_eq!(error, TableError::Buffer { needed: 32, got });
    }
    assert!(CloudTable::new(&cloud, size, vec![0; 32]).is_ok());
}
