//! Bad input: refused before anything is recorded, with the field and its value.

use libtest_mimic::Completion;
use umbra4_core::{
    AreaLight, Bounds, DirectionalLight, Lift, PointLight,
    gbuffer::NormalEncoding,
    glam::{DMat4, DVec3},
};
use umbra4_tests::device::{buffer, texture};
use umbra4_wgpu::{
    Emitted, Frame, Gpu, GpuError, History, Image, Indices, Instances, Lack, Lamp, LatticeScene, Light, LightImage,
    SoftShadows, Surface, VisibilityFormat, WgpuExecutor,
    wgpu::{
        Backend, Backends, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, DeviceDescriptor, IndexFormat,
        Instance, InstanceDescriptor, TextureFormat, TextureUsages, TextureViewDescriptor,
    },
};

use super::{
    fixture::{SIZE, Wish, World, light},
    frames::{PIXELS, shadowed},
};

/// Changes one thing of a sound frame, and wants the error to name it.
fn refused(gpu: &Gpu, world: &World, names: &str, change: impl FnOnce(&mut Frame<'_>, &mut dyn FnMut(&Frame<'_>))) {
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R8Unorm, usage);
    let lights = [shadowed(light(4, 4, -1.0), Image::Texture { texture: &target, layer: 0 })];
    let meshes = world.meshes();
    let mut frame = world.frame(&meshes, &lights);
    let mut asked = false;
    change(&mut frame, &mut |frame| {
        asked = true;
        let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
        let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        for _ in 0..2 {
            let error = shadows.record(&mut encoder, frame).expect_err(names).to_string();
            assert!(error.contains(names), "{error:?} does not name {names:?}");
            assert!(shadows.prepare(frame).is_err());
        }
        assert!(shadows.snapped().is_none());
        // Nothing was recorded that wgpu would refuse.
        gpu.queue.submit([encoder.finish()]);
    });
    assert!(asked);
}

