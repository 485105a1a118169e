//! Stochastic soft shadow maps on the GPU: see [`umbra4_maps::stochastic`]. The host fits the map, and puts triangles in order; all else is the
//! device's.

use std::{collections::HashMap, time::Instant};

use umbra4_core::{Facing, LatticeLight, glam::IVec3};
use umbra4_maps::{
    curve::Curve,
    kernel::{MapKernel, MapSlot, stochastic::passes::passes},
    stochastic::{
        StochasticOptions,
        area_frame::AreaFrame,
        elementary::Elementary,
        fit::{Fit, unmapped},
        gather::Gathered,
        lookup::is_outside,
        params::LensParams,
        tiles::tiles_start,
        trace::{Corners, Node},
        tree::Tree,
    },
};
use wgpu::{Buffer, Device};

use crate::{
    GpuError, LatticeReceivers, LatticeScene, Statistics, WgpuExecutor, checks,
    error::guarded,
    executor::bounds,
    readback::read,
    recorder::{Recorder, Resource},
    scratch::Scratch,
    stages::FACINGS,
    submit::submit,
};

/// What a stochastic soft shadow map says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StochasticShadows {
    /// Of every receiver, the fraction of the light that it sees, about.
    pub visibility: Vec<f32>,
    /// Receivers before the light that the map does not cover: see [`StochasticOptions::reach`]. They are taken as lit.
    pub outside: usize,
    /// Depths of the filter planes, from the nearest to the farthest, in halves of the light's longer edge.
    pub planes: Vec<f32>,
    /// Times; there is nothing to count.
    pub statistics: Statistics,
}

impl WgpuExecutor {
    /// The fraction of the light that every receiver sees, by a stochastic soft shadow map (Liktor et al. 2015): approximate, and filtered. Devices round
    /// differently: unlike masks, this is not the same to the last bit everywhere. Give receivers their facings: those that face away are dark then, where
    /// the map alone leaks light through the surface that they lie on.
    ///
    /// ```no_run
    /// use umbra4_core::{glam::{DVec3, Vec3}, AreaLight, Bounds, Lattice, Lift};
    /// use umbra4_wgpu::{Choice, Gpu, LatticeScene, WgpuExecutor, maps::stochastic::StochasticOptions};
    ///
    /// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?; // X × Z = −Y: shines down
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let corners = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let vertices = [lattice.snap(corners[0])?, lattice.snap(corners[1])?, lattice.snap(corners[2])?];
    /// let receivers = [lattice.snap(Vec3::ZERO)?, lattice.snap(Vec3::new(3.0, 0.0, 0.0))?];
    ///
    /// let executor = WgpuExecutor::new(Gpu::open(&Choice::Hardware)?);
    /// let scene = LatticeScene { vertices: &vertices, triangles: &[[0, 1, 2]] };
    /// let light = light.snap(&lattice, Lift::NONE)?;
    /// let shadows = executor.stochastic_shadows(&scene, &light, &receivers, &StochasticOptions::default())?;
    /// assert!(shadows.visibility[0] < 0.5 && shadows.visibility[1] > 0.9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Options outside their ranges; more vertices, triangles or receivers than can be indexed; facings of some receivers only; a buffer that is larger
    /// than the device can bind; the device fails.
    pub fn stochastic_shadows<'a>(
        &self,
        scene: &LatticeScene<'_>,
        light: &LatticeLight,
        receivers: impl Into<LatticeReceivers<'a>>,
        options: &StochasticOptions,
    ) -> Result<StochasticShadows, GpuError> {
        options.check()?;
        let receivers = receivers.into();
        checks::counts_of(scene, receivers)?;
        let start = Instant::now();
        let Some(fit) = Fit::new(light, receivers.points, options)? else {
            return Ok(nothing_mapped(light, receivers));
        };
        // Triangles without a vertex are none.
        let triangles = if scene.vertices.is_empty() { &[] } else { scene.triangles };
        let scene = LatticeScene { triangles, ..*scene };
        let params = fit.params(options, triangles.len() as u32);
        let outside = receivers.points.iter().filter(|point| is_outside(**point, &params)).count();
        let planes = fit.planes().iter().map(|inverse| 1.0 / inverse).collect();

        let fitted = start.elapsed();
        let ((visibility, stages), time) = self.with_work(|recorder, scratch| {
            let buffers = Buffers::fit(scratch, &self.gpu.device, &params, &scene, receivers)?;
            self.upload(&buffers, &scene, receivers)?;
            record(recorder, &buffers, &params, fit.planes(), receivers)?;
            let (bytes, mut stages) = (receivers.points.len() as u64 * size_of::<f32>() as u64, Vec::new());
            let wanted = buffers.buffer(MapSlot::Visibility).map(|buffer| (buffer, 0, bytes));
            let copies = submit(&self.gpu, recorder, wanted.as_slice(), &mut stages)?;
            let copy = copies.first();
            let visibility = copy.map_or(Ok(Vec::new()), |copy| read::<f32>(&self.gpu.device, copy))?;
            Ok((visibility, stages))
        })?;
        let statistics = Statistics { time: fitted + time, counts: None, stages };
        Ok(StochasticShadows { visibility, outside, planes, statistics })
    }

    /// Brings the scene and the receivers to the device. No run is under way: each has waited for its results.
    fn upload(
        &self,
        buffers: &Buffers,
        scene: &LatticeScene<'_>,
        receivers: LatticeReceivers<'_>,
    ) -> Result<(), GpuError> {
        let order = ordered(scene);
        let parts: [(MapSlot, &[u8]); 5] = [
            (MapSlot::Vertices, bytemuck::cast_slice(scene.vertices)),
            (MapSlot::Triangles, bytemuck::cast_slice(scene.triangles)),
            (MapSlot::Order, bytemuck::cast_slice(&order)),
            (MapSlot::Receivers, bytemuck::cast_slice(receivers.points)),
            (MapSlot::Facings, bytemuck::cast_slice(receivers.facings)),
        ];
        guarded(&self.gpu.device, "uploads a scene", || {
            for (buffer, bytes) in parts.iter().filter_map(|(slot, bytes)| Some((buffers.buffer(*slot)?, *bytes))) {
                self.gpu.queue.write_buffer(buffer, 0, bytes);
            }
        })
    }
}

