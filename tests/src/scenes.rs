//! Scene generators: random, deterministic, and made so that coincidences happen, which floats get wrong.

use umbra4_core::{
    Jitter, LatticeLight,
    area_light::{MIN_PLACE_STEP, MIN_STEP},
    glam::{DVec3, IVec3, Vec3},
    jitter::PLACES,
};

use crate::{
    meshes::{Mesh, cuboid, icosphere},
    rng::Rng,
    scene::{REACH, Scene, WorldScene},
};

/// How the samples of a light are to lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleGrid {
    /// Rows of samples.
    pub rows: u32,
    /// Samples a row.
    pub columns: u32,
    /// Whether they lie off the grid.
    pub jitter: Jitter,
}

impl SampleGrid {
    /// On the grid.
    pub const fn regular(rows: u32, columns: u32) -> Self {
        Self { rows, columns, jitter: Jitter::NONE }
    }

    /// Some pattern of jittered samples.
    #[must_use]
    pub fn jittered(self, rng: &mut Rng) -> Self {
        let number = rng.next_u64() as u32 >> rng.below(32);
        let jitter = Jitter::pattern(number);
        Self { jitter: if number % 4 == 3 { jitter.reversed() } else { jitter }, ..self }
    }

    /// The shortest step, lattice units.
    const fn least(self) -> i32 {
        if self.jitter.is_some() { MIN_PLACE_STEP * PLACES as i32 } else { MIN_STEP }
    }

    /// A step that such samples may have, not longer.
    fn step(self, step: IVec3) -> IVec3 {
        if self.jitter.is_some() { step / PLACES as i32 * PLACES as i32 } else { step }
    }
}

/// A generator: a scene whose light has the given samples.
pub type Generator = fn(&mut Rng, SampleGrid) -> Scene;

/// All generators, by name.
pub const GENERATORS: [(&str, Generator); 12] = [
    ("soup", soup),
    ("tiny", tiny),
    ("outermost", outermost),
    ("slivers", slivers),
    ("zero_area", zero_area),
    ("coarse_grid", coarse_grid),
    ("in_planes", in_planes),
    ("closed_meshes", closed_meshes),
    ("across_planes", across_planes),
    ("interior", interior),
    ("crowd", crowd),
    ("full_coverage", full_coverage),
];

/// Exponents of the lattice step that scenes are tried with; all give the same bits.
pub const EXPONENTS: [i32; 5] = [0, 25, -40, 100, -98];

/// Receivers of a scene, at most.
const RECEIVERS: usize = 90;

/// Sample grids whose rows are as long as a word of `bits` makes interesting.
pub fn grid(rng: &mut Rng, bits: u32) -> SampleGrid {
    let columns = match bits {
        16 => [16, 16, 16, 15, 13, 8, 2, 1],
        32 => [32, 32, 32, 31, 17, 16, 2, 1],
        _ => [64, 64, 64, 63, 33, 32, 17, 1],
    };
    let rows = [64, 64, 33, 32, 17, 16, 5, 1];
    SampleGrid::regular(rng.pick(&rows), rng.pick(&columns))
}

