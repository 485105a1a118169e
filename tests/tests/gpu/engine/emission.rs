//! Lights of which samples emit more or less, in an engine's frame: against the CPU, on the frame's own integers.

use umbra4_core::{
    AreaLight, LatticeLight,
    emission::{Emission, WHOLE, Weight},
    gbuffer::ViewParams,
    glam::{DVec3, IVec3},
    half::halved,
    kernel::{
        NOWHERE, half,
        weigh::{PackedWeight, packed},
    },
    ratio,
};
use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
use umbra4_tests::{
    device::{buffer, read, read_layer, texture},
    rng::Rng,
    weights::weights,
};
use umbra4_wgpu::{
    Emitted, Frame, Gpu, Image, Light, LightImage, Resolution, SoftShadows, VisibilityFormat,
    wgpu::{Buffer, BufferUsages, PollType, Texture, TextureFormat, TextureUsages},
};

use super::{
    fixture::{Expected, SIZE, World, lattice, light},
    frames::{PIXELS, alive, check_lattice, image, on_device, shadowed, snapped, submit, wish},
};

const COPIED: TextureUsages = TextureUsages::COPY_DST.union(TextureUsages::COPY_SRC);

/// Room for more weights and sums than there are: what lies behind is not touched.
const MORE: usize = 5;

fn emission(rng: &mut Rng, light: &AreaLight) -> Emission<Vec<Weight>> {
    let (rows, columns) = (light.rows(), light.columns());
    Emission::new(rows, columns, weights(rng, (rows * columns) as usize)).expect("it emits something")
}

fn bytes(emission: &Emission<Vec<Weight>>) -> Vec<u8> {
    let packed: Vec<PackedWeight> = emission.weights().iter().map(|weight| packed(*weight)).collect();
    [bytemuck::cast_slice(&packed), &[0xff; 8 * MORE]].concat()
}

/// Sums for receivers on the lattice, as the CPU finds them; nothing where there is none.
fn on_cpu(on_lattice: &Expected, light: &LatticeLight, emission: &Emission<Vec<Weight>>) -> Vec<[u32; 3]> {
    let lattice = lattice();
    let world = |p: &[i32; 3]| -> DVec3 { lattice.to_world(IVec3::from_array(*p)) };
    let vertices: Vec<DVec3> = on_lattice.vertices.iter().map(world).collect();
    let occluders = Occluders::from_f64(&lattice, &vertices, &on_lattice.triangles).expect("all are on the lattice");
    let seen: Vec<DVec3> = on_lattice.receivers.iter().filter(|p| **p != NOWHERE).map(world).collect();
    let receivers = Receivers::raw_f64(&lattice, &seen).expect("all are on the lattice");
    let (sums, _) = CpuExecutor::new().light(&occluders, light, &receivers, emission).expect("it fits");
    let mut sums = sums.into_iter();
    let sum = |p: &[i32; 3]| if *p == NOWHERE { [0; 3] } else { sums.next().expect("one each") };
    on_lattice.receivers.iter().map(sum).collect()
}

/// Sums as an engine's buffer has them.
fn read_sums(gpu: &Gpu, sums: &Buffer) -> Vec<[u32; 3]> {
    let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read(gpu, sums, (12 * (PIXELS + MORE)) as u64));
    let sums: Vec<[u32; 3]> = words.chunks_exact(3).map(|own| [own[0], own[1], own[2]]).collect();
    assert!(sums[PIXELS..].iter().all(|sum| *sum == [0x5555_5555; 3]), "what lies behind the pixels is not touched");
    sums[..PIXELS].to_vec()
}

fn sums_buffer(gpu: &Gpu) -> Buffer {
    buffer(gpu, &[0x55; 12 * (PIXELS + MORE)], BufferUsages::STORAGE | BufferUsages::COPY_SRC)
}

/// The bytes of a texture of sums.
fn picture(sums: &[[u32; 3]], samples: u32, format: TextureFormat) -> Vec<u8> {
    let whole = samples * u32::from(WHOLE);
    let channels = sums.iter().flat_map(|[r, g, b]| [*r, *g, *b, whole]);
    match format {
        TextureFormat::Rgba16Float => {
            channels.flat_map(|sum| (ratio::float16(sum, whole) as u16).to_le_bytes()).collect()
        }
        _ => {
            // One rounding, and none that f64 could have made before it: digits of neither are enough to lie so near the middle.
            let part = |sum: u32| (f64::from(sum) / f64::from(whole)) as f32;
            channels.flat_map(|sum| part(sum).to_le_bytes()).collect()
        }
    }
}

fn check_mixed(sums: &[[u32; 3]]) {
    let distinct: std::collections::HashSet<_> = sums.iter().collect();
    assert!(distinct.len() > 20 && sums.contains(&[0; 3]), "{} different sums", distinct.len());
}