pub fn what_is_refused_is_named(gpu: &Gpu) {
    let world = World::new(gpu, 1, Wish { triangles: 16, bad: 0, encoding: NormalEncoding::Signed });
    let meshes = world.meshes();
    let useless = buffer(gpu, &[0; 4096], BufferUsages::VERTEX);
    let short = buffer(gpu, &[0; 24], BufferUsages::STORAGE);

    let vertices = [
        ("meshes[0].vertices.stride is 10", 0, 10, 300, None),
        ("meshes[0].vertices.stride is 8", 0, 8, 300, None),
        ("meshes[0].vertices.offset is 2", 2, 12, 2, Some(&short)),
        ("meshes[0].vertices.buffer is 24 bytes long", 0, 12, 3, Some(&short)),
        ("meshes[0].vertices.buffer is 24 bytes long", u64::MAX - 3, 12, 3, Some(&short)),
        ("meshes[0].vertices.buffer is BufferUsages(", 0, 12, 3, Some(&useless)),
    ];
    for (names, offset, stride, count, other) in vertices {
        refused(gpu, &world, names, |frame, ask| {
            let mut mesh = meshes[0];
            (mesh.vertices.offset, mesh.vertices.stride, mesh.vertices.count) = (offset, stride, count);
            mesh.vertices.buffer = other.unwrap_or(mesh.vertices.buffer);
            ask(&Frame { meshes: &[mesh], ..*frame });
        });
    }
    refused(gpu, &world, "meshes[1].vertices.count is 4", |frame, ask| {
        let mut own = meshes.clone();
        own[1].vertices.count = 4;
        ask(&Frame { meshes: &own, ..*frame });
    });
    let indices = |buffer, count| Indices { buffer, format: IndexFormat::Uint16, first: 0, count, base_vertex: 0 };
    for (names, count, buffer) in [
        ("meshes[0].indices.count is 7", 7, &short),
        ("meshes[0].indices.buffer is 24 bytes long", 15, &short),
        ("meshes[0].indices.buffer is BufferUsages(", 3, &useless),
    ] {
        refused(gpu, &world, names, |frame, ask| {
            let mesh = umbra4_wgpu::Mesh { indices: Some(indices(buffer, count)), ..meshes[0] };
            ask(&Frame { meshes: &[mesh], ..*frame });
        });
    }
    for (names, stride) in
        [("meshes[0].instances.stride is 48", 48), ("meshes[0].instances.buffer is 24 bytes long", 64)]
    {
        refused(gpu, &world, names, |frame, ask| {
            let instances = Some(Instances { buffer: &short, offset: 0, stride, count: 1 });
            let mesh = umbra4_wgpu::Mesh { instances, ..meshes[0] };
            ask(&Frame { meshes: &[mesh], ..*frame });
        });
    }

    let view = |size: [u32; 2], format, usage| {
        texture(gpu, [size[0], size[1], 1], format, usage).create_view(&TextureViewDescriptor::default())
    };
    let narrow = view([SIZE[0] - 1, SIZE[1]], TextureFormat::Rgba32Float, TextureUsages::TEXTURE_BINDING);
    let integers = view(SIZE, TextureFormat::Rgba32Uint, TextureUsages::TEXTURE_BINDING);
    let unbound = view(SIZE, TextureFormat::Rgba32Float, TextureUsages::COPY_DST);
    for (names, normals) in [
        ("gbuffer.normals is [36, 11, 1] (width, height, samples)", &narrow),
        ("gbuffer.normals.format is Rgba32Uint", &integers),
        ("gbuffer.normals.usage is TextureUsages(COPY_DST)", &unbound),
    ] {
        refused(gpu, &world, names, |frame, ask| {
            let mut gbuffer = frame.gbuffer;
            gbuffer.normals = normals;
            ask(&Frame { gbuffer, ..*frame });
        });
    }
    for (names, triangles) in [
        (
            "gbuffer.triangles is [36, 11, 1] (width, height, samples)",
            view([36, 11], TextureFormat::R32Uint, TextureUsages::TEXTURE_BINDING),
        ),
        ("gbuffer.triangles.format is R32Float", view(SIZE, TextureFormat::R32Float, TextureUsages::TEXTURE_BINDING)),
    ] {
        refused(gpu, &world, names, |frame, ask| {
            let mut gbuffer = frame.gbuffer;
            gbuffer.triangles = Some(&triangles);
            ask(&Frame { gbuffer, ..*frame });
        });
    }
    refused(gpu, &world, "gbuffer.sample is 1", |frame, ask| {
        let mut gbuffer = frame.gbuffer;
        gbuffer.sample = 1;
        ask(&Frame { gbuffer, ..*frame });
    });
    let depths = view(SIZE, TextureFormat::R32Float, TextureUsages::TEXTURE_BINDING);
    for (names, unproject, ulps, subpixel_bits) in [
        ("gbuffer.surface.unproject is [", DMat4::from_diagonal(DVec3::INFINITY.extend(1.0)), 4, 8),
        ("gbuffer.surface.ulps is 4000000000", DMat4::IDENTITY, 4_000_000_000, 8),
        ("gbuffer.surface.subpixel_bits is 0", DMat4::IDENTITY, 4, 0),
    ] {
        refused(gpu, &world, names, |frame, ask| {
            let mut gbuffer = frame.gbuffer;
            gbuffer.surface = Surface::Depths { view: &depths, unproject, empty: 0.0, ulps, subpixel_bits };
            ask(&Frame { gbuffer, ..*frame });
        });
    }

    // What only wgpu knows of a view: refused too, and again when it is asked for again.
    let layers = texture(gpu, [SIZE[0], SIZE[1], 2], TextureFormat::Rgba32Float, TextureUsages::TEXTURE_BINDING);
    let layers = layers.create_view(&TextureViewDescriptor::default());
    refused(gpu, &world, "wgpu refuses to", |frame, ask| {
        let mut gbuffer = frame.gbuffer;
        gbuffer.normals = &layers;
        ask(&Frame { gbuffer, ..*frame });
    });
    let coarse = view(SIZE, TextureFormat::Rgba8Unorm, TextureUsages::TEXTURE_BINDING);
    let stencilled = view(SIZE, TextureFormat::Depth24PlusStencil8, TextureUsages::TEXTURE_BINDING);
    let lift = Lift::F32_POSITIONS;
    for (names, surface) in [
        ("gbuffer.surface.view.format is Rgba8Unorm", Surface::Positions { view: &coarse, lift }),
        ("gbuffer.surface.view.format is Depth24PlusStencil8", Surface::Positions { view: &stencilled, lift }),
    ] {
        refused(gpu, &world, names, |frame, ask| {
            let mut gbuffer = frame.gbuffer;
            gbuffer.surface = surface;
            ask(&Frame { gbuffer, ..*frame });
        });
    }

    let usage = TextureUsages::COPY_DST;
    let images = [
        ("lights[0].visibility.format is Rg8Unorm", texture(gpu, [37, 11, 1], TextureFormat::Rg8Unorm, usage), 0),
        ("lights[0].visibility.size is 11 × 37", texture(gpu, [11, 37, 1], TextureFormat::R8Unorm, usage), 0),
        ("lights[0].visibility.layer is 2", texture(gpu, [37, 11, 2], TextureFormat::R8Unorm, usage), 2),
        (
            "lights[0].visibility.usage is TextureUsages(",
            texture(gpu, [37, 11, 1], TextureFormat::R8Unorm, TextureUsages::TEXTURE_BINDING),
            0,
        ),
    ];
    for (names, texture, layer) in &images {
        refused(gpu, &world, names, |frame, ask| {
            let visibility = Some(Image::Texture { texture, layer: *layer });
            ask(&Frame { lights: &[Light { visibility, ..frame.lights[0] }], ..*frame });
        });
    }
    let format = VisibilityFormat::Float16;
    for (names, buffer) in [
        ("lights[0].visibility.buffer is 24 bytes long", &short),
        ("lights[0].visibility.buffer is BufferUsages(", &useless),
    ] {
        refused(gpu, &world, names, |frame, ask| {
            let visibility = Some(Image::Buffer { buffer, format });
            ask(&Frame { lights: &[Light { visibility, ..frame.lights[0] }], ..*frame });
        });
    }
    let unwritten = gpu.device.create_buffer(&BufferDescriptor {
        label: None,
        size: 1 << 20,
        usage: BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    for (names, masks) in
        [("lights[0].masks is 24 bytes long", &short), ("lights[0].masks is BufferUsages(STORAGE)", &unwritten)]
    {
        refused(gpu, &world, names, |frame, ask| {
            ask(&Frame { lights: &[Light { masks: Some(masks), ..frame.lights[0] }], ..*frame });
        });
    }

    for (names, sums, frames) in [
        ("lights[0].history.frames is 1048576", &unwritten, 1 << 20),
        ("lights[0].history.sums is 24 bytes long", &short, 0),
        ("lights[0].history.sums is BufferUsages(", &useless, 0),
    ] {
        refused(gpu, &world, names, |frame, ask| {
            ask(&Frame { lights: &[Light { history: Some(History { sums, frames }), ..frame.lights[0] }], ..*frame });
        });
    }
    refused(gpu, &world, "lights[0].history.frames is 3: the light's visibility", |frame, ask| {
        let masks = Some(&useless);
        let history = Some(History { sums: &unwritten, frames: 3 });
        ask(&Frame { lights: &[Light { visibility: None, masks, history, ..frame.lights[0] }], ..*frame });
    });

    let weights = buffer(gpu, &[0; 8 * 16], BufferUsages::STORAGE);
    let sums = LightImage::Sums(&unwritten);
    let most = 12 * PIXELS - 4;
    let few = buffer(gpu, &vec![0; most], BufferUsages::STORAGE);
    let few_bytes = format!("lights[0].emission.light is {most} bytes long");
    let wide = |format, size: [u32; 2], usage| texture(gpu, [size[0], size[1], 1], format, usage);
    let bytes_only = wide(TextureFormat::Rgba8Unorm, SIZE, usage);
    let unwritable = wide(TextureFormat::Rgba16Float, SIZE, TextureUsages::TEXTURE_BINDING);
    let sound = wide(TextureFormat::Rgba16Float, SIZE, usage);
    let small = wide(TextureFormat::Rgba32Float, [36, 11], usage);
    for (names, weights, light) in [
        ("lights[0].emission.weights is 24 bytes long", &short, sums),
        ("lights[0].emission.weights is BufferUsages(", &useless, sums),
        (few_bytes.as_str(), &weights, LightImage::Sums(&few)),
        ("lights[0].emission.light is BufferUsages(", &weights, LightImage::Sums(&useless)),
        ("lights[0].emission.light is the buffer of the weights", &unwritten, sums),
        (
            "lights[0].emission.light.format is Rgba8Unorm",
            &weights,
            LightImage::Texture { texture: &bytes_only, layer: 0 },
        ),
        (
            "lights[0].emission.light.usage is TextureUsages(TEXTURE_BINDING)",
            &weights,
            LightImage::Texture { texture: &unwritable, layer: 0 },
        ),
        ("lights[0].emission.light.size is 36 × 11", &weights, LightImage::Texture { texture: &small, layer: 0 }),
        ("lights[0].emission.light.layer is 1", &weights, LightImage::Texture { texture: &sound, layer: 1 }),
    ] {
        let emission = Some(Emitted { weights, light });
        refused(gpu, &world, names, |frame, ask| {
            ask(&Frame { lights: &[Light { emission, ..frame.lights[0] }], ..*frame });
        });
    }
    refused(gpu, &world, "lights[1].emission is given: the light has no extent", |frame, ask| {
        let emission = Some(Emitted { weights: &weights, light: sums });
        let hard = Light { emission, ..Light::new(PointLight { position: DVec3::Y }) };
        ask(&Frame { lights: &[frame.lights[0], hard], ..*frame });
    });

    refused(gpu, &world, "bounds: bounds.min.x is NaN", |frame, ask| {
        ask(&Frame { bounds: Bounds { min: DVec3::NAN, ..frame.bounds }, ..*frame });
    });
    refused(gpu, &world, "lights[1]: the light reaches outside the lattice", |frame, ask| {
        let far = AreaLight::new(DVec3::splat(100.0), DVec3::X, DVec3::Y, 4, 4).expect("a light with area");
        ask(&Frame { lights: &[frame.lights[0], Light { lamp: far.into(), ..frame.lights[0] }], ..*frame });
    });
    let nowhere = DirectionalLight { towards: DVec3::ZERO };
    for (names, lamp) in [
        (
            "lights[1]: light position: coordinate y is NaN",
            PointLight { position: DVec3::new(0.0, f64::NAN, 0.0) }.into(),
        ),
        ("lights[1]: light direction is [0, 0, 0]", Lamp::from(nowhere)),
    ] {
        refused(gpu, &world, names, |frame, ask| {
            ask(&Frame { lights: &[frame.lights[0], Light { lamp, ..frame.lights[0] }], ..*frame });
        });
    }
}

/// Nothing panics on a device that is gone, neither in a frame nor for the host.
pub fn a_lost_device_is_an_error(_: &Gpu) {
    let gpu = umbra4_tests::gpu::required().expect("it could be opened before");
    let world = World::new(&gpu, 1, Wish { triangles: 16, bad: 0, encoding: NormalEncoding::Signed });
    let usage = TextureUsages::COPY_DST;
    let target = texture(&gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R8Unorm, usage);
    let lights = [shadowed(light(4, 4, -1.0), Image::Texture { texture: &target, layer: 0 })];
    let meshes = world.meshes();
    let frame = world.frame(&meshes, &lights);
    let mut warm = SoftShadows::new(&gpu.device).expect("the device can be used");
    let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
    warm.record(&mut encoder, &frame).expect("the frame is sound");
    drop(encoder);
    gpu.device.destroy();
    let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
    let mut shadows = [Some(warm), SoftShadows::new(&gpu.device).ok()];
    for shadows in shadows.iter_mut().flatten() {
        assert!(shadows.record(&mut encoder, &frame).is_err());
        // Where all is made already, there is nothing to refuse; it must not panic.
        let _ = shadows.prepare(&frame);
    }
    let points = [umbra4_core::glam::IVec3::ZERO; 3];
    let scene = LatticeScene { vertices: &points, triangles: &[[0, 1, 2]] };
    let light = super::frames::snapped(&light(4, 4, -1.0));
    assert!(WgpuExecutor::new(gpu).visibility(&scene, &light, &points).is_err());
}

/// The kernels do not compile for GL: an engine that runs on it is told so, before anything is compiled.
pub fn a_device_of_gl_is_refused() -> Completion {
    let on_gl = InstanceDescriptor { backends: Backends::GL, ..InstanceDescriptor::new_without_display_handle() };
    let adapters = pollster::block_on(Instance::new(on_gl).enumerate_adapters(Backends::GL));
    let Some(adapter) = adapters.first() else {
        return Completion::ignored_with("there is no adapter of GL to be refused");
    };
    let descriptor = DeviceDescriptor { required_limits: adapter.limits(), ..DeviceDescriptor::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device of GL");
    let points = [umbra4_core::glam::IVec3::ZERO; 3];
    let scene = LatticeScene { vertices: &points, triangles: &[[0, 1, 2]] };
    let shadows = SoftShadows::new(&device).map(|_| ());
    let gpu = Gpu { device, queue, name: "a device of GL".to_owned(), software: true };
    let masks = WgpuExecutor::new(gpu).masks::<u32>(&scene, &super::frames::snapped(&light(4, 4, -1.0)), &points);
    for done in [shadows, masks.map(|_| ())] {
        let Err(GpuError::Unusable { adapter: name, lacks }) = done else { panic!("{done:?}") };
        assert!(name.ends_with("(gl)"), "{name}");
        assert!(matches!(lacks[..], [Lack::Backend { backend: Backend::Gl, .. }, ..]), "{lacks:?}");
    }
    Completion::Completed
}
