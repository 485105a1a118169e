//! The shadow terminator of a coarse sphere, held against the sphere that it stands for.

use std::f64::consts::PI;

use umbra4_core::{
    AreaLight, Bounds, Lattice, LatticeLight, Lift,
    glam::{DVec3, Vec3},
    terminator::{SHARPNESS, coherent, interpolated, lifted},
};
use umbra4_cpu::{CpuExecutor, Occluders, OnTriangle, Receivers, SmoothError, SmoothMesh};
use umbra4_tests::{ledger::say, rng::Rng};

/// A sphere of radius 1 in rings; every pole and the seam in several vertices.
fn sphere(rings: u32, across: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut vertices = Vec::new();
    for ring in 0..=rings {
        for k in 0..=across {
            // The seam is closed: its ends are the same floats.
            let (down, around) =
                (PI * f64::from(ring) / f64::from(rings), 2.0 * PI * f64::from(k % across) / f64::from(across));
            let flat = if ring % rings == 0 { 0.0 } else { down.sin() };
            vertices.push(DVec3::new(flat * around.cos(), down.cos(), flat * around.sin()).as_vec3());
        }
    }
    let at = |ring: u32, k: u32| ring * (across + 1) + k;
    let mut triangles = Vec::new();
    for (ring, k) in (0..rings).flat_map(|ring| (0..across).map(move |k| (ring, k))) {
        let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
        if ring > 0 {
            triangles.push([a, b, c]);
        }
        if ring + 1 < rings {
            triangles.push([a, c, d]);
        }
    }
    (vertices, triangles)
}

fn corners(vertices: &[Vec3], triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|vertex| vertices[vertex as usize].as_dvec3())
}

fn normal(vertices: &[Vec3], triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners(vertices, triangle);
    (b - a).cross(c - a)
}

/// Receivers inside of all triangles, `each` on each.
fn receivers(rng: &mut Rng, triangles: usize, each: usize) -> Vec<OnTriangle> {
    let mut on = |triangle: usize| {
        let (mut u, mut v) = (rng.unit() as f32, rng.unit() as f32);
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        OnTriangle { triangle: triangle as u32, barycentric: [(1.0 - u - v).max(0.0), u, v] }
    };
    (0..triangles * each).map(|k| on(k / each)).collect()
}

/// A lamp of 1 × 1 that looks at the sphere's middle from the distance 4.
fn lamp() -> AreaLight {
    let towards = DVec3::new(-0.6, -0.64, 0.48);
    let u = towards.cross(DVec3::Z).normalize();
    let v = towards.cross(u);
    assert!(u.cross(v).dot(towards) > 0.99);
    AreaLight::new(towards * -4.0 - (u + v) * 0.5, u, v, 16, 16).expect("a lamp")
}

struct Scene {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    lattice: Lattice,
    light: LatticeLight,
    places: Vec<OnTriangle>,
    /// Where the receivers lie on their triangles.
    flat: Vec<Vec3>,
}

fn scene() -> Scene {
    let (vertices, triangles) = sphere(8, 16);
    assert!(triangles.iter().all(|t| normal(&vertices, *t).dot(vertices[t[0] as usize].as_dvec3()) > 0.0), "outwards");
    let lattice = Lattice::covering(Bounds { min: DVec3::splat(-6.0), max: DVec3::splat(6.0) }).expect("bounds");
    let light = lamp().snap(&lattice, Lift::NONE).expect("it is coarse enough");
    let places = receivers(&mut Rng::named(0, "terminator"), triangles.len(), 20);
    let flat = places
        .iter()
        .map(|at| {
            let corners = corners(&vertices, triangles[at.triangle as usize]);
            (0..3).map(|k| corners[k] * f64::from(at.barycentric[k])).sum::<DVec3>().as_vec3()
        })
        .collect();
    Scene { vertices, triangles, lattice, light, places, flat }
}

