//! Which receivers pixels become: by the triangles that they show, by a sample of theirs, at half resolution.

use umbra4_core::{
    Lift,
    gbuffer::{NormalEncoding, ViewParams},
    glam::{
        DMat4, DVec3, DVec4, Vec3,
        dcamera::rh::{proj, view},
    },
    half::halved,
    kernel::{NOWHERE, half},
};
use umbra4_tests::{
    compare::lit_counts,
    device::{buffer, filled, read, read_layer, texture},
};
use umbra4_wgpu::{
    Frame, GBuffer, Gpu, Image, Mesh, Resolution, SoftShadows, Surface, Vertices,
    wgpu::{self, BufferUsages, TextureFormat, TextureUsages, TextureView},
};

use super::{
    fixture::{Expected, SIZE, World, bounds, lattice, light},
    frames::{PIXELS, masks, on_device, shadowed, snapped, submit, wish},
};

/// A wall that leans: its exact normal is longest along x, the pixels' own along y.
pub fn the_triangle_that_is_seen_decides_the_lift(gpu: &Gpu) {
    let wall = [[1.0_f32, 0.0, -1.0], [1.75, 2.0, 0.0], [1.0, 0.0, 1.0]].map(Vec3::from_array);
    let vertices = buffer(gpu, bytemuck::cast_slice(&wall), BufferUsages::STORAGE);
    let on_wall = |k: usize| wall[0].lerp(wall[1], 0.3).lerp(wall[2], k as f32 / PIXELS as f32);
    let positions: Vec<[f32; 4]> = (0..PIXELS).map(|k| on_wall(k).extend(1.0).to_array()).collect();
    // Towards −x, and towards +x on the other side; longest along y, as a careless normal map has it.
    let side = |k: usize| if k.is_multiple_of(2) { -1.0_f32 } else { 1.0 };
    let normals: Vec<[f32; 4]> = (0..PIXELS).map(|k| [0.5 * side(k), -0.8 * side(k), 0.0, 0.0]).collect();
    // Every third pixel shows none of the frame's triangles, or one that is not there.
    let owners: Vec<u32> = (0..PIXELS).map(|k| [1, 1, 0, 1, 1, 77][k % 6]).collect();
    let lift = Lift::f32_positions_off_by(4).expect("1 to 8 units");
    let expected: Vec<[i32; 3]> = (0..PIXELS)
        .map(|k| {
            let mut point = lattice().snap(on_wall(k)).expect("it is inside").to_array();
            let (axis, sign) = if owners[k] == 1 { (0, side(k)) } else { (1, -side(k)) };
            point[axis] += sign as i32 * lift.steps();
            point
        })
        .collect();
    let positions = filled(gpu, SIZE, TextureFormat::Rgba32Float, bytemuck::cast_slice(&positions));
    let normals = filled(gpu, SIZE, TextureFormat::Rgba32Float, bytemuck::cast_slice(&normals));
    let owners = filled(gpu, SIZE, TextureFormat::R32Uint, bytemuck::cast_slice(&owners));
    let gbuffer = GBuffer {
        surface: Surface::Positions { view: &positions, lift },
        normals: &normals,
        encoding: NormalEncoding::Signed,
        triangles: Some(&owners),
        sample: 0,
    };
    let got = receivers(gpu, gbuffer, &[Vertices { buffer: &vertices, offset: 0, stride: 12, count: 3 }]);
    assert_eq!(got.receivers, expected);
}

/// What a G-buffer's pixels become.
fn receivers(gpu: &Gpu, gbuffer: GBuffer<'_>, vertices: &[Vertices<'_>]) -> Expected {
    let usage = TextureUsages::COPY_DST;
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R8Unorm, usage);
    let lights = [shadowed(light(4, 4, -1.0), Image::Texture { texture: &target, layer: 0 })];
    let meshes: Vec<Mesh<'_>> =
        vertices.iter().map(|&vertices| Mesh { vertices, indices: None, instances: None }).collect();
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    submit(gpu, |encoder| {
        let resolution = Resolution::Full;
        let frame = Frame { bounds: bounds(), meshes: &meshes, gbuffer, resolution, lights: &lights };
        shadows.record(encoder, &frame).expect("the frame is sound");
    });
    on_device(gpu, &shadows)
}

/// A texture of four samples a pixel, to be drawn to and read.
pub fn multisampled(gpu: &Gpu, format: TextureFormat) -> TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 4,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

