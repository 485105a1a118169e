//! The executor that users hold: options, and the ways to ask.

use std::sync::{Mutex, PoisonError};

use umbra4_core::{
    Counts, IndexKind, LatticeLight, MaskWord, Plan, SceneFacts,
    edge_plane::LightGrid,
    glam::IVec3,
    kernel::{Kernel, resolve::stride},
    order::CodeFrame,
    params::Params,
};

use crate::{
    Gpu, GpuError, LatticeScene, Statistics,
    pipelines::Pipelines,
    recorder::Recorder,
    run::{Results, Run, Wanted},
};

/// Exact or plain f32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every bit is certified, or decided in integers.
    #[default]
    Exact,
    /// Plain f32: no certification, no fallback. Bits may differ from device to device.
    Fast,
}

/// Bytes that the masks of a block take, at most.
const MASK_BYTES: u64 = 64 << 20;
/// Receivers of a block, at most.
const BLOCK: u32 = 1 << 20;
/// Largest number of elements of one kind.
const MOST: usize = (u32::MAX - 1) as usize;

/// Runs the stages on a GPU.
///
/// ```no_run
/// use umbra4_core::{glam::{DVec3, Vec3}, AreaLight, Bounds, Lattice, Lift};
/// use umbra4_wgpu::{Choice, Gpu, LatticeScene, WgpuExecutor};
///
/// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?; // X × Z = −Y: shines down
/// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
/// let corners = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
/// let vertices = [lattice.snap(corners[0])?, lattice.snap(corners[1])?, lattice.snap(corners[2])?];
/// let receivers = [lattice.snap(Vec3::ZERO)?, lattice.snap(Vec3::new(3.0, 0.0, 0.0))?];
///
/// let executor = WgpuExecutor::new(Gpu::open(&Choice::Hardware)?);
/// let scene = LatticeScene { vertices: &vertices, triangles: &[[0, 1, 2]] };
/// let visibility = executor.visibility(&scene, &light.snap(&lattice, Lift::NONE)?, &receivers)?;
/// assert!(visibility[0] < 0.5 && visibility[1] == 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct WgpuExecutor {
    gpu: Gpu,
    precision: Precision,
    pipelines: Mutex<Pipelines>,
    block: u32,
}

impl WgpuExecutor {
    /// An exact executor. Kernels are compiled when they are first needed.
    pub fn new(gpu: Gpu) -> Self {
        Self { gpu, precision: Precision::Exact, pipelines: Mutex::default(), block: BLOCK }
    }

    /// Chooses the precision.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Works on at most `receivers` receivers at once, at least on one: bounds the memory on the device.
    #[must_use]
    pub fn with_block(mut self, receivers: u32) -> Self {
        self.block = receivers.max(1);
        self
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The masks of all receivers, receiver-major, a word per row of the light.
    ///
    /// # Errors
    /// The word is too narrow for the light; a buffer is larger than the device can bind; the device fails.
    pub fn masks<W: MaskWord>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: &[IVec3],
    ) -> Result<Vec<W>, GpuError> {
        Ok(self.run::<W>(scene, light, receivers, Ask { masks: true, ..Ask::default() })?.0)
    }

