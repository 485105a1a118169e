//! A kernel of any table: what recorder, pipelines and modules ask of it.

use umbra4_core::kernel::{self, Access, Bound, Kernel, ParamsKind};
use umbra4_maps::kernel::{self as map_kernel, MapKernel, MapSlot};

/// A kernel, of core's table or of that of the maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DeviceKernel {
    /// Of the exact system.
    Exact(Kernel),
    /// Of the approximate ones.
    Maps(MapKernel),
}

impl From<Kernel> for DeviceKernel {
    fn from(kernel: Kernel) -> Self {
        Self::Exact(kernel)
    }
}

impl From<MapKernel> for DeviceKernel {
    fn from(kernel: MapKernel) -> Self {
        Self::Maps(kernel)
    }
}

impl DeviceKernel {
    /// All kernels, table by table: the order of the manifest.
    pub fn all() -> impl Iterator<Item = Self> {
        let exact = kernel::TABLE.iter().map(|info| info.kernel.into());
        exact.chain(map_kernel::TABLE.iter().map(|info| info.kernel.into()))
    }

    /// Name of its entry point; no two kernels share one.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact(kernel) => kernel.info().name,
            Self::Maps(kernel) => kernel.info().name,
        }
    }

    /// Bytes of its parameters, binding 0.
    pub const fn params_size(self) -> usize {
        match self {
            Self::Exact(kernel) => kernel.info().params.size(),
            Self::Maps(kernel) => kernel.info().params.size(),
        }
    }

    /// What it does to its bindings, from 1 on.
    pub fn accesses(self) -> impl Iterator<Item = Access> {
        let (exact, maps): (&[Bound], &[Bound<MapSlot>]) = match self {
            Self::Exact(kernel) => (kernel.info().bound, &[]),
            Self::Maps(kernel) => (&[], kernel.info().bound),
        };
        exact.iter().map(|bound| bound.access).chain(maps.iter().map(|bound| bound.access))
    }

    /// Whether it is checked by naga whatever is asked for: raw, lavapipe gives some receivers of jittered samples, or before a cloud,
    /// wrong masks; why is not known yet.
    pub(crate) const fn is_always_checked(self) -> bool {
        match self {
            Self::Exact(kernel) => {
                matches!(kernel.info().params, ParamsKind::JitteredLight | ParamsKind::Cloud | ParamsKind::Caster)
            }
            Self::Maps(_) => false,
        }
    }
}
