//! Instruction sets, and which of them the processor has.

use std::fmt;

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

/// An instruction set that this processor was found to have. Kernels are called through it, so that none can be called that
/// the processor cannot run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Detected(Isa);

impl Detected {
    /// The widest that this processor has.
    pub fn best() -> Self {
        Self(Isa::best())
    }

    /// Which it is.
    pub fn isa(self) -> Isa {
        self.0
    }
}

impl Isa {
    /// All that this processor has, widest first. Never empty.
    pub fn available() -> Vec<Self> {
        let mut found = Self::detected();
        found.push(Self::Portable);
        found
    }

    /// The widest that this processor has.
    pub fn best() -> Self {
        Self::available().first().copied().unwrap_or(Self::Portable)
    }

    /// `None` where the processor lacks it.
    pub fn detect(self) -> Option<Detected> {
        Self::available().contains(&self).then_some(Detected(self))
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
