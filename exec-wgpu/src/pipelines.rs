//! Compute pipelines, each made when it is first needed: what a scene does not call for is not compiled.

use std::{
    borrow::Cow,
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use umbra4_core::kernel::{Access, WORKGROUP};
use wgpu::{
    Backend, BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BufferBindingType,
    BufferSize, ComputePipeline, ComputePipelineDescriptor, Device, Features, PassthroughShaderEntryPoint,
    PipelineCompilationOptions, PipelineLayoutDescriptor, ShaderModule, ShaderModuleDescriptor,
    ShaderModuleDescriptorPassthrough, ShaderSource, ShaderStages, TextureSampleType, TextureViewDimension,
};

use crate::{DeviceKernel, GpuError, error::guarded, modules};

/// How kernels reach the driver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Loading {
    /// Through naga, which checks them and adds bounds checks: every backend.
    #[default]
    Checked,
    /// As they are: Vulkan only, on a device with [`wgpu::Features::PASSTHROUGH_SHADERS`]. Those of jittered samples and of clouds are checked all the
    /// same: one software driver computes wrong masks without.
    Passthrough,
}

impl Loading {
    /// Whether a device can load kernels so.
    pub(crate) fn check(self, device: &Device) -> Result<(), GpuError> {
        let backend = device.adapter_info().backend;
        let possible = backend == Backend::Vulkan && device.features().contains(Features::PASSTHROUGH_SHADERS);
        if self == Self::Checked || possible {
            return Ok(());
        }
        let needs = "Vulkan and the feature PASSTHROUGH_SHADERS are needed";
        Err(GpuError::Field { field: "loading".to_owned(), value: format!("{self:?} on {backend}"), needs })
    }
}

/// A kernel, ready to run.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) layout: BindGroupLayout,
    pub(crate) pipeline: ComputePipeline,
}

/// The pipelines made so far.
#[derive(Debug, Default)]
pub(crate) struct Pipelines {
    loading: Loading,
    made: HashMap<DeviceKernel, Arc<Pipeline>>,
    time: Duration,
}

impl Pipelines {
    pub(crate) fn new(loading: Loading) -> Self {
        Self { loading, ..Self::default() }
    }

    /// Time spent on making pipelines so far.
    pub(crate) fn time(&self) -> Duration {
        self.time
    }

    /// The pipeline of a kernel.
    pub(crate) fn get(&mut self, device: &Device, kernel: DeviceKernel) -> Result<Arc<Pipeline>, GpuError> {
        if let Some(pipeline) = self.made.get(&kernel) {
            return Ok(pipeline.clone());
        }
        let start = Instant::now();
        let pipeline = Arc::new(compile(device, self.loading, kernel)?);
        self.time += start.elapsed();
        self.made.insert(kernel, pipeline.clone());
        Ok(pipeline)
    }
}

fn entry(binding: u32, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry { binding, visibility: ShaderStages::COMPUTE, ty, count: None }
}

const FLOAT: TextureSampleType = TextureSampleType::Float { filterable: false };

fn binding_type(access: Access) -> BindingType {
    let texture = |sample_type, multisampled| BindingType::Texture {
        sample_type,
        view_dimension: TextureViewDimension::D2,
        multisampled,
    };
    let buffer = |read_only| BindingType::Buffer {
        ty: BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    match access {
        Access::Read => buffer(true),
        Access::Write => buffer(false),
        Access::Texture => texture(FLOAT, false),
        Access::Samples => texture(FLOAT, true),
        Access::Ids => texture(TextureSampleType::Uint, false),
        Access::IdSamples => texture(TextureSampleType::Uint, true),
    }
}

fn load(device: &Device, loading: Loading, kernel: DeviceKernel) -> ShaderModule {
    let loading = if kernel.is_always_checked() { Loading::Checked } else { loading };
    let name = kernel.name();
    let words: Vec<u32> =
        modules::code(kernel).chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    let code = Cow::Owned(words);
    match loading {
        Loading::Checked => {
            device.create_shader_module(ShaderModuleDescriptor { label: Some(name), source: ShaderSource::SpirV(code) })
        }
        // SAFETY: the module is this crate's own, validated by spirv-val, and bound by the layout of its table. Its only
        // accesses to buffers are of elements whose index it has compared with the length.
        Loading::Passthrough => unsafe {
            device.create_shader_module_passthrough(ShaderModuleDescriptorPassthrough {
                label: Some(name),
                entry_points: Cow::Owned(vec![PassthroughShaderEntryPoint {
                    name: Cow::Borrowed(name),
                    workgroup_size: (WORKGROUP, 1, 1),
                }]),
                spirv: Some(code),
                ..ShaderModuleDescriptorPassthrough::default()
            })
        },
    }
}

fn compile(device: &Device, loading: Loading, kernel: DeviceKernel) -> Result<Pipeline, GpuError> {
    let name = kernel.name();
    let params = BindingType::Buffer {
        ty: BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: true,
        min_binding_size: BufferSize::new(kernel.params_size() as u64),
    };
    let bound = (1..).zip(kernel.accesses()).map(|(binding, access)| entry(binding, binding_type(access)));
    let entries: Vec<_> = [entry(0, params)].into_iter().chain(bound).collect();
    guarded(device, name, || {
        let layout =
            device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: Some(name), entries: &entries });
        let module = load(device, loading, kernel);
        let pipeline_layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(name),
            compilation_options: PipelineCompilationOptions::default(),
            cache: None,
        });
        Pipeline { layout, pipeline }
    })
}