    /// As [`WgpuExecutor::masks`], and counts what was done for them, which takes a little longer.
    ///
    /// # Errors
    /// As [`WgpuExecutor::masks`].
    pub fn masks_counted<W: MaskWord>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: &[IVec3],
    ) -> Result<(Vec<W>, Statistics), GpuError> {
        let ask = Ask { masks: true, counts: true, visibility: false };
        let (masks, results) = self.run::<W>(scene, light, receivers, ask)?;
        Ok((masks, statistics(&results)))
    }

    /// The fraction of lit samples of every receiver, in `0.0..=1.0`. Masks do not leave the device.
    ///
    /// # Errors
    /// As [`WgpuExecutor::masks`]; the word is chosen to fit the light.
    pub fn visibility(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: &[IVec3],
    ) -> Result<Vec<f32>, GpuError> {
        let ask = Ask { visibility: true, ..Ask::default() };
        let results = match light.columns {
            0..=16 => self.run::<u16>(scene, light, receivers, ask)?.1,
            17..=32 => self.run::<u32>(scene, light, receivers, ask)?.1,
            _ => self.run::<u64>(scene, light, receivers, ask)?.1,
        };
        Ok(results.visibility)
    }

    fn run<W: MaskWord>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: &[IVec3],
        ask: Ask,
    ) -> Result<(Vec<W>, Results), GpuError> {
        if light.columns > W::BITS {
            return Err(GpuError::WordTooNarrow { columns: light.columns, bits: W::BITS });
        }
        let counts =
            [("vertices", scene.vertices.len()), ("triangles", scene.triangles.len()), ("receivers", receivers.len())];
        for (field, count) in counts {
            if count > MOST {
                return Err(GpuError::TooMany { field, count, most: MOST });
            }
        }
        let wanted = Wanted {
            resolve: resolve_kernel(W::BITS, self.precision, ask.counts),
            stride: stride(light.rows, W::BITS),
            masks: ask.masks,
            counts: ask.counts,
        };
        let in_memory = MASK_BYTES / (4 * u64::from(wanted.stride));
        let plan = Plan::new(SceneFacts {
            new_vertices: 0,
            triangles: scene.triangles.len() as u32,
            receivers: receivers.len() as u32,
            world_receivers: false,
            visibility: ask.visibility,
            block: self.block.min(in_memory as u32),
            index: IndexKind::Hierarchy,
        });
        let grid = LightGrid::new(*light);
        let params = Params::new(&grid, &CodeFrame::new(grid.frame.scale, [0.0; 2], 1.0), plan.levels());
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        let recorder = Recorder::new(&self.gpu.device, &self.gpu.queue, &mut pipelines, params);
        let results = Run::new(&plan, wanted, recorder, scene, light, receivers)?.finish()?;
        Ok((words(&results.masks, light.rows as usize, wanted.stride as usize), results))
    }
}

#[derive(Clone, Copy, Default)]
struct Ask {
    masks: bool,
    counts: bool,
    visibility: bool,
}

const fn resolve_kernel(bits: u32, precision: Precision, counted: bool) -> Kernel {
    match (bits, precision, counted) {
        (..=32, Precision::Exact, false) => Kernel::Resolve32Exact,
        (..=32, Precision::Exact, true) => Kernel::Resolve32ExactCounted,
        (..=32, Precision::Fast, false) => Kernel::Resolve32Fast,
        (..=32, Precision::Fast, true) => Kernel::Resolve32FastCounted,
        (_, Precision::Exact, false) => Kernel::Resolve64Exact,
        (_, Precision::Exact, true) => Kernel::Resolve64ExactCounted,
        (_, Precision::Fast, false) => Kernel::Resolve64Fast,
        (_, Precision::Fast, true) => Kernel::Resolve64FastCounted,
    }
}

/// The words of all masks: each receiver's start at a word of 32 bits.
fn words<W: MaskWord>(masks: &[u32], rows: usize, stride: usize) -> Vec<W> {
    let mut out = Vec::with_capacity(masks.len() / stride.max(1) * rows);
    for mask in masks.chunks_exact(stride) {
        // On a big-endian host the halves of words would have to be swapped; wgpu runs on none.
        out.extend_from_slice(&bytemuck::pod_collect_to_vec::<u32, W>(mask)[..rows]);
    }
    out
}

fn statistics(results: &Results) -> Statistics {
    let mut counts = Counts::default();
    for [tested, kept, relevant, fallbacks] in &results.counts {
        counts = counts.plus(Counts {
            pairs_tested: u64::from(*tested),
            pairs_kept: u64::from(*kept),
            pairs_relevant: u64::from(*relevant),
            fallbacks: u64::from(*fallbacks),
        });
    }
    Statistics { counts }
}