impl Scene {
    fn mesh(&self) -> SmoothMesh<'_> {
        SmoothMesh::new(&self.vertices, &self.triangles, &self.vertices).expect("a sphere")
    }

    fn visibility(&self, points: &[Vec3]) -> Vec<f32> {
        let occluders = Occluders::new(&self.lattice, &self.vertices, &self.triangles).expect("inside");
        assert!(occluders.closed_parts().all(), "a sphere");
        let faces: Vec<Vec3> = self
            .places
            .iter()
            .map(|at| normal(&self.vertices, self.triangles[at.triangle as usize]).as_vec3())
            .collect();
        let receivers = Receivers::on_surfaces(&self.lattice, points, &faces, Lift::F32_POSITIONS).expect("inside");
        CpuExecutor::new().visibility(&occluders, &self.light, &receivers).expect("all is fine").0
    }

    /// The cosine of the smooth sphere towards a point.
    fn smooth_cosine(&self, receiver: usize, point: DVec3) -> f64 {
        let on = self.flat[receiver].as_dvec3().normalize();
        on.dot((point - on).normalize())
    }
}

impl Scene {
    /// The fraction of the lamp's samples that lie above the smooth sphere's horizon.
    fn smooth_visibility(&self, receiver: usize) -> f64 {
        let places = (0..256).map(|k| self.lattice.to_world(self.light.sample(k / 16, k % 16)));
        places.filter(|place| self.smooth_cosine(receiver, *place) > 0.0).count() as f64 / 256.0
    }
}

#[test]
fn receivers_that_the_coarse_sphere_shadows() {
    let scene = scene();
    let mesh = scene.mesh();
    let lifted = mesh.lifted(&scene.places).expect("all are on it");
    let plain = scene.visibility(&scene.flat);
    let moved = scene.visibility(&lifted);
    let bends = mesh
        .bends(&mesh.least_cosines(&[lamp().center()]).expect("it is finite"), &scene.places)
        .expect("all are on it");
    let (mut lit, mut shadowed, mut shadowed_lifted, mut facing, mut darker, mut darker_lifted) = (0, 0, 0, 0, 0, 0);
    let (mut lost, mut most) = ([0.0; 3], [0.0_f64; 3]);
    for r in 0..plain.len() {
        if scene.smooth_cosine(r, lamp().center()) > 0.0 {
            facing += 1;
            let smooth = scene.smooth_visibility(r);
            darker += usize::from(f64::from(plain[r]) < smooth - 0.1);
            darker_lifted += usize::from(f64::from(moved[r]) < smooth - 0.1);
        }
        // Lit by the whole lamp, as the smooth sphere has it.
        if !lamp().corners().iter().all(|corner| scene.smooth_cosine(r, *corner) > 0.0) {
            continue;
        }
        lit += 1;
        shadowed += usize::from(plain[r] < 1.0);
        shadowed_lifted += usize::from(moved[r] < 1.0);
        // What is seen of those shadows: the shading that they take away.
        let phong = scene.smooth_cosine(r, lamp().center()).max(0.0);
        let shades =
            [(phong, plain[r]), (f64::from(coherent(bends[r], phong as f32, SHARPNESS)), plain[r]), (phong, moved[r])];
        for (k, (shade, seen)) in shades.into_iter().enumerate() {
            let dark = shade * f64::from(1.0 - seen);
            lost[k] += dark;
            most[k] = most[k].max(dark);
        }
    }
    say(&format!(
        "terminator, sphere of 8 × 16: of {lit} receivers that the smooth one lights wholly, {shadowed} are shadowed, lifted \
         {shadowed_lifted}; of {facing} that face the lamp's middle, {darker} see less of it than from there, by a tenth, lifted {darker_lifted}; shading that the mesh's own \
         shadow takes from the former, mean and most: plain {:.5} {:.3}, coherent {:.5} {:.3}, lifted {:.5} {:.3}",
        lost[0] / f64::from(lit),
        most[0],
        lost[1] / f64::from(lit),
        most[1],
        lost[2] / f64::from(lit),
        most[2]
    ));
    assert!(
        lit > 1000 && shadowed > 50 && darker > 100,
        "the coarse sphere has the fault: {lit}, {shadowed}, {darker}"
    );
    assert!(shadowed_lifted * 4 < shadowed && darker_lifted * 4 < darker, "{shadowed_lifted}, {darker_lifted}");
    assert!(lost[1] * 4.0 < lost[0] && lost[2] * 4.0 < lost[0] && most[1] < most[0] / 2.0, "{lost:?}, {most:?}");
}

