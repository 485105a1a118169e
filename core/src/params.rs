//! What a kernel is told, besides its buffers. All members are vectors of four, so that the layout is the same in Rust,
//! SPIR-V and WGSL.
//!
//! It lies in a storage buffer, not in a uniform one: some drivers (lavapipe) compile a kernel anew for each set of values
//! that they find in uniforms.

use glam::{IVec3, IVec4, UVec4, Vec3, Vec4};

#[cfg(not(target_arch = "spirv"))]
use crate::packed_caster::PackedCaster;
use crate::{
    cloud_extent::CloudExtent,
    edge_plane::LightGrid,
    frame::LightFrame,
    hierarchy::{Levels, MAX_LEVELS},
    jitter::{Jitter, Pattern},
    layers::Layers,
    light::LatticeLight,
    order::{BoxCurve, CodeFrame},
    plane_cell::TableSize,
    punctual::Punctual,
    punctual_frame::PunctualFrame,
    stage::key_triangles::Casting,
    surface_words::SurfaceLayout,
    texture::TextureSize,
};

/// Parameters of a kernel. They say how ids are laid out.
pub trait Dispatched: Sized {
    /// Ids there are.
    fn count(&self) -> u32;
    /// See [`PassParams::row`].
    fn row(&self) -> u32;
    /// The same with rows of `row` ids.
    #[must_use]
    fn with_row(self, row: u32) -> Self;
}

impl Dispatched for Params {
    #[inline(always)]
    fn count(&self) -> u32 {
        self.pass[0].x
    }

    #[inline(always)]
    fn row(&self) -> u32 {
        self.pass[1].y
    }

    fn with_row(mut self, row: u32) -> Self {
        self.pass[1].y = row;
        self
    }
}

/// Parameters with [`Params`] among them, which lay out ids.
macro_rules! dispatched_as_params {
    ($($with_params:ty),*) => {
        $(
            impl Dispatched for $with_params {
                #[inline(always)]
                fn count(&self) -> u32 {
                    self.params.count()
                }

                #[inline(always)]
                fn row(&self) -> u32 {
                    self.params.row()
                }

                fn with_row(self, row: u32) -> Self {
                    Self { params: self.params.with_row(row), ..self }
                }
            }
        )*
    };
}

dispatched_as_params!(JitteredParams, PunctualParams, CloudParams, CasterParams);

/// One light, the layout of the hierarchy, and one pass.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Params {
    /// The light's origin, and its rows.
    origin: IVec4,
    /// Its step between columns, and its columns.
    step_u: IVec4,
    /// Its step between rows, and how its samples are jittered.
    step_v: IVec4,
    /// Columns per lattice unit; what the rounding of the axes moves.
    along_u: Vec4,
    /// Rows per lattice unit; 0.
    along_v: Vec4,
    /// Its normal; 0.
    normal: Vec4,
    /// Lattice units per column and row; 0.
    scale: Vec4,
    /// Middle and inverse spread of the [`CodeFrame`]; 0.
    codes: Vec4,
    /// Where the levels of the hierarchy start, and at last their number.
    levels: [UVec4; 3],
    /// See [`PassParams`].
    pass: [UVec4; 3],
}

/// What is different in every pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PassParams {
    /// Ids there are: `0..count`. Threads beyond do nothing.
    pub count: u32,
    /// First receiver of the block.
    pub first: u32,
    /// Bit from which a digit of the sort is taken.
    pub shift: u32,
    /// Level of the node under which triangles are looked at.
    pub level: u32,
    /// Words of 32 bits a receiver's mask takes.
    pub stride: u32,
    /// Ids of a row of workgroups: those of a dispatch are laid out in rows, since a row is limited.
    pub row: u32,
    /// Elements there are of what ids stand for by runs or blocks; of stages that add to masks, whether there are any (1) yet (0).
    pub elements: u32,
    /// First element of a level of sums, or of nodes; place in its level of the node under which triangles are looked at.
    pub base: u32,
    /// Pixels of a row of an image.
    pub width: u32,
    /// Words of 32 bits from one row of a packed image to the next.
    pub pitch: u32,
    /// Pixels that a word of a packed image holds: 1, 2 or 4.
    pub texels: u32,
    /// Rounds of a loop that a thread takes at its end, to see that it still may.
    pub rounds: u32,
}

