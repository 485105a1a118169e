//! Which adapters can be used: one rule, for all that list adapters, open them, or are handed a device.
//!
//! The backend is one whose kernels are known to compile, the limits suffice ([`lacks`] knows both from what an adapter tells of itself), and the
//! driver does not stop threads before they are done. Only software drivers do that, so that these, and no GPUs, are tried with a little work
//! before they are used ([`crate::trial`]).

use std::fmt;

use thiserror::Error;
use umbra4_core::kernel::WORKGROUP;
use wgpu::{AdapterInfo, Backend, Backends, Limits};

use crate::{DeviceKernel, GpuError};

/// Why an adapter, or a device of it, cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Lack {
    /// The kernels do not run on its backend.
    #[error("its backend is {backend}, {reason}")]
    Backend {
        /// Its backend.
        backend: Backend,
        /// What is known of it.
        reason: &'static str,
    },
    /// A limit is smaller than what every kernel needs.
    #[error("{limit} is {has}, {needs} are needed")]
    Limit {
        /// Name of the limit, as wgpu calls it.
        limit: &'static str,
        /// What it has.
        has: u64,
        /// What is needed.
        needs: u64,
    },
    /// Its driver stops threads that run for long, even for the least that they can be given.
    #[error("its driver stops threads before they are done")]
    Stops,
    /// It gave wrong masks for work whose masks are known.
    #[error("it computes wrong masks")]
    Wrong,
    /// It cannot be opened, or its driver refuses the kernels.
    #[error("{reason}")]
    Fails {
        /// What the driver said.
        reason: String,
    },
}

/// Why GL is out: naga makes `textureSize(sampler2D, uint)` of the kernels that read textures, which no GLSL compiler takes.
const NO_GLSL: &str = "for which the kernels do not compile";

/// The backends that adapters are looked for on. GL is not among them: nothing it has can be used, and libraries that it loads write to the terminal.
pub(crate) const LOOKED_AT: Backends =
    Backends::VULKAN.union(Backends::METAL).union(Backends::DX12).union(Backends::BROWSER_WEBGPU);

/// What an adapter lacks, or a device with these limits, as far as it tells of itself; nothing where it can be used.
///
/// ```
/// use umbra4_wgpu::{Lack, lacks, wgpu::{AdapterInfo, Backend, DeviceType, Limits}};
///
/// let on = |backend| AdapterInfo::new(DeviceType::DiscreteGpu, backend);
/// assert!(lacks(&on(Backend::Vulkan), &Limits::default()).is_empty());
/// assert!(matches!(lacks(&on(Backend::Gl), &Limits::default())[..], [Lack::Backend { .. }]));
/// ```
pub fn lacks(info: &AdapterInfo, limits: &Limits) -> Vec<Lack> {
    let reason = match info.backend {
        // On Vulkan the kernels are tested; to what the others compile, naga translates all of them.
        Backend::Vulkan | Backend::Metal | Backend::Dx12 | Backend::BrowserWebGpu => None,
        Backend::Gl => Some(NO_GLSL),
        Backend::Noop => Some("which runs nothing"),
    };
    let backend = reason.map(|reason| Lack::Backend { backend: info.backend, reason });
    backend.into_iter().chain(shortages(limits)).collect()
}

/// The limits that are too small.
fn shortages(limits: &Limits) -> impl Iterator<Item = Lack> {
    // The parameters are one more.
    let buffers = 1 + DeviceKernel::all().map(|kernel| kernel.accesses().count()).max().unwrap_or(0) as u32;
    let needs = [
        ("max_storage_buffers_per_shader_stage", limits.max_storage_buffers_per_shader_stage, buffers),
        ("max_compute_invocations_per_workgroup", limits.max_compute_invocations_per_workgroup, WORKGROUP),
        ("max_compute_workgroup_size_x", limits.max_compute_workgroup_size_x, WORKGROUP),
        ("max_dynamic_storage_buffers_per_pipeline_layout", limits.max_dynamic_storage_buffers_per_pipeline_layout, 1),
    ];
    let lack = |(limit, has, needs): (&'static str, u32, u32)| {
        (has < needs).then_some(Lack::Limit { limit, has: has.into(), needs: needs.into() })
    };
    needs.into_iter().filter_map(lack)
}