const SAMPLES: &str = "
struct Out {
    @location(0) position: vec4f,
    @location(1) normal: vec4f,
    @location(2) owner: u32,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn samples(@builtin(position) place: vec4f, @builtin(sample_index) sample: u32) -> Out {
    let pixel = floor(place.xy) / 8.0;
    let height = f32(sample) * 0.25 + 0.25;
    return Out(vec4f(pixel.x, height, pixel.y, 1.0), vec4f(0.0, 1.0, 0.0, 0.0), 0u, height);
}
";

/// Every sample of a pixel has a height of its own.
pub fn one_sample_stands_for_a_pixel(gpu: &Gpu) {
    let target = |format| multisampled(gpu, format);
    let formats = [TextureFormat::Rgba16Float, TextureFormat::Rgba8Unorm, TextureFormat::R16Uint];
    let [positions, normals, owners] = formats.map(target);
    let depths = target(TextureFormat::Depth32Float);
    draw_samples(gpu, &formats, [&positions, &normals, &owners], &depths);
    let lift = Lift::f32_positions_off_by(1).expect("1 to 8 units");
    // x and z are place in the image, y is depth, in whole units of the lattice.
    let place = DMat4::from_cols(
        DVec4::new(4.0, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 4.0, 0.0),
        DVec4::new(0.0, 1.0, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 0.0, 1.0),
    );
    for sample in 0..4 {
        let height = 0.25 + 0.25 * sample as f32;
        for triangles in [None, Some(&owners)] {
            let (encoding, normals) = (NormalEncoding::Signed, &normals);
            let surface = Surface::Positions { view: &positions, lift };
            let got = receivers(gpu, GBuffer { surface, normals, encoding, triangles, sample }, &[]);
            for (k, p) in got.receivers.iter().enumerate() {
                let at = Vec3::new((k as u32 % SIZE[0]) as f32 / 8.0, height, (k as u32 / SIZE[0]) as f32 / 8.0);
                let mut expected = lattice().snap(at).expect("it is inside").to_array();
                // Half floats.
                expected[1] += lift.steps() << 13;
                assert_eq!(*p, expected, "sample {sample} of pixel {k}");
            }
            let surface = Surface::Depths { view: &depths, unproject: place, empty: 0.0, ulps: 1, subpixel_bits: 23 };
            let got = receivers(gpu, GBuffer { surface, normals, encoding, triangles, sample }, &[]);
            let own = lattice().snap(Vec3::Y * height).expect("it is inside").y;
            assert!(got.receivers.iter().all(|p| (own..own + 2000).contains(&p[1])), "depth of sample {sample}");
        }
    }
}

fn draw_samples(gpu: &Gpu, formats: &[TextureFormat; 3], colours: [&TextureView; 3], depths: &TextureView) {
    let pipeline = drawing(gpu, SAMPLES, ["everywhere", "samples"], formats, 4, false);
    draw(gpu, &pipeline, None, &colours, depths, 3);
}

/// A pipeline that draws a strip; with a depth test, or over everything.
pub fn drawing(
    gpu: &Gpu,
    code: &str,
    [vertex, fragment]: [&str; 2],
    formats: &[TextureFormat],
    samples: u32,
    tested: bool,
) -> wgpu::RenderPipeline {
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(code.into()),
    });
    let targets: Vec<Option<wgpu::ColorTargetState>> = formats.iter().map(|&format| Some(format.into())).collect();
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState { topology: wgpu::PrimitiveTopology::TriangleStrip, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(if tested { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Always }),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

pub fn draw(
    gpu: &Gpu,
    pipeline: &wgpu::RenderPipeline,
    group: Option<&wgpu::BindGroup>,
    colours: &[&TextureView],
    depths: &TextureView,
    vertices: u32,
) {
    let store = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
    let attachment =
        |view| wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops: store };
    let attachments: Vec<_> = colours.iter().map(|view| Some(attachment(view))).collect();
    submit(gpu, |encoder| {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &attachments,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depths,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        if let Some(group) = group {
            pass.set_bind_group(0, group, &[]);
        }
        pass.draw(0..vertices, 0..1);
    });
}

