//! The casters' oracle is right: on cases counted by hand, against the other oracles where nothing is new, and against itself put
//! another way.

use umbra4_core::{
    Jitter, LatticeLight,
    glam::{DVec3, IVec3},
};
use umbra4_tests::{
    bigint, budget,
    caster_oracle::{
        Decisions, OracleCaster, OracleReceiver, OracleSurface, Prepared, Seen, closed,
        depth::{self, OPAQUE},
        hit::{self, Cone},
        light_of, masks, samples, seen,
        texel::{Corners, OracleTexture, Wrap},
    },
    caster_scenes::{self, CasterScene, GENERATORS, pane},
    meshes::{cuboid, icosphere},
    oracle,
    rng::Rng,
    scenes::{self, SampleGrid},
};

/// Distance of neighbouring samples.
const STEP: i32 = 1024;
const HEIGHT: i32 = 1 << 16;

/// A lamp that shines straight down, sample (0, 0) over the origin.
fn lamp(rows: u32, columns: u32) -> LatticeLight {
    LatticeLight {
        origin: IVec3::new(0, HEIGHT, 0),
        step_u: IVec3::X * STEP,
        step_v: IVec3::Z * STEP,
        rows,
        columns,
        jitter: Jitter::NONE,
    }
}

/// The place half-way from the origin to where sample (row / 2, column / 2) is, or would be.
fn half_way(row: i32, column: i32) -> IVec3 {
    IVec3::new(column * STEP / 4, HEIGHT / 2, row * STEP / 4)
}

/// A card half-way between the origin and given half rows and columns, its texture from one corner to the other.
fn card(rows: [i32; 2], columns: [i32; 2], u: [i32; 2], v: [i32; 2]) -> (Vec<[IVec3; 3]>, Vec<Corners>) {
    let at = |i: usize, j: usize| half_way(rows[i], columns[j]);
    let uv = |i: usize, j: usize| [u[j], v[i]];
    let triangles = vec![[at(0, 0), at(0, 1), at(1, 1)], [at(0, 0), at(1, 1), at(1, 0)]];
    (triangles, vec![[uv(0, 0), uv(0, 1), uv(1, 1)], [uv(0, 0), uv(1, 1), uv(1, 0)]])
}

fn one(light: &LatticeLight, p: impl Into<OracleReceiver>, casters: &[OracleCaster]) -> Seen {
    Prepared::new(light, casters).seen(p.into()).0
}

/// What a row of four texels, the first and third of which are opaque, blocks of five samples on its borders.
fn borders(u: [i32; 2], wrap: Wrap, v: [i32; 2]) -> u64 {
    let (triangles, coordinates) = card([-1, 1], [0, 8], u, v);
    let texture = OracleTexture { width: 4, height: 1, texels: vec![255_u8, 127, 128, 0], wrap: [wrap; 2] };
    let surface = OracleSurface::Cutout { texture, coordinates, threshold: 128 };
    one(&lamp(1, 5), IVec3::ZERO, &[OracleCaster::opaque(triangles).with_surface(surface)]).mask[0]
}

const ONE: i32 = 1 << 16;

#[test]
fn a_hit_on_a_border_belongs_to_the_upper_texel() {
    // Samples at u = 0, 1/4, 1/2, 3/4 and 1, which is the next texture's first texel, or this one's last.
    assert_eq!(borders([0, ONE], Wrap::Repeat, [0, ONE]), 0b10101);
    assert_eq!(borders([0, ONE], Wrap::Clamp, [0, ONE]), 0b00101);
    // The other way round: u = 1, 3/4, 1/2, 1/4, 0.
    assert_eq!(borders([ONE, 0], Wrap::Repeat, [0, ONE]), 0b10101);
    assert_eq!(borders([ONE, 0], Wrap::Clamp, [0, ONE]), 0b10100);
    // A hair before the borders: texels 0 (of −1, which is 3), 0, 1, 2, 3; whatever v is.
    for v in [[0, ONE], [-7 * ONE, 1], [ONE, ONE], [3, 3]] {
        assert_eq!(borders([-1, ONE - 1], Wrap::Repeat, v), 0b01010, "{v:?}");
        assert_eq!(borders([-1, ONE - 1], Wrap::Clamp, v), 0b01011, "{v:?}");
    }
}

#[test]
fn coordinates_below_zero_repeat_and_clamp() {
    assert_eq!(borders([-ONE, 0], Wrap::Repeat, [0, ONE]), 0b10101);
    assert_eq!(borders([-ONE, 0], Wrap::Clamp, [0, ONE]), 0b11111);
    assert_eq!(borders([-5 * ONE, -4 * ONE], Wrap::Repeat, [-ONE, ONE]), 0b10101);
    // Half a texture lower: texels 2, 3, 0, 1, 2.
    assert_eq!(borders([-ONE / 2, ONE / 2], Wrap::Repeat, [0, ONE]), 0b10101);
    // A quarter: texels 3, 0, 1, 2, 3.
    assert_eq!(borders([-ONE / 4, 3 * ONE / 4], Wrap::Repeat, [0, ONE]), 0b01010);
    assert_eq!(borders([-ONE / 4, 3 * ONE / 4], Wrap::Clamp, [0, ONE]), 0b01011);
    // The last texel, which lets light through.
    assert_eq!(borders([9 * ONE, 10 * ONE], Wrap::Clamp, [0, ONE]), 0);
}

