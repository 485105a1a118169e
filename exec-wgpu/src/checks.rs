//! An engine's buffers and textures, checked before anything is recorded: wgpu would refuse the whole encoder later.

use std::num::NonZero;

use umbra4_core::{
    AnyLight, PackedCaster,
    accumulate::most_frames,
    gbuffer::ViewParams,
    glam::Mat4,
    kernel::weigh::PackedWeight,
    mesh::MeshParams,
    plane_offset::MOST_OFFSET,
    snap::SnapParams,
    surface_words::SurfaceKind,
    texture::{MOST_TEXELS, TextureError, TextureSize},
};
use wgpu::{
    Buffer, BufferUsages, Device, IndexFormat, Texture, TextureDimension, TextureFormat, TextureSampleType,
    TextureUsages, TextureView,
};

use crate::{
    GpuError, LatticeReceivers, LatticeScene,
    frame::{Emitted, GBuffer, History, Image, Light, LightImage, Mesh, Surface},
    image::{LightFormat, VisibilityFormat},
    recorder::Resource,
};

fn refuse<T>(field: impl Into<String>, value: impl ToString, needs: &'static str) -> Result<T, GpuError> {
    Err(GpuError::Field { field: field.into(), value: value.to_string(), needs })
}

fn check(holds: bool, field: &str, name: &str, value: impl ToString, needs: &'static str) -> Result<(), GpuError> {
    if holds { Ok(()) } else { refuse(format!("{field}.{name}"), value, needs) }
}

/// Elements of a buffer: where the first lies, how far it is to the next, and the bytes that are read of each.
struct Elements<'a> {
    buffer: &'a Buffer,
    offset: u64,
    stride: u64,
    size: u64,
    count: u64,
}

impl Elements<'_> {
    /// The part of the buffer that holds them, and the byte of it at which the first begins.
    fn part(&self, device: &Device, field: &str) -> Result<(Resource, u64), GpuError> {
        let Self { buffer, offset, stride, size, count } = *self;
        let usage = buffer.usage();
        check(usage.contains(BufferUsages::STORAGE), field, "buffer", format!("{usage:?}"), "its usage needs STORAGE")?;
        check(offset.is_multiple_of(size.min(4)), field, "offset", offset, "it has to be a multiple of 4")?;
        let last = (count.saturating_sub(1)).checked_mul(stride).and_then(|bytes| bytes.checked_add(offset));
        let end = last.and_then(|last| last.checked_add(size)).and_then(|end| end.checked_next_multiple_of(4));
        let Some(end) = end.filter(|end| *end <= buffer.size()) else {
            return refuse(
                format!("{field}.buffer"),
                format!("{} bytes long", buffer.size()),
                "elements lie beyond its end",
            );
        };
        let limits = device.limits();
        let start = offset - offset % u64::from(limits.min_storage_buffer_offset_alignment);
        let limit = limits.max_storage_buffer_binding_size;
        match NonZero::new(end - start) {
            Some(bytes) if bytes.get() > limit => {
                Err(GpuError::TooLarge { what: "elements of a mesh", bytes: bytes.get(), limit })
            }
            Some(bytes) => Ok((Resource::Part(buffer.clone(), start, bytes), offset - start)),
            None => refuse(format!("{field}.count"), 0, "it may not be 0"),
        }
    }
}

/// A mesh as its kernels take it.
pub(crate) struct CheckedMesh {
    pub(crate) vertices: Resource,
    pub(crate) indices: Option<Resource>,
    pub(crate) instances: Option<Resource>,
    /// But the number of ids, which is that of vertices or triangles of all instances.
    pub(crate) params: MeshParams,
    pub(crate) all_vertices: u32,
    pub(crate) all_triangles: u32,
}

