//! Every formula of the stochastic soft shadow map alone, against a direct and slow evaluation in f64.

use umbra4_core::{
    Jitter, LatticeLight,
    glam::{DVec2, DVec3, IVec3, Vec2},
};
use umbra4_maps::stochastic::{
    Basis, Centers, Footprint, Placement, StochasticError, StochasticOptions,
    area_frame::AreaFrame,
    closest, confusion,
    elementary::{self, Elementary},
    fit::Fit,
    gather::{self, Gathered},
    lookup, moments,
    params::{DepthRange, LensParams, RECTANGULAR},
    placement::{self, BINS},
    reproject::{self, END},
    resolve, strata,
    thin_lens::ThinLens,
    tiles,
    trace::{self, Corners, MISS, NOTHING},
    tree::Tree,
};

/// SplitMix64.
struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn around(&mut self, extent: f64) -> f64 {
        (self.unit() * 2.0 - 1.0) * extent
    }

    fn vector(&mut self, extent: f64) -> DVec3 {
        DVec3::new(self.around(extent), self.around(extent), self.around(extent))
    }
}

/// A parallelogram somewhere, about 2^20 lattice units wide.
fn light(rng: &mut Rng, jitter: Jitter) -> LatticeLight {
    let places = if jitter.is_some() { 32 } else { 1 };
    let mut step = |scale: f64| (rng.vector(scale) / f64::from(places)).as_ivec3() * places;
    let step_u = step(60_000.0) + IVec3::new(40_000, 0, 0) / places * places;
    let step_v = step(30_000.0) + IVec3::new(0, 50_000, 0) / places * places;
    let origin = rng.vector(1e7).as_ivec3();
    LatticeLight { origin, step_u, step_v, rows: 12, columns: 16, jitter }
}

/// The light's middle, half edges, normal and the longer half edge: all that the light frame is, in the lattice's own terms.
struct World {
    middle: DVec3,
    half_u: DVec3,
    half_v: DVec3,
    normal: DVec3,
    unit: f64,
}

impl World {
    fn of(light: &LatticeLight) -> Self {
        let (u, v) = (light.step_u.as_dvec3(), light.step_v.as_dvec3());
        let (half_u, half_v) = (u * f64::from(light.columns) / 2.0, v * f64::from(light.rows) / 2.0);
        // The samples' mean is the middle, whether they lie in the middle of cells or, on average, do.
        let first = if light.jitter.is_some() { (u + v) / 64.0 } else { (u + v) / 2.0 };
        let middle = light.origin.as_dvec3() - first + half_u + half_v;
        Self {
            middle,
            half_u,
            half_v,
            normal: half_u.cross(half_v).normalize(),
            unit: half_u.length().max(half_v.length()),
        }
    }

    fn point(&self, a: f64, b: f64, d: f64) -> DVec3 {
        self.middle + self.half_u * a + self.half_v * b + self.normal * (d * self.unit)
    }

    /// a, b and d of a point, by solving for them.
    fn solve(&self, p: DVec3) -> DVec3 {
        let p = p - self.middle;
        let n = self.normal * self.unit;
        let det = self.half_u.dot(self.half_v.cross(n));
        DVec3::new(
            p.dot(self.half_v.cross(n)) / det,
            self.half_u.dot(p.cross(n)) / det,
            self.half_u.dot(self.half_v.cross(p)) / det,
        )
    }
}

fn options(size: u32) -> StochasticOptions {
    StochasticOptions { size, coarse_levels: 0, interleaved: false, smoothed: false, ..StochasticOptions::default() }
}

/// A map of tangents within ±0.6 × ±0.4, in focus at depth 5, of receivers between depths 4 and 8.
fn params(light: &LatticeLight, options: &StochasticOptions, triangles: u32) -> LensParams {
    let lens = ThinLens::covering([Vec2::new(-0.6, -0.4), Vec2::new(0.6, 0.4)], 0.2, options.size);
    LensParams::new(light, &lens, DepthRange { near: 4.0, far: 8.0 }, options, triangles)
}

fn any(options: &StochasticOptions) -> LensParams {
    params(&light(&mut Rng(1), Jitter::NONE), options, 0)
}

#[track_caller]
fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs())), "{a} and {b}");
}

#[test]
fn the_light_is_a_square_in_its_frame() {
    let mut rng = Rng(2);
    for round in 0..200 {
        let jitter = if round % 2 == 0 { Jitter::NONE } else { Jitter::pattern(round) };
        let light = light(&mut rng, jitter);
        let (frame, world) = (AreaFrame::new(&light), World::of(&light));
        for _ in 0..20 {
            let wanted = DVec3::new(rng.around(2.0), rng.around(2.0), rng.around(20.0));
            let point = world.point(wanted.x, wanted.y, wanted.z).as_ivec3();
            let (placed, wanted) = (frame.place(point).as_dvec3(), world.solve(point.as_dvec3()));
            close(placed.x, wanted.x, 1e-4);
            close(placed.y, wanted.y, 1e-4);
            close(placed.z, wanted.z, 1e-4);
        }
        // Every sample of the light is inside.
        for (row, column) in [(0, 0), (0, 15), (11, 0), (11, 15)] {
            let placed = frame.place(light.sample(row, column));
            assert!(placed.x.abs() < 1.0 && placed.y.abs() < 1.0 && placed.z.abs() < 1e-3, "{placed}");
        }
    }
}

