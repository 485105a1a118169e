//! Frames, against the oracle.

use umbra4_core::{
    AreaLight, Jitter, LatticeLight, Lift,
    gbuffer::{NormalEncoding, Pixel, ViewParams, from_depth},
    glam::{
        DVec3, IVec3,
        dcamera::rh::{proj, view},
    },
    kernel::{NOWHERE, status::Status},
    ratio,
    surface::Upwards,
};
use umbra4_tests::{
    compare::{Amount, compare_masks, lit_counts},
    device::{buffer, filled, read, read_layer, texture},
    oracle::oracle_masks,
};
use umbra4_wgpu::{
    Frame, GBuffer, Gpu, History, Image, Light, Loading, Precision, Resolution, SoftShadows, Surface, VisibilityFormat,
    wgpu::{self, BufferUsages, CommandEncoderDescriptor, TextureFormat, TextureUsages},
};

use super::fixture::{Expected, SIZE, Wish, World, bounds, lattice, light};

pub const PIXELS: usize = (SIZE[0] * SIZE[1]) as usize;
const FORMATS: [(TextureFormat, VisibilityFormat); 3] = [
    (TextureFormat::R8Unorm, VisibilityFormat::Unorm8),
    (TextureFormat::R16Float, VisibilityFormat::Float16),
    (TextureFormat::R32Float, VisibilityFormat::Float32),
];

pub fn submit(gpu: &Gpu, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
    let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
    record(&mut encoder);
    gpu.queue.submit([encoder.finish()]);
}

/// The masks that the oracle finds; nothing is lit where there is no receiver.
pub fn masks(expected: &Expected, light: &LatticeLight) -> Vec<u64> {
    let there = |p: &[i32; 3]| *p != NOWHERE;
    let points: Vec<IVec3> = expected.receivers.iter().filter(|p| there(p)).map(|p| IVec3::from_array(*p)).collect();
    let found = oracle_masks(light, &points, &expected.corners());
    let mut found = found.chunks_exact(light.rows as usize);
    let none = vec![u64::MAX >> (64 - light.columns); light.rows as usize];
    let mask = |p| if there(p) { found.next().expect("a mask each").to_vec() } else { none.clone() };
    expected.receivers.iter().flat_map(mask).collect()
}

/// The bytes of an image of visibility, rows without padding.
pub fn image(expected: &Expected, light: &LatticeLight, format: VisibilityFormat) -> Vec<u8> {
    let samples = light.sample_count();
    let bytes = 4 / format.pixels_a_word() as usize;
    let lit = lit_counts(&masks(expected, light), light.rows, light.columns);
    lit.iter().flat_map(|&lit| format.bits(lit, samples).to_le_bytes()[..bytes].to_vec()).collect()
}

pub fn snapped(light: &AreaLight) -> LatticeLight {
    light.snap(&lattice(), Lift::NONE).expect("the lattice is fine enough")
}

/// What the device has on the lattice.
pub fn on_device(gpu: &Gpu, shadows: &SoftShadows) -> Expected {
    let snapped = shadows.snapped().expect("a frame was recorded");
    let read = |buffer, count: u32| read(gpu, buffer, 12 * u64::from(count));
    Expected {
        vertices: bytemuck::pod_collect_to_vec(&read(&snapped.vertices, snapped.vertex_count)),
        triangles: bytemuck::pod_collect_to_vec(&read(&snapped.triangles, snapped.triangle_count)),
        receivers: bytemuck::pod_collect_to_vec(&read(&snapped.receivers, snapped.receiver_count)),
        status: status(gpu, shadows),
    }
}

pub fn status(gpu: &Gpu, shadows: &SoftShadows) -> Status {
    bytemuck::pod_read_unaligned(&read(gpu, shadows.status(), size_of::<Status>() as u64))
}

pub fn check_lattice(got: &Expected, expected: &Expected) {
    assert_eq!(got.vertices, expected.vertices, "vertices");
    assert_eq!(got.triangles, expected.triangles, "triangles");
    assert_eq!(got.receivers, expected.receivers, "receivers");
    assert_eq!(got.status, expected.status, "status");
}

