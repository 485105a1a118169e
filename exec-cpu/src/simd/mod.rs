//! Instruction sets: which of them the processor has, and the resolve kernels compiled for each.

use std::fmt;

use umbra4_core::{
    Exact, Fast, MaskWord, Precision, PrecisionMode,
    cloud_pair::SampleTest,
    jitter::{Pattern, Regular, Samples},
    lanes::{Lanes, Sixteen},
    stage::{
        resolve::{Group, Occlusion, resolve},
        resolve_cells::{CellScene, resolve_cell},
        resolve_cloud::{CloudGroup, CloudScene, resolve_cloud},
        resolve_punctual::{PunctualGroup, PunctualScene, resolve_punctual},
        resolve_silhouette::{SilhouetteRoom, SilhouetteScene, resolve_silhouette},
    },
};

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod long;
#[cfg(target_arch = "aarch64")]
mod neon;

/// What portable kernels are made of, for samples that lie so. Sixteen lanes of jittered ones take compilers minutes.
pub(crate) trait Portable: Samples {
    /// Its lanes.
    type Lanes: Lanes;
}

impl Portable for Regular {
    type Lanes = Sixteen;
}

impl Portable for Pattern {
    type Lanes = f32;
}

/// An instruction set that kernels are compiled for. All give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Isa {
    /// Sixteen lanes in one register.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// Sixteen lanes in two registers.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Sixteen lanes in four registers.
    #[cfg(target_arch = "aarch64")]
    Neon,
    /// What the compiler makes of plain arrays for the target's baseline.
    Portable,
}

impl Isa {
    /// All that this processor has, widest first. Never empty.
    pub fn available() -> Vec<Self> {
        let mut found = Self::detected();
        found.push(Self::Portable);
        found
    }

    #[cfg(target_arch = "x86_64")]
    fn detected() -> Vec<Self> {
        let avx2 = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        let avx512 = avx2
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        [(avx512, Self::Avx512), (avx2, Self::Avx2)].into_iter().filter(|(has, _)| *has).map(|(_, isa)| isa).collect()
    }

    #[cfg(target_arch = "aarch64")]
    fn detected() -> Vec<Self> {
        // No processor that runs this lacks it.
        vec![Self::Neon]
    }

    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    fn detected() -> Vec<Self> {
        Vec::new()
    }

    /// The widest that this processor has.
    pub fn best() -> Self {
        Self::available().first().copied().unwrap_or(Self::Portable)
    }

    /// Fills the masks of a group. `self` comes from [`Isa::available`].
    #[inline]
    pub(crate) fn resolve<W: MaskWord, P: PrecisionMode, S: Portable>(
        self,
        scene: &Occlusion<'_>,
        samples: &S,
        group: &mut Group<W>,
    ) {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an executor only holds an instruction set that `available` has detected.
            Self::Avx512 => unsafe { resolve_avx512::<W, P, S>(scene, samples, group) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Self::Avx2 => unsafe { resolve_avx2::<W, P, S>(scene, samples, group) },
            #[cfg(target_arch = "aarch64")]
            Self::Neon => resolve::<neon::Neon, W, P, S>(scene, samples, group),
            Self::Portable => resolve::<S::Lanes, W, P, S>(scene, samples, group),
        }
    }

    /// Fills the masks of a group by the silhouette. `self` comes from [`Isa::available`].
    #[inline]
    pub(crate) fn resolve_silhouette<W: MaskWord, P: PrecisionMode, S: Portable>(
        self,
        scene: &SilhouetteScene<'_>,
        samples: &S,
        group: &mut Group<W>,
        room: &mut SilhouetteRoom<W>,
    ) {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an executor only holds an instruction set that `available` has detected.
            Self::Avx512 => unsafe { resolve_silhouette_avx512::<W, P, S>(scene, samples, group, room) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Self::Avx2 => unsafe { resolve_silhouette_avx2::<W, P, S>(scene, samples, group, room) },
            #[cfg(target_arch = "aarch64")]
            Self::Neon => resolve_silhouette::<neon::Neon, W, P, S>(scene, samples, group, room),
            Self::Portable => resolve_silhouette::<S::Lanes, W, P, S>(scene, samples, group, room),
        }
    }

    /// Fills the masks of a group with the triangles `list` of its cell. `self` comes from [`Isa::available`].
    #[inline]
    pub(crate) fn resolve_cell<W: MaskWord, P: PrecisionMode>(
        self,
        scene: &CellScene<'_>,
        list: &[u32],
        group: &mut Group<W>,
    ) {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an executor only holds an instruction set that `available` has detected.
            Self::Avx512 => unsafe { resolve_cell_avx512::<W, P>(scene, list, group) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Self::Avx2 => unsafe { resolve_cell_avx2::<W, P>(scene, list, group) },
            #[cfg(target_arch = "aarch64")]
            Self::Neon => resolve_cell::<neon::Neon, W, P>(scene, list, group),
            Self::Portable => resolve_cell::<Sixteen, W, P>(scene, list, group),
        }
    }