#[test]
fn sixteen_neighbours_look_from_sixteen_strata() {
    for seed in 0..5 {
        for block in [[0, 0], [4, 8], [4092, 400], [1000, 4092]] {
            let mut seen = [0; 16];
            for k in 0..16 {
                let from = strata::light_position(block[0] + k % 4, block[1] + k / 4, seed);
                assert!(from.x.abs() < 1.0 && from.y.abs() < 1.0);
                let at = |x: f32| ((x + 1.0) * 2.0) as usize;
                seen[at(from.y) * 4 + at(from.x)] += 1;
            }
            assert_eq!(seen, [1; 16]);
        }
    }
    let mean = (0..1 << 16).map(|k| strata::light_position(k % 256, k / 256, 7)).sum::<Vec2>() / 65536.0;
    assert!(mean.length() < 0.01, "{mean}");
}

/// The depth of the nearest hit, and whether an edge is so near that rounding decides.
fn brute(corners: &[[DVec3; 3]], from: DVec3, towards: DVec3, near: f64) -> (f64, bool) {
    let (mut best, mut doubtful) = (f64::INFINITY, false);
    for [a, b, c] in corners {
        let (e, f) = (*b - *a, *c - *a);
        let normal = e.cross(f);
        let det = towards.dot(normal);
        if normal.length() < 1e-9 || det.abs() < 1e-6 * normal.length() {
            continue;
        }
        let t = (*a - from).dot(normal) / det;
        let p = from + towards * t - *a;
        let inverse = 1.0 / normal.length_squared();
        let (v, w) = (e.cross(p).dot(normal) * inverse, p.cross(f).dot(normal) * inverse);
        let least = v.min(w).min(1.0 - v - w);
        let depth = (from + towards * t).z;
        if least > -1e-3 && depth > near * 0.99 && depth <= best * 1.001 {
            doubtful |= least < 1e-3 || (depth / near - 1.0).abs() < 0.01;
            if least >= 0.0 && depth < best {
                best = depth;
            }
        }
    }
    (best, doubtful)
}

#[test]
fn the_nearest_hit_is_that_of_brute_force() {
    let (mut compared, mut doubtful, mut hits) = (0, 0, 0);
    for round in 0..30 {
        let mut rng = Rng(100 + round);
        let light = light(&mut rng, Jitter::NONE);
        let world = World::of(&light);
        let count = [0, 1, 2, 4, 5, 17, 64, 65, 200][round as usize % 9];
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        for k in 0..count {
            // Some reach behind the light; some are slivers, or points.
            let middle = DVec3::new(rng.around(3.0), rng.around(3.0), rng.unit() * 9.0 - 0.5);
            let size = [0.2, 1.0, 4.0][k % 3];
            let first = vertices.len() as u32;
            for corner in 0..3 {
                let away = if k % 7 == 6 && corner == 2 { DVec3::ZERO } else { rng.vector(size) };
                let p = middle + away;
                vertices.push(world.point(p.x, p.y, p.z).as_ivec3().to_array());
            }
            triangles.push([first, first + 1, first + 2]);
        }
        let params = params(&light, &StochasticOptions { seed: round as u32, ..options(32) }, count as u32);
        let placed: Vec<Corners> = (0..count).map(|id| trace::corners(id, &params, &vertices, &triangles)).collect();
        let tree = Tree::new(count as u32);
        let mut nodes = vec![NOTHING; tree.nodes() as usize];
        for level in 0..tree.levels {
            for id in 0..tree.count(level) as usize {
                let node = if level == 0 {
                    trace::leaf(id, &params, &placed)
                } else {
                    trace::parent(id, level, &tree, &nodes)
                };
                nodes[tree.start(level) as usize + id] = node;
            }
        }
        let corners: Vec<[DVec3; 3]> = triangles
            .iter()
            .map(|t| t.map(|v| world.solve(IVec3::from_array(vertices[v as usize]).as_dvec3())))
            .collect();
        for id in 0..32 * 32 {
            let found = trace::nearest(id, &params, &tree, &placed, &nodes);
            let (column, row) = (id as u32 % 32, id as u32 / 32);
            let from = strata::light_position(column, row, round as u32).as_dvec2();
            // Through the texel's middle on the plane in focus, at depth 5.
            let at =
                |texel: u32, first: f32, scale: f32| f64::from(first) + (f64::from(texel) + 0.5) / f64::from(scale);
            let x = DVec2::new(at(column, params.first[0], params.scale[0]), at(row, params.first[1], params.scale[1]))
                * 5.0;
            let (wanted, doubt) = brute(&corners, from.extend(0.0), (x - from).extend(5.0), f64::from(params.near));
            compared += 1;
            if doubt {
                doubtful += 1;
            } else if wanted.is_finite() {
                hits += 1;
                close(f64::from(found), wanted, 1e-3);
            } else {
                assert_eq!(found, MISS, "round {round}, texel {id}");
            }
        }
    }
    assert!(hits > compared / 4 && doubtful * 20 < compared, "{compared} rays, {hits} hit, {doubtful} doubtful");
}

