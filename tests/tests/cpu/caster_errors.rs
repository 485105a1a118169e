//! Every error of casters is the right one and names what is wrong: the index or field, and the value.

use umbra4_core::{
    AreaLight, Bounds, Lattice, LatticeLight, Layers, Lift, PairWord,
    closed::OpenEdge,
    emission::{Emission, EmissionError},
    glam::{DVec3, Vec2, Vec3},
    layers::LayerError,
    plane_offset::MOST_OFFSET,
    texture::{Coordinate, MOST_TEXELS, TextureError, TextureSize, Wrap},
};
use umbra4_cpu::{Caster, CasterError, CpuExecutor, ExecutorError, Occluders, Receivers, SceneError};
use umbra4_tests::{budget, rng::Rng};

fn lattice() -> Lattice {
    Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("bounds are fine")
}

fn light(rows: u32, columns: u32) -> LatticeLight {
    AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, rows, columns)
        .and_then(|light| light.snap(&lattice(), Lift::NONE))
        .expect("a light with area")
}

const CORNERS: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
const SIDES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
const UVS: [Vec2; 4] = [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE];

fn mesh() -> Occluders {
    Occluders::new(&lattice(), &CORNERS, &SIDES).expect("vertices are inside")
}

fn size(width: u32, height: u32) -> TextureSize {
    TextureSize { width, height, wrap: [Wrap::Repeat, Wrap::Clamp] }
}

/// The message names all of these.
fn names(error: &dyn std::error::Error, parts: &[&str]) {
    let text = error.to_string();
    for part in parts {
        assert!(text.contains(part), "\"{text}\" does not name {part}");
    }
    assert!(!text.contains('\n'), "one line");
}