/// Lights of three word widths, one of them jittered: sums alone, sums beside visibility, textures of both formats. Then other weights
/// in the same buffers: nothing else is others, and nothing is made.
pub fn emissions_are_those_of_the_cpu(_: &Gpu) {
    // A device of its own: what other tests allocate at the same time is counted there.
    let gpu = &umbra4_tests::gpu::required().expect("it could be opened before");
    let world = World::new(gpu, 31, wish(60));
    let jitter = umbra4_core::Jitter::pattern(3);
    let lamps = [light(5, 16, -1.0), light(8, 23, 0.5), light(7, 64, -2.0).with_jitter(jitter), light(6, 9, 0.0)];
    let rng = &mut Rng::new(5);
    let mut emissions = lamps.each_ref().map(|lamp| emission(rng, lamp));
    let weight_buffers = emissions.each_ref().map(|emission| buffer(gpu, &bytes(emission), BufferUsages::STORAGE));
    let sums = [0, 1].map(|_| sums_buffer(gpu));
    let halves = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::Rgba16Float, COPIED);
    let floats = texture(gpu, [SIZE[0], SIZE[1], 2], TextureFormat::Rgba32Float, COPIED);
    let visible = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R32Float, COPIED);
    let images = [
        LightImage::Sums(&sums[0]),
        LightImage::Sums(&sums[1]),
        LightImage::Texture { texture: &floats, layer: 1 },
        LightImage::Texture { texture: &halves, layer: 0 },
    ];
    let lights: Vec<Light<'_>> = (0..lamps.len())
        .map(|k| Light {
            visibility: (k == 1).then_some(Image::Texture { texture: &visible, layer: 0 }),
            emission: Some(Emitted { weights: &weight_buffers[k], light: images[k] }),
            ..Light::new(lamps[k])
        })
        .collect();
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    let mut after_first = None;
    for round in 0..4 {
        if round == 2 {
            emissions = lamps.each_ref().map(|lamp| emission(rng, lamp));
            for (buffer, emission) in weight_buffers.iter().zip(&emissions) {
                gpu.queue.write_buffer(buffer, 0, &bytes(emission));
            }
        }
        submit(gpu, |encoder| {
            let meshes = world.meshes();
            shadows.record(encoder, &world.frame(&meshes, &lights)).expect("the frame is sound");
        });
        let got = on_device(gpu, &shadows);
        check_lattice(&got, &world.expected);
        let wanted: Vec<Vec<[u32; 3]>> =
            lamps.iter().zip(&emissions).map(|(lamp, emission)| on_cpu(&got, &snapped(lamp), emission)).collect();
        wanted.iter().for_each(|sums| check_mixed(sums));
        assert!(read_sums(gpu, &sums[0]) == wanted[0], "round {round}: sums alone");
        assert!(read_sums(gpu, &sums[1]) == wanted[1], "round {round}: sums beside visibility");
        let expected = image(&got, &snapped(&lamps[1]), VisibilityFormat::Float32);
        assert!(read_layer(gpu, &visible, 0) == expected, "round {round}: visibility beside sums");
        let (format, samples) = (floats.format(), snapped(&lamps[2]).sample_count());
        assert!(read_layer(gpu, &floats, 1) == picture(&wanted[2], samples, format), "round {round}: {format:?}");
        let (format, samples) = (halves.format(), snapped(&lamps[3]).sample_count());
        assert!(read_layer(gpu, &halves, 0) == picture(&wanted[3], samples, format), "round {round}: {format:?}");
        // The belt that brings parameters takes its chunks in the first frames.
        if round > 0 {
            assert_eq!(*after_first.get_or_insert(alive(gpu)), alive(gpu), "buffers, groups, pipelines, textures");
        }
    }
}

/// What a frame with a light that asks for this makes on a device of its own: buffers, bind groups, pipelines, textures.
pub fn made(world: &World, gpu: &Gpu, light: Light<'_>) -> [isize; 4] {
    // What brought the world to the device goes first.
    settle(gpu);
    let before = alive(gpu);
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    let lights = [light];
    submit(gpu, |encoder| {
        let meshes = world.meshes();
        shadows.record(encoder, &world.frame(&meshes, &lights)).expect("the frame is sound");
    });
    settle(gpu);
    let after = alive(gpu);
    [0, 1, 2, 3].map(|k| after[k] - before[k])
}

/// All that was submitted is done, and what only that needed is gone.
fn settle(gpu: &Gpu) {
    submit(gpu, |_| ());
    gpu.device.poll(PollType::wait_indefinitely()).expect("the device answers");
}

