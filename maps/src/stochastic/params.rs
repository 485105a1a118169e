//! What a kernel of this map is told, besides its buffers: one structure of 32-bit scalars, so that its layout is the same in Rust,
//! SPIR-V and WGSL.

use glam::{IVec3, Vec2, Vec3};
use umbra4_core::{Jitter, LatticeLight, params::Dispatched};

#[cfg(not(target_arch = "spirv"))]
use crate::stochastic::options::{Basis, Centers, Footprint, StochasticOptions};
use crate::stochastic::{
    area_frame::AreaFrame,
    float::{larger, within},
    thin_lens::ThinLens,
};

/// Set in [`LensParams::flags`]: footprints are rectangles.
pub const RECTANGULAR: u32 = 1;
/// Set in [`LensParams::flags`]: the middles of footprints are where hits project to.
pub const PROJECTED: u32 = 2;
/// Set in [`LensParams::flags`]: every second sample is skipped, each way.
pub const INTERLEAVED: u32 = 4;
/// Set in [`LensParams::flags`]: levels are smoothed as they are resolved.
pub const SMOOTHED: u32 = 8;
/// Set in [`LensParams::flags`]: tiles that nobody looks at are left out.
pub const ACTIVE_TILES: u32 = 16;

/// A light, its map, one filter plane and one of its levels.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LensParams {
    /// See [`AreaFrame::origin`]: the light's own.
    pub origin: [i32; 3],
    /// Texels along each side of the finest level.
    pub size: u32,
    /// See [`AreaFrame::axes`].
    pub axes: [[f32; 3]; 3],
    /// a and b of the origin, negated.
    pub center: [f32; 2],
    /// See [`ThinLens::first`].
    pub first: [f32; 2],
    /// See [`ThinLens::scale`].
    pub scale: [f32; 2],
    /// Both half-extents of a footprint over the larger one.
    pub aspect: [f32; 2],
    /// Inverse depth in focus.
    pub focus: f32,
    /// Least depth of a hit.
    pub near: f32,
    /// Depth of the farthest receiver: rays that hit nothing end there.
    pub far: f32,
    /// Depth at which z is −1.
    pub zero: f32,
    /// What z grows by a unit of depth.
    pub depth_scale: f32,
    /// c of an EVSM, or 0.
    pub exponent: f32,
    /// Of z.
    pub least_deviation: f32,
    /// Texels.
    pub least_radius: f32,
    /// Texels to which a closest occluder may raise a radius; 0: none is looked for.
    pub widest_raise: f32,
    /// [`RECTANGULAR`] and others.
    pub flags: u32,
    /// Where samples look from.
    pub seed: u32,
    /// Triangles of the scene.
    pub triangles: u32,
    /// Levels of a plane.
    pub levels: u32,
    /// Inverse depths of the plane, and of the planes before and behind it; of what is missing, its own.
    pub plane: f32,
    /// See [`LensParams::plane`]: the one nearer to the light.
    pub before: f32,
    /// See [`LensParams::plane`]: the one farther from the light.
    pub behind: f32,
    /// The light's step between columns, lattice.
    pub step_u: [i32; 3],
    /// Its step between rows.
    pub step_v: [i32; 3],
    /// Its rows and columns.
    pub samples: [u32; 2],
    /// 1 where its samples are jittered, else 0.
    pub jittered: u32,
    /// The level that a kernel works on.
    pub level: u32,
    /// Ids there are: `0..count`.
    pub count: u32,
    /// Ids of a row of workgroups: those of a dispatch are laid out in rows, since a row is limited.
    pub row: u32,
}

/// Depths among receivers, light frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// Of the nearest, above 0.
    pub near: f32,
    /// Of the farthest.
    pub far: f32,
}