/// Records all passes.
fn record(
    recorder: &mut Recorder,
    buffers: &Buffers,
    params: &LensParams,
    planes: &[f32],
    receivers: LatticeReceivers<'_>,
) -> Result<(), GpuError> {
    recorder.restart();
    let unknown = receivers.facings.is_empty().then_some(MapSlot::Facings);
    for buffer in unknown.into_iter().chain([MapSlot::Sums]).filter_map(|slot| buffers.buffer(slot)) {
        recorder.clear(buffer, 0);
    }
    passes(params, planes, receivers.points.len() as u32, |kernel, params| {
        if let (MapKernel::MarkLookedAt, Some(tiles)) = (kernel, buffers.buffer(MapSlot::Tiles)) {
            recorder.clear(tiles, 0);
        }
        let info = kernel.info();
        recorder.set_stage(info.stage);
        let bound: Vec<Resource> = info.bound.iter().filter_map(|bound| buffers.0.get(&bound.slot).cloned()).collect();
        recorder.add(kernel, params, &bound)
    })
}

/// What kernels are bound to: of buffers that are kept from run to run, what this run asks for and no more, so that no kernel sees what another has left
/// beyond. The memory of one plane serves all.
struct Buffers(HashMap<MapSlot, Resource>);

impl Buffers {
    fn fit(
        scratch: &mut Scratch,
        device: &Device,
        params: &LensParams,
        scene: &LatticeScene<'_>,
        receivers: LatticeReceivers<'_>,
    ) -> Result<Self, GpuError> {
        let texels = u64::from(params.size) * u64::from(params.size);
        let all_levels = u64::from(params.level_start(params.levels));
        let tiles = u64::from(tiles_start(params, params.levels));
        let (triangles, points) = (scene.triangles.len() as u64, receivers.points.len() as u64);
        let mut own = HashMap::new();
        let mut fit = |slot, what, count: u64, size: usize| {
            // Nothing empty can be bound.
            let bytes = count.max(1) * size as u64;
            own.insert(slot, Resource::first::<u8>(&scratch.fit::<u8>(device, what, bytes)?, bytes));
            Ok::<_, GpuError>(())
        };
        fit(MapSlot::Vertices, "vertices", scene.vertices.len() as u64, size_of::<IVec3>())?;
        fit(MapSlot::Triangles, "triangles", triangles, size_of::<[u32; 3]>())?;
        fit(MapSlot::Order, "order of the map's triangles", triangles, size_of::<u32>())?;
        fit(MapSlot::Corners, "corners of the map's triangles", triangles, size_of::<Corners>())?;
        fit(
            MapSlot::Bounds,
            "boxes around the map's triangles",
            Tree::new(params.triangles).nodes().into(),
            size_of::<Node>(),
        )?;
        fit(MapSlot::Depths, "depths of the map", texels, size_of::<f32>())?;
        fit(MapSlot::Tiles, "tiles of a plane", tiles, size_of::<u32>())?;
        fit(MapSlot::Heads, "heads of lists", texels, size_of::<u32>())?;
        fit(MapSlot::Next, "lists of samples", texels, size_of::<u32>())?;
        fit(MapSlot::Samples, "samples of a plane", all_levels, size_of::<Elementary>())?;
        fit(MapSlot::Found, "radii of closest occluders", texels, size_of::<f32>())?;
        fit(MapSlot::Raised, "raised radii", texels, size_of::<f32>())?;
        fit(MapSlot::Widest, "widest radii of tiles", tiles, size_of::<f32>())?;
        fit(MapSlot::Gathered, "gathered moments", all_levels, size_of::<Gathered>())?;
        fit(MapSlot::Resolved, "resolved moments", all_levels, size_of::<Gathered>())?;
        fit(MapSlot::Receivers, "receivers", points, size_of::<IVec3>())?;
        fit(MapSlot::Facings, FACINGS, receivers.facings.len() as u64, size_of::<Facing>())?;
        fit(MapSlot::Sums, "moments of receivers", points, size_of::<Gathered>())?;
        fit(MapSlot::Visibility, "filtered visibility", points, size_of::<f32>())?;
        Ok(Self(own))
    }

