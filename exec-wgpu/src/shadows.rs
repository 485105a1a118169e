//! Soft shadows within an engine's frame: recorded into its encoder, over its buffers and textures.

use std::{collections::HashMap, mem::offset_of};

use umbra4_core::{
    AnyLight, Lattice, Plan, Precision, SceneFacts,
    gbuffer::ViewParams,
    glam::IVec3,
    half::halved,
    kernel::{
        Kernel,
        dispatch::{MaskLayout, Reduction},
        pack_light::whole,
        status::Status,
    },
    mesh::MeshParams,
    params::{Params, PassParams},
    snap::SnapParams,
    stage::Stage,
};
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, CommandEncoderDescriptor, Device, DeviceType, Queue,
};

use crate::{
    GpuError, Loading,
    checks::{self, CheckedEmission, CheckedMesh, CheckedView},
    error::guarded,
    frame::{Emitted, Frame, History, Image, Lamp, Light, LightImage, Resolution},
    image::VisibilityFormat,
    light_run::{LightRun, RunLight, all_faces},
    readback::{copy, read},
    recorder::{Recorder, Resource},
    scratch::Scratch,
    stages::{BLOCK, Buffers, Ends, FACINGS, SMALLEST_SLICE, block, mask_layout, narrowest},
    timing::{Timing, seconds},
    usable,
};

/// Distance of rows that are copied to a texture, in words of 32 bits: what wgpu asks for.
const PITCH: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4;

/// Soft shadows for an engine. It keeps what frames have in common: pipelines, buffers, bind groups.
///
/// A frame is recorded, not run: nothing waits and nothing is read back. Over resources that earlier frames had too, and
/// with no more elements than they had, a frame makes no object on the device. Frames have to be submitted in the order in
/// which they were recorded.
///
/// ```no_run
/// use umbra4_core::{AreaLight, Bounds, Lift, gbuffer::NormalEncoding, glam::DVec3};
/// use umbra4_wgpu::{Frame, GBuffer, Image, Light, Mesh, Resolution, SoftShadows, Surface, Vertices, wgpu};
///
/// fn frame(
///     shadows: &mut SoftShadows, // SoftShadows::new(&device)?, once
///     encoder: &mut wgpu::CommandEncoder,
///     vertices: &wgpu::Buffer, // 32 bytes a vertex, position first
///     [positions, normals]: [&wgpu::TextureView; 2],
///     visibility: &wgpu::Texture,
/// ) -> Result<(), Box<dyn std::error::Error>> {
///     let lamp = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?;
///     let lift = Lift::f32_positions_off_by(4).ok_or("1 to 8 units")?;
///     shadows.record(encoder, &Frame {
///         bounds: Bounds { min: DVec3::splat(-10.0), max: DVec3::splat(10.0) },
///         meshes: &[Mesh {
///             vertices: Vertices { buffer: vertices, offset: 0, stride: 32, count: 300 },
///             indices: None,
///             instances: None,
///         }],
///         gbuffer: GBuffer {
///             surface: Surface::Positions { view: positions, lift },
///             normals,
///             encoding: NormalEncoding::Signed,
///             triangles: None,
///             sample: 0,
///         },
///         resolution: Resolution::Full,
///         lights: &[Light { visibility: Some(Image::Texture { texture: visibility, layer: 0 }), ..Light::new(lamp) }],
///     })?;
///     Ok(())
/// }
/// ```
#[derive(Debug)]
pub struct SoftShadows {
    device: Device,
    slice: u32,
    precision: Precision,
    recorder: Recorder,
    scratch: Scratch,
    tables: HashMap<(u32, VisibilityFormat), Buffer>,
    status: Buffer,
    snapped: Option<Snapped>,
}

