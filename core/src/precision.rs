//! How much is certified: a choice made by type, so that the cheaper mode carries no trace of the dearer one.

/// Exact or plain f32, chosen at run time: what executors are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every bit is certified, or decided in integers: [`Exact`].
    #[default]
    Exact,
    /// Plain f32, no certification, no fallback: [`Fast`]. Bits may differ from device to device.
    Fast,
}

/// Whether float signs are certified.
pub trait PrecisionMode: Copy + Default + Send + Sync {
    /// True: a sign within its error bound is decided in integers. False: the float sign is taken as it is.
    const CERTIFIED: bool;
}

/// Every bit is the one true answer on the lattice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exact;

/// Plain f32: no bounds, no fallback. Bits within rounding of an edge may differ from [`Exact`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fast;

impl PrecisionMode for Exact {
    const CERTIFIED: bool = true;
}

impl PrecisionMode for Fast {
    const CERTIFIED: bool = false;
}