#[test]
fn rows_of_texels_begin_at_v_of_zero() {
    let (triangles, coordinates) = card([0, 4], [-1, 1], [0, 0], [0, ONE]);
    let texture = OracleTexture { width: 1, height: 2, texels: vec![9_u8, 0], wrap: [Wrap::Clamp; 2] };
    let surface = OracleSurface::Cutout { texture, coordinates, threshold: 9 };
    let caster = OracleCaster::opaque(triangles).with_surface(surface);
    // Samples at v = 0, 1/2 and 1.
    assert_eq!(one(&lamp(3, 1), IVec3::ZERO, &[caster]).mask, [1, 0, 0]);
}

#[test]
fn a_texture_of_one_texel_is_all_or_nothing() {
    for (alpha, blocked) in [(255, 0b11111), (128, 0b11111), (127, 0), (0, 0)] {
        let (triangles, _) = card([-1, 1], [0, 8], [0; 2], [0; 2]);
        let coordinates = vec![[[-(1 << 30), 5], [1 << 30, -(1 << 30)], [3, 1 << 30]]; 2];
        let surface = OracleSurface::Cutout { texture: OracleTexture::one(alpha), coordinates, threshold: 128 };
        let caster = OracleCaster::opaque(triangles).with_surface(surface);
        assert_eq!(one(&lamp(1, 5), IVec3::ZERO, &[caster]).mask, [blocked]);
    }
}

fn glass(depths: [u16; 3]) -> OracleSurface {
    OracleSurface::Tinted { texture: OracleTexture::one(depths), coordinates: None }
}

#[test]
fn an_edge_of_two_panes_counts_once_and_an_outer_one_belongs_to_the_side_that_samples_move_to() {
    // Two panes that share the edge under column 2, from half way before column 0 to column 4 exactly.
    let [left, right] = [[0, 4], [4, 8]].map(|columns| card([-1, 1], columns, [0; 2], [0; 2]).0);
    for turned in [false, true] {
        let mut triangles = [left.clone(), right.clone()].concat();
        if turned {
            triangles.iter_mut().step_by(2).for_each(|triangle| triangle.swap(0, 2));
        }
        let together = OracleCaster::opaque(triangles.clone()).with_surface(glass([1, 2, 3]));
        // The first edge lies on sample 0, which moves into the pane, and the last on sample 4, which moves out of it.
        let expected = [[1, 2, 3], [1, 2, 3], [1, 2, 3], [1, 2, 3], [0; 3]];
        assert_eq!(one(&lamp(1, 5), IVec3::ZERO, &[together]).depths, Some(expected.to_vec()));
        let apart: Vec<_> = triangles
            .chunks(2)
            .map(|part| OracleCaster::opaque(part.to_vec()).with_surface(glass([1, 2, 3])))
            .collect();
        assert_eq!(one(&lamp(1, 5), IVec3::ZERO, &apart).depths, Some(expected.to_vec()));
    }
}

#[test]
fn an_edge_along_the_columns_is_told_by_the_rows() {
    // Two panes that share the edge under row 1, from row 0 to row 2.
    let [upper, lower] = [[0, 2], [2, 4]].map(|rows| card(rows, [-1, 5], [0; 2], [0; 2]).0);
    let caster = OracleCaster::opaque([upper, lower].concat()).with_surface(glass([7, 0, 0]));
    let depths = one(&lamp(3, 3), IVec3::ZERO, &[caster]).depths.expect("before the light");
    assert_eq!(depths.iter().map(|d| d[0]).collect::<Vec<_>>(), [7, 7, 7, 7, 7, 7, 0, 0, 0]);
}

#[test]
fn the_middle_of_a_fan_counts_once() {
    let mut rng = Rng::named(0, "fans");
    for _ in 0..budget::of(500) {
        let count = 3 + rng.below(9);
        let mut around: Vec<IVec3> = (0..count)
            .map(|k| {
                let angle = (k as f64 + rng.unit() * 0.9) / count as f64 * std::f64::consts::TAU;
                let far = 1.0 + 4.0 * rng.unit();
                half_way(4 + (far * angle.sin() * 2.0).round() as i32, 4 + (far * angle.cos() * 2.0).round() as i32)
            })
            .collect();
        // Corners that fall together, or turn back, make no fan.
        let middle = half_way(4, 4);
        around.dedup();
        let turns = |k: usize| {
            let [u, v] = [around[k] - middle, around[(k + 1) % around.len()] - middle];
            i64::from(u.x) * i64::from(v.z) - i64::from(u.z) * i64::from(v.x)
        };
        if around.len() < 3 || (0..around.len()).any(|k| turns(k) <= 0) {
            continue;
        }
        let mut fan: Vec<_> = (0..around.len()).map(|k| [middle, around[k], around[(k + 1) % around.len()]]).collect();
        fan.iter_mut().for_each(|triangle| triangle.rotate_left(rng.below(3)));
        fan.iter_mut().filter(|_| rng.one_in(2)).for_each(|triangle| triangle.swap(0, 1));
        let caster = OracleCaster::opaque(fan.clone()).with_surface(glass([1, 1, 1]));
        let depths = one(&lamp(5, 5), IVec3::ZERO, &[caster]).depths.expect("before the light");
        // Sample (2, 2) is the middle.
        assert_eq!(depths[12], [1; 3], "{fan:?}");
        assert!(depths.iter().all(|depth| depth[0] <= 1), "{fan:?}");
    }
}