/// All meshes, one after the other among the snapped vertices and the triangles. Those without triangles are left out.
pub(crate) fn meshes(device: &Device, snap: SnapParams, meshes: &[Mesh<'_>]) -> Result<Vec<CheckedMesh>, GpuError> {
    let (mut vertices, mut triangles) = (0_u32, 0_u32);
    let mut out = Vec::with_capacity(meshes.len());
    for (index, mesh) in meshes.iter().enumerate() {
        let mut checked = match mesh_of(device, snap, mesh, &format!("meshes[{index}]"))? {
            Some(checked) => checked,
            None => continue,
        };
        checked.params.vertex_base = vertices;
        checked.params.triangle_base = triangles;
        vertices = sum("vertices", vertices, checked.all_vertices)?;
        triangles = sum("triangles", triangles, checked.all_triangles)?;
        out.push(checked);
    }
    Ok(out)
}

/// Largest number of elements of one kind.
const MOST: u32 = u32::MAX - 1;

fn sum(field: &'static str, a: u32, b: u32) -> Result<u32, GpuError> {
    let count = u64::from(a) + u64::from(b);
    count_of(field, count)
}

/// A number of elements that an index can name.
pub(crate) fn count_of(field: &'static str, count: u64) -> Result<u32, GpuError> {
    match u32::try_from(count) {
        Ok(count) if count <= MOST => Ok(count),
        _ => Err(GpuError::TooMany { field, count: count as usize, most: MOST as usize }),
    }
}

/// Whether indices can name all that a call is given, and all receivers, or none, face somewhere.
pub(crate) fn counts_of(scene: &LatticeScene<'_>, receivers: LatticeReceivers<'_>) -> Result<(), GpuError> {
    let LatticeReceivers { points, facings, layers } = receivers;
    if !facings.is_empty() && facings.len() != points.len() {
        return Err(GpuError::FacingCount { facings: facings.len(), receivers: points.len() });
    }
    if !layers.is_empty() && layers.len() != points.len() {
        return Err(GpuError::LayerCount { layers: layers.len(), receivers: points.len() });
    }
    let counts =
        [("vertices", scene.vertices.len()), ("triangles", scene.triangles.len()), ("receivers", points.len())];
    counts.into_iter().try_for_each(|(field, count)| count_of(field, count as u64).map(|_| ()))
}

/// Whether indices can name all of a caster, and its surface is packed as its kind and texture ask for.
pub(crate) fn caster(caster: &PackedCaster<'_>) -> Result<(), GpuError> {
    count_of("vertices", caster.vertices.len() as u64)?;
    count_of("triangles", caster.triangles.len() as u64)?;
    let TextureSize { width, height, .. } = caster.texture;
    for (field, value) in [("width", width), ("height", height)] {
        if value == 0 || value > MOST_TEXELS {
            return Err(TextureError::Size { field, value }.into());
        }
    }
    if caster.casting.offset > MOST_OFFSET {
        return refuse("casting.offset", caster.casting.offset, "at most 2^26 lattice units");
    }
    match caster.kind {
        SurfaceKind::Tinted if caster.casting.closed => {
            return refuse("casting.closed", true, "panes have no inside");
        }
        SurfaceKind::Tinted if caster.casting.offset > 0 => {
            return refuse("casting.offset", caster.casting.offset, "panes stay where they are");
        }
        SurfaceKind::Opaque if !caster.texture.is_one() => {
            return refuse("texture", format!("{width}×{height}"), "opaque casters have none");
        }
        SurfaceKind::Opaque if caster.surface.first().is_some_and(|word| word & 1 == 0) => {
            return refuse("surface[0]", 0, "a one, of an opaque caster");
        }
        _ => {}
    }
    let words = caster.layout().words(caster.kind);
    match words.filter(|words| caster.surface.len() == *words as usize) {
        Some(_) => Ok(()),
        None => refuse("surface.len()", caster.surface.len(), "as many words as the kind and the texture ask for"),
    }
}

fn mesh_of(device: &Device, snap: SnapParams, mesh: &Mesh<'_>, field: &str) -> Result<Option<CheckedMesh>, GpuError> {
    let Mesh { vertices: v, indices, instances } = mesh;
    let of = |name: &str| format!("{field}.{name}");
    check(
        v.stride >= 12 && v.stride.is_multiple_of(4),
        &of("vertices"),
        "stride",
        v.stride,
        "a multiple of 4, at least 12, is needed",
    )?;
    let corners = indices.map_or(v.count, |indices| indices.count);
    let counted = if indices.is_some() { of("indices") } else { of("vertices") };
    check(corners.is_multiple_of(3), &counted, "count", corners, "triangles have three corners")?;
    let drawn = instances.map_or(1, |instances| instances.count);
    if v.count == 0 || corners == 0 || drawn == 0 {
        return Ok(None);
    }
    let elements =
        Elements { buffer: v.buffer, offset: v.offset, stride: v.stride, size: 12, count: u64::from(v.count) };
    let (vertices, vertex_first) = elements.part(device, &of("vertices"))?;
    let mut params = MeshParams {
        snap,
        count: 0,
        row: 0,
        vertex_first: (vertex_first / 4) as u32,
        vertex_stride: (v.stride / 4) as u32,
        vertices: v.count,
        vertex_base: 0,
        instance_first: 0,
        instance_stride: 0,
        index_first: 0,
        index_bits: 32,
        index_offset: 0,
        triangles: corners / 3,
        triangle_base: 0,
        padding: [0; 2],
    };
    let mut bound_indices = None;
    if let Some(i) = indices {
        let size = if i.format == IndexFormat::Uint16 { 2 } else { 4 };
        let elements = Elements {
            buffer: i.buffer,
            offset: u64::from(i.first) * size,
            stride: size,
            size,
            count: u64::from(i.count),
        };
        let (resource, first) = elements.part(device, &of("indices"))?;
        params.index_first = (first / size) as u32;
        params.index_bits = 8 * size as u32;
        params.index_offset = i.base_vertex;
        bound_indices = Some(resource);
    }
    let mut bound_instances = None;
    if let Some(i) = instances {
        let name = of("instances");
        check(
            i.stride >= 64 && i.stride.is_multiple_of(4),
            &name,
            "stride",
            i.stride,
            "a multiple of 4, at least 64, is needed",
        )?;
        let elements =
            Elements { buffer: i.buffer, offset: i.offset, stride: i.stride, size: 64, count: u64::from(i.count) };
        let (resource, first) = elements.part(device, &name)?;
        params.instance_first = (first / 4) as u32;
        params.instance_stride = (i.stride / 4) as u32;
        bound_instances = Some(resource);
    }
    Ok(Some(CheckedMesh {
        vertices,
        indices: bound_indices,
        instances: bound_instances,
        params,
        all_vertices: count_of("vertices", u64::from(v.count) * u64::from(drawn))?,
        all_triangles: count_of("triangles", u64::from(corners / 3) * u64::from(drawn))?,
    }))
}

/// A G-buffer as its kernels take it.
pub(crate) struct CheckedView {
    pub(crate) surface: Resource,
    pub(crate) normals: Resource,
    pub(crate) triangles: Option<Resource>,
    pub(crate) depths: bool,
    pub(crate) multisampled: bool,
    pub(crate) size: [u32; 2],
    /// But the pixels, which come block by block.
    pub(crate) params: ViewParams,
}

/// What a texture of a G-buffer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Holds {
    Positions,
    Depths,
    Normals,
    Triangles,
}

