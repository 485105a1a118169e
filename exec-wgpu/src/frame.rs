//! What an engine hands over for a frame: its own buffers and textures, where they lie.

use umbra4_core::{AreaLight, Bounds, DirectionalLight, Lift, PointLight, gbuffer::NormalEncoding, glam::DMat4};
use wgpu::{Buffer, IndexFormat, Texture, TextureView};

use crate::image::VisibilityFormat;

/// One frame: what blocks light, what is seen, and the lights.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The world, with the lights and all that moves: what the lattice holds. World space. As long as the largest
    /// coordinate stays within the same power of two, so does the lattice.
    pub bounds: Bounds,
    /// What blocks light.
    pub meshes: &'a [Mesh<'a>],
    /// What is seen.
    pub gbuffer: GBuffer<'a>,
    /// How many pixels have a receiver of their own.
    pub resolution: Resolution,
    /// The lights, and where their shadows go.
    pub lights: &'a [Light<'a>],
}

/// How many pixels have a receiver of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Resolution {
    /// All of them: exact everywhere.
    #[default]
    Full,
    /// One in each block of two by two, which is exact; the others are interpolated between those that lie near them, in the
    /// image and in the world. Masks are those of the blocks: `width.div_ceil(2)` a row.
    Half,
}

/// A mesh, drawn once or many times.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// Its vertices.
    pub vertices: Vertices<'a>,
    /// Its indices; without them, three vertices after the other are a triangle.
    pub indices: Option<Indices<'a>>,
    /// Its instances; without them, its vertices are in world space.
    pub instances: Option<Instances<'a>>,
}

/// Positions of vertices: three f32 each. The buffer's usage has `STORAGE`.
#[derive(Clone, Copy, Debug)]
pub struct Vertices<'a> {
    /// The vertex buffer.
    pub buffer: &'a Buffer,
    /// Byte of the first vertex's position; a multiple of 4.
    pub offset: u64,
    /// Bytes from one position to the next; a multiple of 4, at least 12.
    pub stride: u64,
    /// Vertices there are.
    pub count: u32,
}

/// Indices of triangles: a triangle list. The buffer's usage has `STORAGE`, and its size is a multiple of 4.
#[derive(Clone, Copy, Debug)]
pub struct Indices<'a> {
    /// The index buffer.
    pub buffer: &'a Buffer,
    /// 16 or 32 bits.
    pub format: IndexFormat,
    /// First index, as in a draw.
    pub first: u32,
    /// Indices of an instance; a multiple of 3.
    pub count: u32,
    /// Added to every index, as in a draw.
    pub base_vertex: i32,
}

/// Instances: a 4 × 4 matrix each, object → world, f32, column-major, affine. The buffer's usage has `STORAGE`.
#[derive(Clone, Copy, Debug)]
pub struct Instances<'a> {
    /// The instance buffer.
    pub buffer: &'a Buffer,
    /// Byte of the first matrix; a multiple of 4.
    pub offset: u64,
    /// Bytes from one matrix to the next; a multiple of 4, at least 64.
    pub stride: u64,
    /// Instances there are.
    pub count: u32,
}

/// What is seen through each pixel. The textures' usage has `TEXTURE_BINDING`; all have the same size and number of
/// samples, and one mip level; views are of one layer.
#[derive(Clone, Copy, Debug)]
pub struct GBuffer<'a> {
    /// Where the surfaces are.
    pub surface: Surface<'a>,
    /// Normals of the surfaces, world space, towards the side that is seen. Geometric ones: along the axis that is longest in
    /// them a receiver is lifted off its surface, so one that is smoothed or mapped has to have the same longest axis, or
    /// `triangles` to be given.
    pub normals: &'a TextureView,
    /// How they are stored.
    pub encoding: NormalEncoding,
    /// The triangles that are seen, in a format of unsigned integers: one more than their index among all of the frame's (mesh by mesh,
    /// instance by instance), 0 where it is none of them. Receivers are lifted along the exact normals of these then, and
    /// `normals` only tell the side.
    pub triangles: Option<&'a TextureView>,
    /// The sample of multisampled textures whose surface stands for the pixel. 0 for others.
    pub sample: u32,
}

/// Where surfaces are.
#[derive(Clone, Copy, Debug)]
pub enum Surface<'a> {
    /// Stored world positions.
    Positions {
        /// `Rgba32Float`, or `Rgba16Float`: x, y, z; and 0 where nothing is seen.
        view: &'a TextureView,
        /// How they were rounded: [`Lift::f32_positions_off_by`] a few units in the last place, as interpolation gives. The
        /// units of half floats are 8192 times larger, and so are the lifts.
        lift: Lift,
    },
    /// Stored depths. How far surfaces are lifted follows from the error of each pixel's unprojection.
    Depths {
        /// Depth, in a depth format (a view of the depth aspect alone), or in the first component of one of 32-bit floats.
        view: &'a TextureView,
        /// The inverse of the view-projection matrix: clip space, with x and y in −1..=1 and y up, → world. Best computed
        /// in f64: only its rounding to f32 is counted as an error.
        unproject: DMat4,
        /// Depth where nothing is seen.
        empty: f32,
        /// Units in the last place by which depths may be off, from the vertex stage and interpolation: 4 is usual. Depths
        /// that are interpolated between a near and a far vertex are off by units of the near one's.
        ulps: u32,
        /// Bits of the grid within a pixel to which the rasteriser moves vertices: 8 on desktop GPUs, at least 4 on Vulkan.
        subpixel_bits: u32,
    },
}

