//! Clouds of samples: scenes for them, with samples put where signs are zero, and the masks from the rule alone.

use rayon::prelude::*;
use umbra4_core::{
    Bounds, Exact, Lattice, SphereLight,
    cloud::{Cloud, CloudMask, MAX_CLOUD},
    cloud_pair::{Pair, SampleTest},
    cloud_table::{CloudTable, TableSize},
    exact::{Wide, far_side},
    glam::{DVec3, IVec3},
};
use umbra4_cpu::{Occluders, Receivers};

use crate::{
    meshes::{Mesh, icosphere},
    oracle::hit,
    rng::Rng,
    scene::{Inputs, REACH, Scene},
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
};

/// Sizes of clouds: around words, tiles of sixteen, and the most.
const SIZES: [usize; 16] = [1, 2, 15, 16, 17, 31, 32, 33, 64, 100, 255, 256, 257, 500, 1023, MAX_CLOUD];

/// Questions to the oracle that a case may take.
const QUESTIONS: usize = 500_000;

/// A cloud before a scene.
#[derive(Debug)]
pub struct Case<'a> {
    /// Where it comes from.
    pub what: String,
    /// Its place in [`KINDS`].
    pub kind: usize,
    /// The scene.
    pub inputs: Inputs,
    /// The samples.
    pub cloud: Cloud<&'a [IVec3]>,
    /// The masks, as [`oracle`] has them.
    pub expected: Vec<u64>,
}

/// Hands clouds of all kinds before scenes of a generator to `ask`: `rounds` of each kind, and some of all sizes.
///
/// # Panics
/// There is no such generator.
pub fn property(name: &str, rounds: usize, mut ask: impl FnMut(&Case<'_>)) {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).expect("there is such a generator");
    let (mut rng, mut case) = (Rng::named(0, &format!("cloud {name}")), 0);
    for round in 0..rounds {
        let grid = SampleGrid::regular(1 + rng.below(32) as u32, 1 + rng.below(32) as u32);
        let scene = generator(&mut rng, grid);
        for (kind, name_of_kind) in KINDS.into_iter().enumerate() {
            case += 1;
            let size =
                if name_of_kind == "one place" { rng.pick(&[1, 2, 33]) } else { SIZES[(case + round) % SIZES.len()] };
            let mut samples = samples(&mut rng, &scene, name_of_kind, size);
            samples.truncate((QUESTIONS / (1 + scene.mesh.triangles.len())).max(1));
            let mut scene = scene.clone();
            if name_of_kind == "among receivers" && rng.one_in(2) {
                scene.receivers.push(rng.pick(&samples));
            }
            scene.receivers.truncate(1 + QUESTIONS / (1 + scene.mesh.triangles.len()) / samples.len());
            let inputs = scene.inputs(EXPONENTS[round % EXPONENTS.len()]);
            let cloud = Cloud::new(&samples[..]).expect("samples are inside");
            let expected = oracle(&samples, inputs.receivers.points(), &inputs.triangles());
            let what = format!("{name}, scene {round}, {name_of_kind}, {} samples", samples.len());
            ask(&Case { what, kind, inputs, cloud, expected });
        }
    }
}

/// The masks from the rule alone: words of 32 bits, receiver-major.
pub fn oracle(samples: &[IVec3], receivers: &[IVec3], triangles: &[[IVec3; 3]]) -> Vec<u64> {
    let bit = |p: IVec3, s: IVec3| u64::from(triangles.iter().any(|&t| hit(p, s, t)));
    let word = |p: IVec3, of_word: &[IVec3]| of_word.iter().enumerate().map(|(k, &s)| bit(p, s) << k).sum::<u64>();
    receivers.par_iter().flat_map_iter(|&p| samples.chunks(32).map(move |of_word| word(p, of_word))).collect()
}

/// Masks from the rule of a table alone, pair by pair, all four planes looked up: nothing is left out for being far away.
pub fn by_lookups<C: AsRef<[IVec3]>, S: AsRef<[u32]>>(
    table: &CloudTable<'_, C, S>,
    receivers: &[IVec3],
    triangles: &[[IVec3; 3]],
) -> Vec<u64> {
    let words = table.cloud().words();
    let mask = |&receiver: &IVec3| {
        let mut mask = CloudMask::default();
        for &corners in triangles {
            let side = far_side::<Wide>(receiver, corners);
            let pair = Pair { receiver, corners, flipped: side < 0, cuts: 0b1111 };
            if side != 0 {
                table.planes().mark::<f32, Exact, 4>(&pair, &mut mask, &mut 0);
            }
        }
        mask.into_iter().take(words).map(u64::from)
    };
    receivers.iter().flat_map(mask).collect()
}

/// A table of a case's cloud, of a size that is another for each.
///
/// # Panics
/// Never: the size is one.
pub fn table_of<'a>(case: &'a Case<'_>) -> CloudTable<'a, &'a [IVec3], Vec<u32>> {
    const SIZES: [(u32, u32); 4] = [(8, 16), (1, 1), (5, 3), (16, 33)];
    let (directions, distances) = SIZES[(case.expected.len() + case.cloud.samples().len()) % SIZES.len()];
    let size = TableSize { directions, distances };
    let room = vec![!0; CloudTable::words_of(&case.cloud, size).expect("a size")];
    CloudTable::new(&case.cloud, size, room).expect("the room is that of the table")
}

fn inside(p: IVec3) -> IVec3 {
    p.clamp(IVec3::splat(-REACH), IVec3::splat(REACH))
}

/// Kinds of clouds: anywhere, on geometry, among receivers, on a line, in a plane, the samples of the scene's area light, a
/// sphere around a vertex, the lattice's outermost points, all in one place.
pub const KINDS: [&str; 9] =
    ["anywhere", "on geometry", "among receivers", "line", "plane", "area", "sphere", "outermost", "one place"];