/// A ground that the rasteriser draws, on each of four samples: every receiver lies above it, and none far above.
pub fn every_sample_of_a_drawn_ground_lies_above_it(gpu: &Gpu) {
    const GROUND: &str = "
@group(0) @binding(0) var<uniform> camera: mat4x4f;

@vertex
fn ground(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 18.0 - 9.0;
    return camera * vec4f(corner.x, 0.0, corner.y, 1.0);
}

@fragment
fn up() -> @location(0) vec4f {
    return vec4f(0.0, 1.0, 0.0, 0.0);
}
";
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let camera = proj::directx::perspective_infinite_reverse(1.0, aspect, 0.1)
        * view::look_at_mat4(DVec3::new(1.3, 2.1, 5.7), DVec3::new(0.2, 0.4, 0.0), DVec3::Y);
    for samples in [1, 4] {
        let target = |format| {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let (normals, depths) = (target(TextureFormat::Rgba8Unorm), target(TextureFormat::Depth32Float));
        let pipeline = drawing(gpu, GROUND, ["ground", "up"], &[TextureFormat::Rgba8Unorm], samples, true);
        let uniform = buffer(gpu, bytemuck::bytes_of(&camera.as_mat4()), BufferUsages::UNIFORM);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        draw(gpu, &pipeline, Some(&group), &[&normals], &depths, 4);
        for sample in 0..samples {
            let surface =
                Surface::Depths { view: &depths, unproject: camera.inverse(), empty: 0.0, ulps: 8, subpixel_bits: 8 };
            let (encoding, triangles) = (NormalEncoding::Signed, None);
            let got = receivers(gpu, GBuffer { surface, normals: &normals, encoding, triangles, sample }, &[]);
            let heights: Vec<i32> = got.receivers.iter().filter(|p| **p != NOWHERE).map(|p| p[1]).collect();
            assert!(heights.len() > PIXELS / 3, "{} pixels see the ground", heights.len());
            // So many pixels are so wide here that a place is off by 1/512 of ¼ world unit; lifts are of that size.
            let most = (0.05 / lattice().step()) as i32;
            let (low, high) = (heights.iter().min(), heights.iter().max());
            assert!(low > Some(&0) && high < Some(&most), "sample {sample} of {samples}: from {low:?} to {high:?}");
        }
    }
}

/// Pixels that stand for their block are exact; the others are what core makes of them.
pub fn half_resolution_is_exact_where_it_has_receivers(gpu: &Gpu) {
    let world = World::new(gpu, 12, wish(80));
    let own = light(8, 8, -1.0);
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let target = texture(gpu, [SIZE[0], SIZE[1], 1], TextureFormat::R8Unorm, usage);
    let half_size = SIZE.map(halved);
    let blocks = (half_size[0] * half_size[1]) as usize;
    let mask_buffer = buffer(gpu, &vec![0; 4 * 4 * blocks], BufferUsages::COPY_SRC);
    let mut shadows = SoftShadows::new(&gpu.device).expect("the device can be used");
    submit(gpu, |encoder| {
        let mut asked = shadowed(own, Image::Texture { texture: &target, layer: 0 });
        asked.masks = Some(&mask_buffer);
        let (meshes, lights) = (world.meshes(), [asked]);
        let frame = Frame { resolution: Resolution::Half, ..world.frame(&meshes, &lights) };
        shadows.record(encoder, &frame).expect("the frame is sound");
    });
    let params = ViewParams { count: PIXELS as u32, width: SIZE[0], height: SIZE[1], ..bytemuck::Zeroable::zeroed() };
    let pixels = &world.expected.receivers;
    let mut thinned = vec![NOWHERE; blocks];
    let half_params = ViewParams { count: blocks as u32, ..params };
    (0..blocks).for_each(|id| half::thin(id, &half_params, pixels, &mut thinned));
    let got = on_device(gpu, &shadows);
    assert_eq!(got.receivers, thinned);
    assert!(thinned.iter().all(|p| *p == NOWHERE || pixels.contains(p)), "each is a pixel's");

    let light = snapped(&own);
    let of_blocks = Expected { receivers: thinned.clone(), ..world.expected.clone() };
    let expected = masks(&of_blocks, &light);
    let bytes = read(gpu, &mask_buffer, 4 * 4 * blocks as u64);
    let rows: Vec<u64> = bytes.chunks_exact(2).map(|row| u64::from(u16::from_le_bytes([row[0], row[1]]))).collect();
    assert!(rows == expected, "masks of the blocks");

    let exact = lit_counts(&masks(&world.expected, &light), light.rows, light.columns);
    let lit = lit_counts(&expected, light.rows, light.columns);
    let mut upsampled = vec![[0]; PIXELS];
    let lit: Vec<[u32; 1]> = lit.into_iter().map(|lit| [lit]).collect();
    (0..PIXELS).for_each(|id| half::upsample(id, &params, pixels, &thinned, &lit, &mut upsampled));
    let upsampled = upsampled.concat();
    let standing: Vec<usize> = (0..PIXELS).filter(|&k| pixels[k] != NOWHERE && thinned.contains(&pixels[k])).collect();
    assert!(standing.len() > blocks * 3 / 4, "most blocks have a receiver");
    assert!(standing.iter().all(|&k| upsampled[k] == exact[k]), "a pixel that stands for its block keeps its own");
    let format = umbra4_wgpu::VisibilityFormat::Unorm8;
    let byte = |lit: u32| format.bits(lit, light.sample_count()) as i32;
    for (k, &value) in read_layer(gpu, &target, 0).iter().enumerate() {
        // Between two counts a device may round the other way.
        let tolerance = if standing.contains(&k) || pixels[k] == NOWHERE { 0 } else { byte(1) };
        assert!((i32::from(value) - byte(upsampled[k])).abs() <= tolerance, "pixel {k}");
    }
}