impl Holds {
    fn fits(self, format: TextureFormat) -> bool {
        use TextureFormat::{R32Float, Rg32Float, Rgba16Float, Rgba32Float};
        match self {
            Self::Positions => matches!(format, Rgba32Float | Rgba16Float),
            Self::Depths => format.has_depth_aspect() || matches!(format, R32Float | Rg32Float | Rgba32Float),
            Self::Normals => {
                !format.is_depth_stencil_format()
                    && matches!(format.sample_type(None, None), Some(TextureSampleType::Float { .. }))
            }
            Self::Triangles => {
                !format.is_depth_stencil_format() && format.sample_type(None, None) == Some(TextureSampleType::Uint)
            }
        }
    }

    fn needs(self) -> &'static str {
        match self {
            Self::Positions => "Rgba32Float or Rgba16Float is needed",
            Self::Depths => "a depth format, or one of 32-bit floats, is needed",
            Self::Normals => "a float or normalised format is needed",
            Self::Triangles => "a format of unsigned integers is needed",
        }
    }
}

/// Width, height and samples of a texture that can be bound.
fn texture(view: &TextureView, field: &str, holds: Holds) -> Result<[u32; 3], GpuError> {
    let texture = view.texture();
    let usage = texture.usage();
    let usable = usage.contains(TextureUsages::TEXTURE_BINDING);
    check(usable, field, "usage", format!("{usage:?}"), "it needs TEXTURE_BINDING")?;
    let dimension = texture.dimension();
    check(dimension == TextureDimension::D2, field, "dimension", format!("{dimension:?}"), "it has to be D2")?;
    let levels = texture.mip_level_count();
    check(levels == 1, field, "mip_level_count", levels, "it has to be 1")?;
    let format = texture.format();
    check(holds.fits(format), field, "format", format!("{format:?}"), holds.needs())?;
    Ok([texture.width(), texture.height(), texture.sample_count()])
}

