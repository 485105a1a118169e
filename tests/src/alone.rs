//! One kernel alone: on a device, and on the host, where it is a plain function over slices.

use std::collections::HashMap;

use bytemuck::{cast_slice, pod_collect_to_vec};
use umbra4_core::{
    Exact, Fast, PairWord,
    jitter::Regular,
    kernel::{
        Access, Kernel, WORKGROUP, build_level, key_receivers, key_triangles, order_triangles, probe, reduce, resolve,
        sort,
    },
    params::{Dispatched, JitteredParams},
};
use umbra4_wgpu::{
    Gpu, code,
    wgpu::{self, BufferUsages},
};

use crate::device::{buffer, read};

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

    /// Runs a kernel over words in the order of its bindings, all of which are buffers. Of `params` it is told what it takes.
    pub fn run(&mut self, kernel: Kernel, params: &JitteredParams, words: &mut [Vec<u32>]) {
        let pipeline = self.pipeline(kernel);
        let Gpu { device, queue, .. } = &self.gpu;
        let groups = params.count().div_ceil(WORKGROUP);
        let params = params.with_row(groups * WORKGROUP);
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let size = kernel.info().params.size();
        let params = buffer(&self.gpu, &bytemuck::bytes_of(&params)[..size], usage);
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
/// For kernels that read textures or count by atomics: those are tested in whole frames.
pub fn on_host(kernel: Kernel, told: &JitteredParams, words: &mut [Vec<u32>]) {
    let JitteredParams { params, pattern } = told;
    let ids = 0..params.count() as usize;
    // Slices of the kernel's types, which may want another alignment than words; in the order of the bindings.
    macro_rules! run {
        ($function:path $(, $samples:expr)?; $($read:ident),*; $($write:ident),*) => {{
            let [$($read,)* $($write),*] = words else { panic!("{kernel:?} has other bindings") };
            $(let $read = pod_collect_to_vec::<u32, _>($read);)*
            run!(@write $function, [$($samples)?], ids, [$($read),*], $($write),*)
        }};
        (@write $function:path, [$($samples:expr)?], $ids:expr, [$($read:ident),*], $a:ident) => {{
            let mut first = pod_collect_to_vec::<u32, _>($a);
            $ids.for_each(|id| { $function(id, params, $($samples,)? $(&$read,)* &mut first); });
            *$a = pod_collect_to_vec(&first);
        }};
        (@write $function:path, [$($samples:expr)?], $ids:expr, [$($read:ident),*], $a:ident, $b:ident) => {{
            let (mut first, mut second) = (pod_collect_to_vec::<u32, _>($a), pod_collect_to_vec::<u32, _>($b));
            $ids.for_each(|id| { $function(id, params, $($samples,)? $(&$read,)* &mut first, &mut second); });
            (*$a, *$b) = (pod_collect_to_vec(&first), pod_collect_to_vec(&second));
        }};
    }
    match kernel {
        Kernel::KeyTriangles => run!(key_triangles::key_triangles; a, b; c, d),
        Kernel::KeyReceivers => run!(key_receivers::key_receivers; a; b, c),
        Kernel::CountDigits => run!(sort::count_digits; a; b),
        Kernel::SumBlocks => run!(sort::sum_blocks; ; a),
        Kernel::ScanBlocks => run!(sort::scan_blocks; ; a),
        Kernel::ScatterDigits => run!(sort::scatter_digits; a, b; c),
        Kernel::OrderTriangles => run!(order_triangles::order_triangles; a, b, c, d; e, f),
        Kernel::BuildLevel => run!(build_level::build_level; ; a),
        Kernel::Resolve32Exact => run!(resolve::resolve::<u32, Exact, _>, &Regular; a, b, c, d, e; f),
        Kernel::Resolve32ExactJittered => run!(resolve::resolve::<u32, Exact, _>, pattern; a, b, c, d, e; f),
        Kernel::Resolve32Fast => run!(resolve::resolve::<u32, Fast, _>, &Regular; a, b, c, d, e; f),
        Kernel::Resolve32FastJittered => run!(resolve::resolve::<u32, Fast, _>, pattern; a, b, c, d, e; f),
        Kernel::Resolve32ExactCounted => run!(resolve::resolve_counted::<u32, Exact, _>, &Regular; a, b, c, d, e; f, g),
        Kernel::Resolve32ExactJitteredCounted => {
            run!(resolve::resolve_counted::<u32, Exact, _>, pattern; a, b, c, d, e; f, g)
        }
        Kernel::Resolve64Exact => run!(resolve::resolve::<PairWord, Exact, _>, &Regular; a, b, c, d, e; f),
        Kernel::Resolve64ExactJittered => run!(resolve::resolve::<PairWord, Exact, _>, pattern; a, b, c, d, e; f),
        Kernel::Resolve64Fast => run!(resolve::resolve::<PairWord, Fast, _>, &Regular; a, b, c, d, e; f),
        Kernel::Resolve64FastJittered => run!(resolve::resolve::<PairWord, Fast, _>, pattern; a, b, c, d, e; f),
        Kernel::Resolve64ExactCounted => {
            run!(resolve::resolve_counted::<PairWord, Exact, _>, &Regular; a, b, c, d, e; f, g)
        }
        Kernel::Resolve64ExactJitteredCounted => {
            run!(resolve::resolve_counted::<PairWord, Exact, _>, pattern; a, b, c, d, e; f, g)
        }
        Kernel::Reduce => run!(reduce::reduce; a; b),
        Kernel::Probe => run!(probe::probe; a; b),
        other => panic!("{other:?} is not run alone"),
    }
}
