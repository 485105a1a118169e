//! Adapters, and a device of our own for scripts and tests.

use std::fmt;

use umbra4_core::kernel::WORKGROUP;
use wgpu::{
    Adapter, Backends, Buffer, CommandEncoderDescriptor, Device, DeviceDescriptor, DeviceType, ExperimentalFeatures,
    Features, Instance, InstanceDescriptor, Limits, MemoryHints, Queue,
};

use crate::{DeviceKernel, GpuError, error::guarded, readback};

/// Which adapter to open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// A discrete GPU, else an integrated or virtual one; never a software driver.
    #[default]
    Hardware,
    /// A software driver, such as lavapipe.
    Software,
    /// The first whose name contains this text, whatever the case.
    Named(String),
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hardware => f.write_str("GPU"),
            Self::Software => f.write_str("software adapter"),
            Self::Named(name) => write!(f, "adapter called {name:?}"),
        }
    }
}

/// What an adapter is, and what it lacks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterReport {
    /// Its name.
    pub name: String,
    /// Its driver.
    pub driver: String,
    /// "Vulkan", "Metal", …
    pub backend: String,
    /// Whether it is a GPU, and no software driver.
    pub hardware: bool,
    /// What umbra4 needs and it has not; empty where it can be used.
    pub lacks: Vec<String>,
}

/// All adapters of this machine.
pub fn adapters() -> Vec<AdapterReport> {
    found().iter().map(report).collect()
}

fn found() -> Vec<Adapter> {
    let instance = Instance::new(InstanceDescriptor::new_without_display_handle_from_env());
    pollster::block_on(instance.enumerate_adapters(Backends::all()))
}

fn report(adapter: &Adapter) -> AdapterReport {
    let info = adapter.get_info();
    let lacks = shortages(&adapter.limits())
        .map(|(limit, has, needs)| format!("{limit}: {needs} needed, {has} there"))
        .collect();
    AdapterReport {
        name: info.name,
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        backend: info.backend.to_string(),
        hardware: info.device_type != DeviceType::Cpu,
        lacks,
    }
}

/// Name, value and need of the limits that are too small.
fn shortages(limits: &Limits) -> impl Iterator<Item = (&'static str, u64, u64)> {
    // The parameters are one more.
    let buffers = 1 + DeviceKernel::all().map(|kernel| kernel.accesses().count()).max().unwrap_or(0) as u32;
    let needs = [
        ("max_storage_buffers_per_shader_stage", limits.max_storage_buffers_per_shader_stage, buffers),
        ("max_compute_invocations_per_workgroup", limits.max_compute_invocations_per_workgroup, WORKGROUP),
        ("max_compute_workgroup_size_x", limits.max_compute_workgroup_size_x, WORKGROUP),
        ("max_dynamic_storage_buffers_per_pipeline_layout", limits.max_dynamic_storage_buffers_per_pipeline_layout, 1),
    ];
    let needs = needs.map(|(name, has, needs)| (name, u64::from(has), u64::from(needs)));
    needs.into_iter().filter(|(_, has, needs)| has < needs)
}

/// Whether the limits of an adapter, or of a device of it, are large enough.
pub(crate) fn check_limits(adapter: &str, limits: &Limits) -> Result<(), GpuError> {
    match shortages(limits).next() {
        None => Ok(()),
        Some((limit, has, needs)) => Err(GpuError::LimitTooSmall { adapter: adapter.to_owned(), limit, has, needs }),
    }
}

/// Features that are taken where they are there: times of stages, and another way to load kernels.
const OPTIONAL: Features = Features::TIMESTAMP_QUERY.union(Features::PASSTHROUGH_SHADERS);

/// A device and its queue.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: Device,
    /// Its queue.
    pub queue: Queue,
    /// What it is called in reports.
    pub name: String,
    /// Whether it is a software driver. Those may stop threads that run for long: their work is cut into smaller pieces.
    pub software: bool,
}

impl Gpu {
    /// Opens an adapter, with all of its limits.
    ///
    /// # Errors
    /// No such adapter; one that lacks something; a driver that refuses.
    pub fn open(choice: &Choice) -> Result<Self, GpuError> {
        let all = found();
        let preference = |adapter: &Adapter| match (choice, adapter.get_info().device_type) {
            (Choice::Hardware, DeviceType::DiscreteGpu) => Some(0),
            (Choice::Hardware, DeviceType::IntegratedGpu) => Some(1),
            (Choice::Hardware, DeviceType::VirtualGpu) => Some(2),
            (Choice::Software, DeviceType::Cpu) => Some(0),
            (Choice::Named(name), _) => {
                adapter.get_info().name.to_lowercase().contains(&name.to_lowercase()).then_some(0)
            }
            _ => None,
        };
        // Of the same kind, Vulkan before GL.
        let secondary = |adapter: &Adapter| adapter.get_info().backend == wgpu::Backend::Gl;
        let best = all
            .iter()
            .filter_map(|adapter| Some((preference(adapter)?, secondary(adapter), adapter)))
            .min_by_key(|(preference, secondary, _)| (*preference, *secondary));
        let Some((_, _, adapter)) = best else {
            let names: Vec<String> = all.iter().map(|adapter| adapter.get_info().name).collect();
            let reason =
                if names.is_empty() { "there is none".to_owned() } else { format!("there is {}", names.join(", ")) };
            return Err(GpuError::NoAdapter { wanted: choice.to_string(), reason });
        };
        Self::of(adapter)
    }

    /// Waits for the device, and hands over the first `bytes` bytes of a buffer whose usage has `COPY_SRC`. For scripts and
    /// tests: an engine does not wait.
    ///
    /// # Errors
    /// The device fails.
    pub fn read<T: bytemuck::Pod>(&self, source: &Buffer, bytes: u64) -> Result<Vec<T>, GpuError> {
        let Self { device, queue, .. } = self;
        let staging = guarded(device, "reads a buffer", || {
            let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor { label: Some("umbra4") });
            let staging = readback::copy(device, &mut encoder, source, 0, bytes);
            queue.submit([encoder.finish()]);
            staging
        })?;
        readback::read(device, &staging)
    }

    fn of(adapter: &Adapter) -> Result<Self, GpuError> {
        let AdapterReport { name, driver, hardware, .. } = report(adapter);
        check_limits(&name, &adapter.limits())?;
        let descriptor = DeviceDescriptor {
            label: Some("umbra4"),
            required_features: adapter.features() & OPTIONAL,
            required_limits: adapter.limits(),
            experimental_features: ExperimentalFeatures::disabled(),
            memory_hints: MemoryHints::Performance,
            trace: wgpu::Trace::Off,
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice { adapter: name.clone(), reason: error.to_string() })?;
        let name = if driver.is_empty() { name } else { format!("{name}, {driver}") };
        Ok(Self { device, queue, name, software: !hardware })
    }
}
