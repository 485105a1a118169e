//! Lanes of each instruction set.

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) mod avx512;
#[cfg(target_arch = "x86_64")]
mod long;
#[cfg(target_arch = "aarch64")]
pub(crate) mod neon;

use umbra4_core::{
    jitter::{Pattern, Regular, Samples},
    lanes::{Four, Lanes},
};

/// What portable kernels are made of, for samples that lie so. More lanes, and four of jittered ones, take compilers
/// minutes.
pub(crate) trait Portable: Samples {
    /// Its lanes.
    type Lanes: Lanes;
}

impl Portable for Regular {
    type Lanes = Four;
}

impl Portable for Pattern {
    type Lanes = f32;
}
