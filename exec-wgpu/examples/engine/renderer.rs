//! A small deferred renderer. Everything about umbra4 is in [`Renderer::new`], where its shadows are made, and in
//! [`Renderer::shadow`].

use std::mem::size_of;

use umbra4_core::{
    gbuffer::NormalEncoding,
    glam::{
        DMat4, DVec3, Mat4, Vec4,
        dcamera::rh::{proj, view},
    },
};
use umbra4_wgpu::{
    Frame, GBuffer, GpuError, Image, Indices, Instances, Light, Mesh, Resolution, SoftShadows, Surface, Vertices,
    wgpu::{self, util::DeviceExt},
};

use crate::scene::{self, Instance, Vertex};

/// The engine's errors.
pub type Failure = Box<dyn std::error::Error>;

const NORMALS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const COLOURS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTHS: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of the visibility that umbra4 writes.
pub const VISIBILITY: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;

/// What the shaders know of a frame.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct ViewUniform {
    view_projection: Mat4,
    unproject: Mat4,
    lamp: [Vec4; 3],
    eye: Vec4,
}

/// A mesh on the device.
struct Drawn {
    vertices: wgpu::Buffer,
    vertex_count: u32,
    indices: wgpu::Buffer,
    index_count: u32,
    format: wgpu::IndexFormat,
    instances: std::ops::Range<u32>,
}

/// Textures as large as the picture.
struct Targets {
    depths: wgpu::TextureView,
    normals: wgpu::TextureView,
    colours: wgpu::TextureView,
    visibility: wgpu::Texture,
    bound: wgpu::BindGroup,
}

/// The renderer.
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    size: [u32; 2],
    meshes: Vec<Drawn>,
    instances: wgpu::Buffer,
    view: wgpu::Buffer,
    draw_group: wgpu::BindGroup,
    light_group: wgpu::BindGroup,
    gbuffer_pipeline: wgpu::RenderPipeline,
    light_pipeline: wgpu::RenderPipeline,
    targets: Targets,
    shadows: SoftShadows,
}