/// Records a frame with one light and one image, and compares all there is.
fn check_frame(gpu: &Gpu, shadows: &mut SoftShadows, world: &World, light: AreaLight) {
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R32Float, usage);
    let lights = [shadowed(light, Image::Texture { texture: &target, layer: 0 })];
    submit(gpu, |encoder| {
        let meshes = world.meshes();
        let frame = world.frame(&meshes, &lights);
        shadows.record(encoder, &frame).expect("the frame is sound");
    });
    check_lattice(&on_device(gpu, shadows), &world.expected);
    let expected = image(&world.expected, &snapped(&light), VisibilityFormat::Float32);
    assert!(read_layer(gpu, &target, 0) == expected, "visibility differs");
}

pub fn shadowed(light: AreaLight, image: Image<'_>) -> Light<'_> {
    Light { visibility: Some(image), ..Light::new(light) }
}

pub fn wish(triangles: u32) -> Wish {
    Wish { triangles, bad: 0, encoding: NormalEncoding::Signed }
}

/// The same adapter with a device as an engine may have it: wgpu's default limits, and no feature.
fn plain(gpu: &Gpu) -> Gpu {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let adapter = adapters.iter().find(|adapter| gpu.name.starts_with(&adapter.get_info().name));
    let asked = adapter.expect("it is there").request_device(&wgpu::DeviceDescriptor::default());
    let (device, queue) = pollster::block_on(asked).expect("it has the default limits");
    assert_eq!(device.features(), wgpu::Features::empty());
    Gpu { device, queue, ..gpu.clone() }
}

pub fn default_limits_and_no_features_suffice(gpu: &Gpu) {
    let gpu = plain(gpu);
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    shadows.time_stages().expect("without timestamps, nothing is timed");
    check_frame(&gpu, &mut shadows, &World::new(&gpu, 13, wish(40)), light(5, 40, 0.0));
    assert!(shadows.stage_times(&gpu.queue).expect("nothing fails").is_empty());
    let refused =
        SoftShadows::with(&gpu.device, Precision::Exact, Loading::Passthrough).expect_err("no feature, no way");
    assert!(refused.to_string().contains("loading is Passthrough"), "{refused}");
}

/// Timestamps change no bit, and tell of every stage that ran.
pub fn stages_are_timed(gpu: &Gpu) {
    if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        assert!(!gpu.software, "lavapipe has timestamps");
        println!("no timestamps on {}", gpu.name);
        return;
    }
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    shadows.time_stages().expect("there is memory for timestamps");
    check_frame(gpu, &mut shadows, &World::new(gpu, 14, wish(40)), light(5, 9, 0.0));
    let times = shadows.stage_times(&gpu.queue).expect("the device answers");
    let stages: Vec<&str> = times.iter().map(|(stage, _)| *stage).collect();
    let expected = [
        "snap_vertices",
        "snap_receivers",
        "key_triangles",
        "order_triangles",
        "build_level",
        "key_receivers",
        "order_receivers",
        "resolve",
        "reduce",
    ];
    assert_eq!(stages, expected);
    assert!(times.iter().all(|(_, seconds)| (0.0..60.0).contains(seconds)), "{times:?}");
}