#[test]
fn trees_of_all_sizes_hold_every_triangle() {
    for count in (0..300).chain([1 << 20, u32::MAX]) {
        let tree = Tree::new(count);
        assert_eq!(tree.levels == 0, count == 0);
        if count > 0 {
            assert_eq!(tree.count(tree.levels - 1), 1);
            assert_eq!(tree.count(0), count.div_ceil(4));
            (1..tree.levels).for_each(|level| assert_eq!(tree.count(level), tree.count(level - 1).div_ceil(4)));
        }
    }
}

/// Equation 6 and its half-extents: the penumbra of a point, by the light's extreme points.
#[test]
fn the_circle_of_confusion_is_the_penumbra() {
    let mut rng = Rng(3);
    let params = any(&options(64));
    for _ in 0..500 {
        let (sample, plane) = (1.0 + rng.unit() * 9.0, 1.0 + rng.unit() * 9.0);
        let occluder = DVec2::new(rng.around(3.0), rng.around(3.0));
        // Where the shadow of the occluder falls, in tangents, if only this point of the light shone.
        let falls = |from: DVec2| (from + (occluder - from) * (plane / sample)) / plane;
        let scale = DVec2::new(f64::from(params.scale[0]), f64::from(params.scale[1]));
        let wanted = (falls(DVec2::ONE) - falls(-DVec2::ONE)).abs() * 0.5 * scale;
        let radius = confusion::radius(params.widest_scale(), (1.0 / sample) as f32, (1.0 / plane) as f32);
        let half = confusion::half_extents(&LensParams { least_radius: 0.0, ..params }, radius, 1.0).as_dvec2();
        close(half.x, wanted.x, 1e-4);
        close(half.y, wanted.y, 1e-4);
        // As the paper writes it, with m(d_r) = scale / d_r.
        close(f64::from(radius), f64::from(params.widest_scale()) / plane * (plane - sample).abs() / sample, 1e-4);
        let held = confusion::half_extents(&params, radius, 2.0);
        assert!(held.min_element() >= params.least_radius * 2.0);
    }
}

#[test]
fn footprints_have_the_areas_of_their_shapes() {
    let half = Vec2::new(30.0, 17.0);
    let count = |rectangular: bool| {
        (0..100 * 100)
            .filter(|k| confusion::covers(rectangular, half, (k % 100) as f32 - 49.5, (k / 100) as f32 - 49.5))
            .count()
    };
    assert_eq!(count(true), 60 * 34);
    let ellipse = core::f64::consts::PI * 30.0 * 17.0;
    assert!((count(false) as f64 / ellipse - 1.0).abs() < 0.02);
}

/// Where a ray crosses a plane, and where its hit projects to, by intersecting and projecting in space.
#[test]
fn samples_land_where_their_rays_cross_the_plane() {
    let mut rng = Rng(4);
    let (size, seed) = (48, 9);
    let base = any(&StochasticOptions { seed, ..options(size) });
    for plane in [0.2, 0.125, 0.25, 0.21] {
        let params = LensParams { plane, ..base };
        let depths: Vec<f32> =
            (0..size * size).map(|k| if k % 5 == 0 { MISS } else { 2.0 + 6.0 * rng.unit() as f32 }).collect();
        for id in 0..(size * size) as usize {
            let (column, row) = (id as u32 % size, id as u32 / size);
            let scale = DVec2::new(f64::from(params.scale[0]), f64::from(params.scale[1]));
            let first = DVec2::new(f64::from(params.first[0]), f64::from(params.first[1]));
            let middle = first + (DVec2::new(f64::from(column), f64::from(row)) + 0.5) / scale;
            let from = strata::light_position(column, row, seed).as_dvec2();
            // The ray, by two points of it: on the light, and on the plane in focus.
            let at = |depth: f64| from + (middle * 5.0 - from) * (depth / 5.0);
            let crossing = 1.0 / f64::from(plane);
            let texel = (at(crossing) / crossing - first) * scale;
            let landed = reproject::landing(id, &params);
            let inside = texel.min_element() >= 0.0 && texel.max_element() < f64::from(size);
            let border = (texel - texel.round()).abs().min_element() < 1e-3;
            if !border {
                let wanted = if inside { texel.y as u32 * size + texel.x as u32 } else { END };
                assert_eq!(landed, wanted, "texel {id} on plane {plane}");
            }
            if landed != END {
                let own = elementary::sample(id, landed as usize, &params, &depths);
                let depth = if depths[id] == MISS { 8.0 } else { f64::from(depths[id]) };
                let projected = (at(depth) / depth - first) * scale;
                let texel = DVec2::new(f64::from(landed % size), f64::from(landed / size)) + 0.5;
                close(f64::from(own.offset[0]), projected.x - texel.x, 1e-3);
                close(f64::from(own.offset[1]), projected.y - texel.y, 1e-3);
                close(
                    f64::from(own.radius),
                    f64::from(params.widest_scale()) * (1.0 / depth - 1.0 / crossing).abs(),
                    1e-3,
                );
            }
        }
    }
}

