//! The rival on a GPU: a compute shader that shoots one shadow ray per light sample through a hierarchy of four children
//! a node. No ray tracing hardware, as umbra4 uses none.
//!
//! What is to its advantage: the hierarchy is built on the processor, carefully, and is not part of its time; receivers
//! come in 8×8 tiles of the image; 64 rays from one receiver to neighbouring samples share a workgroup.

mod bvh4;
mod clock;
mod device;

use std::time::Instant;

use umbra4::model::Model;
use umbra4_core::glam::Vec3;
use umbra4_wgpu::{
    Gpu, GpuError, Loading, guarded,
    wgpu::{
        self, BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
        BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType, BufferDescriptor, BufferUsages,
        CommandEncoderDescriptor, ComputePassDescriptor, ComputePipeline, ComputePipelineDescriptor,
        PipelineLayoutDescriptor, ShaderModule, ShaderModuleDescriptor, ShaderRuntimeChecks, ShaderSource,
        ShaderStages,
    },
};

use crate::problem::Problem;
use bvh4::{Bvh4, TRIANGLES_MOST};
use clock::Clock;
use device::{filled, read, wait, zeros};

/// Edge of the block of samples that a workgroup shoots at; as in the shader.
const BLOCK: u32 = 8;
/// Rays of a submission, so that it ends before a driver's watchdog fires.
const RAYS: u64 = 1 << 25;
/// The same for a software driver.
const SOFTWARE_RAYS: u64 = 1 << 20;

/// What is asked of the rival.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The number of lit samples of every receiver.
    Lit,
    /// Masks, receiver-major: words of 32 bits, as many a row as hold its columns.
    Masks,
}

/// What came out.
#[derive(Clone, Debug, Default)]
pub struct Traced {
    /// See [`Answer`].
    pub words: Vec<u32>,
    /// Seconds of tracing: on the device where it has timestamps, else as the host saw it.
    pub seconds: f64,
}

/// Parameters of a dispatch; laid out as `Work` in the shader.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Work {
    first: u32,
    end: u32,
    columns: u32,
    rows: u32,
    point: [f32; 3],
    words: u32,
    normal: [f32; 3],
    layer: u32,
}

/// A scene's hierarchy on a device, and the kernels that trace it.
pub struct GpuRival {
    gpu: Gpu,
    boxes: Buffer,
    children: Buffer,
    triangles: Buffer,
    layout: BindGroupLayout,
    lit: ComputePipeline,
    masks: ComputePipeline,
    /// Seconds of building the hierarchy, on one thread of the processor.
    pub build_seconds: f64,
}

impl GpuRival {
    /// Builds the hierarchy of a model. With [`Loading::Passthrough`] the shader goes without wgpu's checks, as umbra4's
    /// kernels do then.
    ///
    /// # Errors
    /// A model that is too large; a device that refuses.
    pub fn new(gpu: &Gpu, model: &Model, loading: Loading) -> Result<Self, GpuError> {
        let start = Instant::now();
        let hierarchy = Bvh4::new(model);
        let build_seconds = start.elapsed().as_secs_f64();
        let count = hierarchy.triangles.len();
        if count > TRIANGLES_MOST {
            return Err(GpuError::TooMany { field: "triangles", count, most: TRIANGLES_MOST });
        }
        let device = &gpu.device;
        let layout = guarded(device, "lay out bindings", || layout(device))?;
        let pipelines = guarded(device, "compile the rival", || {
            let module = module(device, hierarchy.depth, loading);
            ["count_lit", "write_masks"].map(|kernel| pipeline(device, &layout, &module, kernel))
        });
        let [lit, masks] = pipelines?;
        Ok(Self {
            gpu: gpu.clone(),
            boxes: filled(device, "the rival's boxes", &hierarchy.boxes)?,
            children: filled(device, "the rival's nodes", &hierarchy.children)?,
            triangles: filled(device, "the rival's triangles", &hierarchy.triangles)?,
            layout,
            lit,
            masks,
            build_seconds,
        })
    }

