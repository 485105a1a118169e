//! Adapters, and a device of our own for scripts and tests.

use std::fmt;

use wgpu::{
    Adapter, Buffer, CommandEncoderDescriptor, Device, DeviceDescriptor, DeviceType, ExperimentalFeatures, Features,
    Instance, InstanceDescriptor, MemoryHints, Queue,
};

use crate::{
    GpuError, Lack,
    error::guarded,
    readback, trial,
    usable::{self, LOOKED_AT, Listed, lacks},
};

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
    pub lacks: Vec<Lack>,
}

/// All adapters of this machine but those of GL, which nobody can use. Software drivers are tried, which takes them a moment.
pub fn adapters() -> Vec<AdapterReport> {
    found().iter().map(report).collect()
}

fn found() -> Vec<Adapter> {
    let asked = InstanceDescriptor::new_without_display_handle_from_env();
    let instance = Instance::new(InstanceDescriptor { backends: asked.backends & LOOKED_AT, ..asked });
    pollster::block_on(instance.enumerate_adapters(LOOKED_AT))
}

fn report(adapter: &Adapter) -> AdapterReport {
    let info = adapter.get_info();
    let lacks = match lacks(&info, &adapter.limits()) {
        lacks if lacks.is_empty() && is_software(adapter) => match Gpu::of(adapter) {
            Ok(_) => lacks,
            Err(GpuError::Unusable { lacks, .. }) => lacks,
            Err(error) => vec![Lack::Fails { reason: error.to_string() }],
        },
        lacks => lacks,
    };
    let hardware = !is_software(adapter);
    AdapterReport { driver: driver(adapter), name: info.name, backend: info.backend.to_string(), hardware, lacks }
}

fn is_software(adapter: &Adapter) -> bool {
    adapter.get_info().device_type == DeviceType::Cpu
}

fn driver(adapter: &Adapter) -> String {
    let info = adapter.get_info();
    format!("{} {}", info.driver, info.driver_info).trim().to_owned()
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
    /// Opens the first adapter that can be used, with all of its limits.
    ///
    /// # Errors
    /// No such adapter; none of them can be used, each with the reason; a driver that refuses.
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
        let mut wanted: Vec<(u32, &Adapter)> =
            all.iter().filter_map(|adapter| Some((preference(adapter)?, adapter))).collect();
        wanted.sort_by_key(|(preference, _)| *preference);
        let mut refused = Vec::new();
        for (_, adapter) in wanted {
            match Self::of(adapter) {
                Ok(gpu) => return Ok(gpu),
                Err(error) => refused.push(error),
            }
        }
        let reason = match &refused[..] {
            [] if all.is_empty() => "there is none, and those of GL are not looked at".to_owned(),
            [] => {
                let names: Vec<String> = all.iter().map(|adapter| usable::called(&adapter.get_info())).collect();
                format!("there is {}", names.join(", "))
            }
            [_] => return Err(refused.remove(0)),
            several => Listed(several).to_string(),
        };
        Err(GpuError::NoAdapter { wanted: choice.to_string(), reason })
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

    /// Opens an adapter that can be used.
    fn of(adapter: &Adapter) -> Result<Self, GpuError> {
        let (info, software) = (adapter.get_info(), is_software(adapter));
        usable::check(&info, &adapter.limits())?;
        let descriptor = DeviceDescriptor {
            label: Some("umbra4"),
            required_features: adapter.features() & OPTIONAL,
            required_limits: adapter.limits(),
            experimental_features: ExperimentalFeatures::disabled(),
            memory_hints: MemoryHints::Performance,
            trace: wgpu::Trace::Off,
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice { adapter: usable::called(&info), reason: error.to_string() })?;
        let driver = driver(adapter);
        let name = if driver.is_empty() { info.name.clone() } else { format!("{}, {driver}", info.name) };
        let gpu = Self { device, queue, name, software };
        let tried = if software { trial::run(&gpu) } else { Ok(()) };
        usable::refuse(&info, tried.err().into_iter().collect())?;
        Ok(gpu)
    }
}