    /// Finds the receivers of a group that a light without extent does not reach. `self` comes from [`Isa::available`].
    #[inline]
    pub(crate) fn resolve_punctual(self, precision: Precision, scene: &PunctualScene<'_>, group: &mut PunctualGroup) {
        match precision {
            Precision::Exact => self.resolve_punctual_in::<Exact>(scene, group),
            Precision::Fast => self.resolve_punctual_in::<Fast>(scene, group),
        }
    }

    #[inline]
    fn resolve_punctual_in<P: PrecisionMode>(self, scene: &PunctualScene<'_>, group: &mut PunctualGroup) {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an executor only holds an instruction set that `available` has detected.
            Self::Avx512 => unsafe { resolve_punctual_avx512::<P>(scene, group) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Self::Avx2 => unsafe { resolve_punctual_avx2::<P>(scene, group) },
            #[cfg(target_arch = "aarch64")]
            Self::Neon => resolve_punctual::<neon::Neon, P>(scene, group),
            Self::Portable => resolve_punctual::<Sixteen, P>(scene, group),
        }
    }

    /// Fills the masks of a group before a cloud. `self` comes from [`Isa::available`].
    #[inline]
    pub(crate) fn resolve_cloud<P: PrecisionMode, T: SampleTest>(
        self,
        scene: &CloudScene<'_, T>,
        group: &mut CloudGroup,
    ) {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an executor only holds an instruction set that `available` has detected.
            Self::Avx512 => unsafe { resolve_cloud_avx512::<P, T>(scene, group) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Self::Avx2 => unsafe { resolve_cloud_avx2::<P, T>(scene, group) },
            #[cfg(target_arch = "aarch64")]
            Self::Neon => resolve_cloud::<neon::Neon, P, T>(scene, group),
            Self::Portable => resolve_cloud::<Sixteen, P, T>(scene, group),
        }
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "AVX-512",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "AVX2",
            #[cfg(target_arch = "aarch64")]
            Self::Neon => "NEON",
            Self::Portable => "portable",
        })
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_avx512<W: MaskWord, P: PrecisionMode, S: Samples>(scene: &Occlusion<'_>, samples: &S, group: &mut Group<W>) {
    resolve::<avx512::Avx512, W, P, S>(scene, samples, group);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_avx2<W: MaskWord, P: PrecisionMode, S: Samples>(scene: &Occlusion<'_>, samples: &S, group: &mut Group<W>) {
    resolve::<avx2::Avx2, W, P, S>(scene, samples, group);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_silhouette_avx512<W: MaskWord, P: PrecisionMode, S: Samples>(
    scene: &SilhouetteScene<'_>,
    samples: &S,
    group: &mut Group<W>,
    room: &mut SilhouetteRoom<W>,
) {
    resolve_silhouette::<avx512::Avx512, W, P, S>(scene, samples, group, room);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_silhouette_avx2<W: MaskWord, P: PrecisionMode, S: Samples>(
    scene: &SilhouetteScene<'_>,
    samples: &S,
    group: &mut Group<W>,
    room: &mut SilhouetteRoom<W>,
) {
    resolve_silhouette::<avx2::Avx2, W, P, S>(scene, samples, group, room);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_cell_avx512<W: MaskWord, P: PrecisionMode>(scene: &CellScene<'_>, list: &[u32], group: &mut Group<W>) {
    resolve_cell::<avx512::Avx512, W, P>(scene, list, group);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_cell_avx2<W: MaskWord, P: PrecisionMode>(scene: &CellScene<'_>, list: &[u32], group: &mut Group<W>) {
    resolve_cell::<avx2::Avx2, W, P>(scene, list, group);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_punctual_avx512<P: PrecisionMode>(scene: &PunctualScene<'_>, group: &mut PunctualGroup) {
    resolve_punctual::<avx512::Avx512, P>(scene, group);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_punctual_avx2<P: PrecisionMode>(scene: &PunctualScene<'_>, group: &mut PunctualGroup) {
    resolve_punctual::<avx2::Avx2, P>(scene, group);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_cloud_avx512<P: PrecisionMode, T: SampleTest>(scene: &CloudScene<'_, T>, group: &mut CloudGroup) {
    resolve_cloud::<avx512::Avx512, P, T>(scene, group);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn resolve_cloud_avx2<P: PrecisionMode, T: SampleTest>(scene: &CloudScene<'_, T>, group: &mut CloudGroup) {
    resolve_cloud::<avx2::Avx2, P, T>(scene, group);
}