    /// Traces the rays of all receivers of a problem. Receivers that are neighbours should be neighbours in the image.
    ///
    /// # Errors
    /// Too many receivers for a buffer; a device that refuses or is lost.
    pub fn trace(&self, answer: Answer, problem: &Problem<'_>) -> Result<Traced, GpuError> {
        let Gpu { device, queue, software, .. } = &self.gpu;
        let light = &problem.light;
        let receivers = problem.origins.len() as u32;
        if receivers == 0 {
            return Ok(Traced::default());
        }
        let words = light.columns.div_ceil(u32::BITS);
        let (pipeline, results) = match answer {
            Answer::Lit => (&self.lit, u64::from(receivers)),
            Answer::Masks => (&self.masks, u64::from(receivers) * u64::from(light.rows * words)),
        };
        let results = zeros(&self.gpu, "the rival's results", results * size_of::<u32>() as u64)?;
        let (group, uniform) = self.bind(problem, &results)?;

        let blocks = light.columns.div_ceil(BLOCK) * light.rows.div_ceil(BLOCK);
        let rays = if *software { SOFTWARE_RAYS } else { RAYS };
        let step = (rays / u64::from(blocks * BLOCK * BLOCK)).max(1) as u32;
        let clock = Clock::new(&self.gpu, receivers.div_ceil(step))?;
        let most = device.limits().max_compute_workgroups_per_dimension;
        wait(device)?;

        let start = Instant::now();
        guarded(device, "trace rays", || {
            for submission in 0..receivers.div_ceil(step) {
                let first = submission * step;
                let end = receivers.min(first.saturating_add(step));
                let layers = (end - first).div_ceil(most);
                let layer = (end - first).div_ceil(layers);
                let work = Work {
                    first,
                    end,
                    columns: light.columns,
                    rows: light.rows,
                    point: problem.samples[0].to_array(),
                    words,
                    normal: problem.light_normal.to_array(),
                    layer,
                };
                queue.write_buffer(&uniform, 0, bytemuck::bytes_of(&work));
                let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor { label: Some("rival") });
                let timestamp_writes = clock.as_ref().map(Clock::writes);
                let mut pass =
                    encoder.begin_compute_pass(&ComputePassDescriptor { label: Some("rival"), timestamp_writes });
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(blocks, layer, layers);
                drop(pass);
                if let Some(clock) = &clock {
                    clock.keep(&mut encoder, submission);
                }
                queue.submit([encoder.finish()]);
            }
        })?;
        wait(device)?;
        let elapsed = start.elapsed().as_secs_f64();
        let seconds = clock.map_or(Ok(elapsed), |clock| clock.seconds(&self.gpu))?;
        Ok(Traced { words: read(&self.gpu, &results)?, seconds })
    }

    /// All that the kernels see, and the buffer of parameters among it.
    fn bind(&self, problem: &Problem<'_>, results: &Buffer) -> Result<(BindGroup, Buffer), GpuError> {
        let device = &self.gpu.device;
        let padded = |points: &[Vec3]| -> Vec<[f32; 4]> { points.iter().map(|p| p.extend(0.0).to_array()).collect() };
        let receivers = filled(device, "the rival's receivers", &padded(&problem.origins))?;
        let samples = filled(device, "the rival's samples", &padded(&problem.samples))?;
        guarded(device, "bind buffers", || {
            let uniform = device.create_buffer(&BufferDescriptor {
                label: Some("rival's parameters"),
                size: size_of::<Work>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let bound = [&uniform, &self.boxes, &self.children, &self.triangles, &receivers, &samples, results];
            let entries: Vec<BindGroupEntry<'_>> = (0..)
                .zip(bound)
                .map(|(binding, buffer)| BindGroupEntry { binding, resource: buffer.as_entire_binding() })
                .collect();
            let descriptor = BindGroupDescriptor { label: Some("rival"), layout: &self.layout, entries: &entries };
            (device.create_bind_group(&descriptor), uniform)
        })
    }
}

/// Parameters, five buffers that are read, and one that is written.
fn layout(device: &wgpu::Device) -> BindGroupLayout {
    let storage = |read_only| BufferBindingType::Storage { read_only };
    let types = [[BufferBindingType::Uniform].as_slice(), &[storage(true); 5], &[storage(false)]].concat();
    let entry = |(binding, ty)| BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty: BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    let entries: Vec<BindGroupLayoutEntry> = (0..).zip(types).map(entry).collect();
    device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: Some("rival"), entries: &entries })
}

/// The shader, with a stack for a hierarchy of this depth.
fn module(device: &wgpu::Device, depth: u32, loading: Loading) -> ShaderModule {
    let text = format!("const STACK = {depth}u;\n{}", include_str!("trace.wgsl"));
    let descriptor = ShaderModuleDescriptor { label: Some("rival"), source: ShaderSource::Wgsl(text.into()) };
    match loading {
        Loading::Checked => device.create_shader_module(descriptor),
        // SAFETY: every index comes from the hierarchy, or is compared with a length first; the stack is as long as the
        // hierarchy is deep; loops end, as each round takes a child from a finite tree.
        Loading::Passthrough => unsafe {
            device.create_shader_module_trusted(descriptor, ShaderRuntimeChecks::unchecked())
        },
    }
}

fn pipeline(device: &wgpu::Device, layout: &BindGroupLayout, module: &ShaderModule, kernel: &str) -> ComputePipeline {
    let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
        label: Some(kernel),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_compute_pipeline(&ComputePipelineDescriptor {
        label: Some(kernel),
        layout: Some(&layout),
        module,
        entry_point: Some(kernel),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may panic")]
mod tests;