#[test]
fn coherent_shading_is_black_where_a_triangle_faces_away() {
    let scene = scene();
    let (mesh, lamp) = (scene.mesh(), lamp());
    for light in [vec![lamp.center()], lamp.corners().to_vec()] {
        let bends =
            mesh.bends(&mesh.least_cosines(&light).expect("it is finite"), &scene.places).expect("all are on it");
        let (mut away, mut shaded) = (0, 0);
        for (at, bend) in scene.places.iter().zip(&bends) {
            let triangle = scene.triangles[at.triangle as usize];
            let (n, [a, ..]) = (normal(&scene.vertices, triangle).normalize(), corners(&scene.vertices, triangle));
            let shade = coherent(*bend, 1.0, SHARPNESS);
            if light.iter().any(|point| n.dot(*point - a) < -1e-4) {
                assert_eq!(shade, 0.0, "{at:?}");
                away += 1;
            } else {
                shaded += usize::from(shade == 1.0);
            }
        }
        assert!(away > 1000 && shaded > 300, "{away} face away, {shaded} keep their shading");
    }
}

#[test]
fn coherent_shading_goes_over_edges_smoothly() {
    let scene = scene();
    let mesh = scene.mesh();
    let least = mesh.least_cosines(&[lamp().center()]).expect("it is finite");
    let mut edges = 0;
    for (t, s) in (0..scene.triangles.len()).flat_map(|t| (0..t).map(move |s| (t, s))) {
        let [of_t, of_s] = [t, s].map(|t| corners(&scene.vertices, scene.triangles[t]));
        let shared: Vec<(usize, usize)> =
            (0..9).map(|k| (k / 3, k % 3)).filter(|(i, j)| of_t[*i] == of_s[*j]).collect();
        let &[(i, j), (k, l)] = &shared[..] else { continue };
        edges += 1;
        for step in 0..=8 {
            let along = step as f32 / 8.0;
            let on = |triangle: usize, from: usize, to: usize| {
                let mut barycentric = [0.0; 3];
                (barycentric[from], barycentric[to]) = (1.0 - along, along);
                OnTriangle { triangle: triangle as u32, barycentric }
            };
            let bends = mesh.bends(&least, &[on(t, i, k), on(s, j, l)]).expect("both are on it");
            assert!((bends[0] - bends[1]).abs() < 1e-6, "{t}, {s}: {bends:?}");
        }
    }
    assert_eq!(edges, scene.triangles.len() * 3 / 2, "every edge is shared by two");
    // The function itself has no step, neither at black nor where Phong takes over.
    let shade = |bend: f32| coherent(bend, 0.8, SHARPNESS);
    let steps: Vec<f32> = (-1000..=1000).map(|k| shade(k as f32 / 1000.0)).collect();
    assert!(steps.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.004));
    assert_eq!((shade(-0.5), shade(0.0), shade(1.0 / 3.0 + 1e-6), shade(1.0)), (0.0, 0.0, 0.8, 0.8));
    assert_eq!(coherent(f32::NAN, 0.8, SHARPNESS), 0.0);
}

#[test]
fn least_cosines_are_those_of_all_pairs() {
    let scene = scene();
    for light in [vec![lamp().center()], lamp().corners().to_vec()] {
        let found = scene.mesh().least_cosines(&light).expect("it is finite");
        for (vertex, found) in scene.vertices.iter().zip(&found) {
            let place = vertex.as_dvec3();
            let around = scene.triangles.iter().filter(|t| corners(&scene.vertices, **t).contains(&place));
            let cosines = around.flat_map(|t| {
                let n = normal(&scene.vertices, *t).normalize();
                light.iter().map(move |point| n.dot((*point - place).normalize()))
            });
            let least = cosines.fold(1.0, f64::min);
            assert!((f64::from(*found) - least).abs() < 1e-6, "{vertex}: {found}, not {least}");
        }
    }
    // A vertex of no triangle, and one of a triangle without area.
    let vertices = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::Y];
    let mesh = SmoothMesh::new(&vertices, &[[0, 1, 2]], &[Vec3::Y; 4]).expect("it is fine");
    assert_eq!(mesh.least_cosines(&[DVec3::Z]).as_deref(), Ok(&[1.0; 4][..]));
    let nowhere = DVec3::new(0.0, f64::INFINITY, 0.0);
    assert_eq!(mesh.least_cosines(&[DVec3::Z, nowhere]), Err(SmoothError::Light { index: 1, point: nowhere }));
}