/// The last frame on the lattice, until the next is recorded: the very integers for which its masks are exact. Vertices and receivers are i32 × 3, with
/// `i32::MIN` in the place of those that take no part; triangles are u32 × 3, vertex indices.
#[derive(Clone, Debug)]
pub struct Snapped {
    /// Its vertices; the usage has `COPY_SRC`.
    pub vertices: Buffer,
    /// How many there are.
    pub vertex_count: u32,
    /// Its triangles; the usage has `COPY_SRC`.
    pub triangles: Buffer,
    /// How many there are.
    pub triangle_count: u32,
    /// Its receivers, pixels (at [`Resolution::Half`], blocks) row by row; the usage has `COPY_SRC`.
    pub receivers: Buffer,
    /// How many there are.
    pub receiver_count: u32,
    /// Which way its receivers face, words of [`umbra4_core::Facing`], where a light asks for that; the usage has `COPY_SRC`.
    pub facings: Option<Buffer>,
    /// Its lights, those that ask for something.
    pub lights: Vec<AnyLight>,
}

impl SoftShadows {
    /// Exact shadows on the engine's device, which needs no feature.
    ///
    /// # Errors
    /// [`GpuError::Unusable`] where the device cannot be used: it is one of GL, for which the kernels do not compile, or a limit of it is too small.
    pub fn new(device: &Device) -> Result<Self, GpuError> {
        Self::with(device, Precision::Exact, Loading::Checked)
    }

