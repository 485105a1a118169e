//! Compiles the ways to fill masks for the instruction sets that umbra4-cpu has, with its own lanes.

use umbra4_core::{LatticeLight, MaskWord, lanes::Sixteen};
use umbra4_cpu::Isa;

use super::{
    fill::{Fill, GroupMasks},
    pairs::GroupPairs,
};

// They are no part of umbra4-cpu's interface. With other lanes, the row loop would not be the one that it runs.
#[cfg(target_arch = "x86_64")]
#[path = "../../../exec-cpu/kernels/src/lanes/avx2.rs"]
mod avx2;
#[cfg(target_arch = "x86_64")]
#[path = "../../../exec-cpu/kernels/src/lanes/avx512.rs"]
mod avx512;
#[cfg(target_arch = "x86_64")]
#[path = "../../../exec-cpu/kernels/src/lanes/long.rs"]
mod long;

/// Fills the masks of a group. `isa` comes from [`Isa::available`].
#[inline]
pub fn run<W: MaskWord, F: Fill<W>>(
    isa: Isa,
    fill: &F,
    light: &LatticeLight,
    group: &GroupPairs,
    masks: &mut GroupMasks<W>,
) -> u64 {
    match isa {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the caller has an instruction set that the processor has.
        Isa::Avx512 => unsafe { run_avx512(fill, light, group, masks) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Isa::Avx2 => unsafe { run_avx2(fill, light, group, masks) },
        _ => fill.fill::<Sixteen>(light, group, masks),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx512<W: MaskWord, F: Fill<W>>(
    fill: &F,
    light: &LatticeLight,
    group: &GroupPairs,
    masks: &mut GroupMasks<W>,
) -> u64 {
    fill.fill::<avx512::Avx512>(light, group, masks)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<W: MaskWord, F: Fill<W>>(
    fill: &F,
    light: &LatticeLight,
    group: &GroupPairs,
    masks: &mut GroupMasks<W>,
) -> u64 {
    fill.fill::<avx2::Avx2>(light, group, masks)
}