#[test]
fn lifted_receivers_lie_on_what_normals_imply() {
    let scene = scene();
    let points = scene.mesh().lifted(&scene.places).expect("all are on it");
    let (mut before, mut after) = (0.0_f32, 0.0_f32);
    for ((flat, point), at) in scene.flat.iter().zip(&points).zip(&scene.places) {
        // The formula, in f64.
        let vertices = corners(&scene.vertices, scene.triangles[at.triangle as usize]);
        let p: DVec3 = (0..3).map(|k| vertices[k] * f64::from(at.barycentric[k])).sum();
        let up = |k: usize| {
            let n = vertices[k].normalize();
            n * (f64::from(at.barycentric[k]) * (vertices[k] - p).dot(n).max(0.0))
        };
        let wanted = p + (0..3).map(up).sum::<DVec3>();
        assert!((wanted - point.as_dvec3()).length() < 1e-6, "{point}, not {wanted}");
        assert!(point.length() > flat.length() - 1e-6, "never inwards");
        before = before.max(1.0 - flat.length());
        after = after.max((1.0 - point.length()).abs());
    }
    // A tangent plane rises twice as high over a chord as the arc does.
    assert!(after < before, "no farther outside than they were inside: {after}, {before}");
    say(&format!("lifted receivers are at most {after:.4} above the sphere, those on triangles {before:.4} below it"));
    // At a corner nothing moves; nor where the surface is hollow, or flat.
    let [a, b, c] = [Vec3::X, Vec3::Y, Vec3::Z];
    assert_eq!(lifted([a, b, c], [a, b, c], [0.0, 1.0, 0.0]), b);
    let middle = [0.25, 0.25, 0.5];
    let flat = a * 0.25 + b * 0.25 + c * 0.5;
    assert_eq!(lifted([a, b, c], [-a, -b, -c], middle), flat);
    let level = [Vec3::ZERO, Vec3::X, Vec3::Z];
    assert_eq!(lifted(level, [Vec3::Y; 3], middle), Vec3::X * 0.25 + Vec3::Z * 0.5);
    assert_eq!(interpolated([4.0, 8.0, -2.0], middle), 2.0);
}

#[test]
fn what_is_refused() {
    let (vertices, triangles) = ([Vec3::ZERO, Vec3::X, Vec3::Y], [[0, 1, 2]]);
    let new = |vertices: &[Vec3], triangles: &[[u32; 3]], normals: &[Vec3]| {
        SmoothMesh::new(vertices, triangles, normals).map(|_| ())
    };
    assert_eq!(new(&vertices, &triangles, &[Vec3::Z; 3]), Ok(()));
    assert_eq!(new(&vertices, &triangles, &[Vec3::Z; 2]), Err(SmoothError::NormalCount { count: 2, vertices: 3 }));
    let zero = [Vec3::Z, Vec3::ZERO, Vec3::NAN];
    assert_eq!(new(&vertices, &triangles, &zero), Err(SmoothError::Normal { index: 1, normal: Vec3::ZERO }));
    let far = [Vec3::ZERO, Vec3::X, Vec3::Y * f32::INFINITY];
    assert!(matches!(new(&far, &triangles, &[Vec3::Z; 3]), Err(SmoothError::Vertex { index: 2, .. })));
    let missing = SmoothError::IndexOutOfRange { triangle: 1, vertex: 3, vertices: 3 };
    assert_eq!(new(&vertices, &[[0, 1, 2], [0, 3, 1]], &[Vec3::Z; 3]), Err(missing));

    let mesh = SmoothMesh::new(&vertices, &triangles, &[Vec3::Z; 3]).expect("it is fine");
    let fine = OnTriangle { triangle: 0, barycentric: [0.5, 0.5, 0.0] };
    let absent = OnTriangle { triangle: 1, ..fine };
    let none = SmoothError::NoTriangle { index: 1, triangle: 1, triangles: 1 };
    assert_eq!(mesh.lifted(&[fine, absent]), Err(none));
    assert_eq!(mesh.bends(&[0.0; 3], &[fine, absent]), Err(none));
    assert_eq!(mesh.bends(&[0.0; 2], &[fine]), Err(SmoothError::CosineCount { count: 2, vertices: 3 }));
    for barycentric in [[0.5, f32::NAN, 0.5], [1.5, -0.5, 0.0], [0.0; 3], [1.0; 3], [0.5, 0.4999, 0.0]] {
        let outside = OnTriangle { barycentric, ..fine };
        let refused = mesh.lifted(&[outside]);
        assert!(matches!(refused, Err(SmoothError::Barycentric { index: 0, .. })), "{refused:?}");
    }
}
