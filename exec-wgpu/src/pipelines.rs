//! Compute pipelines, each made when it is first needed: what a scene does not call for is not compiled.

use std::{
    borrow::Cow,
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use umbra4_core::{
    kernel::{Access, Kernel},
    params::Params,
};
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BufferBindingType, BufferSize,
    ComputePipeline, ComputePipelineDescriptor, Device, PipelineCompilationOptions, PipelineLayoutDescriptor,
    ShaderModuleDescriptor, ShaderSource, ShaderStages,
};

use crate::{GpuError, error::guarded, modules};

/// A kernel, ready to run.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) layout: BindGroupLayout,
    pub(crate) pipeline: ComputePipeline,
}

/// The pipelines made so far.
#[derive(Debug, Default)]
pub(crate) struct Pipelines {
    made: HashMap<Kernel, Arc<Pipeline>>,
    time: Duration,
}

impl Pipelines {
    /// Time spent on making pipelines so far.
    pub(crate) fn time(&self) -> Duration {
        self.time
    }

    /// The pipeline of a kernel.
    pub(crate) fn get(&mut self, device: &Device, kernel: Kernel) -> Result<Arc<Pipeline>, GpuError> {
        if let Some(pipeline) = self.made.get(&kernel) {
            return Ok(pipeline.clone());
        }
        let start = Instant::now();
        let pipeline = Arc::new(compile(device, kernel)?);
        self.time += start.elapsed();
        self.made.insert(kernel, pipeline.clone());
        Ok(pipeline)
    }
}

fn buffer_entry(binding: u32, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry { binding, visibility: ShaderStages::COMPUTE, ty, count: None }
}

fn compile(device: &Device, kernel: Kernel) -> Result<Pipeline, GpuError> {
    let info = kernel.info();
    let params = BindingType::Buffer {
        ty: BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: true,
        min_binding_size: BufferSize::new(size_of::<Params>() as u64),
    };
    let storage = info.bound.iter().enumerate().map(|(k, bound)| {
        let read_only = bound.access == Access::Read;
        let ty = BufferBindingType::Storage { read_only };
        buffer_entry(k as u32 + 1, BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None })
    });
    let entries: Vec<_> = [buffer_entry(0, params)].into_iter().chain(storage).collect();
    let words: Vec<u32> =
        modules::code(kernel).chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();

    guarded(device, info.name, || {
        let layout =
            device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: Some(info.name), entries: &entries });
        let module = device.create_shader_module(ShaderModuleDescriptor {
            label: Some(info.name),
            source: ShaderSource::SpirV(Cow::Owned(words)),
        });
        let pipeline_layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some(info.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(info.name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(info.name),
            compilation_options: PipelineCompilationOptions::default(),
            cache: None,
        });
        Pipeline { layout, pipeline }
    })
}