/// Where in a pixel a sample lies: the standard places, those of Vulkan and of all others.
fn sample_place(samples: u32, sample: u32) -> Option<[f32; 2]> {
    const TWO: [[f32; 2]; 2] = [[0.75, 0.75], [0.25, 0.25]];
    const FOUR: [[f32; 2]; 4] = [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]];
    const EIGHT: [[f32; 2]; 8] = [
        [0.5625, 0.3125],
        [0.4375, 0.6875],
        [0.8125, 0.5625],
        [0.3125, 0.1875],
        [0.1875, 0.8125],
        [0.0625, 0.4375],
        [0.6875, 0.9375],
        [0.9375, 0.0625],
    ];
    let places: &[[f32; 2]] = match samples {
        1 => &[[0.5; 2]],
        2 => &TWO,
        4 => &FOUR,
        8 => &EIGHT,
        _ => &[],
    };
    places.get(sample as usize).copied()
}

/// Largest error of a depth beside the relative one: that of its format.
fn depth_quantum(format: TextureFormat) -> f32 {
    match format {
        TextureFormat::Depth16Unorm => 1.0 / 65535.0,
        TextureFormat::Depth24Plus | TextureFormat::Depth24PlusStencil8 => 1.0 / 16_777_215.0,
        _ => 0.0,
    }
}

pub(crate) fn gbuffer(snap: SnapParams, gbuffer: &GBuffer<'_>) -> Result<CheckedView, GpuError> {
    let (view, holds) = match gbuffer.surface {
        Surface::Positions { view, .. } => (view, Holds::Positions),
        Surface::Depths { view, .. } => (view, Holds::Depths),
    };
    let [width, height, samples] = texture(view, "gbuffer.surface.view", holds)?;
    let others = [
        ("gbuffer.normals", Some(gbuffer.normals), Holds::Normals),
        ("gbuffer.triangles", gbuffer.triangles, Holds::Triangles),
    ];
    for (field, view, holds) in others {
        let Some(view) = view else { continue };
        let size = texture(view, field, holds)?;
        if size != [width, height, samples] {
            let value = format!("{size:?} (width, height, samples)");
            return refuse(field, value, "it has to be as large as the surface, with as many samples");
        }
    }
    check(gbuffer.sample < samples, "gbuffer", "sample", gbuffer.sample, "there is no such sample")?;
    let mut params = ViewParams {
        snap,
        count: 0,
        row: 0,
        width,
        height,
        first: 0,
        sample: gbuffer.sample,
        normals: gbuffer.encoding as u32,
        lift: 0,
        empty_depth: 0.0,
        depth_error: 0.0,
        depth_quantum: 0.0,
        pixel_width: 2.0 / width as f32,
        pixel_height: 2.0 / height as f32,
        place: [0.5; 2],
        place_error: 0.0,
        triangles: 0,
        unproject: Mat4::IDENTITY.to_cols_array_2d(),
    };
    match gbuffer.surface {
        Surface::Positions { lift, .. } => {
            let halves = view.texture().format() == TextureFormat::Rgba16Float;
            params.lift = lift.steps() * if halves { 1 << 13 } else { 1 };
        }
        Surface::Depths { view, unproject, empty, ulps, subpixel_bits } => {
            check(unproject.is_finite(), "gbuffer.surface", "unproject", unproject, "all of it has to be finite")?;
            check(ulps <= 1 << 20, "gbuffer.surface", "ulps", ulps, "that is no depth any more")?;
            let bits = (1..=23).contains(&subpixel_bits);
            check(bits, "gbuffer.surface", "subpixel_bits", subpixel_bits, "it has to be in 1..=23")?;
            let Some(place) = sample_place(samples, gbuffer.sample) else {
                return refuse("gbuffer.surface.view.sample_count", samples, "where its samples lie is not known");
            };
            params.place = place;
            params.place_error = 0.5 / (1_u32 << subpixel_bits) as f32;
            params.empty_depth = empty;
            params.depth_error = ulps as f32 * f32::EPSILON;
            params.depth_quantum = depth_quantum(view.texture().format());
            params.unproject = unproject.as_mat4().to_cols_array_2d();
        }
    }
    Ok(CheckedView {
        surface: Resource::Texture(view.clone()),
        normals: Resource::Texture(gbuffer.normals.clone()),
        triangles: gbuffer.triangles.map(|view| Resource::Texture(view.clone())),
        depths: holds == Holds::Depths,
        multisampled: samples > 1,
        size: [width, height],
        params,
    })
}