    /// With another precision, or another way to load kernels.
    ///
    /// # Errors
    /// As [`SoftShadows::new`]; the device cannot load kernels so.
    pub fn with(device: &Device, precision: Precision, loading: Loading) -> Result<Self, GpuError> {
        usable::check(&device.adapter_info(), &device.limits())?;
        loading.check(device)?;
        let status = guarded(device, "allocates a buffer", || {
            device.create_buffer(&BufferDescriptor {
                label: Some("umbra4 status"),
                size: size_of::<Status>() as u64,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })?;
        Ok(Self {
            device: device.clone(),
            // Nobody waits for a frame to see whether it was stopped: software drivers get the least at once.
            slice: if device.adapter_info().device_type == DeviceType::Cpu { SMALLEST_SLICE } else { u32::MAX },
            precision,
            recorder: Recorder::new(device, loading, None),
            scratch: Scratch::default(),
            tables: HashMap::new(),
            status,
            snapped: None,
        })
    }

    /// Takes the time of every stage, where the device has timestamps ([`wgpu::Features::TIMESTAMP_QUERY`]). Stages no
    /// longer overlap then.
    ///
    /// # Errors
    /// The device is out of memory.
    pub fn time_stages(&mut self) -> Result<(), GpuError> {
        self.recorder.set_timing(Timing::new(&self.device)?);
        Ok(())
    }

    /// Counts of what the last frame could not use, [`Status`]. The buffer's usage has `COPY_SRC`.
    pub fn status(&self) -> &Buffer {
        &self.status
    }

    /// The last frame on the lattice, once there was one.
    pub fn snapped(&self) -> Option<&Snapped> {
        self.snapped.as_ref()
    }

    /// Waits for the frame that was recorded last, which has to have been submitted, and tells the seconds of its stages. For tools: an engine does
    /// not wait. Empty where [`SoftShadows::time_stages`] was not called, or the device has no timestamps.
    ///
    /// # Errors
    /// The device fails.
    pub fn stage_times(&self, queue: &Queue) -> Result<Vec<(&'static str, f64)>, GpuError> {
        let Some(timing) = self.recorder.timing().filter(|timing| !timing.stages().is_empty()) else {
            return Ok(Vec::new());
        };
        let staging = guarded(&self.device, "reads timestamps", || {
            let mut encoder = self.device.create_command_encoder(&CommandEncoderDescriptor { label: Some("umbra4") });
            let size = timing.stages().len() * size_of::<[u64; 2]>();
            let staging = copy(&self.device, &mut encoder, timing.ticks(), 0, size as u64);
            queue.submit([encoder.finish()]);
            staging
        })?;
        Ok(seconds(timing.stages(), &read::<u64>(&self.device, &staging)?, queue.get_timestamp_period()))
    }

    /// Records the shadows of a frame. Nothing is recorded where an error is returned.
    ///
    /// # Errors
    /// Bounds that no lattice holds; a light that the lattice is too coarse for; a buffer or texture that cannot be used,
    /// by name; a view that wgpu refuses; more than the device can hold.
    pub fn record(&mut self, encoder: &mut CommandEncoder, frame: &Frame<'_>) -> Result<(), GpuError> {
        let snapped = self.collect(frame)?;
        self.recorder.encode(encoder)?;
        self.snapped = snapped;
        Ok(())
    }

    /// Makes everything that a frame like this needs, kernels above all, and records nothing: so that the first frame does not
    /// have to wait for them.
    ///
    /// # Errors
    /// As [`SoftShadows::record`].
    pub fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), GpuError> {
        self.collect(frame)?;
        self.recorder.prepare()
    }

    /// Collects the steps of a frame. Returns what it will have on the lattice.
    fn collect(&mut self, frame: &Frame<'_>) -> Result<Option<Snapped>, GpuError> {
        let lattice = Lattice::covering(frame.bounds)?;
        let corners = [frame.bounds.min, frame.bounds.max].map(|corner| lattice.snap_f64(corner));
        // A lattice around zero has parameters, and it holds the bounds that it was made for.
        let (Some(snap), [Ok(low), Ok(high)]) = (lattice.snap_params(), corners) else { return Ok(None) };
        let checked = Checked::new(&self.device, snap, &lattice, frame)?;
        self.recorder.restart();
        self.collect_lights(frame, &checked, [low, high])
    }

    fn collect_lights(
        &mut self,
        frame: &Frame<'_>,
        checked: &Checked,
        bounds: [IVec3; 2],
    ) -> Result<Option<Snapped>, GpuError> {
        self.recorder.set_stage(Stage::SnapVertices.info().name);
        self.recorder.clear(&self.status, 0);
        let planned: Vec<(MaskLayout, SceneFacts)> =
            checked.lights.iter().enumerate().map(|(k, own)| self.plan(frame, checked, own, k == 0)).collect();
        // All grow before any is used: what says that a thread was stopped is of the whole frame.
        for (layout, facts) in &planned {
            self.fit(facts, layout, checked)?;
        }
        let facings = self.facings(frame, checked)?;
        let mut snapped = None;
        for (k, (own, (layout, facts))) in checked.lights.iter().zip(planned).enumerate() {
            let light = &frame.lights[own.index];
            let mut buffers = self.fit(&facts, &layout, checked)?;
            let weighed = self.weighed(checked, own)?;
            buffers.emission = own.emission.as_ref().map(|own| own.weights.clone()).zip(weighed).map(Into::into);
            if k == 0 {
                self.recorder.clear(&buffers.masks, buffers.stopped());
            }
            let pixels = match checked.thinned {
                true => Some(self.scratch.fit::<[i32; 3]>(&self.device, "pixels", u64::from(checked.pixels))?),
                false => None,
            };
            let mut ends = Engine {
                checked,
                status: &self.status,
                pixels: pixels.as_ref(),
                facings: &facings,
                masks: light.masks,
                stride: layout.stride,
            };
            let run = LightRun { light: RunLight::Any(own.light), faces: all_faces(&own.light), facts, layout, bounds };
            run.record(&mut self.recorder, &buffers, &mut ends)?;
            if let (Some(image), Some(format), Some(lit)) = (&light.visibility, own.format, &buffers.lit) {
                let lit = match &pixels {
                    Some(pixels) => {
                        let upsampled =
                            self.scratch.fit::<u32>(&self.device, "upsampled", u64::from(checked.pixels))?;
                        let bound = [pixels.into(), (&buffers.receivers).into(), lit.into(), (&upsampled).into()];
                        self.upsample(Kernel::Upsample, checked, &bound)?;
                        upsampled
                    }
                    None => lit.clone(),
                };
                let history = light.history.as_ref();
                self.pack(image, format, own.light.sample_count(), checked.view.size, &lit, history)?;
            }
            if let (Some(emitted), Some([_, sums])) = (&light.emission, &buffers.emission) {
                let thinned = pixels.as_ref().map(|pixels| [pixels, &buffers.receivers]);
                self.give_light(checked, own, emitted, thinned, sums)?;
            }
            if self.slice == SMALLEST_SLICE {
                let place = offset_of!(Status, stopped) as u64;
                let size = size_of::<u32>() as u64;
                self.recorder.copy((&buffers.masks, buffers.stopped()), (&self.status, place), size);
            }
            snapped = Some(checked.snapped(&buffers, facings.first()));
        }
        Ok(snapped)
    }

    /// How a light is resolved, and what has to run for it; the first brings the frame to the lattice.
    fn plan(&self, frame: &Frame<'_>, checked: &Checked, own: &CheckedLight, first: bool) -> (MaskLayout, SceneFacts) {
        let light = &frame.lights[own.index];
        let reduction = Reduction::of(light.visibility.is_some(), light.emission.is_some());
        let layout = own.layout(self.precision, self.slice);
        let layout = MaskLayout { reduction: reduction.unwrap_or_default(), ..layout };
        let facts = SceneFacts {
            new_vertices: if first { checked.vertices } else { 0 },
            triangles: checked.triangles,
            receivers: checked.receivers,
            world_receivers: first,
            visibility: reduction.is_some(),
            facing: light.only_facing,
            block: block(&layout, BLOCK),
            jittered: matches!(own.light, AnyLight::Area(light) if light.jitter.is_some()),
            punctual: matches!(own.light, AnyLight::Punctual(_)),
            ..SceneFacts::default()
        };
        (layout, facts)
    }

    fn fit(&mut self, facts: &SceneFacts, layout: &MaskLayout, checked: &Checked) -> Result<Buffers, GpuError> {
        Buffers::fit(&mut self.scratch, &self.device, &Plan::new(*facts), layout, checked.vertices)
    }

    /// Where facings go, if a light asks for them: those of receivers, and those of pixels where these are more.
    fn facings(&mut self, frame: &Frame<'_>, checked: &Checked) -> Result<Vec<Buffer>, GpuError> {
        let mut facings = Vec::new();
        if checked.lights.iter().any(|own| frame.lights[own.index].only_facing) {
            // The name is that of the buffer that kernels are bound to.
            facings.push(self.scratch.fit::<u32>(&self.device, FACINGS, u64::from(checked.receivers))?);
            if checked.thinned {
                facings.push(self.scratch.fit::<u32>(&self.device, "facings of pixels", u64::from(checked.pixels))?);
            }
        }
        Ok(facings)
    }

    /// All pixels' from those of the blocks that have a receiver. `bound` is what the kernel is bound to.
    fn upsample(&mut self, kernel: Kernel, checked: &Checked, bound: &[Resource]) -> Result<(), GpuError> {
        let params = ViewParams { count: checked.pixels, ..checked.view.params };
        self.recorder.set_stage(Stage::Reduce.info().name);
        self.recorder.add(kernel, params, bound)
    }

    /// Where the sums of weights of a light's receivers go, where it has an emission: to the engine, unless there is more to be done.
    fn weighed(&mut self, checked: &Checked, own: &CheckedLight) -> Result<Option<Resource>, GpuError> {
        match &own.emission {
            None => Ok(None),
            Some(CheckedEmission { sums: Some(sums), .. }) if !checked.thinned => Ok(Some(sums.clone())),
            Some(_) => {
                let count = u64::from(checked.receivers);
                Ok(Some((&self.scratch.fit::<[u32; 3]>(&self.device, "weighed light", count)?).into()))
            }
        }
    }

    /// Sums of the weights of receivers to where the engine wants them. `thinned`: pixels, and the receivers that stand for them.
    fn give_light(
        &mut self,
        checked: &Checked,
        own: &CheckedLight,
        emitted: &Emitted<'_>,
        thinned: Option<[&Buffer; 2]>,
        weighed: &Resource,
    ) -> Result<(), GpuError> {
        let mut light = weighed.clone();
        if let Some([pixels, receivers]) = thinned {
            light = match own.emission.as_ref().and_then(|emission| emission.sums.clone()) {
                Some(sums) => sums,
                None => {
                    let count = u64::from(checked.pixels);
                    (&self.scratch.fit::<[u32; 3]>(&self.device, "upsampled light", count)?).into()
                }
            };
            let bound = [pixels.into(), receivers.into(), weighed.clone(), light.clone()];
            self.upsample(Kernel::UpsampleLight, checked, &bound)?;
        }
        let format = own.emission.as_ref().and_then(|emission| emission.format);
        let (LightImage::Texture { texture, layer }, Some(format)) = (&emitted.light, format) else { return Ok(()) };
        let [width, height] = checked.view.size;
        let pitch = format.words(width).next_multiple_of(PITCH);
        let words = u64::from(pitch) * u64::from(height);
        let target = self.scratch.fit::<u32>(&self.device, "image of light", words)?;
        let pass = PassParams {
            count: pitch * height,
            width,
            pitch,
            texels: format.channels_a_word(),
            elements: whole(own.light.sample_count()),
            ..PassParams::default()
        };
        let params = <Params as bytemuck::Zeroable>::zeroed();
        self.recorder.set_stage(Stage::Reduce.info().name);
        self.recorder.add(Kernel::PackLight, params.with_pass(&pass), &[light, (&target).into()])?;
        self.recorder.copy_image(&target, 4 * pitch, texture, *layer);
        Ok(())
    }

    /// Lit counts, or their sums over frames, to an image.
    fn pack(
        &mut self,
        image: &Image<'_>,
        format: VisibilityFormat,
        samples: u32,
        [width, height]: [u32; 2],
        lit: &Buffer,
        history: Option<&History<'_>>,
    ) -> Result<(), GpuError> {
        let words = format.words(width);
        let (pitch, target) = match image {
            Image::Texture { .. } => {
                let pitch = words.next_multiple_of(PITCH);
                let count = u64::from(pitch) * u64::from(height);
                (pitch, self.scratch.fit::<u32>(&self.device, "image", count)?)
            }
            Image::Buffer { buffer, .. } => (words, (*buffer).clone()),
        };
        let image_part = Resource::first::<u32>(&target, u64::from(pitch) * u64::from(height));
        let pass =
            PassParams { count: pitch * height, width, pitch, texels: format.pixels_a_word(), ..PassParams::default() };
        let params = <Params as bytemuck::Zeroable>::zeroed();
        self.recorder.set_stage(Stage::Reduce.info().name);
        match history {
            None => {
                let table = self.table(samples, format)?;
                let bound = [lit.into(), (&table).into(), image_part];
                self.recorder.add(Kernel::Pack, params.with_pass(&pass), &bound)?;
            }
            Some(History { sums, frames }) => {
                let pass = PassParams { first: *frames, elements: (frames + 1) * samples, ..pass };
                let bound = [lit.into(), (*sums).into(), image_part];
                self.recorder.add(Kernel::Accumulate, params.with_pass(&pass), &bound)?;
            }
        }
        if let Image::Texture { texture, layer } = image {
            self.recorder.copy_image(&target, 4 * pitch, texture, *layer);
        }
        Ok(())
    }

    /// The visibility of every lit count, made once.
    fn table(&mut self, samples: u32, format: VisibilityFormat) -> Result<Buffer, GpuError> {
        if let Some(table) = self.tables.get(&(samples, format)) {
            return Ok(table.clone());
        }
        let entries = format.table(samples);
        let buffer = guarded(&self.device, "allocates a table", || {
            self.device.create_buffer(&BufferDescriptor {
                label: Some("umbra4 visibility table"),
                size: size_of_val(&entries[..]) as u64,
                usage: BufferUsages::STORAGE,
                mapped_at_creation: true,
            })
        })?;
        let lost = |reason: String| GpuError::Lost { doing: "maps a table", reason };
        buffer
            .get_mapped_range_mut(..)
            .map_err(|error| lost(error.to_string()))?
            .copy_from_slice(bytemuck::cast_slice(&entries));
        buffer.unmap();
        self.tables.insert((samples, format), buffer.clone());
        Ok(buffer)
    }
}

/// A frame, checked.
struct Checked {
    meshes: Vec<CheckedMesh>,
    vertices: u32,
    triangles: u32,
    view: CheckedView,
    pixels: u32,
    /// Whether receivers are fewer than pixels.
    thinned: bool,
    receivers: u32,
    lights: Vec<CheckedLight>,
}

struct CheckedLight {
    /// Its place among the frame's lights.
    index: usize,
    light: AnyLight,
    format: Option<VisibilityFormat>,
    emission: Option<CheckedEmission>,
}

/// A light on the lattice.
fn snapped(lamp: &Lamp, lattice: &Lattice, index: usize) -> Result<AnyLight, GpuError> {
    let punctual = |source| GpuError::PunctualLight { index, source };
    Ok(match lamp {
        Lamp::Area { light, lift } => {
            light.snap(lattice, *lift).map_err(|source| GpuError::Light { index, source })?.into()
        }
        Lamp::Point(light) => light.snap(lattice).map_err(punctual)?.into(),
        Lamp::Directional(light) => light.snap().map_err(punctual)?.into(),
    })
}

impl CheckedLight {
    fn new(
        device: &Device,
        lattice: &Lattice,
        index: usize,
        light: &Light<'_>,
        view: &CheckedView,
        pixels: u32,
    ) -> Result<Self, GpuError> {
        let field = checks::light_field(index);
        let snapped = snapped(&light.lamp, lattice, index)?;
        let image = light.visibility.as_ref();
        let own = Self {
            index,
            light: snapped,
            format: image.map(|image| checks::image(device, image, view.size, &field)).transpose()?,
            emission: match &light.emission {
                Some(emitted) => Some(checks::emission(device, emitted, &snapped, view.size, &field)?),
                None => None,
            },
        };
        let all = view.size.map(u64::from);
        checks::history(light, snapped.sample_count(), all[0] * all[1], &field)?;
        if let Some(masks) = light.masks {
            let stride = own.layout(Precision::Exact, u32::MAX).stride;
            checks::masks(masks, u64::from(pixels), stride, &field)?;
        }
        Ok(own)
    }

