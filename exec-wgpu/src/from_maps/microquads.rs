//! Microquad soft shadow mapping on the GPU: the map, its pyramid, and the masks or areas of all receivers.
//!
//! Where the map looks, and the table of half-spaces, are made on the host, in f64.

use std::time::{Duration, Instant};

use umbra4_core::{
    LatticeLight, MaskWord,
    hierarchy::Levels,
    kernel::{
        Kernel,
        resolve::{STOPPED, stride},
    },
    params::PassParams,
    stage::{Stage, reduce},
};
use umbra4_maps::{
    kernel::{
        BUILD_PYRAMID, DRAW_MAP, GATHER, MapKernel,
        microquads::{ADD, ROWS},
    },
    microquad::{
        DrawnMap, Footprint, MicroquadError, MicroquadOptions, fit, gather,
        half_spaces::{table_length, write_table},
        params::{MapPass, MicroquadParams},
    },
    pyramid::{self, Node},
};
use wgpu::Buffer;

use crate::{
    GpuError, LatticeReceivers, LatticeScene, Statistics, WgpuExecutor, checks,
    error::guarded,
    executor::words,
    readback::read,
    recorder::{Recorder, Resource},
    scratch::Scratch,
    stages::{FACINGS, narrowest, receivers_of},
    submit::{Wanted, submit},
    told::Told,
};

/// A light's shadow map, as it was drawn.
pub type ShadowMap = DrawnMap<Vec<u32>, Vec<Node>>;

/// Tiles of its search area that a receiver looks at in one dispatch, at first, on software drivers: lavapipe ends loops after 65,535 rounds. Of one
/// tile, no thread needs as many.
const SOFTWARE_TILES: u32 = 64;

/// What is asked of every receiver.
#[derive(Clone, Copy, Debug)]
enum Ask<'a> {
    /// Its mask, with rows in words of so many bits, added to words of 32 bits where there are some.
    Masks { bits: u32, onto: Option<&'a [u32]> },
    /// How many samples it sees.
    Lit,
    /// The area that is hidden from it.
    Areas,
}

/// A light, and what a map of it is drawn from.
struct Shadows<'a> {
    options: &'a MicroquadOptions,
    scene: &'a LatticeScene<'a>,
    light: &'a LatticeLight,
    receivers: LatticeReceivers<'a>,
    params: MicroquadParams,
    beyond: u64,
    table: Vec<u32>,
    /// What the host took for all that.
    time: Duration,
}

/// What a map is drawn from, and what it is.
struct MapBuffers {
    vertices: Buffer,
    triangles: Buffer,
    map: Buffer,
    nodes: Buffer,
    table: Buffer,
}

impl WgpuExecutor {
    /// The shadow map that [`WgpuExecutor::microquad_masks`] would use, back on the host: where it looks, and what it shows.
    ///
    /// # Errors
    /// Options that are refused: [`MicroquadOptions::check`]; a buffer that is larger than the device can bind; the device fails.
    pub fn shadow_map<'a>(
        &self,
        options: &MicroquadOptions,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(ShadowMap, Statistics), GpuError> {
        let shadows = Shadows::fitted(options, scene, light, receivers.into())?;
        let size = shadows.params.frame().size();
        let mut stages = Vec::new();
        let ((texels, nodes), time) = self.with_work(|recorder, scratch| {
            let buffers = self.draw(&shadows, recorder, scratch)?;
            let (texels, nodes) = (u64::from(size * size), u64::from(pyramid::start(size, pyramid::levels(size))));
            let wanted: [Wanted<'_>; 2] = [
                (&buffers.map, 0, texels * size_of::<u32>() as u64),
                (&buffers.nodes, 0, nodes * size_of::<Node>() as u64),
            ];
            let device = &self.gpu.device;
            match &submit(&self.gpu, recorder, &wanted, &mut stages)?[..] {
                [texels, nodes] => Ok((read::<u32>(device, texels)?, read::<Node>(device, nodes)?)),
                _ => Ok((Vec::new(), Vec::new())),
            }
        })?;
        let time = shadows.time + time;
        let map = ShadowMap::new(shadows.params, texels, nodes, shadows.table, shadows.beyond);
        Ok((map, Statistics { time, counts: None, stages }))
    }