/// What shines, world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// A light with an area: soft shadows.
    Area {
        /// The light.
        light: AreaLight,
        /// Moves its samples off a surface that it is flush with; else [`Lift::NONE`].
        lift: Lift,
    },
    /// A point, which shines to all sides: hard shadows.
    Point(PointLight),
    /// A light that is infinitely far away: hard shadows.
    Directional(DirectionalLight),
}

impl From<AreaLight> for Lamp {
    fn from(light: AreaLight) -> Self {
        Self::Area { light, lift: Lift::NONE }
    }
}

impl From<PointLight> for Lamp {
    fn from(light: PointLight) -> Self {
        Self::Point(light)
    }
}

impl From<DirectionalLight> for Lamp {
    fn from(light: DirectionalLight) -> Self {
        Self::Directional(light)
    }
}

/// A light, and where its shadows go. [`Light::new`] asks for nothing, and the rest is what a literal adds to it:
/// `Light { visibility: Some(image), ..Light::new(lamp) }`.
#[derive(Clone, Copy, Debug)]
pub struct Light<'a> {
    /// The light.
    pub lamp: Lamp,
    /// Where the fraction of lit samples of every pixel goes.
    pub visibility: Option<Image<'a>>,
    /// Where the masks of all pixels go, pixels row by row: rows of 16, 32 or 64 bits, the narrowest that hold the light's
    /// columns, in words of 32 bits, each mask from a word of its own (of a light without extent,
    /// a word that is 0 or 1). The buffer's usage has `COPY_DST`.
    pub masks: Option<&'a Buffer>,
    /// Accumulates visibility over frames, each with another [`umbra4_core::Jitter`]: noise converges to what all samples tell.
    pub history: Option<History<'a>>,
    /// What samples emit, of a light with an area, where that is not the same for all: a coloured texture, a disk, a stencil. Pixels
    /// get sums over their lit samples. Visibility, masks and history do not change by it.
    pub emission: Option<Emitted<'a>>,
    /// Whether it gives light only to what faces it: a pixel whose surface, by [`GBuffer::normals`], has the whole light behind it is
    /// dark, and no triangle is looked at for it. Worth its while where shading drops light from behind anyway, since pixels in
    /// the shade of their own object cost most. The test is that of [`umbra4_core::Facing`]; at [`Resolution::Half`] a block
    /// faces where the pixel does that stands for it.
    pub only_facing: bool,
}

impl Light<'_> {
    /// A light that asks for nothing yet.
    pub fn new(lamp: impl Into<Lamp>) -> Self {
        Self { lamp: lamp.into(), visibility: None, masks: None, history: None, emission: None, only_facing: false }
    }
}

/// What a light's samples emit, and where the light that pixels get goes. It is read when the frame runs: an engine may write other
/// weights for every frame, without touching anything else.
#[derive(Clone, Copy, Debug)]
pub struct Emitted<'a> {
    /// A weight for every sample, row by row, two words of 32 bits each: red in the low half of the first, green in its high
    /// half, blue in the low half of the second ([`umbra4_core::kernel::weigh::packed`] makes them of
    /// [`umbra4_core::emission::Emission::weights`]). The buffer's usage has `STORAGE`.
    pub weights: &'a Buffer,
    /// Where the light goes.
    pub light: LightImage<'a>,
}

/// The light that pixels get from one light: sums of the weights of the samples that they see. 0 where nothing is seen.
#[derive(Clone, Copy, Debug)]
pub enum LightImage<'a> {
    /// A layer of a texture of format `Rgba16Float` or `Rgba32Float`, as large as the G-buffer, whose usage has `COPY_DST`. Sums are
    /// divided by what they would be if all samples were lit and emitted [`umbra4_core::emission::WHOLE`], and rounded to the nearest:
    /// 0 to 1 in red, green and blue, and an alpha of 1.
    Texture {
        /// The texture.
        texture: &'a Texture,
        /// Its layer.
        layer: u32,
    },
    /// A buffer whose usage has `STORAGE`, other than that of the weights: the sums themselves, each below 2^28. Three u32 a pixel (red,
    /// green, blue), pixels row by row with nothing between them: in WGSL an `array<u32>`, since those of `vec3u` have a stride of 16.
    Sums(&'a Buffer),
}

/// What earlier frames have left of a light's visibility.
#[derive(Clone, Copy, Debug)]
pub struct History<'a> {
    /// A u32 for every pixel: sums of lit samples. The buffer's usage has `STORAGE`.
    pub sums: &'a Buffer,
    /// Frames that the sums are of, below [`umbra4_core::accumulate::most_frames`]: the next counts one more. 0 drops them, and has
    /// to where camera, light or anything that casts a shadow has moved.
    pub frames: u32,
}

/// An image of visibility, as large as the G-buffer.
#[derive(Clone, Copy, Debug)]
pub enum Image<'a> {
    /// A layer of a texture of format `R8Unorm`, `R16Float` or `R32Float`, whose usage has `COPY_DST`.
    Texture {
        /// The texture.
        texture: &'a Texture,
        /// Its layer.
        layer: u32,
    },
    /// A buffer whose usage has `STORAGE`: rows one after the other, each from a word of 32 bits on.
    Buffer {
        /// The buffer.
        buffer: &'a Buffer,
        /// Format of a pixel.
        format: VisibilityFormat,
    },
}