#[test]
fn samples_count_once_over_any_pane() {
    let mut rng = Rng::named(0, "panes");
    let (mut once, mut on_edge) = (0, 0);
    for _ in 0..budget::of(800) {
        let (min, extent) = ([0; 2].map(|_| rng.around(6)), [0; 2].map(|_| 1 + rng.below(14) as i32));
        let mut triangles = pane(&mut rng, min, extent).expect("it has an extent");
        for corner in triangles.as_flattened_mut() {
            *corner = half_way(corner.z, corner.x);
        }
        triangles.iter_mut().filter(|_| rng.one_in(3)).for_each(|triangle| triangle.swap(1, 2));
        let light = lamp(7, 7);
        let caster = OracleCaster::opaque(triangles).with_surface(glass([5, 0, 0]));
        let (seen, decisions) = Prepared::new(&light, &[caster]).seen(IVec3::ZERO.into());
        on_edge += decisions.on_edge;
        for (k, depth) in seen.depths.expect("before the light").iter().enumerate() {
            let [z, x] = [2 * (k as i32 / 7), 2 * (k as i32 % 7)];
            // Half open: what moves in belongs to it.
            let inside = (min[0]..min[0] + extent[0]).contains(&x) && (min[1]..min[1] + extent[1]).contains(&z);
            assert_eq!(depth[0], if inside { 5 } else { 0 }, "sample {k}");
            once += u64::from(inside);
        }
    }
    assert!(once > 4000 && on_edge > 4000, "{once} samples inside, {on_edge} on edges");
}

#[test]
fn panes_behind_one_another_add_up() {
    let pane_of = |depths: [u16; 3], lower: i32| {
        let triangles = card([-1, 1], [-1, 3], [0; 2], [0; 2]).0;
        let moved = triangles.into_iter().map(|t| t.map(|corner| corner - IVec3::Y * lower)).collect();
        OracleCaster::opaque(moved).with_surface(glass(depths))
    };
    let light = lamp(1, 2);
    let weights = [[u16::MAX, 1000, 3], [u16::MAX, 65535, 40000]];
    let light_through = |casters: &[OracleCaster]| light_of(&light, &one(&light, IVec3::ZERO, casters), &weights);
    assert_eq!(light_through(&[]), [131_070, 66_535, 40_003]);
    // A tint of 1 is nothing; one of 0 is a wall.
    assert_eq!(light_through(&[pane_of([0; 3], 0)]), [131_070, 66_535, 40_003]);
    assert_eq!(light_through(&[pane_of([OPAQUE, 0, OPAQUE], 0)]), [0, 66_535, 0]);
    // A stop each: halves, each weight rounded for itself, halves up: 65535/2 = 32768, 500, 2, 32768, 20000.
    assert_eq!(light_through(&[pane_of([2048; 3], 0)]), [65_536, 33_268, 20_002]);
    assert_eq!(
        light_through(&[pane_of([2048, 0, 0], 0), pane_of([2048; 3], 100), pane_of([0, 2048, 0], 7)]),
        [2 * 16_384, 250 + 16_384, 20_002]
    );
    // 20 stops leave nothing of 16 bits, more than 32 saturate.
    assert_eq!(light_through(&[pane_of([40_000; 3], 0), pane_of([40_000; 3], 9)]), [0; 3]);
    let both = one(&light, IVec3::ZERO, &[pane_of([40_000, 1, 65_534], 0), pane_of([40_000, 2, 1], 9)]);
    assert_eq!(both.depths, Some(vec![[OPAQUE, 3, OPAQUE]; 2]));
    // A wall before the glass blocks; the mask says so and the light is gone.
    let wall = OracleCaster::opaque(card([-1, 1], [-1, 1], [0; 2], [0; 2]).0);
    let behind = one(&light, IVec3::ZERO, &[pane_of([0; 3], 9), wall]);
    assert_eq!(behind.mask, [0b01]);
    assert_eq!(light_of(&light, &behind, &weights), [65_535, 65_535, 40_000]);
    assert_eq!(light_of(&light, &one(&light, IVec3::Y * HEIGHT, &[]), &weights), [0; 3]);
}

