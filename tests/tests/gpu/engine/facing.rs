//! Pixels that face away from a light, in an engine's frame: dark, and no triangle is looked at for them.

use umbra4_core::{
    DirectionalLight, Facing, Lift, PointLight,
    gbuffer::{NormalEncoding, ViewParams, decode_normal},
    glam::{DVec3, IVec3, Vec3},
    kernel::{NOWHERE, face_pixels},
};
use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
use umbra4_tests::{
    compare::lit_counts,
    device::{buffer, read, read_layer, texture},
};
use umbra4_wgpu::{
    Frame, GBuffer, Gpu, Image, Lamp, Light, Resolution, SoftShadows, Surface,
    wgpu::{Buffer, BufferUsages, Texture, TextureFormat, TextureUsages},
};

use super::{
    emission::made,
    fixture::{Expected, SIZE, Wish, World, lattice, light},
    frames::{PIXELS, check_lattice, on_device, shadowed, snapped, submit, wish},
    pixels::{draw, drawing, multisampled},
};

const COPIED: TextureUsages = TextureUsages::COPY_DST.union(TextureUsages::COPY_SRC);

/// Facings of the receivers of the frame that was recorded last.
fn facings(gpu: &Gpu, shadows: &SoftShadows) -> Vec<Facing> {
    let snapped = shadows.snapped().expect("a frame was recorded");
    let words = snapped.facings.as_ref().expect("a light asked for them");
    let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read(gpu, words, 4 * u64::from(snapped.receiver_count)));
    words.into_iter().map(Facing::from_word).collect()
}

/// Receivers and triangles of a frame, as the CPU takes them; those that face some way, if they do.
fn on_cpu(got: &Expected, normals: Option<&[Vec3]>) -> (Occluders, Receivers) {
    let lattice = lattice();
    let world = |p: &[i32; 3]| -> DVec3 { lattice.to_world(IVec3::from_array(*p)) };
    let vertices: Vec<DVec3> = got.vertices.iter().map(world).collect();
    let occluders = Occluders::from_f64(&lattice, &vertices, &got.triangles).expect("all are on the lattice");
    let there = |k: &usize| got.receivers[*k] != NOWHERE;
    let seen: Vec<usize> = (0..got.receivers.len()).filter(there).collect();
    let points: Vec<DVec3> = seen.iter().map(|k| world(&got.receivers[*k])).collect();
    let receivers = Receivers::raw_f64(&lattice, &points).expect("all are on the lattice");
    let Some(normals) = normals else { return (occluders, receivers) };
    let normals: Vec<Vec3> = seen.iter().map(|k| normals[*k]).collect();
    (occluders, receivers.facing(&normals).expect("a normal each"))
}

/// Lit samples of all pixels, as the CPU finds them; none where nothing is seen.
fn lit_on_cpu(got: &Expected, lamp: &Lamp, normals: Option<&[Vec3]>) -> Vec<u32> {
    let (occluders, receivers) = on_cpu(got, normals);
    let cpu = CpuExecutor::new();
    let hard = |light| {
        let (words, _) = cpu.hard_shadows(&occluders, &light, &receivers).expect("it fits");
        (0..receivers.len()).map(|r| 1 - (words.words()[r / 32] >> (r % 32) & 1)).collect()
    };
    let lit: Vec<u32> = match lamp {
        Lamp::Area { light, .. } => {
            let light = snapped(light);
            let (masks, _) = cpu.masks::<u64>(&occluders, &light, &receivers).expect("it fits");
            lit_counts(masks.words(), light.rows, light.columns)
        }
        Lamp::Point(light) => hard(light.snap(&lattice()).expect("inside")),
        Lamp::Directional(light) => hard(light.snap().expect("a direction")),
    };
    let mut lit = lit.into_iter();
    got.receivers.iter().map(|p| if *p == NOWHERE { 0 } else { lit.next().expect("one each") }).collect()
}

fn lamps() -> [Lamp; 5] {
    [
        light(5, 9, 0.0).into(),
        light(8, 23, 0.5).into(),
        light(7, 64, -2.0).into(),
        PointLight { position: DVec3::new(0.3, 1.5, -0.2) }.into(),
        DirectionalLight { towards: DVec3::new(1.0, 0.9, -0.1) }.into(),
    ]
}

fn samples(lamp: &Lamp) -> u32 {
    if let Lamp::Area { light, .. } = lamp { light.rows() * light.columns() } else { 1 }
}