    fn layout(&self, precision: Precision, slice: u32) -> MaskLayout {
        mask_layout(&self.light, narrowest(&self.light), precision, false, slice)
    }
}

impl Checked {
    fn new(device: &Device, snap: SnapParams, lattice: &Lattice, frame: &Frame<'_>) -> Result<Self, GpuError> {
        let meshes = checks::meshes(device, snap, frame.meshes)?;
        let mut view = checks::gbuffer(snap, &frame.gbuffer)?;
        let pixels = checks::pixels(view.size)?;
        let thinned = frame.resolution == Resolution::Half;
        let receivers = if thinned { checks::pixels(view.size.map(halved))? } else { pixels };
        // A light that asks for nothing may be anything.
        let lights = frame.lights.iter().enumerate().filter(|(_, light)| checks::asks(light));
        let lights = lights
            .map(|(index, light)| CheckedLight::new(device, lattice, index, light, &view, receivers))
            .collect::<Result<_, _>>()?;
        let last = meshes.last();
        let triangles = last.map_or(0, |mesh| mesh.params.triangle_base + mesh.all_triangles);
        view.params.triangles = triangles;
        Ok(Self {
            vertices: last.map_or(0, |mesh| mesh.params.vertex_base + mesh.all_vertices),
            triangles,
            meshes,
            view,
            pixels,
            thinned,
            receivers,
            lights,
        })
    }