/// Three lights of three word widths into three layers of every format, an image in a buffer, and all masks.
pub fn a_frame_is_exact(gpu: &Gpu) {
    let world = World::new(gpu, 1, wish(80));
    let lights = [light(5, 16, -1.0), light(8, 23, 0.5), light(7, 64, -2.0)];
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    for (texture_format, format) in FORMATS {
        let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
        let target = texture(gpu, [SIZE[0], SIZE[1], 3], texture_format, usage);
        let row = format.words(SIZE[0]) as usize * 4;
        let plain = buffer(gpu, &vec![0xaa; row * SIZE[1] as usize], BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let words = [5_usize.div_ceil(2), 8, 2 * 7];
        let mask_buffers = words.map(|words| buffer(gpu, &vec![0; 4 * words * PIXELS], BufferUsages::COPY_SRC));
        let mut asked: Vec<Light<'_>> = (0..)
            .zip(&lights)
            .map(|(layer, light)| Light {
                masks: Some(&mask_buffers[layer as usize]),
                ..shadowed(*light, Image::Texture { texture: &target, layer })
            })
            .collect();
        asked.push(shadowed(lights[0], Image::Buffer { buffer: &plain, format }));
        submit(gpu, |encoder| {
            let meshes = world.meshes();
            let frame = world.frame(&meshes, &asked);
            shadows.record(encoder, &frame).expect("the frame is sound");
        });
        check_lattice(&on_device(gpu, &shadows), &world.expected);
        for (layer, light) in lights.iter().enumerate() {
            let light = snapped(light);
            let expected = image(&world.expected, &light, format);
            assert!(read_layer(gpu, &target, layer as u32) == expected, "{format:?}: visibility of light {layer}");
            let bytes = read(gpu, &mask_buffers[layer], 4 * (words[layer] * PIXELS) as u64);
            check_masks(&bytes, &masks(&world.expected, &light), &light, words[layer]);
        }
        let got = read(gpu, &plain, (row * SIZE[1] as usize) as u64);
        let pixels = SIZE[0] as usize * 4 / format.pixels_a_word() as usize;
        let got: Vec<u8> = got.chunks_exact(row).flat_map(|line| line[..pixels].to_vec()).collect();
        assert!(got == image(&world.expected, &snapped(&lights[0]), format), "{format:?}: the image in a buffer");
    }
}

/// Masks from words of 32 bits, each mask from a word of its own.
fn check_masks(bytes: &[u8], expected: &[u64], light: &LatticeLight, words: usize) {
    let row = match light.columns {
        ..=16 => 2,
        17..=32 => 4,
        _ => 8,
    };
    let rows = light.rows as usize;
    let got: Vec<u64> = bytes
        .chunks_exact(4 * words)
        .flat_map(|mask| mask.chunks(row).take(rows))
        .map(|row| {
            let mut word = [0; 8];
            word[..row.len()].copy_from_slice(row);
            u64::from_le_bytes(word)
        })
        .collect();
    let compared = compare_masks(expected, &got, light.rows, light.columns, Amount::Some).expect("the oracle's bits");
    assert!(compared.blocked > 0 && compared.blocked < compared.bits, "the scene has light and shadow");
}

pub fn what_cannot_be_used_is_counted(gpu: &Gpu) {
    let world = World::new(gpu, 2, Wish { bad: 8, ..wish(96) });
    let Status { vertices, triangles, receivers, .. } = world.expected.status;
    assert!(vertices > 0 && triangles > 0 && receivers > 0, "the world has something of everything");
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    // Twice: the counts are of one frame.
    check_frame(gpu, &mut shadows, &world, light(16, 16, -1.0));
    check_frame(gpu, &mut shadows, &world, light(16, 16, -1.0));
}

pub fn every_encoding_of_normals(gpu: &Gpu) {
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    for encoding in [NormalEncoding::Signed, NormalEncoding::Biased, NormalEncoding::Octahedral] {
        let world = World::new(gpu, 3, Wish { encoding, ..wish(12) });
        check_frame(gpu, &mut shadows, &world, light(4, 4, -1.0));
    }
}

pub fn frames_grow_and_shrink(gpu: &Gpu) {
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    for (seed, triangles) in [(4, 16), (5, 400), (6, 24), (7, 900), (4, 16)] {
        check_frame(gpu, &mut shadows, &World::new(gpu, seed, wish(triangles)), light(6, 9, 0.0));
    }
}

/// Both are recorded before either runs, and neither sees the other's parameters.
pub fn two_frames_in_one_submission(gpu: &Gpu) {
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    let worlds = [World::new(gpu, 8, wish(60)), World::new(gpu, 9, wish(32))];
    let lights = [light(8, 8, -2.0), light(3, 30, 1.0)];
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let targets = [0, 1].map(|_| texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R32Float, usage));
    submit(gpu, |encoder| {
        for ((world, light), texture) in worlds.iter().zip(lights).zip(&targets) {
            let lights = [shadowed(light, Image::Texture { texture, layer: 0 })];
            let meshes = world.meshes();
            let frame = world.frame(&meshes, &lights);
            shadows.record(encoder, &frame).expect("the frame is sound");
        }
    });
    for ((world, light), texture) in worlds.iter().zip(lights).zip(&targets) {
        let expected = image(&world.expected, &snapped(&light), VisibilityFormat::Float32);
        assert!(read_layer(gpu, texture, 0) == expected, "visibility differs");
    }
}