/// A vector whose largest component is `longest`, or at least `least`: along an axis, along a diagonal, or anyhow.
fn direction(rng: &mut Rng, longest: i32, least: i32) -> IVec3 {
    loop {
        let v = match rng.below(3) {
            0 => {
                IVec3::from_array(rng.pick(&[[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]))
                    * longest
            }
            1 => IVec3::new(rng.around(1), rng.around(1), rng.around(1)) * longest,
            _ => rng.point(longest),
        };
        if v.abs().max_element() >= least {
            return v;
        }
    }
}

fn parallel(u: IVec3, v: IVec3) -> bool {
    let (u, v) = (u.to_array().map(i64::from), v.to_array().map(i64::from));
    [(1, 2), (2, 0), (0, 1)].iter().all(|&(a, b)| u[a] * v[b] == u[b] * v[a])
}

/// A light centred within `extent` of `center`, whose samples stay within `extent` of its centre and inside the lattice.
pub fn light(rng: &mut Rng, samples: SampleGrid, center: IVec3, extent: i32) -> LatticeLight {
    let (SampleGrid { rows, columns, jitter }, least) = (samples, samples.least());
    loop {
        let mut step = |count: u32| {
            let most = (extent / count as i32).max(least);
            // Steps of all sizes, down to the shortest that is allowed.
            let longest = most >> rng.below(12);
            samples.step(direction(rng, longest.max(least), least))
        };
        let (step_u, step_v) = (step(columns), step(rows));
        let half = (step_u * (columns as i32 - 1) + step_v * (rows as i32 - 1)) / 2;
        let origin = center + rng.point(extent) - half;
        // In floats, since a light that does not fit may not fit i32 either.
        // Jittered samples may lie anywhere before the next cell.
        let beyond = if jitter.is_some() { 0 } else { 1 };
        let fits = [0, rows - beyond].iter().all(|&i| {
            [0, columns - beyond].iter().all(|&j| {
                let sample = origin.as_dvec3() + step_v.as_dvec3() * f64::from(i) + step_u.as_dvec3() * f64::from(j);
                sample.abs().max_element() < f64::from(REACH)
            })
        });
        if fits && !parallel(step_u, step_v) {
            return LatticeLight { origin, step_u, step_v, rows, columns, jitter };
        }
    }
}

fn clamp(p: IVec3) -> IVec3 {
    p.clamp(IVec3::splat(-REACH), IVec3::splat(REACH))
}

/// Half of the scenes' points are taken from what is there already: vertices, middles of edges, points in planes, samples.
fn receiver(rng: &mut Rng, light: &LatticeLight, mesh: &Mesh, center: IVec3, extent: i32) -> IVec3 {
    let corners = (!mesh.triangles.is_empty()).then(|| {
        let t = mesh.triangles[rng.below(mesh.triangles.len())];
        t.map(|v| mesh.vertices[v as usize])
    });
    let sample = light.sample(rng.below(light.rows as usize) as u32, rng.below(light.columns as usize) as u32);
    let p = match (rng.below(12), corners) {
        (0, Some([a, _, _])) => a,
        (1, Some([a, b, _])) => a + (b - a) / 2,
        // On the edge's line, beyond its end.
        (2, Some([a, b, _])) => b + (b - a) / 4,
        // In the triangle, and in its plane, as nearly as the division allows.
        (3, Some([a, b, c])) => a + (b - a) / 4 + (c - a) / 4,
        (4, Some([a, b, c])) => a + (b - a) / 2 - (c - a) / 4,
        // One step off the surface.
        (5, Some([a, _, _])) => a + rng.point(1),
        (6, _) => sample,
        // In the light's plane, beside its samples, by no more than i32 can hold.
        (7, _) => {
            let steps = if light.step_u.abs().max(light.step_v.abs()).max_element() < REACH / 8 { 3 } else { 1 };
            clamp(sample + light.step_u * rng.around(steps)) - light.step_v * rng.around(steps)
        }
        _ => center + rng.point(extent),
    };
    clamp(p)
}

/// Receivers for a mesh; most of those that fall behind the light are drawn again.
fn receivers(rng: &mut Rng, light: &LatticeLight, mesh: &Mesh, center: IVec3, extent: i32) -> Vec<IVec3> {
    // Any number, since executors work in groups.
    (0..1 + rng.below(RECEIVERS))
        .map(|_| {
            let mut p = receiver(rng, light, mesh, center, extent);
            for _ in 0..6 {
                if !crate::oracle::behind(light, p) || rng.one_in(8) {
                    break;
                }
                p = receiver(rng, light, mesh, center, extent);
            }
            p
        })
        .collect()
}

fn finish(rng: &mut Rng, light: LatticeLight, mesh: Mesh, center: IVec3, extent: i32) -> Scene {
    Scene { receivers: receivers(rng, &light, &mesh, center, extent), light, mesh }
}

/// Triangles of all sizes anywhere in the lattice.
pub fn soup(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = REACH / 2;
    let light = light(rng, samples, IVec3::ZERO, extent / 2);
    let mut mesh = Mesh::default();
    for _ in 0..rng.below(40) {
        let (size, at) = (extent >> rng.below(6), rng.point(extent));
        mesh.add_triangle([0; 3].map(|_| clamp(at + rng.point(size))));
    }
    finish(rng, light, mesh, IVec3::ZERO, extent)
}

/// The smallest scenes that a light allows, in a far corner of the lattice: coordinates large, differences small.
pub fn tiny(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = samples.least() * 80;
    let center = rng.point(1) * (REACH - 4 * extent);
    let light = light(rng, samples, center, extent);
    let mut mesh = Mesh::default();
    for _ in 0..rng.below(40) {
        let (size, at) = (extent >> rng.below(12), center + rng.point(extent));
        mesh.add_triangle([0; 3].map(|_| at + rng.point(size)));
    }
    finish(rng, light, mesh, center, extent)
}

/// Vertices, receivers and light at the outermost points of the lattice: determinants as large as they get.
pub fn outermost(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let light = light(rng, samples, IVec3::ZERO, REACH - 1);
    let mut mesh = Mesh::default();
    let outer = |rng: &mut Rng| {
        let inward = 1 << rng.below(24);
        rng.point(1) * REACH - rng.point(1) * inward
    };
    for _ in 0..rng.below(24) {
        mesh.add_triangle([0; 3].map(|_| clamp(outer(rng))));
    }
    let mut scene = finish(rng, light, mesh, IVec3::ZERO, REACH);
    for p in scene.receivers.iter_mut().step_by(3) {
        *p = clamp(outer(rng));
    }
    scene
}

/// Slivers of aspect 10^6, some with two corners a single step apart.
pub fn slivers(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = REACH / 2;
    let light = light(rng, samples, IVec3::ZERO, extent / 2);
    let mut mesh = Mesh::default();
    for _ in 0..rng.below(60) {
        let (a, b) = (rng.point(extent), rng.point(extent));
        let width = (extent / 1_000_000).max(1) >> rng.below(10);
        let c = if rng.one_in(2) { a } else { a + (b - a) / 3 };
        mesh.add_triangle([a, b, clamp(c + rng.point(width.max(1)))]);
    }
    finish(rng, light, mesh, IVec3::ZERO, extent)
}

/// Triangles without area: points, segments, corners on one line; and a few real ones, duplicated.
pub fn zero_area(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = 1 << (12 + rng.below(16));
    let light = light(rng, samples, IVec3::ZERO, extent);
    let mut mesh = Mesh::default();
    for _ in 0..rng.below(40) {
        let (a, d) = (rng.point(extent), rng.point(extent / 8));
        match rng.below(4) {
            0 => mesh.add_triangle([a, a, a]),
            1 => mesh.add_triangle([a, a + d, a]),
            2 => mesh.add_triangle([a, a + d * rng.around(4), a + d * rng.around(4)]),
            _ => {
                let real = [a, rng.point(extent), rng.point(extent)];
                mesh.add_triangle(real);
                mesh.add_triangle([real[1], real[2], real[0]]);
                mesh.add_triangle([real[2], real[1], real[0]]);
            }
        }
    }
    finish(rng, light, mesh, IVec3::ZERO, extent)
}

/// Everything on a grid of a few points: samples in edge planes, receivers on vertices and edges and in planes, planes
/// that hold the light, all the time.
pub fn coarse_grid(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let SampleGrid { rows, columns, jitter } = samples;
    let unit = samples.least() << rng.below(if jitter.is_some() { 12 } else { 16 });
    let reach = 6;
    let node = |rng: &mut Rng| rng.point(reach) * unit;
    let light = loop {
        // Steps are a half, a quarter … of the unit, where they may be.
        let finer = (unit >> rng.below(4)).max(samples.least());
        let (u, v) = (rng.point(1) * finer, rng.point(2) * finer);
        let half = (u * (columns as i32 / 2) + v * (rows as i32 / 2)) / unit * unit;
        let far = half.abs().max_element();
        if u != IVec3::ZERO && v != IVec3::ZERO && !parallel(u, v) && far < REACH / 4 {
            break LatticeLight { origin: node(rng) - half, step_u: u, step_v: v, rows, columns, jitter };
        }
    };
    let mut mesh = Mesh::default();
    for _ in 0..rng.below(24) {
        mesh.add_triangle([0; 3].map(|_| node(rng)));
    }
    let mut scene = finish(rng, light, mesh, IVec3::ZERO, reach * unit);
    for p in scene.receivers.iter_mut().step_by(2) {
        *p = node(rng);
    }
    scene
}

/// Triangles in the light's plane, in planes through rows and columns of the light, and in planes through receivers.
pub fn in_planes(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = 1 << (16 + rng.below(10));
    let light = light(rng, samples, IVec3::ZERO, extent);
    let mut mesh = Mesh::default();
    let mut seen = Vec::new();
    let sample =
        |rng: &mut Rng| light.sample(rng.below(light.rows as usize) as u32, rng.below(light.columns as usize) as u32);
    for _ in 0..rng.below(30) {
        let p = rng.point(extent);
        seen.push(p);
        let (l, m, n) = (sample(rng), sample(rng), sample(rng));
        match rng.below(5) {
            0 => mesh.add_triangle([l, m, n]),
            1 => mesh.add_triangle([l, m, rng.point(extent)]),
            // Corners half-way from the receiver to samples: the edges' planes hold samples, often whole rows.
            2 => mesh.add_triangle([l, m, n].map(|s| p + (s - p) / 2)),
            3 => mesh.add_triangle([p + (l - p) / 2, p + (m - p) / 4, rng.point(extent)]),
            _ => mesh.add_triangle([p, p + (l - p) / 2, rng.point(extent)]),
        }
    }
    let mut scene = finish(rng, light, mesh, IVec3::ZERO, extent);
    for (p, seen) in scene.receivers.iter_mut().zip(seen) {
        *p = seen;
    }
    scene
}

/// Closed meshes, smooth and jagged: boxes and spheres, some around receivers, some around the light.
pub fn closed_meshes(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = 1 << (14 + rng.below(13));
    let light = light(rng, samples, IVec3::ZERO, extent);
    let mut mesh = Mesh::default();
    for _ in 0..1 + rng.below(3) {
        let (at, size) = (rng.point(extent), 64 + rng.around(extent / 2).abs());
        if rng.one_in(2) {
            mesh.add(&cuboid(at, at + IVec3::ONE + (rng.point(size) + size)));
        } else {
            let jagged = rng.one_in(2);
            let depth = rng.below(2) as u32;
            mesh.add(&icosphere(at, depth, |_| f64::from(size) * if jagged { 0.5 + rng.unit() } else { 1.0 }));
        }
    }
    finish(rng, light, mesh, IVec3::ZERO, extent)
}

/// Triangles through the light's plane, through the receivers, behind the light.
pub fn across_planes(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = 1 << (14 + rng.below(13));
    let light = light(rng, samples, IVec3::ZERO, extent / 2);
    let normal = light.step_u.as_dvec3().cross(light.step_v.as_dvec3()).normalize();
    let mut mesh = Mesh::default();
    for _ in 0..rng.below(24) {
        let s = light.sample(rng.below(light.rows as usize) as u32, rng.below(light.columns as usize) as u32);
        let reach = extent >> rng.below(10);
        let off = |rng: &mut Rng, side: f64| s + rng.point(reach) + (normal * side * f64::from(reach)).as_ivec3();
        let sides = rng.pick(&[[1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-2.0, -2.0, -3.0], [0.0, 1.0, -1.0], [2.0; 3]]);
        let corners = sides.map(|side| clamp(off(rng, side)));
        mesh.add_triangle(corners);
    }
    finish(rng, light, mesh, IVec3::ZERO, extent)
}

/// A room with the light inside, and boxes standing on its floor.
pub fn interior(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let size = 1 << (16 + rng.below(10));
    let mut mesh = cuboid(IVec3::splat(-size), IVec3::splat(size));
    let light = light(rng, samples, IVec3::ZERO, size / 2);
    for _ in 0..1 + rng.below(6) {
        let (w, h) = (size / 16 + rng.around(size / 32), size / 4 + rng.around(size / 5));
        let at = IVec3::new(rng.around(size - 2 * w), -size, rng.around(size - 2 * w));
        mesh.add(&cuboid(at, at + IVec3::new(w, h, w)));
    }
    finish(rng, light, mesh, IVec3::ZERO, size)
}

/// Hundreds or thousands of small triangles, in clusters: what an index has to sort.
pub fn crowd(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = 1 << (18 + rng.below(9));
    let light = light(rng, samples, IVec3::ZERO, extent / 2);
    let mut mesh = Mesh::default();
    // Now and then so many that a hierarchy of sixteens has four levels.
    let many = if rng.one_in(6) { 20 } else { 1 };
    for _ in 0..1 + rng.below(5) {
        let (cluster, spread) = (rng.point(extent), extent >> (1 + rng.below(4)));
        for _ in 0..(40 + rng.below(80)) * many {
            let at = cluster + rng.point(spread);
            mesh.add_triangle([0; 3].map(|_| clamp(at + rng.point(spread / 8))));
        }
    }
    finish(rng, light, mesh, IVec3::ZERO, extent)
}

/// Large triangles that cover all of the light from most receivers, or all but a row, a column or a corner of it.
pub fn full_coverage(rng: &mut Rng, samples: SampleGrid) -> Scene {
    let extent = 1 << (16 + rng.below(10));
    let light = light(rng, samples, IVec3::ZERO, extent);
    let mut mesh = Mesh::default();
    let mut seen = Vec::new();
    for _ in 0..1 + rng.below(8) {
        let p = rng.point(extent);
        seen.push(p);
        // Corners on the light's plane around its grid, off it by up to a few steps, pulled half-way to the receiver.
        let mut at = |row: i32, column: i32| {
            let (row, column) = (row + rng.around(2), column + rng.around(2));
            let l = light.origin.as_dvec3()
                + light.step_v.as_dvec3() * f64::from(row)
                + light.step_u.as_dvec3() * f64::from(column);
            let p = p.as_dvec3();
            clamp((p + (l - p) * 0.5).round().as_ivec3())
        };
        let (r, c) = (samples.rows as i32, samples.columns as i32);
        mesh.add_triangle([at(-1, -1), at(-1, 2 * c + 1), at(2 * r + 1, -1)]);
    }
    let mut scene = finish(rng, light, mesh, IVec3::ZERO, extent);
    for (p, seen) in scene.receivers.iter_mut().step_by(2).zip(seen) {
        *p = seen;
    }
    scene
}

/// A realistic scene in world floats: leaves and slats over a ground, a light above.
pub fn world(rng: &mut Rng, rows: u32, columns: u32, leaves: usize, receivers: usize) -> WorldScene {
    let mut vertices = Vec::new();
    let vector = |rng: &mut Rng, x: f64, y: f64, z: f64| DVec3::new(rng.real(x), rng.real(y), rng.real(z));
    for _ in 0..leaves {
        let at = DVec3::new(0.0, 3.0, 0.0) + vector(rng, 4.0, 2.0, 4.0);
        vertices.extend([0; 3].map(|_| (at + vector(rng, 0.7, 0.5, 0.7)).as_vec3()));
    }
    let mut triangles: Vec<[u32; 3]> = (0..leaves as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let base = vertices.len() as u32;
    vertices.extend([(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(|(x, z)| Vec3::new(x, -0.1, z)));
    triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    let receivers = (0..receivers).map(|_| vector(rng, 8.0, 0.05, 8.0).as_vec3()).collect();
    let (corner, edge_u, edge_v) =
        (DVec3::new(-1.5, 9.5, -1.25), DVec3::new(3.0, 0.25, 0.0), DVec3::new(0.125, 0.0, 2.5));
    WorldScene { vertices, triangles, receivers, corner, edge_u, edge_v, rows, columns }
}