/// The first light asks for no facings, the second does: they are made when the frame comes to the lattice, once for all.
pub fn pixels_that_face_away_are_dark(gpu: &Gpu) {
    for encoding in [NormalEncoding::Signed, NormalEncoding::Octahedral] {
        let world = World::new(gpu, 41, Wish { encoding, ..wish(60) });
        let target = texture(gpu, [SIZE[0], SIZE[1], 5], TextureFormat::R32Float, COPIED);
        let lights: Vec<Light<'_>> = (0..)
            .zip(lamps())
            .map(|(layer, lamp)| Light {
                only_facing: layer != 0,
                visibility: Some(Image::Texture { texture: &target, layer }),
                ..Light::new(lamp)
            })
            .collect();
        let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
        for _ in 0..2 {
            submit(gpu, |encoder| {
                let meshes = world.meshes();
                shadows.record(encoder, &world.frame(&meshes, &lights)).expect("the frame is sound");
            });
            let got = on_device(gpu, &shadows);
            check_lattice(&got, &world.expected);
            let facings = facings(gpu, &shadows);
            if encoding == NormalEncoding::Signed {
                let own: Vec<Facing> = world.pixel_normals.iter().map(|normal| Facing::of(*normal)).collect();
                assert!(facings == own, "facings");
            }
            let away = |p: &[i32; 3], facing: &Facing| {
                *p != NOWHERE && facing.is_away_from(&snapped(&light(8, 23, 0.5)), IVec3::from_array(*p))
            };
            let away = got.receivers.iter().zip(&facings).filter(|(p, facing)| away(p, facing)).count();
            assert!(away > PIXELS / 8 && away < PIXELS * 7 / 8, "{away} of {PIXELS} pixels face away");
            for (layer, lamp) in lamps().iter().enumerate() {
                let normals = (layer != 0).then_some(&world.pixel_normals[..]);
                check_layer(gpu, &target, layer, &lit_on_cpu(&got, lamp, normals), samples(lamp));
            }
        }
    }
}

fn check_layer(gpu: &Gpu, target: &Texture, layer: usize, lit: &[u32], samples: u32) {
    let expected: Vec<u8> = lit.iter().flat_map(|lit| (*lit as f32 / samples as f32).to_le_bytes()).collect();
    assert!(lit.contains(&0) && lit.iter().any(|lit| *lit > 0));
    assert!(read_layer(gpu, target, layer as u32) == expected, "visibility of light {layer}");
}