#[test]
fn lists_are_merged_into_their_mean() {
    let size = 16;
    let params = LensParams { plane: 0.125, ..any(&options(size)) };
    let depths: Vec<f32> = (0..size * size).map(|k| 2.0 + (k % 23) as f32 * 0.25).collect();
    let count = depths.len();
    let (mut heads, mut next) = (vec![END; count], vec![END; count]);
    let landings: Vec<u32> = (0..count).map(|id| reproject::landing(id, &params)).collect();
    for (id, landing) in landings.iter().enumerate().filter(|(_, landing)| **landing != END) {
        next[id] = std::mem::replace(&mut heads[*landing as usize], id as u32);
    }
    let mut total = 0.0;
    for texel in 0..count {
        let merged = reproject::merged(texel, &params, &heads, &next, &depths);
        let own: Vec<Elementary> = (0..count)
            .filter(|id| landings[*id] == texel as u32)
            .map(|id| elementary::sample(id, texel, &params, &depths))
            .collect();
        total += merged.weight;
        assert_eq!(merged.weight, own.len() as f32);
        let mean = |of: &dyn Fn(&Elementary) -> f32| {
            own.iter().map(|s| f64::from(of(s))).sum::<f64>() / own.len().max(1) as f64
        };
        close(f64::from(merged.radius), mean(&|s| s.radius), 1e-5);
        close(f64::from(merged.inverse_depth), mean(&|s| s.inverse_depth), 1e-5);
        for k in 0..4 {
            close(f64::from(merged.moments[k]), mean(&|s| s.moments[k]), 1e-5);
        }
        for k in 0..2 {
            close(f64::from(merged.offset[k]), mean(&|s| s.offset[k]), 1e-5);
        }
    }
    assert_eq!(total, landings.iter().filter(|landing| **landing != END).count() as f32);
}

/// A plane's level of random samples: some texels have none, some several.
fn random_samples(rng: &mut Rng, params: &LensParams, widest: f64) -> Vec<Elementary> {
    (0..params.size * params.size)
        .map(|_| {
            let z = rng.around(1.0) as f32;
            let radius = (rng.unit() * widest) as f32;
            let away = 0.5 + f64::from(radius) * 0.9;
            let aspect = params.aspect;
            Elementary {
                weight: [0.0, 1.0, 1.0, 3.0][rng.next() as usize % 4],
                radius,
                inverse_depth: 0.1 + rng.unit() as f32,
                offset: [rng.around(away) as f32 * aspect[0], rng.around(away) as f32 * aspect[1]],
                moments: moments::of_depth(params.exponent, z),
            }
        })
        .map(|sample| if sample.weight > 0.0 { sample } else { Elementary::NONE })
        .collect()
}

#[test]
fn the_closest_occluder_is_that_of_the_pattern() {
    // No two neighbours are close to one another, and all lie within the radius.
    for (k, [x, y]) in closest::OFFSETS.iter().enumerate() {
        assert!(x * x + y * y <= closest::SEARCH_RADIUS * closest::SEARCH_RADIUS);
        for [a, b] in &closest::OFFSETS[..k] {
            assert!((x - a).pow(2) + (y - b).pow(2) >= 100, "{x} {y} and {a} {b}");
        }
    }
    for (round, footprint) in [Footprint::Rectangle, Footprint::Ellipse].into_iter().enumerate() {
        let mut rng = Rng(5 + round as u64);
        let options = StochasticOptions { footprint, centers: Centers::Texel, ..options(80) };
        let params = any(&options);
        let samples = random_samples(&mut rng, &params, 60.0);
        let mut raised = 0;
        let mut found = Vec::new();
        for id in 0..samples.len() {
            let (column, row) = (id as i32 % 80, id as i32 / 80);
            let own = &samples[id];
            let radii = closest::OFFSETS.iter().filter_map(|[x, y]| {
                let (at_x, at_y) = (column + x, row + y);
                let inside = (0..80).contains(&at_x) && (0..80).contains(&at_y) && own.weight > 0.0;
                let other = inside.then(|| &samples[(at_y * 80 + at_x) as usize])?;
                let half = DVec2::from_array(params.aspect.map(f64::from)) * f64::from(other.radius);
                let half = half.max(DVec2::splat(1.5));
                let (x, y) = (f64::from(*x).abs() / half.x, f64::from(*y).abs() / half.y);
                let within = if footprint == Footprint::Rectangle { x.max(y) < 1.0 } else { x * x + y * y < 1.0 };
                (other.weight > 0.0 && other.inverse_depth > own.inverse_depth && within).then_some(other.radius)
            });
            let wanted = radii.fold(f32::INFINITY, f32::min);
            let wanted = if wanted.is_finite() { wanted } else { 0.0 };
            found.push(closest::closest(id, &params, &samples));
            assert_eq!(found[id], wanted, "texel {id}");
            raised += usize::from(wanted > 0.0);
        }
        assert!(raised > samples.len() / 4, "{raised}");
        // Smoothed: a direct Gaussian.
        for id in (0..samples.len()).step_by(37) {
            let (mut sum, mut weights) = (0.0, 0.0);
            for other in (0..samples.len()).filter(|other| samples[*other].weight > 0.0) {
                let away = |a: usize, b: usize| (a as f64 - b as f64).abs();
                let (x, y) = (away(other % 80, id % 80), away(other / 80, id / 80));
                if x <= 2.0 && y <= 2.0 {
                    let weight = (-(x * x + y * y) / 2.0).exp();
                    sum += weight * f64::from(found[other]);
                    weights += weight;
                }
            }
            close(f64::from(closest::smoothed(id, &params, &samples, &found)), sum / f64::max(weights, 1e-30), 1e-5);
            let raised = closest::raised(id, &params, &samples, &found);
            assert!(raised >= samples[id].radius && raised <= samples[id].radius.max(params.widest_raise));
        }
    }
}

