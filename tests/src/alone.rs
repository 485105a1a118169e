//! One kernel alone: on a device, and on the host, where it is a plain function over slices.

use std::collections::HashMap;

use bytemuck::{cast_slice, pod_collect_to_vec};
use umbra4_core::{
    Exact, Fast, PairWord,
    jitter::Regular,
    kernel::{
        Access, Kernel, ParamsKind, WORKGROUP, build_level, illuminate, key_receivers, key_triangles, order_triangles,
        pack_light, probe, reduce, resolve, resolve_punctual, settle_receivers, sort, weigh,
    },
    params::{Dispatched, JitteredParams, Params, PassParams, PunctualParams},
};
use umbra4_wgpu::{
    Gpu, code,
    wgpu::{self, BufferUsages},
};

use crate::device::{buffer, read};

/// What kernels are told of a light.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one at a time")]
pub enum Told {
    /// Of one with an area: most take the first part only.
    Area(JitteredParams),
    /// Of a face of one without extent: most take the first part only.
    Punctual(PunctualParams),
}

impl From<Params> for Told {
    fn from(params: Params) -> Self {
        Self::Area(JitteredParams { params, ..bytemuck::Zeroable::zeroed() })
    }
}

impl Told {
    /// The same for one pass.
    #[must_use]
    pub fn with_pass(self, pass: &PassParams) -> Self {
        match self {
            Self::Area(own) => Self::Area(JitteredParams { params: own.params.with_pass(pass), ..own }),
            Self::Punctual(own) => Self::Punctual(own.with_pass(pass)),
        }
    }

    fn count(&self) -> u32 {
        match self {
            Self::Area(own) => own.count(),
            Self::Punctual(own) => own.count(),
        }
    }

    /// The bytes that a kernel takes, with rows of `row` ids.
    fn bytes(&self, kernel: Kernel, row: u32) -> Vec<u8> {
        let all = match self {
            Self::Area(own) => bytemuck::bytes_of(&own.with_row(row)).to_vec(),
            Self::Punctual(own) => bytemuck::bytes_of(&own.with_row(row)).to_vec(),
        };
        all[..kernel.info().params.size()].to_vec()
    }
}

/// Kernels on a device, each alone: buffers go up, the kernel runs, buffers come back.
#[derive(Debug)]
pub struct OnDevice {
    gpu: Gpu,
    made: HashMap<Kernel, wgpu::ComputePipeline>,
}

impl OnDevice {
    /// Kernels on a device.
    pub fn new(gpu: &Gpu) -> Self {
        Self { gpu: gpu.clone(), made: HashMap::new() }
    }

    fn pipeline(&mut self, kernel: Kernel) -> wgpu::ComputePipeline {
        let device = &self.gpu.device;
        let made = self.made.entry(kernel).or_insert_with(|| {
            let info = kernel.info();
            let entries: Vec<_> = [Access::Read]
                .into_iter()
                .chain(info.bound.iter().map(|bound| bound.access))
                .zip(0..)
                .map(|(access, binding)| wgpu::BindGroupLayoutEntry {
                    binding,
                    visibility: wgpu::ShaderStages::COMPUTE,
                    ty: wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Storage { read_only: access == Access::Read },
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    count: None,
                })
                .collect();
            let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(info.name),
                entries: &entries,
            });
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(info.name),
                source: wgpu::util::make_spirv(code(kernel)),
            });
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(info.name),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(info.name),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(info.name),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        });
        made.clone()
    }

    /// Runs a kernel over words in the order of its bindings, all of which are buffers. It is told what it takes.
    ///
    /// # Panics
    /// For a kernel of another kind of light.
    pub fn run(&mut self, kernel: Kernel, told: &Told, words: &mut [Vec<u32>]) {
        let pipeline = self.pipeline(kernel);
        let Gpu { device, queue, .. } = &self.gpu;
        let of_point = kernel.info().params == ParamsKind::PunctualLight;
        assert!(!of_point || matches!(told, Told::Punctual(_)), "{kernel:?} is of a light without extent");
        let groups = told.count().div_ceil(WORKGROUP);
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let params = buffer(&self.gpu, &told.bytes(kernel, groups * WORKGROUP), usage);
        let bound: Vec<wgpu::Buffer> = words.iter().map(|words| buffer(&self.gpu, cast_slice(words), usage)).collect();
        let entries: Vec<_> = [&params]
            .into_iter()
            .chain(&bound)
            .zip(0..)
            .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(groups, 1, 1);
        drop(pass);
        queue.submit([encoder.finish()]);
        for ((words, buffer), bound) in words.iter_mut().zip(&bound).zip(kernel.info().bound) {
            if bound.access == Access::Write {
                *words = pod_collect_to_vec(&read(&self.gpu, buffer, size_of_val(&words[..]) as u64));
            }
        }
    }
}