const FACES: &str = "
struct Out {
    @location(0) position: vec4f,
    @location(1) normal: vec4f,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn faces(@builtin(position) place: vec4f, @builtin(sample_index) sample: u32) -> Out {
    let pixel = vec2u(place.xy);
    let turn = (pixel.x * 5u + pixel.y * 3u + sample * 7u) % 8u;
    let normal = vec3f(f32(turn & 1u) - 0.25, f32(turn >> 1u & 1u) - 0.5, f32(turn >> 2u) - 0.75);
    let height = f32(sample) * 0.25 + 0.25;
    return Out(vec4f(f32(pixel.x) / 4.0 - 4.0, height, f32(pixel.y) / 2.0 - 2.5, 1.0), vec4f(normal, 0.0), height);
}
";

/// Every sample of a pixel faces another way; the one that is named counts.
pub fn samples_that_face_away_are_dark(gpu: &Gpu) {
    let world = World::new(gpu, 45, wish(12));
    let formats = [TextureFormat::Rgba16Float; 2];
    let [positions, normals] = formats.map(|format| multisampled(gpu, format));
    let pipeline = drawing(gpu, FACES, ["everywhere", "faces"], &formats, 4, false);
    let depths = multisampled(gpu, TextureFormat::Depth32Float);
    draw(gpu, &pipeline, None, &[&positions, &normals], &depths, 3);
    let target = texture(gpu, [SIZE[0], SIZE[1], 3], TextureFormat::R32Float, COPIED);
    let lights: Vec<Light<'_>> = (0..)
        .zip(lamps().into_iter().take(3))
        .map(|(layer, lamp)| Light {
            only_facing: true,
            visibility: Some(Image::Texture { texture: &target, layer }),
            ..Light::new(lamp)
        })
        .collect();
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    let (mut seen, mut darkened) = (Vec::new(), 0);
    for sample in 0..4 {
        submit(gpu, |encoder| {
            let meshes = world.meshes();
            let lift = Lift::f32_positions_off_by(1).expect("1 to 8 units");
            let surface = Surface::Positions { view: &positions, lift };
            let gbuffer = GBuffer { surface, normals: &normals, sample, ..world.gbuffer() };
            let frame = Frame { gbuffer, ..world.frame(&meshes, &lights) };
            shadows.record(encoder, &frame).expect("the frame is sound");
        });
        let normal = |k: u32| {
            let turn = (k % SIZE[0] * 5 + k / SIZE[0] * 3 + sample * 7) % 8;
            Vec3::new((turn & 1) as f32 - 0.25, (turn >> 1 & 1) as f32 - 0.5, (turn >> 2) as f32 - 0.75)
        };
        let normals: Vec<Vec3> = (0..PIXELS as u32).map(normal).collect();
        let own: Vec<Facing> = normals.iter().map(|normal| Facing::of(*normal)).collect();
        assert!(facings(gpu, &shadows) == own, "facings of sample {sample}");
        assert!(!seen.contains(&own), "samples differ");
        seen.push(own);
        let got = on_device(gpu, &shadows);
        assert!(got.receivers.iter().all(|p| *p != NOWHERE));
        for (layer, lamp) in lamps().iter().take(3).enumerate() {
            let lit = lit_on_cpu(&got, lamp, Some(&normals));
            darkened += usize::from(lit != lit_on_cpu(&got, lamp, None));
            check_layer(gpu, &target, layer, &lit, samples(lamp));
        }
    }
    assert!(darkened > 6, "pixels of {darkened} samples face away from a light that would reach them");
}

/// A block faces where the pixel does that stands for it.
pub fn blocks_face_where_their_pixel_does(gpu: &Gpu) {
    let world = World::new(gpu, 42, wish(60));
    let masks: Buffer = buffer(gpu, &vec![0; 4 * 3 * PIXELS], BufferUsages::COPY_SRC);
    let lamp = light(6, 16, 0.0);
    let lights = [Light { only_facing: true, masks: Some(&masks), ..Light::new(lamp) }];
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    submit(gpu, |encoder| {
        let meshes = world.meshes();
        let frame = Frame { resolution: Resolution::Half, ..world.frame(&meshes, &lights) };
        shadows.record(encoder, &frame).expect("the frame is sound");
    });
    let got = on_device(gpu, &shadows);
    let of_pixels: Vec<u32> = world.pixel_normals.iter().map(|normal| Facing::of(*normal).word()).collect();
    let [width, height] = SIZE;
    let params = ViewParams { count: got.receivers.len() as u32, width, height, ..bytemuck::Zeroable::zeroed() };
    let mut thinned = vec![0; got.receivers.len()];
    (0..thinned.len())
        .for_each(|id| face_pixels::thin_facings(id, &params, &world.expected.receivers, &of_pixels, &mut thinned));
    let facings: Vec<u32> = facings(gpu, &shadows).into_iter().map(Facing::word).collect();
    assert!(facings == thinned, "facings of the blocks");
    // Every receiver of a block is one of its pixels', and so is its facing.
    for (p, facing) in got.receivers.iter().zip(&thinned).filter(|(p, _)| **p != NOWHERE) {
        let mut pixels = world.expected.receivers.iter().zip(&of_pixels);
        assert!(pixels.any(|own| own == (p, facing)));
    }
    let normals: Vec<Vec3> = got
        .receivers
        .iter()
        .map(|p| match world.expected.receivers.iter().position(|own| own == p) {
            Some(pixel) => world.pixel_normals[pixel],
            None => Vec3::Y,
        })
        .collect();
    let (occluders, receivers) = on_cpu(&got, Some(&normals));
    let (wanted, _) = CpuExecutor::new().masks::<u16>(&occluders, &snapped(&lamp), &receivers).expect("it fits");
    let mut wanted = wanted.words().chunks_exact(6);
    let words: Vec<u16> = bytemuck::pod_collect_to_vec(&read(gpu, &masks, 12 * got.receivers.len() as u64));
    for (p, mask) in got.receivers.iter().zip(words.chunks_exact(6)) {
        let expected = if *p == NOWHERE { &[u16::MAX; 6][..] } else { wanted.next().expect("a mask each") };
        assert_eq!(mask, expected, "{p:?}");
    }
}

/// A light that shines through surfaces makes nothing more, and another only what it takes.
pub fn only_those_who_ask_pay_for_facings(_: &Gpu) {
    let gpu = &umbra4_tests::gpu::required().expect("it could be opened before");
    let world = World::new(gpu, 43, wish(60));
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R32Float, COPIED);
    let plain = shadowed(light(6, 9, 0.0), Image::Texture { texture: &target, layer: 0 });
    let before = made(&world, gpu, plain);
    let facing = made(&world, gpu, Light { only_facing: true, ..plain });
    let more = [0, 1, 2, 3].map(|k| facing[k] - before[k]);
    // A word a pixel; `face_pixels` and `settle_receivers`.
    assert_eq!(more, [1, 2, 2, 0], "buffers, bind groups, pipelines, textures");
}

/// What a normal is stored as is what the facing is made of.
pub fn encodings_of_facings(gpu: &Gpu) {
    let world = World::new(gpu, 44, Wish { encoding: NormalEncoding::Biased, ..wish(12) });
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R32Float, COPIED);
    let asked = shadowed(light(6, 9, 0.0), Image::Texture { texture: &target, layer: 0 });
    let lights = [Light { only_facing: true, ..asked }];
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    submit(gpu, |encoder| {
        let meshes = world.meshes();
        shadows.record(encoder, &world.frame(&meshes, &lights)).expect("the frame is sound");
    });
    for (facing, normal) in facings(gpu, &shadows).iter().zip(&world.pixel_normals) {
        let stored = [normal.x, normal.y, normal.z].map(|c| (c * 0.5 + 0.5) * 255.0).map(f32::round);
        let texel = [stored[0] / 255.0, stored[1] / 255.0, stored[2] / 255.0, 0.0];
        let own = Facing::of(decode_normal(NormalEncoding::Biased as u32, texel));
        // A device may turn a byte into a float that is off by a little.
        let component = |facing: Facing, k: u32| (facing.word() << (22 - 10 * k)) as i32 >> 22;
        assert!((0..3).all(|k| (component(*facing, k) - component(own, k)).abs() <= 1), "{facing:?}, not {own:?}");
    }
}