#[test]
fn moments_and_their_bound() {
    let mut rng = Rng(6);
    for _ in 0..500 {
        // A distribution of depths, and the share of it beyond each of some receivers.
        let depths: Vec<f64> = (0..20).map(|_| rng.around(1.0)).collect();
        for exponent in [0.0_f32, 1.0, 5.0, 10.0] {
            let sum = depths
                .iter()
                .map(|z| moments::of_depth(exponent, *z as f32))
                .fold([0.0_f32; 4], |s, m| [s[0] + m[0], s[1] + m[1], s[2] + m[2], s[3] + m[3]]);
            let mean = sum.map(|m| m / 20.0);
            let at = rng.around(1.0);
            let direct = |f: &dyn Fn(f64) -> f64| {
                let mean = depths.iter().map(|z| f(*z)).sum::<f64>() / 20.0;
                let variance = depths.iter().map(|z| (f(*z) - mean).powi(2)).sum::<f64>() / 20.0;
                let beyond = f(at) - mean;
                if beyond <= 0.0 { 1.0 } else { variance / (variance + beyond * beyond) }
            };
            let c = f64::from(exponent);
            let wanted = if exponent > 0.0 {
                direct(&|z| (c * z).exp()).min(direct(&|z| -(-c * z).exp()))
            } else {
                direct(&|z| z)
            };
            let found = f64::from(moments::visibility(exponent, &mean, at as f32, 0.0));
            close(found, wanted, 2e-3);
            let share = depths.iter().filter(|z| **z >= at).count() as f64 / 20.0;
            assert!(found >= share - 1e-3, "an upper bound: {found} of {share}");
        }
    }
    // At the largest exponent nothing overflows.
    for z in [-1.0, 0.0, 1.0] {
        let m = moments::of_depth(35.0, z);
        assert!(m.iter().all(|m| (m * 4096.0 * 4096.0).is_finite()));
        let seen = moments::visibility(35.0, &m, 1.0, 0.0);
        assert_eq!(seen, if z < 1.0 { 0.0 } else { 1.0 });
    }
}

/// Equation 8, as it is written.
#[test]
fn levels_share_samples_as_equation_8_says() {
    let share = |radius: f64| {
        let reach = 8.0;
        if radius > 0.5 * reach {
            1.0
        } else if radius < 0.4 * reach {
            0.0
        } else {
            1.0 - (0.5 * reach - radius) / (0.1 * reach)
        }
    };
    for k in 0..1000 {
        let radius = f64::from(k) * 0.01;
        close(f64::from(gather::coarse_share(radius as f32)), share(radius), 1e-4);
    }
    // What one level hands on, and what it keeps, are all of a sample.
    let options = StochasticOptions { coarse_levels: 3, ..options(37) };
    let params = any(&options);
    let mut rng = Rng(7);
    let mut samples = random_samples(&mut rng, &params, 30.0);
    let total: f32 = samples.iter().map(|s| s.weight).sum();
    let middle: f64 = samples.iter().map(|s| f64::from(s.weight * s.moments[0])).sum();
    let (mut kept, mut kept_middle) = (0.0, 0.0);
    for level in 0..4 {
        let params = params.with_level(level);
        let start = params.level_start(level) as usize;
        for sample in &samples[start..] {
            let share = f64::from(sample.weight * gather::kept_share(&params, sample.radius));
            kept += share;
            kept_middle += share * f64::from(sample.moments[0]);
        }
        if level < 3 {
            let size = params.level_size(level + 1);
            let next: Vec<Elementary> =
                (0..(size * size) as usize).map(|id| gather::coarser(id, &params, &samples)).collect();
            samples.extend(next);
        }
    }
    assert_eq!(samples.len(), params.level_start(4) as usize);
    close(kept, f64::from(total), 1e-5);
    // A merged sample has one radius, which decides for all that were merged: shares of moments move a little.
    close(kept_middle, middle, 0.05);
}