    /// Approximate masks of all receivers, from micro-occluders: bits as those of [`WgpuExecutor::masks`], and where they go. The same
    /// as those of the CPU executor.
    ///
    /// ```no_run
    /// use umbra4_core::{glam::{DVec3, Vec3}, AreaLight, Bounds, Lattice, Lift};
    /// use umbra4_wgpu::{Choice, Gpu, LatticeScene, WgpuExecutor, maps::microquad::MicroquadOptions};
    ///
    /// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?; // X × Z = −Y: shines down
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let corners = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let vertices = [lattice.snap(corners[0])?, lattice.snap(corners[1])?, lattice.snap(corners[2])?];
    /// let receivers = [lattice.snap(Vec3::ZERO)?, lattice.snap(Vec3::new(3.0, 0.0, 0.0))?];
    ///
    /// let executor = WgpuExecutor::new(Gpu::open(&Choice::Hardware)?);
    /// let scene = LatticeScene { vertices: &vertices, triangles: &[[0, 1, 2]] };
    /// let (options, light) = (MicroquadOptions::default(), light.snap(&lattice, Lift::NONE)?);
    /// let (masks, _) = executor.microquad_masks::<u16>(&options, &scene, &light, &receivers)?;
    /// let blocked = |receiver: &[u16]| receiver.iter().map(|row| row.count_ones()).sum::<u32>();
    /// assert!(blocked(&masks[..16]) > 128 && blocked(&masks[16..]) == 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`WgpuExecutor::shadow_map`]; areas, of which there are no masks; a word that is too narrow.
    pub fn microquad_masks<'a, W: MaskWord>(
        &self,
        options: &MicroquadOptions,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<W>, Statistics), GpuError> {
        let ask = Ask::Masks { bits: W::BITS, onto: None };
        let (masks, statistics) = self.run_microquads(options, scene, light, receivers.into(), ask)?;
        Ok((words(&masks, light.rows as usize, stride(light.rows, W::BITS) as usize), statistics))
    }

    /// Adds the bits of [`WgpuExecutor::microquad_masks`] to masks that are there, receiver-major, a word per row: those of the exact system for
    /// other occluders, for example.
    ///
    /// # Errors
    /// As [`WgpuExecutor::microquad_masks`]; masks of other receivers, or of another light.
    pub fn add_microquad_masks<'a, W: MaskWord>(
        &self,
        options: &MicroquadOptions,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
        masks: &mut [W],
    ) -> Result<Statistics, GpuError> {
        let (receivers, rows) = (receivers.into(), light.rows as usize);
        if masks.len() != receivers.points.len() * rows {
            let receivers = receivers.points.len();
            return Err(GpuError::MaskCount { words: masks.len(), receivers, rows: light.rows });
        }
        let stride = stride(light.rows, W::BITS) as usize;
        // Every receiver's begin at a word of 32 bits.
        let mut onto = vec![0_u32; receivers.points.len() * stride];
        for (own, rows) in onto.chunks_exact_mut(stride).zip(masks.chunks_exact(rows)) {
            let bytes: &[u8] = bytemuck::cast_slice(rows);
            bytemuck::cast_slice_mut::<u32, u8>(own)[..bytes.len()].copy_from_slice(bytes);
        }
        let ask = Ask::Masks { bits: W::BITS, onto: Some(&onto) };
        let (added, statistics) = self.run_microquads(options, scene, light, receivers, ask)?;
        masks.copy_from_slice(&words::<W>(&added, rows, stride));
        Ok(statistics)
    }

    /// The approximate fraction of the light that every receiver sees, from micro-occluders: of its samples, or, by
    /// [`Footprint::Area`], of its area. In `0.0..=1.0`. Masks do not leave the device.
    ///
    /// # Errors
    /// As [`WgpuExecutor::shadow_map`].
    pub fn microquad_visibility<'a>(
        &self,
        options: &MicroquadOptions,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<f32>, Statistics), GpuError> {
        let receivers = receivers.into();
        if options.footprint == Footprint::Area {
            let shadows = Shadows::fitted(options, scene, light, receivers)?;
            let params = shadows.params;
            let (areas, statistics) = self.gather(&shadows, Ask::Areas)?;
            let seen = |area: &u32| gather::visibility(params.arithmetic(), &params, f32::from_bits(*area));
            return Ok((areas.iter().map(seen).collect(), statistics));
        }
        let (lit, statistics) = self.run_microquads(options, scene, light, receivers, Ask::Lit)?;
        let samples = light.sample_count();
        Ok((lit.iter().map(|&lit| reduce::visibility(lit, samples)).collect(), statistics))
    }

    /// Masks, or what they are reduced to.
    fn run_microquads(
        &self,
        options: &MicroquadOptions,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: LatticeReceivers<'_>,
        ask: Ask<'_>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        if let Ask::Masks { bits, .. } = ask
            && light.columns > bits
        {
            return Err(GpuError::WordTooNarrow { columns: light.columns, bits });
        }
        if options.footprint == Footprint::Area {
            return Err(MicroquadError::NoMasks.into());
        }
        self.gather(&Shadows::fitted(options, scene, light, receivers)?, ask)
    }

    /// Brings a scene to the device, and records how its map is drawn.
    fn draw(
        &self,
        shadows: &Shadows<'_>,
        recorder: &mut Recorder,
        scratch: &mut Scratch,
    ) -> Result<MapBuffers, GpuError> {
        let Shadows { scene, params, table, .. } = shadows;
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let size = params.frame().size();
        let nodes = pyramid::start(size, pyramid::levels(size));
        let buffers = MapBuffers {
            vertices: scratch.fit::<[i32; 3]>(device, "vertices", scene.vertices.len() as u64)?,
            triangles: scratch.fit::<[u32; 3]>(device, "triangles", scene.triangles.len() as u64)?,
            map: scratch.fit::<u32>(device, "shadow map", u64::from(size * size))?,
            nodes: scratch.fit::<Node>(device, "pyramid", u64::from(nodes))?,
            table: scratch.fit::<u32>(device, "half-spaces", table.len() as u64)?,
        };
        guarded(device, "uploads a scene", || {
            queue.write_buffer(&buffers.vertices, 0, bytemuck::cast_slice(scene.vertices));
            queue.write_buffer(&buffers.triangles, 0, bytemuck::cast_slice(scene.triangles));
            queue.write_buffer(&buffers.table, 0, bytemuck::cast_slice(table));
        })?;
        recorder.restart();
        recorder.clear(&buffers.map, 0);
        recorder.set_stage(DRAW_MAP);
        let (triangles, parts) = (scene.triangles.len() as u32, size.div_ceil(ROWS));
        // Ids have 32 bits.
        let batch = u32::MAX / parts;
        let drawn = [
            Resource::first::<[i32; 3]>(&buffers.vertices, scene.vertices.len() as u64),
            (&buffers.triangles).into(),
            (&buffers.map).into(),
        ];
        for first in (0..triangles).step_by(batch as usize) {
            let count = batch.min(triangles - first) * parts;
            let pass = MapPass { count, number: parts, first, ..MapPass::default() };
            recorder.add(MapKernel::DrawMap, params.with_pass(&pass), &drawn)?;
        }
        recorder.set_stage(BUILD_PYRAMID);
        let [map, nodes]: [Resource; 2] = [(&buffers.map).into(), (&buffers.nodes).into()];
        for level in 0..pyramid::levels(size) {
            let count = pyramid::start(size, level + 1) - pyramid::start(size, level);
            let told = params.with_pass(&MapPass { count, number: level, ..MapPass::default() });
            match level {
                0 => recorder.add(MapKernel::BuildTiles, told, &[map.clone(), nodes.clone()])?,
                _ => recorder.add(MapKernel::BuildParents, told, std::slice::from_ref(&nodes))?,
            }
        }
        Ok(buffers)
    }

    /// Draws the map and gathers what is asked for, in words of 32 bits.
    fn gather(&self, shadows: &Shadows<'_>, ask: Ask<'_>) -> Result<(Vec<u32>, Statistics), GpuError> {
        let tiles = pyramid::start(shadows.params.frame().size(), 1);
        let mut slice = if self.gpu.software { SOFTWARE_TILES.min(tiles) } else { tiles };
        let mut stages = Vec::new();
        let (out, time) = self.with_work(|recorder, scratch| {
            let buffers = self.draw(shadows, recorder, scratch)?;
            submit(&self.gpu, recorder, &[], &mut stages)?;
            loop {
                match self.gather_slices(shadows, ask, slice, recorder, scratch, &buffers, &mut stages)? {
                    Some(out) => return Ok(out),
                    // The driver ended threads before they were done: they get less to do.
                    None if slice > 1 => slice = (slice / 4).max(1),
                    None => return Err(GpuError::Stopped { adapter: self.gpu.name.clone() }),
                }
            }
        })?;
        Ok((out, Statistics { time: shadows.time + time, counts: None, stages }))
    }

    /// In dispatches of `slice` tiles; `None` where the driver has stopped a thread.
    #[allow(clippy::too_many_arguments, reason = "what a run keeps, and what it is of")]
    fn gather_slices(
        &self,
        shadows: &Shadows<'_>,
        ask: Ask<'_>,
        slice: u32,
        recorder: &mut Recorder,
        scratch: &mut Scratch,
        buffers: &MapBuffers,
        stages: &mut Vec<(&'static str, f64)>,
    ) -> Result<Option<Vec<u32>>, GpuError> {
        let Shadows { options, light, receivers, params, .. } = shadows;
        let LatticeReceivers { points, facings, .. } = *receivers;
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let bits = match ask {
            Ask::Masks { bits, .. } => bits,
            _ => narrowest(&(**light).into()),
        };
        let stride = if let Ask::Areas = ask { 1 } else { stride(light.rows, bits) };
        let block = receivers_of(stride, self.block).min(points.len() as u32).max(1);
        let on_device = scratch.fit::<[i32; 3]>(device, "receivers", points.len() as u64)?;
        // Whoever has none is bound to one that nobody writes: nothing is known.
        let facing = if facings.is_empty() { "no facings" } else { FACINGS };
        let facing = scratch.fit::<u32>(device, facing, facings.len() as u64)?;
        let masks = scratch.fit::<u32>(device, "masks", u64::from(block) * u64::from(stride) + 1)?;
        let lit = scratch.fit::<u32>(device, "lit counts", u64::from(block))?;
        guarded(device, "uploads receivers", || {
            queue.write_buffer(&on_device, 0, bytemuck::cast_slice(points));
            queue.write_buffer(&facing, 0, bytemuck::cast_slice(facings));
        })?;
        let (kernel, by_table) = gather_kernel(options.footprint, bits);
        let mut bound = vec![
            (&on_device).into(),
            (&facing).into(),
            (&buffers.map).into(),
            (&buffers.nodes).into(),
            (&masks).into(),
        ];
        if by_table {
            bound.push((&buffers.table).into());
        }
        let word = size_of::<u32>() as u64;
        let stopped = masks.size() - word;
        let tiles = pyramid::start(params.frame().size(), 1);
        let mut out = Vec::with_capacity(points.len() * if let Ask::Lit = ask { 1 } else { stride as usize });
        for first in (0..points.len() as u32).step_by(block as usize) {
            let count = block.min(points.len() as u32 - first);
            let onto = match ask {
                Ask::Masks { onto: Some(onto), .. } => {
                    onto.get((first * stride) as usize..((first + count) * stride) as usize)
                }
                _ => None,
            };
            if let Some(onto) = onto {
                guarded(device, "uploads masks", || queue.write_buffer(&masks, 0, bytemuck::cast_slice(onto)))?;
            }
            recorder.clear(&masks, stopped);
            recorder.set_stage(GATHER);
            for tile in (0..tiles).step_by(slice as usize) {
                let number = if onto.is_some() || tile > 0 { ADD } else { 0 };
                let pass = MapPass { count, number, first, stride, tile, tiles: slice };
                recorder.add(kernel, params.with_pass(&pass), &bound)?;
            }
            let result = if let Ask::Lit = ask {
                recorder.set_stage(Stage::Reduce.info().name);
                let pass = PassParams { count, stride, ..PassParams::default() };
                // Nothing is ordered.
                let told = Told::area(light, [light.origin; 2], &Levels::default()).plain(&pass);
                recorder.add(Kernel::Reduce, told, &[(&masks).into(), (&lit).into()])?;
                (&lit, 0, u64::from(count) * word)
            } else {
                (&masks, 0, u64::from(count) * u64::from(stride) * word)
            };
            let copies = submit(&self.gpu, recorder, &[result, (&masks, stopped, word)], stages)?;
            if let [result, stopped] = &copies[..] {
                if read::<u32>(device, stopped)?.contains(&STOPPED) {
                    return Ok(None);
                }
                out.extend(read::<u32>(device, result)?);
            }
        }
        Ok(Some(out))
    }
}