#[test]
fn tints_are_rounded_to_the_nearest_depth() {
    assert_eq!([0.0, 1.0, 0.5, 0.25].map(depth::of_tint), [OPAQUE, 0, 2048, 4096]);
    assert_eq!(depth::of_tint(f32::from_bits(1)), OPAQUE - 1);
    assert_eq!(depth::of_tint(f32::MIN_POSITIVE), OPAQUE - 1);
    assert_eq!(depth::of_tint(2.0_f32.powi(-32)), OPAQUE - 1);
    assert_eq!(depth::of_tint(2.0_f32.powi(-31)), 31 * 2048);
    assert_eq!(depth::of_tint(1.0 - f32::EPSILON / 2.0), 0);
    let mut rng = Rng::named(0, "tints");
    for _ in 0..budget::of(300) {
        let tint = rng.unit().powi(1 + rng.below(8) as i32) as f32;
        let exact = (-2048.0 * f64::from(tint).log2()).min(65_534.0);
        let off = (f64::from(depth::of_tint(tint)) - exact).abs();
        assert!(off <= 0.5 + 1e-9, "{tint}: {exact}");
    }
    // Depths come back: between neighbours lie many floats.
    for depth in (0..OPAQUE).step_by(211) {
        assert_eq!(depth::of_tint((-f64::from(depth) / 2048.0).exp2() as f32), depth);
    }
}

#[test]
fn transmittances_are_rounded_twice() {
    assert_eq!([0, 2048, 4096, OPAQUE].map(depth::transmittance), [65_536, 32_768, 16_384, 0]);
    // 2^(16 − 1/2048) = 65513.82…; 2^(16 − 2047/2048) = 32779.09….
    assert_eq!([1, 2047].map(depth::transmittance), [65_514, 32_779]);
    // 65514 / 2 + 1/2, 32779 / 2 + 1/2 = 16390.
    assert_eq!([2049, 4095].map(depth::transmittance), [32_757, 16_390]);
    // 1, a half (which counts as 1), a little less than a half, nothing.
    assert_eq!([16 * 2048, 17 * 2048, 17 * 2048 + 1, OPAQUE - 1].map(depth::transmittance), [1, 1, 0, 0]);
    let mut last = 65_537;
    for depth in 0..OPAQUE {
        let (exact, got) = ((16.0 - f64::from(depth) / 2048.0).exp2(), depth::transmittance(depth));
        // At most ½ for the table and ½ for the shift.
        assert!((f64::from(got) - exact).abs() <= 0.5 + 0.5_f64.min(exact), "{depth}: {exact}, {got}");
        assert!(got <= last, "{depth}");
        last = got;
    }
    assert_eq!(depth::transmitted(u16::MAX, 0), 65_535);
    assert_eq!(depth::transmitted(3, 2048), 2);
    assert_eq!(depth::transmitted(1, 2048), 1);
    assert_eq!(depth::transmitted(1, 2049), 0);
}

fn triangles(mesh: &umbra4_tests::meshes::Mesh) -> Vec<[IVec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|v| mesh.vertices[v as usize])).collect()
}

#[test]
fn a_receiver_inside_a_closed_box_sees_the_light() {
    let light = lamp(4, 4);
    let walls = triangles(&cuboid(IVec3::splat(-9000), IVec3::splat(9000)));
    let open = OracleCaster::opaque(walls);
    let closed = OracleCaster { closed: true, ..open.clone() };
    for (p, inside) in [(IVec3::ZERO, true), (IVec3::splat(8999), true), (IVec3::new(0, -9001, 0), false)] {
        assert_eq!(one(&light, p, std::slice::from_ref(&open)).mask, [0b1111; 4], "{p}");
        assert_eq!(one(&light, p, std::slice::from_ref(&closed)).mask, [if inside { 0 } else { 0b1111 }; 4], "{p}");
    }
    // Between the light and the box, and beside it.
    for p in [IVec3::Y * 9001, IVec3::Y * 9000, IVec3::new(20_000, 0, 0)] {
        assert_eq!(one(&light, p, std::slice::from_ref(&closed)).mask, [0; 4], "{p}");
    }
    // Wound the other way, the roof casts and the floor does not.
    let mut inside_out = closed;
    inside_out.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    assert_eq!(one(&light, IVec3::ZERO, &[inside_out]).mask, [0b1111; 4]);
}

/// What leaves a closed mesh towards the light has entered it: outside, only what faces away from the light need cast.
#[test]
fn closed_meshes_look_the_same_from_outside() {
    let mut rng = Rng::named(0, "closed meshes");
    let (mut compared, mut inside) = (0, 0);
    for _ in 0..budget::of(60) {
        let extent = 1 << 22;
        let samples = caster_scenes::grid(&mut rng, 64);
        let light = scenes::light(&mut rng, samples, IVec3::Y * (3 * extent), extent);
        let mesh = if rng.one_in(2) {
            cuboid(IVec3::splat(-extent), IVec3::splat(extent))
        } else {
            icosphere(IVec3::ZERO, 2, |_| f64::from(extent))
        };
        let open = OracleCaster::opaque(triangles(&mesh));
        let casters = [OracleCaster { closed: true, ..open.clone() }];
        for _ in 0..30 {
            let p = rng.point(2 * extent);
            let is_outside = open.triangles.iter().any(|&[a, b, c]| {
                let n = (b - a).as_dvec3().cross((c - a).as_dvec3());
                n.dot((p - a).as_dvec3()) > 1.0e6
            });
            let (with, without) = (one(&light, p, &casters), one(&light, p, std::slice::from_ref(&open)));
            if is_outside {
                assert_eq!(with.mask, without.mask, "{p}");
                compared += with.mask.iter().map(|word| word.count_ones()).sum::<u32>();
            } else {
                inside += 1;
            }
        }
    }
    assert!(compared > 1000 && inside > 10, "{compared} bits, {inside} receivers inside");
}