impl Params {
    /// What a light's passes share. `codes` decides the order of triangles and receivers, never a bit.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(grid: &LightGrid, codes: &CodeFrame, levels: &Levels) -> Self {
        Self::of(&grid.light, &grid.frame, grid.skew, codes, levels)
    }

    #[cfg(not(target_arch = "spirv"))]
    fn of(light: &LatticeLight, frame: &LightFrame, skew: f32, codes: &CodeFrame, levels: &Levels) -> Self {
        let mut words = [UVec4::ZERO; 3];
        for (word, value) in words.iter_mut().flat_map(|v| v.as_mut()).zip(levels.words()) {
            *word = value;
        }
        Self {
            origin: light.origin.extend(light.rows as i32),
            step_u: light.step_u.extend(light.columns as i32),
            step_v: light.step_v.extend(light.jitter.code() as i32),
            along_u: frame.along_u.extend(skew),
            along_v: frame.along_v.extend(0.0),
            normal: frame.normal.extend(0.0),
            scale: Vec4::new(frame.scale[0], frame.scale[1], 0.0, 0.0),
            codes: Vec4::new(codes.center[0], codes.center[1], codes.inverse_spread, 0.0),
            levels: words,
            pass: [UVec4::ZERO; 3],
        }
    }

    /// The same for one pass.
    #[must_use]
    pub fn with_pass(mut self, pass: &PassParams) -> Self {
        let p = pass;
        self.pass = [
            UVec4::new(p.count, p.first, p.shift, p.level),
            UVec4::new(p.stride, p.row, p.elements, p.base),
            UVec4::new(p.width, p.pitch, p.texels, p.rounds),
        ];
        self
    }

    /// The pass.
    #[inline(always)]
    pub fn pass(&self) -> PassParams {
        let [a, b, c] = self.pass;
        let (count, first, shift, level) = (a.x, a.y, a.z, a.w);
        let (stride, row, elements, base) = (b.x, b.y, b.z, b.w);
        let (width, pitch, texels, rounds) = (c.x, c.y, c.z, c.w);
        PassParams { count, first, shift, level, stride, row, elements, base, width, pitch, texels, rounds }
    }

    /// The light.
    #[inline(always)]
    pub fn light(&self) -> LatticeLight {
        LatticeLight {
            origin: three(self.origin),
            step_u: three(self.step_u),
            step_v: three(self.step_v),
            rows: self.origin.w as u32,
            columns: self.step_u.w as u32,
            jitter: Jitter::from_code(self.step_v.w as u32),
        }
    }

    /// The light's frame.
    #[inline(always)]
    pub fn frame(&self) -> LightFrame {
        let light = self.light();
        LightFrame {
            origin: light.origin,
            along_u: Vec3::new(self.along_u.x, self.along_u.y, self.along_u.z),
            along_v: Vec3::new(self.along_v.x, self.along_v.y, self.along_v.z),
            normal: Vec3::new(self.normal.x, self.normal.y, self.normal.z),
            last_column: light.last_column(),
            last_row: light.last_row(),
            scale: [self.scale.x, self.scale.y],
        }
    }

    /// What planes need of the light.
    #[inline(always)]
    pub fn grid(&self) -> LightGrid {
        LightGrid::from_frame(self.light(), self.frame(), self.along_u.w)
    }

    /// What orders triangles and receivers.
    #[inline(always)]
    pub fn codes(&self) -> CodeFrame {
        CodeFrame {
            center: [self.codes.x, self.codes.y],
            inverse_spread: self.codes.z,
            scale: [self.scale.x, self.scale.y],
        }
    }

    /// Layout of the hierarchy.
    #[inline(always)]
    pub fn levels(&self) -> Levels {
        let [a, b, c] = self.levels;
        Levels::from_words([a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y])
    }
}

/// [`Params`] of a light whose samples are jittered.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct JitteredParams {
    /// The light and the pass.
    pub params: Params,
    /// Where the light's samples lie.
    pub pattern: Pattern,
}

/// [`Params`] of a caster before a light with an area.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CasterParams {
    /// The light and the pass.
    pub params: Params,
    /// Width, height and wraps of the texture; word of the first texel.
    texture: UVec4,
    /// Whether the mesh is closed; its plane offset; its layers; 0.
    casting: UVec4,
    /// Where the light's samples lie; zero where they are regular.
    pub pattern: Pattern,
}

impl CasterParams {
    /// What the passes of a caster share.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(params: Params, caster: &PackedCaster<'_>) -> Self {
        let [width, height, wrap] = caster.texture.to_words();
        let Casting { closed, offset } = caster.casting;
        Self {
            pattern: Pattern::of(&params.light()),
            params,
            texture: UVec4::new(width, height, wrap, caster.layout().texels),
            casting: UVec4::new(u32::from(closed), offset, caster.layers.bits(), 0),
        }
    }

    /// The same for one pass.
    #[must_use]
    pub fn with_pass(self, pass: &PassParams) -> Self {
        Self { params: self.params.with_pass(pass), ..self }
    }

    /// How its surface is packed.
    #[inline(always)]
    pub fn layout(&self) -> SurfaceLayout {
        SurfaceLayout { texture: TextureSize::from_words(self.texture), texels: self.texture.w }
    }

    /// How its triangles cast.
    #[inline(always)]
    pub fn casting(&self) -> Casting {
        Casting { closed: self.casting.x != 0, offset: self.casting.y }
    }

    /// Its layers.
    #[inline(always)]
    pub fn layers(&self) -> Layers {
        Layers::from_bits(self.casting.z)
    }
}