/// Frames of jittered samples, in every format; the third moves the light, and so begins anew.
pub fn jittered_frames_accumulate(gpu: &Gpu) {
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    let world = World::new(gpu, 12, wish(60));
    // What the buffer holds before the first frame is not looked at.
    let sums = buffer(gpu, &vec![0xa5; 4 * PIXELS], BufferUsages::STORAGE);
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let mut lit = vec![0; PIXELS];
    for (number, (frames, edge)) in [(0, -2.0), (1, -2.0), (0, 1.0), (1, 1.0), (2, 1.0)].into_iter().enumerate() {
        let (texture_format, format) = FORMATS[number % 3];
        let target = texture(gpu, [SIZE[0], SIZE[1], 1], texture_format, usage);
        let light = light(5, 7, edge).with_jitter(Jitter::pattern(number as u32));
        let history = Some(History { sums: &sums, frames });
        let lights = [Light { history, ..shadowed(light, Image::Texture { texture: &target, layer: 0 }) }];
        submit(gpu, |encoder| {
            let meshes = world.meshes();
            shadows.record(encoder, &world.frame(&meshes, &lights)).expect("the frame is sound");
        });
        if frames == 0 {
            lit.fill(0);
        }
        let snapped = snapped(&light);
        let own = lit_counts(&masks(&world.expected, &snapped), snapped.rows, snapped.columns);
        lit.iter_mut().zip(own).for_each(|(sum, lit)| *sum += lit);
        let whole = (frames + 1) * snapped.sample_count();
        let bytes = 4 / format.pixels_a_word() as usize;
        let ratio = match format {
            VisibilityFormat::Unorm8 => ratio::unorm8,
            VisibilityFormat::Float16 => ratio::float16,
            VisibilityFormat::Float32 => ratio::float32,
        };
        let expected: Vec<u8> = lit.iter().flat_map(|&lit| ratio(lit, whole).to_le_bytes()[..bytes].to_vec()).collect();
        assert!(read_layer(gpu, &target, 0) == expected, "visibility differs in frame {number}");
    }
    assert!(lit.iter().any(|&sum| sum > 0 && sum < 3 * 35), "there is a penumbra");
}

/// Buffers, bind groups, pipelines and textures that are alive, as wgpu counts them.
pub fn alive(gpu: &Gpu) -> [isize; 4] {
    let counters = gpu.device.get_internal_counters();
    let hal = &counters.hal;
    [hal.buffers.read(), hal.bind_groups.read(), hal.compute_pipelines.read(), hal.textures.read()]
}

pub fn no_allocation_once_frames_repeat(_: &Gpu) {
    // A device of its own: what other tests allocate at the same time is counted there.
    let gpu = &umbra4_tests::gpu::required().expect("it could be opened before");
    let world = World::new(gpu, 10, wish(60));
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R8Unorm, usage);
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    // The light moves, the world does not.
    let mut frame = |step: u32| {
        let lights = [shadowed(light(8, 8, -f64::from(step) * 0.1), Image::Texture { texture: &target, layer: 0 })];
        submit(gpu, |encoder| {
            let meshes = world.meshes();
            let frame = world.frame(&meshes, &lights);
            shadows.record(encoder, &frame).expect("the frame is sound");
        });
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        alive(gpu)
    };
    let before = frame(0);
    let first = frame(1);
    assert!(before[0] > 0 && before[1] > 0 && before[2] > 0, "wgpu counts: {before:?}");
    for step in 2..6 {
        assert_eq!(frame(step), first, "buffers, bind groups, pipelines, textures at frame {step}");
    }
}

pub fn a_frame_without_triangles_is_lit(gpu: &Gpu) {
    let world = World::new(gpu, 11, wish(8));
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R8Unorm, usage);
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    let lights = [shadowed(light(8, 8, -1.0), Image::Texture { texture: &target, layer: 0 })];
    submit(gpu, |encoder| {
        let frame = world.frame(&[], &lights);
        shadows.record(encoder, &frame).expect("the frame is sound");
    });
    let lit: Vec<u8> = world.expected.receivers.iter().map(|p| if *p == NOWHERE { 0 } else { 255 }).collect();
    assert_eq!(read_layer(gpu, &target, 0), lit);
}