impl Renderer {
    /// A renderer of pictures of a size, in a format.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        size: [u32; 2],
        format: wgpu::TextureFormat,
    ) -> Result<Self, Failure> {
        let mut first = 0;
        let meshes = scene::shapes().map(|(shape, count)| {
            let instances = first..first + count;
            first += count;
            drawn(device, &shape, instances)
        });
        let buffer = |label, size: usize, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let instances = buffer("instances", first as usize * size_of::<Instance>(), wgpu::BufferUsages::STORAGE);
        let view = buffer("view", size_of::<ViewUniform>(), wgpu::BufferUsages::UNIFORM);

        let module = device.create_shader_module(wgpu::include_wgsl!("renderer.wgsl"));
        let gbuffer_pipeline = pipeline(device, &module, ["surface", "gbuffer"], &[NORMALS, COLOURS], true);
        let light_pipeline = pipeline(device, &module, ["everywhere", "light"], &[format], false);
        let group = |pipeline: &wgpu::RenderPipeline, entries: &[wgpu::BindGroupEntry<'_>]| {
            let layout = &pipeline.get_bind_group_layout(0);
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("frame"), layout, entries })
        };
        let (view_entry, instances_entry) =
            (entry(0, view.as_entire_binding()), entry(1, instances.as_entire_binding()));
        let draw_group = group(&gbuffer_pipeline, &[view_entry.clone(), instances_entry]);
        let light_group = group(&light_pipeline, &[view_entry]);
        Ok(Self {
            device: device.clone(),
            queue: queue.clone(),
            size,
            meshes: meshes.into(),
            instances,
            draw_group,
            light_group,
            targets: Targets::new(device, size, &light_pipeline),
            view,
            gbuffer_pipeline,
            light_pipeline,
            shadows: SoftShadows::new(device)?,
        })
    }

    /// Pictures of another size from now on.
    pub fn resize(&mut self, size: [u32; 2]) {
        self.size = size;
        self.targets = Targets::new(&self.device, size, &self.light_pipeline);
    }

    /// The visibility of the last frame.
    pub fn visibility(&self) -> &wgpu::Texture {
        &self.targets.visibility
    }

    /// umbra4.
    pub fn shadows(&self) -> &SoftShadows {
        &self.shadows
    }

    /// Records a frame: the picture at a time in seconds.
    pub fn frame(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        picture: &wgpu::TextureView,
        time: f32,
    ) -> Result<(), Failure> {
        let unproject = self.update(time);
        self.draw(encoder);
        self.shadow(encoder, time, unproject)?;
        self.light(encoder, picture);
        Ok(())
    }

    /// Moves camera, lamp and instances. Returns the inverse of the view-projection matrix.
    fn update(&self, time: f32) -> DMat4 {
        let [width, height] = self.size.map(f64::from);
        let eye = DVec3::new(-2.9, 5.6, 10.8);
        // The depth of what is far goes to 0, where floats are finest.
        let projection = proj::directx::perspective_infinite_reverse(0.75, width / height, 0.1);
        let view_projection = projection * view::look_at_mat4(eye, DVec3::new(0.0, 1.2, 0.0), DVec3::Y);
        let unproject = view_projection.inverse();
        let uniform = ViewUniform {
            view_projection: view_projection.as_mat4(),
            unproject: unproject.as_mat4(),
            lamp: scene::lamp(time).map(|v| v.extend(0.0)),
            eye: eye.as_vec3().extend(1.0),
        };
        self.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        self.queue.write_buffer(&self.instances, 0, bytemuck::cast_slice(&scene::instances(time)));
        unproject
    }

    /// The G-buffer.
    fn draw(&self, encoder: &mut wgpu::CommandEncoder) {
        let clear = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("G-buffer"),
            color_attachments: &[clear(&self.targets.normals), clear(&self.targets.colours)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depths,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.gbuffer_pipeline);
        pass.set_bind_group(0, &self.draw_group, &[]);
        for mesh in &self.meshes {
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), mesh.format);
            pass.draw_indexed(0..mesh.index_count, 0, mesh.instances.clone());
        }
    }

    /// The lamp's shadows: this is all that umbra4 asks of an engine.
    fn shadow(&mut self, encoder: &mut wgpu::CommandEncoder, time: f32, unproject: DMat4) -> Result<(), Failure> {
        let light = scene::area_light(time)?;
        let stride = size_of::<Instance>() as u64;
        let meshes: Vec<Mesh<'_>> = self
            .meshes
            .iter()
            .map(|mesh| Mesh {
                vertices: Vertices {
                    buffer: &mesh.vertices,
                    offset: 0,
                    stride: size_of::<Vertex>() as u64,
                    count: mesh.vertex_count,
                },
                indices: Some(Indices {
                    buffer: &mesh.indices,
                    format: mesh.format,
                    first: 0,
                    count: mesh.index_count,
                    base_vertex: 0,
                }),
                instances: Some(Instances {
                    buffer: &self.instances,
                    offset: u64::from(mesh.instances.start) * stride,
                    stride,
                    count: mesh.instances.len() as u32,
                }),
            })
            .collect();
        let recorded: Result<(), GpuError> = self.shadows.record(
            encoder,
            &Frame {
                bounds: scene::bounds(),
                meshes: &meshes,
                gbuffer: GBuffer {
                    surface: Surface::Depths {
                        view: &self.targets.depths,
                        unproject,
                        empty: 0.0,
                        ulps: 8,
                        subpixel_bits: 8,
                    },
                    normals: &self.targets.normals,
                    encoding: NormalEncoding::Signed,
                    triangles: None,
                    sample: 0,
                },
                resolution: Resolution::Full,
                lights: &[Light {
                    visibility: Some(Image::Texture { texture: &self.targets.visibility, layer: 0 }),
                    ..Light::new(light)
                }],
            },
        );
        Ok(recorded?)
    }

    /// The picture.
    fn light(&self, encoder: &mut wgpu::CommandEncoder, picture: &wgpu::TextureView) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("light"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: picture,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.light_pipeline);
        pass.set_bind_group(0, &self.light_group, &[]);
        pass.set_bind_group(1, &self.targets.bound, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn entry(binding: u32, resource: wgpu::BindingResource<'_>) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource }
}

impl Targets {
    fn new(device: &wgpu::Device, [width, height]: [u32; 2], light: &wgpu::RenderPipeline) -> Self {
        use wgpu::TextureUsages as Usage;
        let texture = |label, format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | Usage::TEXTURE_BINDING,
                view_formats: &[],
            })
        };
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let depths = view(&texture("depths", DEPTHS, Usage::RENDER_ATTACHMENT));
        let normals = view(&texture("normals", NORMALS, Usage::RENDER_ATTACHMENT));
        let colours = view(&texture("colours", COLOURS, Usage::RENDER_ATTACHMENT));
        let visibility = texture("visibility", VISIBILITY, Usage::COPY_DST | Usage::COPY_SRC);
        let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("G-buffer"),
            layout: &light.get_bind_group_layout(1),
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(&depths)),
                entry(1, wgpu::BindingResource::TextureView(&normals)),
                entry(2, wgpu::BindingResource::TextureView(&colours)),
                entry(3, wgpu::BindingResource::TextureView(&view(&visibility))),
            ],
        });
        Self { depths, normals, colours, visibility, bound }
    }
}

/// A shape on the device, with the narrowest indices that hold it. Both buffers are storage buffers too, for umbra4.
fn drawn(device: &wgpu::Device, shape: &scene::Shape, instances: std::ops::Range<u32>) -> Drawn {
    let buffer = |label, contents: &[u8], usage| {
        let usage = usage | wgpu::BufferUsages::STORAGE;
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    };
    let narrow = shape.vertices.len() <= 1 << 16;
    let mut indices: Vec<u8> = if narrow {
        shape.indices.iter().flat_map(|&index| (index as u16).to_ne_bytes()).collect()
    } else {
        bytemuck::cast_slice(&shape.indices).to_vec()
    };
    indices.resize(indices.len().next_multiple_of(4), 0);
    Drawn {
        vertices: buffer("vertices", bytemuck::cast_slice(&shape.vertices), wgpu::BufferUsages::VERTEX),
        vertex_count: shape.vertices.len() as u32,
        indices: buffer("indices", &indices, wgpu::BufferUsages::INDEX),
        index_count: shape.indices.len() as u32,
        format: if narrow { wgpu::IndexFormat::Uint16 } else { wgpu::IndexFormat::Uint32 },
        instances,
    }
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    formats: &[wgpu::TextureFormat],
    geometry: bool,
) -> wgpu::RenderPipeline {
    let targets: Vec<Option<wgpu::ColorTargetState>> = formats.iter().map(|&format| Some(format.into())).collect();
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    let buffers = [Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    })];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(vertex),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: if geometry { &buffers } else { &[] },
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: geometry.then(|| wgpu::DepthStencilState {
            format: DEPTHS,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