/// [`Params`] of one frame of a light without extent.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PunctualParams {
    /// The frame, as that of a light with one sample, and the pass.
    pub params: Params,
    /// Where the light is, and one more than its face; or the vector towards it, and 0.
    light: IVec4,
}

impl PunctualParams {
    /// What the passes of a frame, `face < light.faces()`, share.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(light: &Punctual, face: u32, codes: &CodeFrame, levels: &Levels) -> Self {
        let frame = *light.frame(face).light_frame();
        let sample = LatticeLight {
            origin: frame.origin,
            step_u: IVec3::ZERO,
            step_v: IVec3::ZERO,
            rows: 1,
            columns: 1,
            jitter: Jitter::NONE,
        };
        let (at, face) = match (light.position(), light.towards()) {
            (None, Some(towards)) => (towards, 0),
            (position, _) => (position.unwrap_or(IVec3::ZERO), face as i32 + 1),
        };
        Self { params: Params::of(&sample, &frame, 0.0, codes, levels), light: at.extend(face) }
    }

    /// The same for one pass.
    #[must_use]
    pub fn with_pass(self, pass: &PassParams) -> Self {
        Self { params: self.params.with_pass(pass), ..self }
    }

    /// The light.
    #[inline(always)]
    pub fn light(&self) -> Punctual {
        if self.light.w > 0 { Punctual::at_sample(three(self.light)) } else { Punctual::from_afar(three(self.light)) }
    }

    /// Which of the light's frames it is.
    #[inline(always)]
    pub fn face(&self) -> u32 {
        if self.light.w > 0 { self.light.w as u32 - 1 } else { 0 }
    }

    /// The frame.
    #[inline(always)]
    pub fn frame(&self) -> PunctualFrame {
        PunctualFrame::of(self.params.frame(), self.light.w <= 0)
    }
}

/// [`Params`] of a light that is a cloud of samples.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct CloudParams {
    /// The pass, and a light of as many samples; else nothing.
    pub params: Params,
    /// The lowest corner of the box around the samples; directions on a side of the table of planes, 0 without one.
    low: IVec4,
    /// The highest; distances of the table.
    high: IVec4,
    /// How far samples lie from the middle; 0.
    radius: Vec4,
    /// What orders triangles and receivers.
    curve: IVec4,
}

impl CloudParams {
    /// What the passes of a cloud of `samples` samples share. The curve decides the order of triangles and receivers, never a bit.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(extent: &CloudExtent, samples: u32, curve: &BoxCurve, levels: &Levels) -> Self {
        let light = LatticeLight {
            origin: IVec3::ZERO,
            step_u: IVec3::ZERO,
            step_v: IVec3::ZERO,
            rows: samples,
            columns: 1,
            jitter: Jitter::NONE,
        };
        let frame = LightFrame {
            origin: IVec3::ZERO,
            along_u: Vec3::ZERO,
            along_v: Vec3::ZERO,
            normal: Vec3::ZERO,
            last_column: 0.0,
            last_row: 0.0,
            scale: [0.0; 2],
        };
        let codes = CodeFrame { center: [0.0; 2], inverse_spread: 0.0, scale: [0.0; 2] };
        let [low, high] = extent.bounds();
        Self {
            params: Params::of(&light, &frame, 0.0, &codes, levels),
            low: low.extend(0),
            high: high.extend(0),
            radius: Vec4::new(extent.radius(), 0.0, 0.0, 0.0),
            curve: IVec3::from_array(curve.low).extend(curve.shift as i32),
        }
    }

    /// The same for one pass.
    #[must_use]
    pub fn with_pass(self, pass: &PassParams) -> Self {
        Self { params: self.params.with_pass(pass), ..self }
    }

    /// The same, by a table of planes.
    #[cfg(not(target_arch = "spirv"))]
    #[must_use]
    pub fn with_table(mut self, size: TableSize) -> Self {
        (self.low.w, self.high.w) = (size.directions as i32, size.distances as i32);
        self
    }

    /// Size of the table of planes.
    #[inline(always)]
    pub fn table(&self) -> TableSize {
        TableSize { directions: self.low.w as u32, distances: self.high.w as u32 }
    }

    /// Samples of the cloud.
    #[inline(always)]
    pub fn samples(&self) -> u32 {
        self.params.light().sample_count()
    }

    /// Where they lie.
    #[inline(always)]
    pub fn extent(&self) -> CloudExtent {
        CloudExtent::new([three(self.low), three(self.high)], self.radius.x)
    }

    /// What orders triangles and receivers.
    #[inline(always)]
    pub fn curve(&self) -> BoxCurve {
        BoxCurve { low: [self.curve.x, self.curve.y, self.curve.z], shift: self.curve.w as u32 }
    }
}

#[inline(always)]
fn three(v: IVec4) -> IVec3 {
    IVec3::new(v.x, v.y, v.z)
}

// The starts of all levels and their number fit the three vectors.
const _: () = assert!(MAX_LEVELS + 2 <= 12);