/// A ground and a wall seen by a camera, as depths: the receivers are those that core finds on the host, none is shadowed by
/// its own surface, and what is not seen is dark.
pub fn depths_are_unprojected(gpu: &Gpu) {
    let projection = proj::directx::perspective_infinite_reverse(1.0, f64::from(SIZE[0]) / f64::from(SIZE[1]), 0.1);
    let eye = DVec3::new(1.3, 2.1, 5.7);
    let view_projection = projection * view::look_at_mat4(eye, DVec3::new(0.2, 0.4, 0.0), DVec3::Y);
    let unproject = view_projection.inverse();
    let mut depths = Vec::new();
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let place = [(f64::from(x) + 0.5) / f64::from(SIZE[0]), (f64::from(y) + 0.5) / f64::from(SIZE[1])];
            let far = unproject.project_point3(DVec3::new(2.0 * place[0] - 1.0, 1.0 - 2.0 * place[1], 0.01));
            let along = far - eye;
            // y = 0 within the bounds, and nothing above it.
            let hit = eye - along * (eye.y / along.y);
            let seen = along.y < 0.0 && hit.abs().max_element() < 9.0;
            depths.push(if seen { view_projection.project_point3(hit).z as f32 } else { 0.0 });
        }
    }
    let surface = filled(gpu, SIZE, TextureFormat::R32Float, bytemuck::cast_slice(&depths));
    let up = vec![[0_u8, 127, 0, 0]; PIXELS];
    let normals = filled(gpu, SIZE, TextureFormat::Rgba8Snorm, bytemuck::cast_slice(&up));
    let ground = [
        [-9.5_f32, 0.0, -9.5],
        [9.5, 0.0, -9.5],
        [9.5, 0.0, 9.5],
        [-9.5, 0.0, -9.5],
        [9.5, 0.0, 9.5],
        [-9.5, 0.0, 9.5],
    ];
    let vertices = buffer(gpu, bytemuck::cast_slice(&ground), BufferUsages::STORAGE);
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R8Unorm, usage);
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    let lights = [shadowed(light(8, 8, -1.0), Image::Texture { texture: &target, layer: 0 })];
    submit(gpu, |encoder| {
        let meshes = [umbra4_wgpu::Mesh {
            vertices: umbra4_wgpu::Vertices { buffer: &vertices, offset: 0, stride: 12, count: 6 },
            indices: None,
            instances: None,
        }];
        let gbuffer = GBuffer {
            surface: Surface::Depths { view: &surface, unproject, empty: 0.0, ulps: 1, subpixel_bits: 8 },
            normals: &normals,
            encoding: NormalEncoding::Signed,
            triangles: None,
            sample: 0,
        };
        let resolution = Resolution::Full;
        let frame = Frame { bounds: bounds(), meshes: &meshes, gbuffer, resolution, lights: &lights };
        shadows.record(encoder, &frame).expect("the frame is sound");
    });
    let params = ViewParams {
        width: SIZE[0],
        depth_error: f32::EPSILON,
        pixel_width: 2.0 / SIZE[0] as f32,
        pixel_height: 2.0 / SIZE[1] as f32,
        place: [0.5; 2],
        place_error: 1.0 / 512.0,
        unproject: unproject.as_mat4().to_cols_array_2d(),
        snap: lattice().snap_params().expect("a lattice around zero"),
        ..bytemuck::Zeroable::zeroed()
    };
    let mut seen = 0;
    let receivers: Vec<[i32; 3]> = depths
        .iter()
        .enumerate()
        .map(|(pixel, &depth)| {
            let (x, y) = (pixel as u32 % SIZE[0], pixel as u32 / SIZE[0]);
            match from_depth(&params, x, y, depth, Upwards { axis: 1, sign: 1 }) {
                Pixel::Receiver(p) => {
                    seen += 1;
                    p.to_array()
                }
                Pixel::Empty => NOWHERE,
                Pixel::Refused => panic!("pixel {x}, {y} is refused"),
            }
        })
        .collect();
    assert!(seen > PIXELS / 3 && seen < PIXELS, "{seen} of {PIXELS} pixels are seen");
    let got = on_device(gpu, &shadows);
    let lit: Vec<u8> = got.receivers.iter().map(|p| if *p == NOWHERE { 0 } else { 255 }).collect();
    assert_eq!(read_layer(gpu, &target, 0), lit, "the ground shadows itself");
    // Another device may round the unprojection otherwise, within the bound; a software driver rounds as the host does.
    if gpu.software {
        assert_eq!(got.receivers, receivers);
    }
}