/// Equation 7 over all samples of the map.
fn direct(params: &LensParams, samples: &[Elementary], at: DVec2) -> (f64, [f64; 4]) {
    let size = params.size as usize;
    let (mut weights, mut sums) = (0.0, [0.0; 4]);
    for (k, sample) in samples.iter().enumerate().filter(|(_, sample)| sample.weight > 0.0) {
        let middle = DVec2::new((k % size) as f64 + 0.5, (k / size) as f64 + 0.5);
        let middle = middle + DVec2::from_array(sample.offset.map(f64::from));
        let half = DVec2::from_array(params.aspect.map(f64::from)) * f64::from(sample.radius);
        let half = half.max(DVec2::splat(f64::from(params.least_radius)));
        // What the footprint and the texel have in common, by their ends.
        let (low, high) = ((middle - half).max(at - 0.5), (middle + half).min(at + 0.5));
        let area = (high - low).max(DVec2::ZERO).element_product();
        let away = ((at - middle) / half).length_squared();
        let covered = if params.is(RECTANGULAR) { area } else { f64::from(u8::from(away < 1.0)) };
        if covered > 0.0 {
            let weight = covered * f64::from(sample.weight) / (half.x * half.y);
            weights += weight;
            sums.iter_mut().zip(sample.moments).for_each(|(sum, m)| *sum += weight * f64::from(m));
        }
    }
    (weights, sums)
}

#[test]
fn one_level_gathers_equation_7() {
    for footprint in [Footprint::Rectangle, Footprint::Ellipse] {
        gathers_equation_7(&any(&StochasticOptions { basis: Basis::Variance, footprint, ..options(40) }));
    }
}

fn gathers_equation_7(params: &LensParams) {
    // So narrow that no sample is beyond what a texel looks at.
    let samples = random_samples(&mut Rng(8), params, 2.9);
    let mut same = 0;
    for id in 0..samples.len() {
        let found = gather::gathered(id, gather::RADIUS, params, &samples);
        let at = DVec2::new((id % 40) as f64 + 0.5, (id / 40) as f64 + 0.5);
        let (weights, sums) = direct(params, &samples, at);
        // On the border of a footprint rounding decides.
        if (f64::from(found.weight) - weights).abs() < 1e-4 {
            same += 1;
            (0..4).for_each(|k| close(f64::from(found.moments[k]), sums[k], 1e-4));
        }
        // A search radius that is made for the widest sample finds them all.
        let search = gather::search_radius(params, 2.9);
        assert_eq!(gather::gathered(id, search, params, &samples), found);
    }
    assert!(same > samples.len() - 8, "{same} of {}", samples.len());
}

#[test]
fn interleaving_skips_what_it_says() {
    let full = any(&options(40));
    let params = any(&StochasticOptions { interleaved: true, ..options(40) });
    let samples = random_samples(&mut Rng(9), &params, 3.0);
    for id in [0, 5, 41, 820, 1599] {
        let (column, row) = (id % 40, id / 40);
        let thinned: Vec<Elementary> = samples
            .iter()
            .enumerate()
            .map(|(k, s)| if k % 40 % 2 == column % 2 && k / 40 % 2 == row % 2 { *s } else { Elementary::NONE })
            .collect();
        assert_eq!(gather::gathered(id, 7, &params, &samples), gather::gathered(id, 7, &full, &thinned));
    }
}

/// All levels of a plane, resolved; one texel after the other.
fn resolved(params: &LensParams, mut samples: Vec<Elementary>) -> Vec<Gathered> {
    for level in 0..params.levels - 1 {
        let params = params.with_level(level);
        let size = params.level_size(level + 1);
        let next: Vec<Elementary> =
            (0..(size * size) as usize).map(|id| gather::coarser(id, &params, &samples)).collect();
        samples.extend(next);
    }
    let all = params.level_start(params.levels) as usize;
    let (mut gathered, mut out) = (vec![Gathered::NONE; all], vec![Gathered::NONE; all]);
    for level in (0..params.levels).rev() {
        let params = params.with_level(level);
        let (start, size) = (params.level_start(level) as usize, params.level_size(level));
        for id in 0..(size * size) as usize {
            gathered[start + id] = gather::gathered(id, gather::RADIUS, &params, &samples);
        }
        for id in 0..(size * size) as usize {
            out[start + id] = resolve::resolved(id, &params, &gathered, &out, 0);
        }
    }
    out
}

/// What is gathered level by level is close to the average over all samples at full resolution: an edge between near and far samples, both of them wide.
#[test]
fn levels_together_are_the_full_resolution_average() {
    let size = 96;
    for (interleaved, smoothed, tolerance) in [(false, false, 0.12), (true, true, 0.25)] {
        let options =
            StochasticOptions { coarse_levels: 4, basis: Basis::Variance, interleaved, smoothed, ..options(size) };
        let params = any(&options);
        for radius in [2.0_f32, 3.5, 3.7, 6.0, 13.0, 25.0] {
            let samples: Vec<Elementary> = (0..size * size)
                .map(|k| Elementary {
                    weight: 1.0,
                    radius,
                    inverse_depth: 0.2,
                    offset: [0.0; 2],
                    moments: moments::of_depth(0.0, if k % size < size / 2 { -1.0 } else { 1.0 }),
                })
                .collect();
            let found = resolved(&params, samples.clone());
            let mut worst = 0.0_f64;
            for column in 30..66 {
                let (weights, sums) = direct(&params, &samples, DVec2::new(f64::from(column) + 0.5, 48.5));
                let found = found[(48 * size + column) as usize];
                assert_eq!(found.weight, 1.0);
                worst = worst.max((f64::from(found.moments[0]) - sums[0] / weights).abs());
            }
            // Means go from −1 to 1. A coarse texel is up to half a narrow radius wide, and moves an edge by a part of that; to smooth moves
            // it by as much again.
            let narrow = f64::from(radius) * f64::from(params.aspect[0]);
            assert!(worst < tolerance + if narrow < 4.0 { 1.0 / narrow } else { 0.0 }, "radius {radius}: {worst}");
        }
    }
}