/// A cloud for a scene; of `size` samples, but for the kind "area".
pub fn samples(rng: &mut Rng, scene: &Scene, kind: &str, size: usize) -> Vec<IVec3> {
    let corners = |rng: &mut Rng| match scene.mesh.triangles.len() {
        0 => [rng.point(1 << 20), rng.point(1 << 20), rng.point(1 << 20)],
        count => scene.mesh.triangles[rng.below(count)].map(|vertex| scene.mesh.vertices[vertex as usize]),
    };
    let far = |points: &[IVec3]| points.iter().map(|p| p.abs().max_element()).max().unwrap_or(REACH);
    let extent = far(&scene.mesh.vertices).max(far(&scene.receivers)).min(REACH);
    let [a, b, c] = corners(rng);
    let center = if rng.one_in(2) { a } else { rng.point(extent) };
    let spread = (extent >> rng.below(14)).max(1);
    let [along, across] = [rng.point(spread), rng.point(spread)];
    match kind {
        "area" => {
            let light = scene.light;
            (0..light.rows).flat_map(|i| (0..light.columns).map(move |j| light.sample(i, j))).collect()
        }
        "sphere" => {
            let bounds = Bounds { min: DVec3::splat(-1024.0), max: DVec3::splat(1024.0) };
            let lattice = Lattice::covering(bounds).expect("bounds are fine");
            let radius = f64::from(spread.clamp(64, 1 << 26)) * lattice.step();
            let center = lattice.to_world(center.clamp(IVec3::splat(-(1 << 28)), IVec3::splat(1 << 28)));
            let light = SphereLight { center, radius }.snap(&lattice, vec![IVec3::ZERO; size]);
            light.unwrap_or_else(|error| panic!("{error}")).samples().to_vec()
        }
        _ => {
            let mut sample = || match kind {
                "anywhere" => center + rng.point(spread),
                "on geometry" => {
                    let [a, b, c] = corners(rng);
                    match rng.below(6) {
                        0 => a,
                        1 => a + (b - a) / 2,
                        2 => b + (b - a) / 4,
                        3 => a + (b - a) / 4 + (c - a) / 4,
                        4 => a + (b - a) / 2 - (c - a) / 4,
                        _ => a + rng.point(1),
                    }
                }
                "among receivers" => match scene.receivers.len() {
                    0 => rng.point(extent),
                    count => {
                        let p = scene.receivers[rng.below(count)];
                        if rng.one_in(2) { p } else { p + rng.point(spread) }
                    }
                },
                "line" => center + along / 64 * rng.around(64),
                "plane" if rng.one_in(2) => center + along / 64 * rng.around(64) + across / 64 * rng.around(64),
                // That of a triangle.
                "plane" => a + (b - a) / 64 * rng.around(64) + (c - a) / 64 * rng.around(32),
                "outermost" => rng.point(1) * REACH,
                _ => center,
            };
            (0..size).map(|_| inside(sample())).collect()
        }
    }
}

/// Two samples far from each other, whose extent no float holds, before a triangle whose plane passes just inside, through or beyond
/// one of them.
pub fn beside_the_outermost(rng: &mut Rng) -> ([IVec3; 2], Inputs) {
    let axis = rng.below(3);
    let half = (1 << (24 + rng.below(4))) + 2 * rng.below(1 << 20) as i32 + 1;
    let turned = |along: i32, u: i32, v: i32| {
        let mut p = [0; 3];
        (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (along, u, v);
        IVec3::from_array(p)
    };
    let samples = [turned(half, 0, 0), turned(-half, 0, 0)];
    let plane = half - rng.around(16);
    let size = 50 + rng.below(1 << 12) as i32;
    let triangle = [turned(plane, -size, -size), turned(plane, size, -size), turned(plane, 0, 2 * size)];
    let receivers = vec![turned(plane + 100, 0, 0), turned(plane + 1, 1, -1), turned(half + 40, 3, 5)];
    let mesh = Mesh { vertices: triangle.to_vec(), triangles: vec![[0, 1, 2]] };
    let light = GENERATORS[0].1(&mut Rng::named(0, "a light"), SampleGrid::regular(1, 1)).light;
    (samples, Scene { light, receivers, mesh }.inputs(0))
}

/// A ball over a floor, before a sphere: a scene as they are, large enough for a hierarchy of some levels and several jobs.
pub fn ball(subdivisions: u32, side: i32) -> (Occluders, Receivers, Cloud<Vec<IVec3>>) {
    let lattice =
        Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("bounds are fine");
    let unit = (1.0 / lattice.step()) as i32;
    let mesh = icosphere(IVec3::new(0, unit, 0), subdivisions, |_| f64::from(unit));
    let world = |p: &IVec3| lattice.to_world(*p);
    let vertices: Vec<DVec3> = mesh.vertices.iter().map(world).collect();
    let occluders = Occluders::from_f64(&lattice, &vertices, &mesh.triangles).expect("vertices are inside");
    let step = 4.0 / f64::from(side);
    let points = (0..side).flat_map(|i| (0..side).map(move |j| (f64::from(i) * step - 2.0, f64::from(j) * step - 2.0)));
    let points: Vec<DVec3> = points.map(|(x, z)| DVec3::new(x, -0.25, z)).collect();
    let receivers = Receivers::raw_f64(&lattice, &points).expect("points are inside");
    let light = SphereLight { center: DVec3::new(1.0, 6.0, 0.5), radius: 0.75 };
    (occluders, receivers, light.snap(&lattice, vec![IVec3::ZERO; 256]).expect("it fits"))
}