/// Where an image of visibility goes.
pub(crate) fn image(
    device: &Device,
    image: &Image<'_>,
    [width, height]: [u32; 2],
    field: &str,
) -> Result<VisibilityFormat, GpuError> {
    let field = format!("{field}.visibility");
    match image {
        Image::Texture { texture, layer } => {
            let format = texture.format();
            let Some(known) = VisibilityFormat::of(format) else {
                return refuse(
                    format!("{field}.format"),
                    format!("{format:?}"),
                    "R8Unorm, R16Float or R32Float is needed",
                );
            };
            target(texture, *layer, [width, height], &field)?;
            Ok(known)
        }
        Image::Buffer { buffer, format } => {
            let usage = buffer.usage();
            let usable = usage.contains(BufferUsages::STORAGE);
            check(usable, &field, "buffer", format!("{usage:?}"), "its usage needs STORAGE")?;
            let bytes = 4 * u64::from(format.words(width)) * u64::from(height);
            let size = format!("{} bytes long", buffer.size());
            check(buffer.size() >= bytes, &field, "buffer", size, "the image does not fit it")?;
            let limit = device.limits().max_storage_buffer_binding_size;
            if bytes > limit {
                return Err(GpuError::TooLarge { what: "an image of visibility", bytes, limit });
            }
            Ok(*format)
        }
    }
}

/// A layer of a texture that an image is copied to.
fn target(texture: &Texture, layer: u32, [width, height]: [u32; 2], field: &str) -> Result<(), GpuError> {
    let usage = texture.usage();
    let usable = usage.contains(TextureUsages::COPY_DST);
    check(usable, field, "usage", format!("{usage:?}"), "it needs COPY_DST")?;
    let size = format!("{} × {}", texture.width(), texture.height());
    let fits = texture.width() == width && texture.height() == height && texture.sample_count() == 1;
    check(fits, field, "size", size, "it has to be as large as the G-buffer, with one sample")?;
    let layered = texture.dimension() == TextureDimension::D2 && layer < texture.depth_or_array_layers();
    check(layered, field, "layer", layer, "the texture has no such layer")
}

/// A light's emission as kernels take it.
pub(crate) struct CheckedEmission {
    pub(crate) weights: Resource,
    /// Where sums go, where they are asked for.
    pub(crate) sums: Option<Resource>,
    /// Format of the texture, where there is one.
    pub(crate) format: Option<LightFormat>,
}