    fn buffer(&self, slot: MapSlot) -> Option<&Buffer> {
        self.0.get(&slot).and_then(Resource::buffer)
    }
}

/// Where no receiver is within reach.
fn nothing_mapped(light: &LatticeLight, receivers: LatticeReceivers<'_>) -> StochasticShadows {
    let LatticeReceivers { points, facings, .. } = receivers;
    let frame = AreaFrame::new(light);
    let facing = |index: usize| facings.get(index).copied().unwrap_or(Facing::UNKNOWN);
    let visibility = points.iter().enumerate().map(|(index, p)| unmapped(light, &frame, *p, facing(index))).collect();
    let outside = points.iter().filter(|point| frame.place(**point).z > 0.0).count();
    StochasticShadows { visibility, outside, ..StochasticShadows::default() }
}

/// Triangles along a curve through space, those without a corner last: boxes around neighbours are small.
fn ordered(scene: &LatticeScene<'_>) -> Vec<u32> {
    let corner = |index: u32| scene.vertices.get(index as usize).copied();
    let curve = Curve::through(bounds(scene.vertices.iter()), 3);
    let place = |triangle: &[u32; 3]| match triangle.map(corner) {
        [Some(a), Some(b), Some(c)] => curve.place([a, b, c]),
        _ => u64::MAX,
    };
    let mut places: Vec<(u64, u32)> = scene.triangles.iter().map(place).zip(0..).collect();
    places.sort_unstable();
    places.into_iter().map(|(_, triangle)| triangle).collect()
}