impl LensParams {
    /// What all kernels of a map share. `options` have been checked.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(
        light: &LatticeLight,
        lens: &ThinLens,
        depths: DepthRange,
        options: &StochasticOptions,
        triangles: u32,
    ) -> Self {
        let (frame, widest) = (AreaFrame::new(light), lens.scale.max_element());
        let flag = |set: bool, flag: u32| if set { flag } else { 0 };
        let exponent = match options.basis {
            Basis::Variance => 0.0,
            Basis::Exponential { exponent } => exponent,
        };
        // Occluders before all receivers are the same to all: what lies nearer than a little before them is as dark.
        let before = 0.1 * depths.near.max(depths.far - depths.near);
        let zero = (depths.near - before).max(0.0);
        Self {
            origin: frame.origin.to_array(),
            size: options.size,
            axes: frame.axes.map(|axis| axis.to_array()),
            center: [frame.center.x, frame.center.y],
            first: lens.first.to_array(),
            scale: lens.scale.to_array(),
            aspect: (lens.scale / widest).to_array(),
            focus: lens.focus,
            near: depths.far * NEAREST,
            far: depths.far,
            zero,
            depth_scale: 2.0 / (depths.far - zero),
            exponent,
            least_deviation: options.least_deviation,
            least_radius: options.least_radius,
            widest_raise: options.widest_raise,
            flags: flag(options.footprint == Footprint::Rectangle, RECTANGULAR)
                | flag(options.centers == Centers::Projected, PROJECTED)
                | flag(options.interleaved, INTERLEAVED)
                | flag(options.smoothed, SMOOTHED)
                | flag(options.active_tiles, ACTIVE_TILES),
            seed: options.seed,
            triangles,
            levels: options.levels(),
            plane: lens.focus,
            before: lens.focus,
            behind: lens.focus,
            step_u: light.step_u.to_array(),
            step_v: light.step_v.to_array(),
            samples: [light.rows, light.columns],
            jittered: light.jitter.is_some().into(),
            level: 0,
            count: 0,
            row: 0,
        }
    }

    /// The same for plane `index` of `planes`, inverse depths from the nearest to the farthest.
    #[cfg(not(target_arch = "spirv"))]
    #[must_use]
    pub fn with_plane(mut self, planes: &[f32], index: usize) -> Self {
        let own = planes.get(index).copied().unwrap_or(self.focus);
        self.plane = own;
        self.before = index.checked_sub(1).and_then(|before| planes.get(before)).copied().unwrap_or(own);
        self.behind = planes.get(index + 1).copied().unwrap_or(own);
        self
    }

    /// The same for one level.
    #[inline(always)]
    #[must_use]
    pub fn with_level(self, level: u32) -> Self {
        Self { level, ..self }
    }

    /// The same for the ids `0..count`.
    #[must_use]
    pub fn with_count(self, count: u32) -> Self {
        Self { count, ..self }
    }

    /// The light, but for its pattern of jitter: what tells who faces away from it.
    #[inline(always)]
    pub fn light(&self) -> LatticeLight {
        LatticeLight {
            origin: whole(self.origin),
            step_u: whole(self.step_u),
            step_v: whole(self.step_v),
            rows: self.samples[0],
            columns: self.samples[1],
            jitter: if self.jittered != 0 { Jitter::pattern(0) } else { Jitter::NONE },
        }
    }

    /// Whether samples move to reach the plane: in focus they are there already.
    #[inline(always)]
    pub fn moves(&self) -> bool {
        self.plane != self.focus
    }

    /// The light's frame.
    #[inline(always)]
    pub fn place(&self, point: IVec3) -> Vec3 {
        let [u, v, n] = self.axes;
        let frame = AreaFrame {
            origin: whole(self.origin),
            axes: [three(u), three(v), three(n)],
            center: Vec3::new(self.center[0], self.center[1], 0.0),
            half_edges: [1.0; 2],
        };
        frame.place(point)
    }

    /// The camera.
    #[inline(always)]
    pub fn lens(&self) -> ThinLens {
        ThinLens {
            first: Vec2::new(self.first[0], self.first[1]),
            scale: Vec2::new(self.scale[0], self.scale[1]),
            focus: self.focus,
            size: self.size,
        }
    }

    /// Texels a unit of tangent along the axis that has more of them.
    #[inline(always)]
    pub fn widest_scale(&self) -> f32 {
        larger(self.scale[0], self.scale[1])
    }

    /// Depth as it is filtered, in −1..=1.
    #[inline(always)]
    pub fn z(&self, depth: f32) -> f32 {
        within((depth - self.zero) * self.depth_scale - 1.0, -1.0, 1.0)
    }

    /// Whether a flag is set.
    #[inline(always)]
    pub fn is(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// Texels along each side of a level.
    #[inline(always)]
    pub fn level_size(&self, level: u32) -> u32 {
        level_size(self.size, level)
    }

    /// Where a level starts among the texels of all.
    #[inline(always)]
    pub fn level_start(&self, level: u32) -> u32 {
        let (mut start, mut below) = (0, 0);
        while below < level {
            let size = self.level_size(below);
            start += size * size;
            below += 1;
        }
        start
    }
}

impl Dispatched for LensParams {
    #[inline(always)]
    fn count(&self) -> u32 {
        self.count
    }

    #[inline(always)]
    fn row(&self) -> u32 {
        self.row
    }

    fn with_row(self, row: u32) -> Self {
        Self { row, ..self }
    }
}

/// Nearest hit over farthest receiver: what lies closer to the light's plane is not seen.
#[cfg(not(target_arch = "spirv"))]
const NEAREST: f32 = 1.0 / 65536.0;

/// Texels along each side of a level: half as many as of the one below, rounded up.
#[inline(always)]
pub fn level_size(size: u32, level: u32) -> u32 {
    (size + (1 << level) - 1) >> level
}

#[inline(always)]
fn whole(v: [i32; 3]) -> IVec3 {
    IVec3::new(v[0], v[1], v[2])
}

#[inline(always)]
fn three(v: [f32; 3]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}