#[test]
fn smoothing_removes_what_interleaving_leaves() {
    let options = StochasticOptions { smoothed: true, ..options(16) };
    let params = any(&options);
    // Any pattern of two by two.
    let pattern = [0.5, 3.0, 1.25, 7.0];
    let gathered: Vec<Gathered> =
        (0..256).map(|k| Gathered { weight: pattern[k % 2 + k / 16 % 2 * 2], moments: [0.0; 4] }).collect();
    for k in (0..256).filter(|k| (1..15).contains(&(k % 16)) && (1..15).contains(&(k / 16))) {
        assert_eq!(resolve::smoothed(k % 16, k / 16, &params, &gathered).weight, 11.75 / 4.0);
    }
}

#[test]
fn upsampling_keeps_what_is_linear() {
    let params = any(&StochasticOptions { coarse_levels: 1, ..options(16) });
    let of = |x: f32, y: f32| 3.0 * x - 2.0 * y;
    let coarser: Vec<Gathered> = (0..64)
        .map(|k| Gathered { weight: of((k % 8) as f32 * 2.0 + 1.0, (k / 8) as f32 * 2.0 + 1.0), moments: [0.0; 4] })
        .collect();
    for (column, row) in [(1, 1), (2, 7), (8, 3), (13, 14)] {
        let found = resolve::upsampled(column, row, &params, &coarser, params.level_start(1)).weight;
        assert_eq!(found, of(column as f32 + 0.5, row as f32 + 0.5));
    }
}

#[test]
fn lookups_are_bilinear_and_planes_share_receivers() {
    let mut rng = Rng(10);
    let params = any(&options(32));
    let plane: Vec<Gathered> = (0..1024)
        .map(|k| Gathered { weight: 1.0, moments: [(k % 32) as f32 + 0.5, (k / 32) as f32 + 0.5, 0.0, 0.0] })
        .collect();
    for _ in 0..300 {
        let (x, y) = (0.5 + rng.unit() as f32 * 31.0, 0.5 + rng.unit() as f32 * 31.0);
        let found = lookup::bilinear(x, y, &params, &plane);
        close(f64::from(found.moments[0]), f64::from(x), 1e-4);
        close(f64::from(found.moments[1]), f64::from(y), 1e-4);
    }
    // Texels without a value have no say; where there are none, there is none.
    let holes: Vec<Gathered> =
        plane.iter().enumerate().map(|(k, g)| if k % 2 == 0 { *g } else { Gathered::NONE }).collect();
    assert_eq!(lookup::bilinear(4.75, 9.5, &params, &holes).moments[0], 4.5);
    assert_eq!(lookup::bilinear(4.75, 9.5, &params, &[]), Gathered::NONE);

    for planes in [vec![0.2_f32], vec![0.25, 0.125], vec![0.5, 0.3, 0.29, 0.1]] {
        for _ in 0..200 {
            let at = (0.05 + rng.unit() * 0.6) as f32;
            let weights: Vec<f32> =
                (0..planes.len()).map(|k| lookup::plane_weight(&params.with_plane(&planes, k), at)).collect();
            close(f64::from(weights.iter().sum::<f32>()), 1.0, 1e-5);
            assert!(weights.iter().filter(|w| **w > 0.0).count() <= 2);
            // The mean of the planes is where the receiver is, between the outermost.
            let mean: f32 = weights.iter().zip(&planes).map(|(w, q)| w * q).sum();
            close(f64::from(mean), f64::from(at.clamp(planes[planes.len() - 1], planes[0])), 1e-5);
        }
    }
}

#[test]
fn planes_lie_where_they_are_asked_for() {
    let depths = DepthRange { near: 2.0, far: 10.0 };
    let mut histogram = [0_u32; BINS];
    // Most receivers far away, some near.
    for _ in 0..7000 {
        histogram[placement::bin(depths, 0.11)] += 1;
    }
    for k in 0..1000 {
        histogram[placement::bin(depths, 0.1 + 0.4 * k as f32 / 999.0)] += 1;
    }
    for count in [1, 2, 3, 8, 64] {
        for placement in [Placement::Depth, Placement::InverseDepth, Placement::Receivers] {
            let mut planes = vec![0.0; count];
            placement::place(&mut planes, placement, depths, &histogram);
            assert!(planes.iter().all(|q| (0.1..=0.5).contains(q)), "{placement:?} {planes:?}");
            assert!(planes.windows(2).all(|pair| pair[0] >= pair[1]), "{placement:?} {planes:?}");
            if count > 1 {
                close(f64::from(planes[0]), 0.5, 1e-2);
                close(f64::from(planes[count - 1]), 0.1, 1e-2);
            }
        }
        let mut planes = vec![0.0; count];
        placement::place(&mut planes, Placement::Depth, depths, &histogram);
        for (k, plane) in planes.iter().enumerate().filter(|_| count > 1) {
            close(f64::from(1.0 / plane), 2.0 + 8.0 * k as f64 / (count - 1) as f64, 1e-4);
        }
    }
    // The median, of one.
    let mut plane = [0.0];
    placement::place(&mut plane, Placement::Receivers, depths, &histogram);
    assert!((0.108..0.113).contains(&plane[0]), "{plane:?}");
    // Cube roots: a bin with 27 times the receivers takes three times the planes. (To the width of one.)
    let mut even = [1000_u32; BINS];
    even[BINS / 2..].fill(27_000);
    let mut planes = vec![0.0; 64];
    placement::place(&mut planes, Placement::Receivers, depths, &even);
    let denser = planes.iter().filter(|q| **q > 0.3).count();
    assert!((47..=49).contains(&denser), "{denser} of 64");
}