    fn snapped(&self, buffers: &Buffers, facings: Option<&Buffer>) -> Snapped {
        Snapped {
            vertices: buffers.vertices.clone(),
            vertex_count: self.vertices,
            triangles: buffers.triangles.clone(),
            triangle_count: self.triangles,
            receivers: buffers.receivers.clone(),
            receiver_count: self.receivers,
            facings: facings.cloned(),
            lights: self.lights.iter().map(|own| own.light).collect(),
        }
    }
}

/// An engine's ends of a frame.
struct Engine<'a> {
    checked: &'a Checked,
    status: &'a Buffer,
    /// Receivers of all pixels, where those that are resolved are fewer.
    pixels: Option<&'a Buffer>,
    /// Of receivers, and of all pixels where these are more; none where no light asks for them.
    facings: &'a [Buffer],
    masks: Option<&'a Buffer>,
    stride: u32,
}

impl Engine<'_> {
    /// Facings of `count` pixels from `first` on.
    fn face_pixels(&self, recorder: &mut Recorder, facings: &Buffer, first: u32, count: u32) -> Result<(), GpuError> {
        let view = &self.checked.view;
        let kernel = if view.multisampled { Kernel::FacePixelSamples } else { Kernel::FacePixels };
        recorder.add(kernel, ViewParams { first, count, ..view.params }, &[view.normals.clone(), facings.into()])
    }

    /// Receivers of `count` pixels from `first` on.
    fn snap_pixels(
        &self,
        recorder: &mut Recorder,
        buffers: &Buffers,
        receivers: &Buffer,
        first: u32,
        count: u32,
    ) -> Result<(), GpuError> {
        let view = &self.checked.view;
        let kernel = match (view.depths, view.multisampled, view.triangles.is_some()) {
            (false, false, false) => Kernel::SnapPositions,
            (false, true, false) => Kernel::SnapPositionSamples,
            (true, false, false) => Kernel::SnapDepths,
            (true, true, false) => Kernel::SnapDepthSamples,
            (false, false, true) => Kernel::SnapOwnedPositions,
            (false, true, true) => Kernel::SnapOwnedPositionSamples,
            (true, false, true) => Kernel::SnapOwnedDepths,
            (true, true, true) => Kernel::SnapOwnedDepthSamples,
        };
        let params = ViewParams { first, count, ..view.params };
        let (surface, normals, status) = (view.surface.clone(), view.normals.clone(), self.status.into());
        match view.triangles.clone() {
            None => recorder.add(kernel, params, &[surface, normals, receivers.into(), status]),
            Some(triangles) => {
                let (vertices, corners) = ((&buffers.vertices).into(), (&buffers.triangles).into());
                let bound = [surface, normals, triangles, vertices, corners, receivers.into(), status];
                recorder.add(kernel, params, &bound)
            }
        }
    }
}