/// The first `bytes` bytes of a buffer, which holds `what`; `needs` says what it is to be large enough for.
fn beginning(
    device: &Device,
    buffer: &Buffer,
    bytes: u64,
    [field, name]: [&str; 2],
    [what, needs]: [&'static str; 2],
) -> Result<Resource, GpuError> {
    let usage = buffer.usage();
    check(usage.contains(BufferUsages::STORAGE), field, name, format!("{usage:?}"), "its usage needs STORAGE")?;
    let size = format!("{} bytes long", buffer.size());
    check(buffer.size() >= bytes, field, name, size, needs)?;
    let limit = device.limits().max_storage_buffer_binding_size;
    match NonZero::new(bytes) {
        Some(bytes) if bytes.get() <= limit => Ok(Resource::Part(buffer.clone(), 0, bytes)),
        _ => Err(GpuError::TooLarge { what, bytes, limit }),
    }
}

/// What samples emit, and where the light goes.
pub(crate) fn emission(
    device: &Device,
    emission: &Emitted<'_>,
    light: &AnyLight,
    size: [u32; 2],
    field: &str,
) -> Result<CheckedEmission, GpuError> {
    let field = format!("{field}.emission");
    if matches!(light, AnyLight::Punctual(_)) {
        return refuse(field, "given", "the light has no extent: it has no samples to be weighed");
    }
    let Emitted { weights, light: image } = emission;
    let bytes = u64::from(light.sample_count()) * size_of::<PackedWeight>() as u64;
    let fits = "a weight for every sample does not fit it";
    let weights_part = beginning(device, weights, bytes, [&field, "weights"], ["weights of samples", fits])?;
    let (sums, format) = match image {
        LightImage::Sums(buffer) => {
            check(buffer != weights, &field, "light", "the buffer of the weights", "it has to be another")?;
            let bytes = u64::from(size[0]) * u64::from(size[1]) * size_of::<[u32; 3]>() as u64;
            let fits = "three u32 for every pixel do not fit it";
            (Some(beginning(device, buffer, bytes, [&field, "light"], ["an image of light", fits])?), None)
        }
        LightImage::Texture { texture, layer } => {
            let field = format!("{field}.light");
            let format = texture.format();
            let Some(known) = LightFormat::of(format) else {
                return refuse(
                    format!("{field}.format"),
                    format!("{format:?}"),
                    "Rgba16Float or Rgba32Float is needed",
                );
            };
            target(texture, *layer, size, &field)?;
            (None, Some(known))
        }
    };
    Ok(CheckedEmission { weights: weights_part, sums, format })
}

/// Where masks of `stride` words of 32 bits go.
pub(crate) fn masks(buffer: &Buffer, pixels: u64, stride: u32, field: &str) -> Result<(), GpuError> {
    let usage = buffer.usage();
    check(usage.contains(BufferUsages::COPY_DST), field, "masks", format!("{usage:?}"), "its usage needs COPY_DST")?;
    let size = format!("{} bytes long", buffer.size());
    check(buffer.size() >= 4 * pixels * u64::from(stride), field, "masks", size, "the masks do not fit it")
}

/// What a light's history has to be; `samples` of the light.
pub(crate) fn history(light: &Light<'_>, samples: u32, pixels: u64, field: &str) -> Result<(), GpuError> {
    let Some(History { sums, frames }) = &light.history else { return Ok(()) };
    let field = format!("{field}.history");
    let known = light.visibility.is_some();
    check(known, &field, "frames", frames, "the light's visibility, which is to be accumulated, has no place to go")?;
    let most = most_frames(samples);
    check(*frames < most, &field, "frames", frames, "so many frames do not fit the sums: no more are to be counted")?;
    let usage = sums.usage();
    check(usage.contains(BufferUsages::STORAGE), &field, "sums", format!("{usage:?}"), "its usage needs STORAGE")?;
    let size = format!("{} bytes long", sums.size());
    check(sums.size() >= 4 * pixels, &field, "sums", size, "a u32 for every pixel does not fit it")
}

/// The lights' names in errors.
pub(crate) fn light_field(index: usize) -> String {
    format!("lights[{index}]")
}

/// Whether a light asks for anything.
pub(crate) fn asks(light: &Light<'_>) -> bool {
    light.visibility.is_some() || light.masks.is_some() || light.emission.is_some()
}

/// Pixels of an image.
pub(crate) fn pixels([width, height]: [u32; 2]) -> Result<u32, GpuError> {
    count_of("receivers", u64::from(width) * u64::from(height))
}