/// Runs a kernel on the host, one id after the other.
///
/// # Panics
/// For kernels that read textures or count by atomics, which are tested in whole frames, and for those of another kind of light.
pub fn on_host(kernel: Kernel, told: &Told, words: &mut [Vec<u32>]) {
    let (params, pattern, punctual) = match told {
        Told::Area(JitteredParams { params, pattern }) => (params, Some(pattern), None),
        Told::Punctual(own) => (&own.params, None, Some(own)),
    };
    let pattern = || pattern.expect("the kernel is of a light with an area");
    let punctual = || punctual.expect("the kernel is of a light without extent");
    let ids = 0..params.count() as usize;
    // Slices of the kernel's types, which may want another alignment than words; in the order of the bindings.
    macro_rules! run {
        ($function:path, $($told:expr),+; $($read:ident),*; $($write:ident),*) => {{
            let [$($read,)* $($write),*] = words else { panic!("{kernel:?} has other bindings") };
            $(let $read = pod_collect_to_vec::<u32, _>($read);)*
            run!(@write $function, [$($told),+], ids, [$($read),*], $($write),*)
        }};
        (@write $function:path, [$($told:expr),+], $ids:expr, [$($read:ident),*], $a:ident) => {{
            let mut first = pod_collect_to_vec::<u32, _>($a);
            $ids.for_each(|id| { $function(id, $($told,)+ $(&$read,)* &mut first); });
            *$a = pod_collect_to_vec(&first);
        }};
        (@write $function:path, [$($told:expr),+], $ids:expr, [$($read:ident),*], $a:ident, $b:ident) => {{
            let (mut first, mut second) = (pod_collect_to_vec::<u32, _>($a), pod_collect_to_vec::<u32, _>($b));
            $ids.for_each(|id| { $function(id, $($told,)+ $(&$read,)* &mut first, &mut second); });
            (*$a, *$b) = (pod_collect_to_vec(&first), pod_collect_to_vec(&second));
        }};
    }
    match kernel {
        Kernel::KeyTriangles => run!(key_triangles::key_triangles, params; a, b; c, d),
        Kernel::KeyPunctualTriangles => run!(key_triangles::key_triangles, punctual(); a, b; c, d),
        Kernel::KeyReceivers => run!(key_receivers::key_receivers, params; a; b, c),
        Kernel::KeyPunctualReceivers => run!(key_receivers::key_receivers, punctual(); a; b, c),
        Kernel::SettleReceivers => run!(settle_receivers::settle_receivers, params; a, b; c),
        Kernel::SettlePunctualReceivers => run!(settle_receivers::settle_punctual_receivers, punctual(); a, b; c, d),
        Kernel::CountDigits => run!(sort::count_digits, params; a; b),
        Kernel::SumBlocks => run!(sort::sum_blocks, params; ; a),
        Kernel::ScanBlocks => run!(sort::scan_blocks, params; ; a),
        Kernel::ScatterDigits => run!(sort::scatter_digits, params; a, b; c),
        Kernel::OrderTriangles => run!(order_triangles::order_triangles, params; a, b, c, d; e, f),
        Kernel::OrderPunctualTriangles => run!(order_triangles::order_triangles, punctual(); a, b, c, d; e, f),
        Kernel::BuildLevel => run!(build_level::build_level, params; ; a),
        Kernel::Resolve32Exact => run!(resolve::resolve::<u32, Exact, _>, params, &Regular; a, b, c, d, e; f),
        Kernel::Resolve32ExactJittered => run!(resolve::resolve::<u32, Exact, _>, params, pattern(); a, b, c, d, e; f),
        Kernel::Resolve32Fast => run!(resolve::resolve::<u32, Fast, _>, params, &Regular; a, b, c, d, e; f),
        Kernel::Resolve32FastJittered => run!(resolve::resolve::<u32, Fast, _>, params, pattern(); a, b, c, d, e; f),
        Kernel::Resolve32ExactCounted => {
            run!(resolve::resolve_counted::<u32, Exact, _>, params, &Regular; a, b, c, d, e; f, g)
        }
        Kernel::Resolve32ExactJitteredCounted => {
            run!(resolve::resolve_counted::<u32, Exact, _>, params, pattern(); a, b, c, d, e; f, g)
        }
        Kernel::Resolve64Exact => run!(resolve::resolve::<PairWord, Exact, _>, params, &Regular; a, b, c, d, e; f),
        Kernel::Resolve64ExactJittered => {
            run!(resolve::resolve::<PairWord, Exact, _>, params, pattern(); a, b, c, d, e; f)
        }
        Kernel::Resolve64Fast => run!(resolve::resolve::<PairWord, Fast, _>, params, &Regular; a, b, c, d, e; f),
        Kernel::Resolve64FastJittered => {
            run!(resolve::resolve::<PairWord, Fast, _>, params, pattern(); a, b, c, d, e; f)
        }
        Kernel::Resolve64ExactCounted => {
            run!(resolve::resolve_counted::<PairWord, Exact, _>, params, &Regular; a, b, c, d, e; f, g)
        }
        Kernel::Resolve64ExactJitteredCounted => {
            run!(resolve::resolve_counted::<PairWord, Exact, _>, params, pattern(); a, b, c, d, e; f, g)
        }
        Kernel::ResolvePunctualExact => {
            run!(resolve_punctual::resolve_punctual::<Exact>, punctual(); a, b, c, d, e; f)
        }
        Kernel::ResolvePunctualFast => run!(resolve_punctual::resolve_punctual::<Fast>, punctual(); a, b, c, d, e; f),
        Kernel::ResolvePunctualExactCounted => {
            run!(resolve_punctual::resolve_punctual_counted::<Exact>, punctual(); a, b, c, d, e; f, g)
        }
        Kernel::ResolvePunctualFastCounted => {
            run!(resolve_punctual::resolve_punctual_counted::<Fast>, punctual(); a, b, c, d, e; f, g)
        }
        Kernel::Reduce => run!(reduce::reduce, params; a; b),
        Kernel::Weigh => run!(weigh::weigh, params; a, b; c),
        Kernel::Illuminate => run!(illuminate::illuminate, params; a, b, c, d; e),
        Kernel::PackLight => run!(pack_light::pack_light, params; a; b),
        Kernel::Probe => run!(probe::probe, params; a; b),
        other => panic!("{other:?} is not run alone"),
    }
}