impl Ends for Engine<'_> {
    fn snap_vertices(&mut self, recorder: &mut Recorder, buffers: &Buffers) -> Result<(), GpuError> {
        let snapped = Resource::from(&buffers.vertices);
        let triangles = Resource::from(&buffers.triangles);
        let status = Resource::from(self.status);
        for mesh in &self.checked.meshes {
            let vertices = mesh.vertices.clone();
            let by_vertex = MeshParams { count: mesh.all_vertices, ..mesh.params };
            let by_triangle = MeshParams { count: mesh.all_triangles, ..mesh.params };
            match mesh.instances.clone() {
                None => recorder.add(Kernel::SnapVertices, by_vertex, &[vertices, snapped.clone(), status.clone()])?,
                Some(instances) => recorder.add(
                    Kernel::SnapInstances,
                    by_vertex,
                    &[vertices, instances, snapped.clone(), status.clone()],
                )?,
            }
            match mesh.indices.clone() {
                None => recorder.add(Kernel::NumberTriangles, by_triangle, std::slice::from_ref(&triangles))?,
                Some(indices) => {
                    recorder.add(Kernel::IndexTriangles, by_triangle, &[indices, triangles.clone(), status.clone()])?
                }
            }
        }
        Ok(())
    }

    fn snap_receivers(
        &mut self,
        recorder: &mut Recorder,
        buffers: &Buffers,
        first: u32,
        count: u32,
    ) -> Result<(), GpuError> {
        let Some(pixels) = self.pixels else {
            if let Some(facings) = self.facings.first() {
                self.face_pixels(recorder, facings, first, count)?;
            }
            return self.snap_pixels(recorder, buffers, &buffers.receivers, first, count);
        };
        if first > 0 {
            return Ok(());
        }
        // All of them at once: rows of blocks need two rows of pixels.
        self.snap_pixels(recorder, buffers, pixels, 0, self.checked.pixels)?;
        let params = ViewParams { count: self.checked.receivers, ..self.checked.view.params };
        recorder.add(Kernel::Thin, params, &[pixels.into(), (&buffers.receivers).into()])?;
        if let [thinned, all] = self.facings {
            self.face_pixels(recorder, all, 0, self.checked.pixels)?;
            recorder.add(Kernel::ThinFacings, params, &[pixels.into(), all.into(), thinned.into()])?;
        }
        Ok(())
    }

    fn block(&mut self, recorder: &mut Recorder, buffers: &Buffers, first: u32, count: u32) -> Result<(), GpuError> {
        if let Some(masks) = self.masks {
            let bytes = |pixels: u32| 4 * u64::from(pixels) * u64::from(self.stride);
            recorder.copy((&buffers.masks, 0), (masks, bytes(first)), bytes(count));
        }
        Ok(())
    }
}
