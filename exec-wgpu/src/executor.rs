//! The executor that users hold: options, and the ways to ask.

use std::{
    sync::{Mutex, PoisonError},
    time::Instant,
};

use umbra4_core::{
    Counts, IndexKind, LatticeLight, MaskWord, Plan, Precision, SceneFacts,
    edge_plane::LightGrid,
    glam::IVec3,
    kernel::{
        Kernel,
        resolve::{ReceiverCounts, stride},
    },
    order::CodeFrame,
    params::Params,
};

use crate::{
    Gpu, GpuError, LatticeScene, Statistics,
    pipelines::Pipelines,
    recorder::Recorder,
    run::{Results, Run, Wanted},
};

/// Bytes that the masks of a block take, at most.
const MASK_BYTES: u64 = 64 << 20;
/// Triangles that a dispatch of a software driver looks at: lavapipe ends loops after 65,535 rounds.
const SOFTWARE_SLICE: u32 = 256;
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
/// let (visibility, _) = executor.visibility(&scene, &light.snap(&lattice, Lift::NONE)?, &receivers)?;
/// assert!(visibility[0] < 0.5 && visibility[1] == 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct WgpuExecutor {
    gpu: Gpu,
    precision: Precision,
    counted: bool,
    pipelines: Mutex<Pipelines>,
    block: u32,
}

impl WgpuExecutor {
    /// An exact executor. Kernels are compiled when they are first needed.
    pub fn new(gpu: Gpu) -> Self {
        Self { gpu, precision: Precision::Exact, counted: false, pipelines: Mutex::default(), block: BLOCK }
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

    /// Counts pairs and fallbacks as well, which takes a little longer.
    #[must_use]
    pub fn with_counts(mut self, counted: bool) -> Self {
        self.counted = counted;
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
    ) -> Result<(Vec<W>, Statistics), GpuError> {
        let ask = Ask { masks: true, counts: self.counted, visibility: false };
        let (results, statistics) = self.run(scene, light, receivers, W::BITS, ask)?;
        Ok((words(&results.masks, light.rows as usize, stride(light.rows, W::BITS) as usize), statistics))
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
    ) -> Result<(Vec<f32>, Statistics), GpuError> {
        let ask = Ask { masks: false, counts: self.counted, visibility: true };
        let (results, statistics) = self.run(scene, light, receivers, narrowest(light), ask)?;
        Ok((results.visibility, statistics))
    }

    /// How many triangles block at least one sample of each receiver; for receivers in full shadow, how many were met
    /// until nothing was left to block. Shows where the work goes.
    ///
    /// # Errors
    /// As [`WgpuExecutor::visibility`].
    pub fn pairs_per_receiver(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: &[IVec3],
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let ask = Ask { masks: false, counts: true, visibility: false };
        let (results, statistics) = self.run(scene, light, receivers, narrowest(light), ask)?;
        Ok((results.counts.iter().map(|[_, _, relevant, _]| *relevant).collect(), statistics))
    }

    /// With rows in words of `bits` bits.
    fn run(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: &[IVec3],
        bits: u32,
        ask: Ask,
    ) -> Result<(Results, Statistics), GpuError> {
        if light.columns > bits {
            return Err(GpuError::WordTooNarrow { columns: light.columns, bits });
        }
        let counts =
            [("vertices", scene.vertices.len()), ("triangles", scene.triangles.len()), ("receivers", receivers.len())];
        for (field, count) in counts {
            if count > MOST {
                return Err(GpuError::TooMany { field, count, most: MOST });
            }
        }
        let wanted = Wanted {
            resolve: resolve_kernel(bits, self.precision, ask.counts),
            stride: stride(light.rows, bits),
            masks: ask.masks,
            counts: ask.counts,
            slice: if self.gpu.software { SOFTWARE_SLICE } else { u32::MAX },
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
        let compiling = pipelines.time();
        let start = Instant::now();
        let recorder = Recorder::new(&self.gpu.device, &self.gpu.queue, &mut pipelines, params);
        let results = Run::new(&plan, wanted, recorder, scene, light, receivers)?.finish()?;
        let time = start.elapsed().saturating_sub(pipelines.time() - compiling);
        let counts = ask.counts.then(|| sum(&results.counts));
        Ok((results, Statistics { time, counts }))
    }
}

/// Bits of the narrowest word that holds a row.
const fn narrowest(light: &LatticeLight) -> u32 {
    match light.columns {
        0..=16 => 16,
        17..=32 => 32,
        _ => 64,
    }
}

#[derive(Clone, Copy)]
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

fn sum(receivers: &[ReceiverCounts]) -> Counts {
    let mut counts = Counts::default();
    for [tested, kept, relevant, fallbacks] in receivers {
        counts = counts.plus(Counts {
            pairs_tested: u64::from(*tested),
            pairs_kept: u64::from(*kept),
            pairs_relevant: u64::from(*relevant),
            fallbacks: u64::from(*fallbacks),
        });
    }
    counts
}
