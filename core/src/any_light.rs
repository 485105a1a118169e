//! A light of any kind, on the lattice.

use crate::{light::LatticeLight, punctual::Punctual};

/// A light on the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnyLight {
    /// One with an area.
    Area(LatticeLight),
    /// One without extent.
    Punctual(Punctual),
}

impl AnyLight {
    /// Bits of a mask.
    pub fn sample_count(&self) -> u32 {
        match self {
            Self::Area(light) => light.sample_count(),
            Self::Punctual(_) => 1,
        }
    }
}

impl From<LatticeLight> for AnyLight {
    fn from(light: LatticeLight) -> Self {
        Self::Area(light)
    }
}

impl From<Punctual> for AnyLight {
    fn from(light: Punctual) -> Self {
        Self::Punctual(light)
    }
}