#[test]
fn a_fit_holds_every_ray_to_its_receivers() {
    let mut rng = Rng(11);
    for round in 0..40 {
        let light = light(&mut rng, Jitter::NONE);
        let world = World::of(&light);
        let flat = round % 4 == 0;
        let points: Vec<IVec3> = (0..100)
            .map(|_| {
                let d = if flat { 5.0 } else { 0.5 + rng.unit() * 9.0 };
                world.point(rng.around(2.0), rng.around(3.0), d).as_ivec3()
            })
            .collect();
        let options = StochasticOptions { planes: 5, reach: 100.0, ..options(64) };
        let fit = Fit::new(&light, &points, &options).expect("options are good").expect("receivers are before it");
        assert!(fit.planes().windows(2).all(|pair| pair[0] > pair[1]));
        assert!(flat || fit.planes().len() == 5);
        for p in &points {
            let placed = fit.frame.place(*p);
            for corner in [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::new(1.0, 1.0)] {
                // Where the ray from the corner of the light crosses the plane in focus, as a tangent.
                let crossing = 1.0 / fit.lens.focus;
                let at = corner + (placed.truncate() - corner) * (crossing / placed.z);
                assert!(fit.lens.holds(fit.lens.texels(at / crossing)), "round {round}");
            }
        }
    }
    // Nobody is before the light, or within reach; or there is nobody.
    let light = light(&mut rng, Jitter::NONE);
    let world = World::of(&light);
    let behind = [world.point(0.0, 0.0, -3.0).as_ivec3()];
    let aside = [world.point(20.0, 0.0, 1.0).as_ivec3()];
    for points in [&behind[..], &aside, &[]] {
        assert_eq!(Fit::new(&light, points, &options(64)), Ok(None));
    }
}

#[test]
fn bad_options_are_refused_by_field_and_value() {
    let good = StochasticOptions::default();
    assert_eq!((good.check(), StochasticOptions::paper().check()), (Ok(()), Ok(())));
    let refused = |options: StochasticOptions, wanted: &str, value: f64| match options.check() {
        Err(
            StochasticError::OutOfRange { field, value: found, .. }
            | StochasticError::Overflow { field, value: found, .. },
        ) => {
            assert_eq!(field, wanted);
            assert!(found == value || found.is_nan() && value.is_nan());
        }
        Ok(()) => panic!("{wanted} = {value} is accepted"),
    };
    refused(StochasticOptions { size: 0, ..good }, "size", 0.0);
    refused(StochasticOptions { size: 4097, ..good }, "size", 4097.0);
    refused(StochasticOptions { planes: 0, ..good }, "planes", 0.0);
    refused(StochasticOptions { planes: 65, ..good }, "planes", 65.0);
    refused(StochasticOptions { coarse_levels: 9, ..good }, "coarse_levels", 9.0);
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        refused(StochasticOptions { least_radius: bad, ..good }, "least_radius", f64::from(bad));
        refused(StochasticOptions { widest_raise: bad, ..good }, "widest_raise", f64::from(bad));
        refused(StochasticOptions { least_deviation: bad, ..good }, "least_deviation", f64::from(bad));
        refused(StochasticOptions { reach: bad, ..good }, "reach", f64::from(bad));
    }
    for exponent in [0.0, -2.0, 35.5, f32::NAN, f32::INFINITY] {
        refused(StochasticOptions { basis: Basis::Exponential { exponent }, ..good }, "exponent", f64::from(exponent));
    }
    let error = StochasticOptions { basis: Basis::Exponential { exponent: 50.0 }, ..good }
        .check()
        .expect_err("its square overflows");
    assert_eq!(error.to_string(), "stochastic shadow map: exponent is 50: beyond 35 moments overflow");
}

#[test]
fn tiles_cover_the_levels() {
    let params = any(&StochasticOptions { coarse_levels: 3, ..options(70) });
    let mut seen = vec![0; tiles::tiles_start(&params, 4) as usize];
    for level in 0..4 {
        let params = params.with_level(level);
        let size = params.level_size(level);
        for id in 0..(size * size) as usize {
            seen[tiles::tile_of(id, &params) as usize] += 1;
        }
    }
    assert!(seen.iter().all(|count| (1..=256).contains(count)));
    assert_eq!(seen.iter().sum::<u32>(), params.level_start(4));
}