/// Cutouts and stained panes have the same textures.
fn refused(coordinates: &[Vec2], size: TextureSize, texels: usize) -> TextureError {
    let cutout = Caster::cutout(mesh(), coordinates, size, &vec![0; texels], 1).expect_err("it is refused");
    let stained = Caster::stained(mesh(), coordinates, size, &vec![[0.5; 3]; texels]).expect_err("it is refused");
    // As they print: NaN is no other NaN.
    assert_eq!(format!("{cutout:?}"), format!("{stained:?}"));
    match cutout {
        CasterError::Texture(error) => {
            assert_eq!(cutout.to_string(), error.to_string());
            error
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn textures_of_no_or_too_many_texels() {
    for (width, height, field, value) in [
        (0, 1, "width", 0),
        (3, 0, "height", 0),
        (0, 0, "width", 0),
        (MOST_TEXELS + 1, 1, "width", MOST_TEXELS + 1),
        (1, u32::MAX, "height", u32::MAX),
    ] {
        let texels = (u64::from(width) * u64::from(height)).min(100_000) as usize;
        let error = refused(&UVS, size(width, height), texels);
        assert_eq!(error, TextureError::Size { field, value });
        names(&error, &[field, &value.to_string(), "16384"]);
    }
    assert!(Caster::cutout(mesh(), &UVS, size(MOST_TEXELS, 1), &vec![7; MOST_TEXELS as usize], 8).is_ok());
    assert!(Caster::cutout(mesh(), &UVS, size(1, MOST_TEXELS), &vec![8; MOST_TEXELS as usize], 8).is_ok());
}

#[test]
fn textures_of_another_number_of_texels() {
    for (width, height, count) in [(2, 3, 5), (2, 3, 7), (1, 1, 0), (4, 4, 0), (1, 1, 2), (MOST_TEXELS, MOST_TEXELS, 1)]
    {
        let error = refused(&UVS, size(width, height), count);
        assert_eq!(error, TextureError::TexelCount { count, width, height });
        names(&error, &[&count.to_string(), &format!("{width}×{height}")]);
    }
}

#[test]
fn coordinates_that_are_missing_or_too_many() {
    for (count, texture) in [(0, size(2, 2)), (3, size(2, 2)), (5, size(2, 2)), (0, size(1, 1)), (3, size(1, 1))] {
        let error = refused(&vec![Vec2::ZERO; count], texture, (texture.width * texture.height) as usize);
        assert_eq!(error, TextureError::CoordinateCount { count, vertices: 4 });
        names(&error, &[&count.to_string(), "4 vertices"]);
    }
}

#[test]
fn coordinates_that_are_not_finite_or_too_large() {
    let beyond = 16384.0_f32.next_up();
    for texture in [size(2, 2), size(1, 1)] {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, beyond, -beyond, 1.0e30] {
            for index in 0..4 {
                for (axis, name) in ["u", "v"].into_iter().enumerate() {
                    let mut uvs = UVS;
                    uvs[index][axis] = value;
                    let error = refused(&uvs, texture, (texture.width * texture.height) as usize);
                    let TextureError::Coordinate { index: at, axis, value: named } = error else { panic!("{error:?}") };
                    assert_eq!((at, axis, named.to_bits()), (index, name, value.to_bits()));
                    names(&error, &[&index.to_string(), name, &value.to_string(), "16384"]);
                }
            }
        }
        // The largest there are.
        for far in [16384.0, -16384.0] {
            let uvs = [Vec2::splat(far); 4];
            assert!(
                Caster::cutout(mesh(), &uvs, texture, &vec![0; (texture.width * texture.height) as usize], 1).is_ok()
            );
        }
    }
}

#[test]
fn triangles_that_reach_over_too_many_texels() {
    let reaching = |u: f32, v: f32| [Vec2::ZERO, Vec2::new(u, v), Vec2::ZERO, Vec2::ZERO];
    // Triangle 0 is the first to have corner 1. 2^16 texels are too many, along either axis.
    for (uvs, texture, axis) in [
        (reaching(16384.0, 0.0), size(4, 1), "u"),
        (reaching(-16384.0, 0.0), size(4, 1), "u"),
        (reaching(1.0, 8192.0), size(1, 8), "v"),
        (reaching(16384.0, 0.0), size(5, 1), "u"),
    ] {
        let error = refused(&uvs, texture, (texture.width * texture.height) as usize);
        let texels = u64::from(texture.width.max(texture.height)) * if axis == "u" { 16384 } else { 8192 };
        assert_eq!(error, TextureError::Span { triangle: 0, axis, texels });
        names(&error, &["triangle 0", axis, &texels.to_string(), "65536"]);
    }
    let just = reaching(16384.0_f32.next_down(), -(16384.0_f32.next_down()));
    assert!(Caster::cutout(mesh(), &just, size(4, 3), &[1; 12], 1).is_ok());
}

#[test]
fn coordinates_are_rounded_halves_away_from_zero() {
    let units = |u: f32, v: f32| Coordinate::snap(0, Vec2::new(u, v)).expect("they are finite").units();
    let unit = 1.0 / 65536.0;
    assert_eq!(units(0.5 * unit, -0.5 * unit), [1, -1]);
    assert_eq!(units(0.5_f32.next_down() * unit, -(0.5_f32.next_down()) * unit), [0, 0]);
    assert_eq!(units(2.5 * unit, -3.5 * unit), [3, -4]);
    assert_eq!(units(f32::from_bits(1), -0.0), [0, 0]);
    assert_eq!(units(16384.0, -16384.0), [1 << 30, -(1 << 30)]);
    let mut rng = Rng::named(0, "coordinates");
    for _ in 0..budget::of(100_000) {
        let scale = 2.0_f64.powi(rng.below(40) as i32 - 24);
        let value = ((rng.around(1 << 20) as f64 / 2.0) * scale) as f32;
        if value.abs() <= 16384.0 {
            assert_eq!(units(value, -value), [1, -1].map(|sign| sign * (f64::from(value) * 65536.0).round() as i32));
        }
    }
}

#[test]
fn layers_that_do_not_exist() {
    for (numbers, index, layer) in [(&[32][..], 0, 32), (&[0, 31, 33], 2, 33), (&[u32::MAX, 99], 0, u32::MAX)] {
        let error = Layers::of(numbers).expect_err("it does not exist");
        assert_eq!(error, LayerError { index, layer });
        names(&error, &[&format!("[{index}]"), &layer.to_string(), "31"]);
    }
    assert_eq!(Layers::of(&[0, 5, 31, 5]).map(Layers::bits), Ok(1 | 1 << 5 | 1 << 31));
    assert_eq!(Layers::of(&[]), Ok(Layers::NONE));
    let receivers = Receivers::raw(&lattice(), &CORNERS).expect("they are inside");
    for count in [0, 3, 5] {
        let error = receivers.clone().on_layers(&vec![Layers::ALL; count]).expect_err("another number");
        assert_eq!(error, SceneError::LayerCount { count, receivers: 4 });
        names(&error, &[&count.to_string(), "4 receivers"]);
    }
}

#[test]
fn tints_that_are_no_fractions() {
    let beyond = 1.0_f32.next_up();
    for value in [f32::NAN, -0.1, -f32::MIN_POSITIVE, beyond, f32::INFINITY, f32::NEG_INFINITY] {
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let mut tint = [0.5; 3];
            tint[channel] = value;
            let named = |error: CasterError, at: usize| {
                let CasterError::Texture(TextureError::Tint { index, channel, value: named }) = error else {
                    panic!("{error:?}")
                };
                assert_eq!((index, channel, named.to_bits()), (at, name, value.to_bits()));
                names(&error, &[name, &value.to_string(), "0..=1"]);
            };
            named(Caster::tinted(mesh(), tint).expect_err("it is no fraction"), 0);
            for at in 0..3 {
                let mut tints = [[1.0; 3]; 3];
                tints[at] = tint;
                named(Caster::stained(mesh(), &UVS, size(3, 1), &tints).expect_err("it is no fraction"), at);
            }
        }
    }
}

#[test]
fn open_meshes_that_are_said_to_be_closed() {
    for (missing, lost) in SIDES.iter().enumerate() {
        let mut sides = SIDES.to_vec();
        sides.remove(missing);
        let open = Occluders::new(&lattice(), &CORNERS, &sides).expect("vertices are inside");
        let error = Caster::opaque(open).closed().expect_err("it is open");
        // The first triangle has one side in common with the one that is missing: its ends, in its order.
        let [a, b, c] = sides[0];
        let edge = [[a, b], [b, c], [c, a]].into_iter().find(|edge| edge.iter().all(|v| lost.contains(v)));
        let vertices = edge.expect("two sides of a tetrahedron share an edge");
        assert_eq!(error, CasterError::Open(OpenEdge { triangle: 0, vertices }));
        names(&error, &["triangle 0", &format!("from vertex {} to {}", vertices[0], vertices[1])]);
    }
    assert!(Caster::opaque(mesh()).closed().is_ok());
    // A mesh without triangles has no edges.
    let nothing = Occluders::new(&lattice(), &[], &[]).expect("nothing is legal");
    assert!(Caster::opaque(nothing).closed().is_ok());
}

#[test]
fn panes_have_no_inside_and_stay_where_they_are() {
    let panes = [
        Caster::tinted(mesh(), [0.5; 3]),
        Caster::tinted(mesh(), [0.0; 3]),
        Caster::stained(mesh(), &UVS, size(2, 1), &[[1.0; 3], [0.25; 3]]),
        // That nothing is to be seen of them makes no difference: a tint may change from frame to frame.
        Caster::tinted(mesh(), [1.0; 3]),
        Caster::stained(mesh(), &UVS, size(1, 2), &[[1.0; 3]; 2]),
    ];
    for pane in panes {
        let pane = pane.expect("tints are fractions");
        let error = pane.clone().closed().expect_err("it is a pane");
        assert_eq!(error, CasterError::Tinted { field: "closed side" });
        names(&error, &["closed side"]);
        let error = pane.clone().with_plane_offset(1).expect_err("it is a pane");
        assert_eq!(error, CasterError::Tinted { field: "plane offset" });
        names(&error, &["plane offset"]);
        assert_eq!(pane.clone().with_plane_offset(0), Ok(pane));
    }
}

#[test]
fn offsets_that_are_too_large() {
    for value in [MOST_OFFSET + 1, u32::MAX] {
        let error = Caster::opaque(mesh()).with_plane_offset(value).expect_err("it is too large");
        assert_eq!(error, CasterError::Offset { value });
        names(&error, &[&value.to_string(), &MOST_OFFSET.to_string()]);
    }
    assert!(Caster::opaque(mesh()).with_plane_offset(MOST_OFFSET).is_ok());
}

#[test]
fn arranged_meshes_have_lost_their_texture_coordinates() {
    let cutout = Caster::cutout(mesh().arranged(), &UVS, size(2, 1), &[0, 1], 1);
    assert_eq!(cutout, Err(CasterError::Arranged));
    let stained = Caster::stained(mesh().arranged(), &UVS, size(2, 1), &[[0.5; 3]; 2]);
    names(&stained.expect_err("it is arranged"), &["arranged"]);
}

#[test]
fn vertices_that_casters_do_not_move_to() {
    let mut caster = Caster::opaque(mesh()).closed().expect("it is closed");
    let before = caster.clone();
    let error = caster.move_vertices(&lattice(), &CORNERS[..3]).expect_err("one is missing");
    assert_eq!(error, CasterError::Scene(SceneError::VertexCount { count: 3, vertices: 4 }));
    let mut corners = CORNERS;
    corners[2].y = f32::NAN;
    let error = caster.move_vertices(&lattice(), &corners).expect_err("not a number");
    assert!(matches!(error, CasterError::Scene(SceneError::Vertex { index: 2, .. })), "{error:?}");
    names(&error, &["vertex 2", "NaN"]);
    assert_eq!(caster, before, "nothing has moved");
    // Closed by its indices: wherever its vertices are.
    assert!(caster.move_vertices(&lattice(), &[Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE]).is_ok());

    // Closed by places alone: corners of its own for every triangle.
    let apart: Vec<Vec3> = SIDES.iter().flatten().map(|corner| CORNERS[*corner as usize]).collect();
    let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
    let soup = Occluders::new(&lattice(), &apart, &triangles).expect("vertices are inside");
    let mut caster = Caster::opaque(soup).closed().expect("it is closed, by places");
    let before = caster.clone();
    let together: Vec<Vec3> = apart.iter().map(|p| *p * 0.5 + Vec3::Y).collect();
    assert!(caster.move_vertices(&lattice(), &together).is_ok());
    assert!(caster.move_vertices(&lattice(), &apart).is_ok());
    let mut torn = apart;
    torn[4].x += 0.5;
    let error = caster.move_vertices(&lattice(), &torn).expect_err("it comes apart");
    assert!(matches!(error, CasterError::Open(OpenEdge { triangle: 0 | 1, .. })), "{error:?}");
    assert_eq!(caster, before, "nothing has moved");
}

#[test]
fn casters_that_are_not_there_and_words_that_are_too_narrow() {
    let executor = CpuExecutor::new();
    let caster = Caster::opaque(mesh());
    for casters in 0..3 {
        let mut index = executor.index_casters(&vec![caster.clone(); casters], &light(4, 4));
        for place in [casters, casters + 7, usize::MAX] {
            let error = executor.index_caster(&mut index, place, &caster).expect_err("there is none");
            assert_eq!(error, ExecutorError::NoCaster { place, casters });
            names(&error, &[&place.to_string(), &casters.to_string()]);
        }
    }
    let receivers = Receivers::raw(&lattice(), &CORNERS).expect("they are inside");
    let index = executor.index_casters(std::slice::from_ref(&caster), &light(2, 33));
    let narrow = |columns, bits| Some(ExecutorError::WordTooNarrow { columns, bits });
    assert_eq!(executor.caster_masks::<u16>(&index, &receivers).err(), narrow(33, 16));
    assert_eq!(executor.caster_masks::<u32>(&index, &receivers).err(), narrow(33, 32));
    assert!(executor.caster_masks::<u64>(&index, &receivers).is_ok());
    assert!(executor.caster_masks::<PairWord>(&index, &receivers).is_ok());
    let index = executor.index_casters(&[caster], &light(2, 17));
    assert_eq!(executor.caster_masks::<u16>(&index, &receivers).err(), narrow(17, 16));
    assert!(executor.caster_masks::<u32>(&index, &receivers).is_ok());
}

#[test]
fn emissions_of_another_light() {
    let executor = CpuExecutor::new();
    let index = executor.index_casters(&[Caster::opaque(mesh())], &light(4, 5));
    let receivers = Receivers::raw(&lattice(), &CORNERS).expect("they are inside");
    for (rows, columns) in [(5, 4), (4, 4), (1, 20)] {
        let emission = Emission::new(rows, columns, vec![[1; 3]; (rows * columns) as usize]).expect("it is not dark");
        let error = executor.caster_light(&index, &receivers, &emission).expect_err("another light");
        names(&error, &[&rows.to_string(), &columns.to_string()]);
    }
    assert_eq!(Emission::new(4, 5, vec![[0; 3]; 20]), Err(EmissionError::Dark));
}