impl<'a> Shadows<'a> {
    /// Checks what is given, and finds out where the map looks.
    fn fitted(
        options: &'a MicroquadOptions,
        scene: &'a LatticeScene<'a>,
        light: &'a LatticeLight,
        receivers: LatticeReceivers<'a>,
    ) -> Result<Self, GpuError> {
        options.check(light)?;
        checks::counts_of(scene, receivers)?;
        let start = Instant::now();
        let corner = |index: u32| scene.vertices.get(index as usize).copied();
        let corners = scene.triangles.iter().filter_map(|[a, b, c]| Some([corner(*a)?, corner(*b)?, corner(*c)?]));
        let (params, beyond) = fit::fitted(options, light, receivers.points.iter().copied(), corners);
        let mut table = Vec::new();
        if let Footprint::Table(fineness) = options.footprint {
            table.resize(table_length(light, fineness), 0);
            write_table(light, fineness, &mut table);
        }
        Ok(Self { options, scene, light, receivers, params, beyond, table, time: start.elapsed() })
    }
}

/// The kernel of a footprint, for rows in words of `bits` bits; and whether it reads a table.
const fn gather_kernel(footprint: Footprint, bits: u32) -> (MapKernel, bool) {
    match (footprint, bits) {
        (Footprint::Rows, ..=32) => (MapKernel::GatherRows32, false),
        (Footprint::Rows, _) => (MapKernel::GatherRows64, false),
        (Footprint::Table(_), ..=32) => (MapKernel::GatherTable32, true),
        (Footprint::Table(_), _) => (MapKernel::GatherTable64, true),
        (Footprint::Rectangles, ..=32) => (MapKernel::GatherRectangles32, false),
        (Footprint::Rectangles, _) => (MapKernel::GatherRectangles64, false),
        (Footprint::Area, _) => (MapKernel::GatherAreas, false),
    }
}