/// A light without an emission makes nothing for one, and one with an emission makes only what it is bound to.
pub fn a_light_without_emission_pays_nothing(_: &Gpu) {
    let gpu = &umbra4_tests::gpu::required().expect("it could be opened before");
    let world = World::new(gpu, 32, wish(60));
    let lamp = light(6, 9, 0.0);
    let (weights, sums) =
        (buffer(gpu, &bytes(&emission(&mut Rng::new(1), &lamp)), BufferUsages::STORAGE), sums_buffer(gpu));
    let masks = buffer(gpu, &vec![0; 4 * 3 * PIXELS], BufferUsages::COPY_SRC);
    let visible = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R32Float, COPIED);
    let emission = Some(Emitted { weights: &weights, light: LightImage::Sums(&sums) });
    let masked = Light { masks: Some(&masks), ..Light::new(lamp) };
    let shadowed = Light { masks: Some(&masks), ..shadowed(lamp, Image::Texture { texture: &visible, layer: 0 }) };
    let plain = made(&world, gpu, masked);
    assert!(plain[0] > 0 && plain[1] > 0 && plain[2] > 0, "wgpu counts: {plain:?}");
    let more = |light: Light<'_>| {
        let made = made(&world, gpu, light);
        [0, 1, 2, 3].map(|k| made[k] - plain[k])
    };
    assert_eq!(more(masked), [0; 4], "the same again");
    // Lit counts, the table and the image; `reduce` and `pack`.
    assert_eq!(more(shadowed), [3, 2, 2, 0], "visibility");
    // One kernel between the engine's buffers.
    assert_eq!(more(Light { emission, ..masked }), [0, 1, 1, 0], "an emission");
    assert_eq!(more(Light { emission, ..shadowed }), [3, 3, 3, 0], "both");
}

/// Pixels that stand for their block are exact; the others are what core makes of them.
pub fn emissions_at_half_resolution(gpu: &Gpu) {
    let world = World::new(gpu, 33, wish(80));
    let lamps = [light(8, 8, -1.0), light(6, 9, 0.0)];
    let rng = &mut Rng::new(6);
    let emissions = lamps.each_ref().map(|lamp| emission(rng, lamp));
    let weight_buffers = emissions.each_ref().map(|emission| buffer(gpu, &bytes(emission), BufferUsages::STORAGE));
    let sums = sums_buffer(gpu);
    let floats: Texture = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::Rgba32Float, COPIED);
    let images = [LightImage::Sums(&sums), LightImage::Texture { texture: &floats, layer: 0 }];
    let lights = [0, 1].map(|k| Light {
        emission: Some(Emitted { weights: &weight_buffers[k], light: images[k] }),
        ..Light::new(lamps[k])
    });
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    submit(gpu, |encoder| {
        let meshes = world.meshes();
        let frame = Frame { resolution: Resolution::Half, ..world.frame(&meshes, &lights) };
        shadows.record(encoder, &frame).expect("the frame is sound");
    });
    let blocks = on_device(gpu, &shadows);
    let pixels = &world.expected.receivers;
    let [width, height] = SIZE;
    assert_eq!(blocks.receivers.len(), (halved(width) * halved(height)) as usize);
    let params = ViewParams { count: PIXELS as u32, width, height, ..bytemuck::Zeroable::zeroed() };
    let wanted = [0, 1].map(|k| {
        let own = on_cpu(&blocks, &snapped(&lamps[k]), &emissions[k]);
        let mut upsampled = vec![[0; 3]; PIXELS];
        (0..PIXELS).for_each(|id| half::upsample(id, &params, pixels, &blocks.receivers, &own, &mut upsampled));
        upsampled
    });
    check_mixed(&wanted[0]);
    let exact = on_cpu(&world.expected, &snapped(&lamps[0]), &emissions[0]);
    let standing: Vec<bool> = pixels.iter().map(|p| *p == NOWHERE || blocks.receivers.contains(p)).collect();
    assert!(standing.iter().filter(|stands| **stands).count() > PIXELS / 5);
    let got = read_sums(gpu, &sums);
    let texels: Vec<f32> = bytemuck::pod_collect_to_vec(&read_layer(gpu, &floats, 0));
    for k in 0..PIXELS {
        for channel in 0..3 {
            let (got, want) = (f64::from(got[k][channel]), f64::from(wanted[0][k][channel]));
            // Another device may round a float otherwise.
            let tolerance = if standing[k] { 0.0 } else { 1.0 + want * 1.0e-5 };
            assert!((got - want).abs() <= tolerance, "pixel {k}: {got}, not {want}");
            if standing[k] {
                assert_eq!(wanted[0][k], exact[k], "pixel {k} stands for its block");
            }
            let whole = f64::from(lamps[1].rows() * lamps[1].columns()) * f64::from(WHOLE);
            let (got, want) = (f64::from(texels[4 * k + channel]), f64::from(wanted[1][k][channel]) / whole);
            assert!((got - want).abs() <= 1.0e-6, "texel {k}: {got}, not {want}");
        }
        assert_eq!(texels[4 * k + 3], 1.0);
    }
}