/// Whether an adapter, or a device with these limits, can be used as far as it tells of itself.
pub(crate) fn check(info: &AdapterInfo, limits: &Limits) -> Result<(), GpuError> {
    refuse(info, lacks(info, limits))
}

/// The error, if anything is lacking.
pub(crate) fn refuse(info: &AdapterInfo, lacks: Vec<Lack>) -> Result<(), GpuError> {
    if lacks.is_empty() { Ok(()) } else { Err(GpuError::Unusable { adapter: called(info), lacks }) }
}

/// What an adapter is called where there may be another of its name: "llvmpipe (vulkan)".
pub(crate) fn called(info: &AdapterInfo) -> String {
    format!("{} ({})", info.name, info.backend)
}

/// Several reasons, one after the other.
pub(crate) struct Listed<'a, T>(pub(crate) &'a [T]);

impl<T: fmt::Display> fmt::Display for Listed<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().enumerate().try_for_each(|(k, reason)| {
            let separator = if k == 0 { "" } else { "; " };
            write!(f, "{separator}{reason}")
        })
    }
}

#[cfg(test)]
mod tests {
    use wgpu::DeviceType;

    use super::*;

    fn named(backend: Backend, device_type: DeviceType) -> AdapterInfo {
        AdapterInfo { name: "a GPU".to_owned(), ..AdapterInfo::new(device_type, backend) }
    }

    #[test]
    fn backends_whose_kernels_compile_can_be_used() {
        for device_type in [DeviceType::DiscreteGpu, DeviceType::IntegratedGpu, DeviceType::Cpu, DeviceType::Other] {
            for backend in Backend::ALL {
                let lacks = lacks(&named(backend, device_type), &Limits::default());
                let usable = LOOKED_AT.contains(backend.into());
                assert_eq!(lacks.is_empty(), usable, "{backend}: {lacks:?}");
            }
        }
        let error = check(&named(Backend::Gl, DeviceType::IntegratedGpu), &Limits::default()).expect_err("GL");
        let reason = NO_GLSL;
        let lacks = vec![Lack::Backend { backend: Backend::Gl, reason }];
        assert_eq!(error, GpuError::Unusable { adapter: "a GPU (gl)".to_owned(), lacks });
        assert_eq!(
            error.to_string(),
            "adapter a GPU (gl) cannot be used: its backend is gl, for which the kernels do not compile"
        );
    }

    #[test]
    fn every_limit_that_is_too_small_is_named() {
        let limits = Limits {
            max_storage_buffers_per_shader_stage: 4,
            max_compute_invocations_per_workgroup: WORKGROUP - 1,
            ..Limits::default()
        };
        let lacks = lacks(&named(Backend::Metal, DeviceType::IntegratedGpu), &limits);
        let [buffers, threads] = &lacks[..] else { panic!("{lacks:?}") };
        assert!(
            matches!(buffers, Lack::Limit { limit: "max_storage_buffers_per_shader_stage", has: 4, needs } if *needs > 4)
        );
        let (has, needs) = (u64::from(WORKGROUP) - 1, u64::from(WORKGROUP));
        assert_eq!(*threads, Lack::Limit { limit: "max_compute_invocations_per_workgroup", has, needs });
        let both = Listed(&lacks).to_string();
        assert!(both.contains("is 4, ") && both.contains("; max_compute_invocations_per_workgroup is "), "{both}");
        assert!(self::lacks(&named(Backend::Vulkan, DeviceType::Cpu), &Limits::downlevel_webgl2_defaults()).len() >= 3);
    }
}