#[test]
fn boundaries_are_found_by_places() {
    let mesh = cuboid(IVec3::ZERO, IVec3::ONE);
    let mut walls = triangles(&mesh);
    assert!(closed::boundary(&walls).is_empty());
    assert_eq!(closed::in_closed_components(&walls), [true; 12]);
    // Adds nothing, whichever corners are the same.
    let [a, b, c] = walls[0];
    walls.extend([[a, a, b], [b, a, a], [a, b, a], [c, c, c]]);
    assert!(closed::boundary(&walls).is_empty());
    walls.truncate(12);
    // A second box elsewhere keeps its inside when the first loses a wall.
    walls.extend(triangles(&cuboid(IVec3::splat(5), IVec3::splat(9))));
    let [a, b, c] = walls.remove(3).map(|corner| corner.to_array());
    let edges = [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
    assert_eq!(closed::boundary(&walls), edges.into());
    assert_eq!(closed::in_closed_components(&walls), [vec![false; 11], vec![true; 12]].concat());
    // A wall turned around has as many neighbours, but none that run the other way.
    let mut walls = triangles(&mesh);
    walls[5].swap(0, 1);
    assert_eq!(closed::boundary(&walls).len(), 3);
    // Twice the same, once each way.
    let [a, b, c] = walls[0];
    assert!(closed::boundary(&[[a, b, c], [a, c, b]]).is_empty());
    assert!(!closed::boundary(&[[a, b, c], [a, b, c]]).is_empty());
}

#[test]
fn a_plane_moved_towards_the_light_takes_what_it_passes() {
    let light = lamp(4, 4);
    let slab = |offset: i32| {
        let corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(|[x, z]| IVec3::new(x, 0, z) * 100_000);
        let [a, b, c, d] = corners;
        OracleCaster { offset, ..OracleCaster::opaque(vec![[a, b, c], [a, d, c]]) }
    };
    for (y, offset, blocked) in [
        (-1, 0, true),
        (0, 0, false),
        (0, 1, true),
        (1, 1, false),
        (-1, 8, true),
        (7, 8, true),
        (8, 8, false),
        (9, 8, false),
    ] {
        let expected = if blocked { [0b1111; 4] } else { [0; 4] };
        assert_eq!(one(&light, IVec3::new(5, y, 7), &[slab(offset)]).mask, expected, "{y}, {offset}");
    }
    // Beside the slab nothing changes, however far it is moved.
    assert_eq!(one(&light, IVec3::new(100_001, 7, 0), &[slab(8)]).mask, [0; 4]);
    // A wall that the light stands over, on both sides: not moved.
    let wall = [IVec3::new(STEP, 0, -9000), IVec3::new(STEP, 900, 9000), IVec3::new(STEP, 900, -9000)];
    let wall = |offset: i32| OracleCaster { offset, ..OracleCaster::opaque(vec![wall]) };
    for p in [IVec3::new(STEP, 5, -4000), IVec3::new(STEP + 1, 5, -4000), IVec3::new(STEP - 2, 5, -4000)] {
        assert_eq!(one(&light, p, &[wall(500)]), one(&light, p, &[wall(0)]), "{p}");
    }
}

/// On which side of a plane a light lies does not change with the pattern of its jitter.
#[test]
fn planes_through_the_light_are_not_moved_whatever_the_jitter() {
    let mut rng = Rng::named(0, "sides of jittered lights");
    let (mut sides, mut through, mut samples_aside) = (0, 0, 0);
    for _ in 0..budget::of(4000) {
        let regular = lamp(1 + rng.below(3) as u32, 1 + rng.below(3) as u32);
        let jittered = |number: usize| LatticeLight { jitter: Jitter::pattern(number as u32), ..regular };
        let triangle = [
            regular.origin + IVec3::new(rng.around(3 * STEP), rng.around(20), rng.around(3 * STEP)),
            IVec3::new(rng.around(9000), HEIGHT / 2, rng.around(9000)),
            IVec3::new(rng.around(9000), HEIGHT / 2, rng.around(9000)),
        ];
        let side = hit::offset_side(&jittered(0), triangle);
        assert_eq!(hit::offset_side(&jittered(1 + rng.below(1000)), triangle), side);
        // Every place, one by one.
        let mut places = vec![];
        for row in 0..32 * regular.rows as i32 {
            for column in 0..32 * regular.columns as i32 {
                places.push(regular.origin + regular.step_v / 32 * row + regular.step_u / 32 * column);
            }
        }
        let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
        let of_place = |place: &IVec3| (b - a).cross(c - a).dot(place.as_dvec3() - a).total_cmp(&0.0) as i128;
        let first = of_place(&places[0]);
        let expected = (first != 0 && places.iter().all(|place| of_place(place) == first)).then_some(first);
        assert_eq!(side, expected, "{triangle:?}");
        sides += usize::from(side.is_some());
        through += usize::from(side.is_none());
        let first = samples(&jittered(0)).iter().map(of_place).collect::<std::collections::BTreeSet<_>>();
        samples_aside += usize::from(side.is_none() && first.len() == 1);
        // Regular samples are their own places.
        let all: std::collections::BTreeSet<_> = samples(&regular).iter().map(of_place).collect();
        let expected = all.first().copied().filter(|side| all.len() == 1 && *side != 0);
        assert_eq!(hit::offset_side(&regular, triangle), expected, "{triangle:?}");
    }
    assert!(sides > 500 && through > 500 && samples_aside > 50, "{sides}, {through}, {samples_aside}");
}

/// By how much a plane is moved is counted along the axis nearest to its normal.
#[test]
fn slanted_planes_are_moved_along_an_axis() {
    let light = lamp(2, 2);
    // y = x/2, roughly: e is the y axis.
    let triangle = [IVec3::new(-8000, -4000, -8000), IVec3::new(-8000, -4000, 8000), IVec3::new(8000, 4000, 0)];
    for turned in [triangle, [triangle[1], triangle[0], triangle[2]]] {
        let caster = OracleCaster { offset: 10, ..OracleCaster::opaque(vec![turned]) };
        for (y, blocked) in [(49, true), (59, true), (60, false), (61, false)] {
            let expected = if blocked { [0b11; 2] } else { [0; 2] };
            assert_eq!(one(&light, IVec3::new(100, y, 0), std::slice::from_ref(&caster)).mask, expected, "{y}");
        }
    }
}

#[test]
fn layers_have_to_share_a_bit() {
    let light = lamp(1, 2);
    let wall = OracleCaster { layers: 0b0110, ..OracleCaster::opaque(card([-1, 1], [-1, 3], [0; 2], [0; 2]).0) };
    let pane = OracleCaster { layers: 0b1000, ..wall.clone().with_surface(glass([4; 3])) };
    for (layers, blocked, depth) in
        [(u32::MAX, 0b11, 4), (0b0001, 0, 0), (0b0010, 0b11, 0), (0b1000, 0, 4), (0b1100, 0b11, 4), (0, 0, 0)]
    {
        let receiver = OracleReceiver { point: IVec3::ZERO, layers };
        let expected = Seen { mask: vec![blocked], depths: Some(vec![[depth; 3]; 2]) };
        assert_eq!(one(&light, receiver, &[wall.clone(), pane.clone()]), expected, "{layers:b}");
    }
    // Behind the light there is no light on any layer.
    let behind = OracleReceiver { point: IVec3::Y * HEIGHT, layers: 0 };
    assert_eq!(one(&light, behind, &[]), Seen { mask: vec![0b11], depths: None });
}

fn scenes_of_all_kinds(name: &str, rounds: usize, mut check: impl FnMut(&str, &mut Rng, &CasterScene)) {
    let mut rng = Rng::named(0, name);
    for _ in 0..budget::of(rounds) {
        for (generator, build) in GENERATORS {
            let samples = caster_scenes::grid(&mut rng, 64);
            let scene = build(&mut rng, samples);
            check(generator, &mut rng, &scene);
        }
    }
}

#[test]
fn opaque_casters_give_the_masks_of_the_oracle() {
    let (mut words, mut set) = (0, 0);
    scenes_of_all_kinds("opaque casters", 4, |name, _, scene| {
        let opaque = |caster: &OracleCaster| OracleCaster::opaque(caster.triangles.clone());
        let casters: Vec<_> = scene.casters.iter().map(opaque).collect();
        let triangles: Vec<_> = casters.iter().flat_map(|caster| caster.triangles.iter().copied()).collect();
        let points: Vec<_> = scene.receivers.iter().map(|receiver| receiver.point).collect();
        let expected = oracle::oracle_masks(&scene.light, &points, &triangles);
        let all_layers: Vec<_> = points.iter().map(|&p| OracleReceiver::from(p)).collect();
        let (seen, _) = seen(&scene.light, &all_layers, &casters);
        assert_eq!(masks(&seen), expected, "{name}");
        words += expected.len();
        set += expected.iter().map(|word| word.count_ones() as usize).sum::<usize>();
    });
    assert!(words > 20_000 && set > 20_000, "{words} words, {set} bits set");
}

/// Every rule decides something in every kind of scene that is made for it, and all of them in some.
#[test]
fn scenes_are_not_vacuous() {
    let mut all = Decisions::default();
    let mut by_name = std::collections::BTreeMap::<String, Decisions>::new();
    scenes_of_all_kinds("scenes are not vacuous", 24, |name, _, scene| {
        let (_, decisions) = seen(&scene.light, &scene.receivers, &scene.casters);
        all = all.with(decisions);
        let own = by_name.entry(name.to_owned()).or_default();
        *own = own.with(decisions);
    });
    for (name, own) in &by_name {
        println!("{name}: {own:?}");
    }
    let Decisions { cut_out, kept, faced, moved, tinted, on_edge, apart } = all;
    for (what, count) in [
        ("cut out", cut_out),
        ("kept", kept),
        ("faced", faced),
        ("moved", moved),
        ("tinted", tinted),
        ("on edge", on_edge),
        ("apart", apart),
    ] {
        assert!(count > 1000, "{what}: {count}");
    }
    assert!(by_name["cards"].cut_out > 1000 && by_name["cards"].kept > 1000);
    assert!(by_name["panes"].on_edge > 1000 && by_name["panes"].tinted > 1000);
    assert!(by_name["closed_casters"].faced > 1000 && by_name["slabs"].moved > 1000);
}

/// A sample of bits by big integers: the plain rule by other determinants, the moved sample always moved, planes moved by moving
/// points, places of hits by dividing.
#[test]
fn big_integers_agree() {
    let (mut plain, mut through, mut moved) = (0, 0, 0);
    scenes_of_all_kinds("big integers and casters", 3, |name, rng, scene| {
        let all = samples(&scene.light);
        for _ in 0..6000 {
            let caster = &scene.casters[rng.below(scene.casters.len())];
            if caster.triangles.is_empty() {
                continue;
            }
            let triangle = caster.triangles[rng.below(caster.triangles.len())];
            let p = scene.receivers[rng.below(scene.receivers.len())].point;
            let sample = rng.pick(&all);
            let corners = triangle.map(bigint::point);
            let blocked = bigint::hit(&bigint::point(p), &bigint::point(sample), &corners);
            assert_eq!(hit::blocks(p, sample, triangle), blocked, "{name}: {p} {sample} {triangle:?}");
            plain += u64::from(blocked);
            let cone = Cone::new(p, triangle);
            let steps = [scene.light.step_u, scene.light.step_v];
            let seen = hit::sees_through(p, sample, triangle, steps);
            let short =
                cone.plain(sample).is_some_and(|weights| !weights.contains(&0) || cone.sees_moved(sample, steps));
            assert_eq!(seen, short, "{name}: {p} {sample} {triangle:?}");
            through += u64::from(seen);
            if let Some(side) = hit::offset_side(&scene.light, triangle) {
                // All samples lie there; and planes that are not moved are the plain rule's.
                let towards = |sample: &IVec3| hit::is_behind(triangle, *sample);
                assert!(all.iter().all(|sample| towards(sample) == (side < 0)), "{name}: {triangle:?}");
                assert_eq!(cone.with_plane_moved(sample, side, 0), cone.plain(sample), "{name}");
                let offset = rng.pick(&[1, 100, 1 << 20]);
                let got = cone.with_plane_moved(sample, side, offset).is_some();
                assert_eq!(
                    got,
                    blocked_when_moved(p, sample, triangle, side, offset),
                    "{name}: {p} {sample} {triangle:?}"
                );
                moved += u64::from(got != blocked);
            }
        }
    });
    println!("{plain} blocked, {through} seen through, {moved} by planes moved");
    assert!(plain > 1000 && through > 1000 && moved > 20, "{plain}, {through}, {moved}");
}

/// The rule of moved planes as it is written: n and e found, determinants of big integers.
fn blocked_when_moved(p: IVec3, sample: IVec3, [a, b, c]: [IVec3; 3], side: i128, offset: i32) -> bool {
    let [b, c] = if side > 0 { [b, c] } else { [c, b] };
    let [p, l, a, b, c] = [p, sample, a, b, c].map(bigint::point);
    let minus = |x: &bigint::Point, y: &bigint::Point| [0, 1, 2].map(|k| &x[k] - &y[k]);
    let (ab, ac) = (minus(&b, &a), minus(&c, &a));
    let n = [0, 1, 2].map(|k| &ab[(k + 1) % 3] * &ac[(k + 2) % 3] - &ab[(k + 2) % 3] * &ac[(k + 1) % 3]);
    let size = |k: usize| &n[k] * bigint::sign(&n[k]);
    let axis = (0..3).fold(0, |most, k| if size(k) > size(most) { k } else { most });
    let mut moved = p.clone();
    moved[axis] -= bigint::sign(&n[axis]) * offset;
    let edge = |from: &bigint::Point, to: &bigint::Point| {
        // ((from − p) × (to − from))·(L − p)
        bigint::sign(&bigint::det3(&minus(from, &p), &minus(to, from), &minus(&l, &p)))
    };
    let behind = bigint::sign(&bigint::det3(&minus(&moved, &a), &ab, &ac)) < 0;
    behind && edge(&a, &b) >= 0 && edge(&b, &c) >= 0 && edge(&c, &a) >= 0
}

/// Floats find the same texel where the hit is not next to a border.
#[test]
fn floats_find_the_same_texels() {
    let mut compared = 0;
    scenes_of_all_kinds("texels by floats", 8, |name, rng, scene| {
        let all = samples(&scene.light);
        for caster in &scene.casters {
            let OracleSurface::Cutout { texture, coordinates, .. } = &caster.surface else { continue };
            for (&triangle, corners) in caster.triangles.iter().zip(coordinates) {
                // A hit, if there is one to be found soon.
                let pairs = (0..200).map(|_| (scene.receivers[rng.below(scene.receivers.len())].point, rng.pick(&all)));
                let hit = |(p, sample)| Some((p, sample, Cone::new(p, triangle).plain(sample)?));
                let Some((p, sample, weights)) = pairs.into_iter().find_map(hit) else { continue };
                // Where the way meets the plane, and areas there.
                let [a, b, c] = triangle.map(|corner| corner.as_dvec3() - p.as_dvec3());
                let l = sample.as_dvec3() - p.as_dvec3();
                let n = (b - a).cross(c - a);
                // Neither slivers nor triangles seen from their edge, where floats find no place.
                let longest = (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared());
                if n.length() < 1e-2 * longest || n.dot(l).abs() < 1e-2 * n.length() * l.length() {
                    continue;
                }
                let at = l * (n.dot(a) / n.dot(l));
                let part = |u: DVec3, v: DVec3| (u - at).cross(v - at).dot(n) / n.dot(n);
                let parts = [part(b, c), part(c, a), part(a, b)];
                for (axis, size) in [texture.width, texture.height].into_iter().enumerate() {
                    let place = (0..3).map(|k| parts[k] * f64::from(corners[k][axis])).sum::<f64>() / 65536.0;
                    let place = place * f64::from(size);
                    let spread = corners.iter().map(|uv| f64::from(uv[axis]).abs()).fold(1.0, f64::max);
                    let wrong = 1e-5 * spread / 65536.0 * f64::from(size);
                    if (place - wrong).floor() == (place + wrong).floor() {
                        let found =
                            umbra4_tests::caster_oracle::texel::floor(&weights, corners.map(|uv| uv[axis]), size);
                        assert_eq!(found, dashu_int::IBig::from(place.floor() as i64), "{name}: {place}");
                        compared += 1;
                    }
                }
            }
        }
    });
    assert!(compared > 300, "{compared}");
}

/// What each of the comparisons of masks and lights hangs on: nothing that is changed in a scene goes unnoticed.
#[test]
fn changes_are_noticed() {
    let light = lamp(3, 5);
    let (triangles, coordinates) = card([-1, 5], [-1, 9], [0, ONE], [0, ONE]);
    let base = OracleCaster::opaque(triangles.clone());
    let cut = |texels: Vec<u8>, threshold: u8| {
        let texture = OracleTexture { width: 5, height: 3, texels, wrap: [Wrap::Repeat; 2] };
        let surface = OracleSurface::Cutout { texture, coordinates: coordinates.clone(), threshold };
        one(&light, IVec3::ZERO, &[base.clone().with_surface(surface)]).mask
    };
    // One texel a sample.
    for texel in 0..15 {
        let mut texels = vec![0; 15];
        texels[texel] = 200;
        let mut expected = [0; 3];
        expected[texel / 5] = 1 << (texel % 5);
        assert_eq!(cut(texels, 200), expected);
    }
    let tint = |texels: Vec<[u16; 3]>| {
        let texture = OracleTexture { width: 5, height: 3, texels, wrap: [Wrap::Clamp; 2] };
        let surface = OracleSurface::Tinted { texture, coordinates: Some(coordinates.clone()) };
        one(&light, IVec3::ZERO, &[base.clone().with_surface(surface)])
    };
    let weights: Vec<[u16; 3]> = (0..15).map(|k| [1 << k, 3, u16::MAX]).collect();
    for texel in 0..15 {
        let mut texels = vec![[0; 3]; 15];
        texels[texel] = [OPAQUE, 0, 1];
        let seen = tint(texels.clone());
        assert_eq!(seen.depths.as_ref(), Some(&texels));
        assert_eq!(seen.mask, [0; 3]);
        // 65535 · 65514 / 65536 = 65513.0003….
        assert_eq!(light_of(&light, &seen, &weights), [(1 << 15) - 1 - (1 << texel), 45, 14 * 65_535 + 65_513]);
    }
}

#[test]
fn jittered_samples_are_where_the_light_says() {
    let light = LatticeLight { jitter: Jitter::pattern(77), ..lamp(5, 9) };
    let all = samples(&light);
    assert_eq!(all.len(), 45);
    assert_eq!(all[9 * 3 + 4], light.sample(3, 4));
    assert_ne!(all, samples(&lamp(5, 9)));
    let regular = samples(&lamp(5, 9));
    assert!((0..45).all(|k| regular[k] == lamp(5, 9).sample(k as u32 / 9, k as u32 % 9)));
    assert!(SampleGrid::regular(5, 9).jittered(&mut Rng::new(1)).jitter.is_some());
}
