//! Layers: which casters matter to which receivers. A caster casts on a receiver whose layers have one in common with its own.

use thiserror::Error;

/// Layers there are, numbered from 0.
pub const LAYERS: u32 = 32;

/// A layer does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("layers[{index}] is {layer}, outside 0..={}", LAYERS - 1)]
pub struct LayerError {
    /// Its place among those given.
    pub index: usize,
    /// The number given.
    pub layer: u32,
}

/// A set of layers.
///
/// ```
/// use umbra4_core::Layers;
///
/// let (hero, world) = (Layers::of(&[3])?, Layers::of(&[0, 1])?);
/// assert!(!hero.meet(world) && hero.meet(Layers::ALL));
/// assert!(Layers::of(&[0, 32]).is_err());
/// # Ok::<(), umbra4_core::layers::LayerError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Layers(u32);

impl Default for Layers {
    fn default() -> Self {
        Self::ALL
    }
}

impl Layers {
    /// Every layer: what casters and receivers are on unless told otherwise.
    pub const ALL: Self = Self(u32::MAX);
    /// No layer: casts on nothing, and nothing casts on it.
    pub const NONE: Self = Self(0);

    /// The layers with these numbers.
    ///
    /// # Errors
    /// The first number that is [`LAYERS`] or more.
    pub fn of(numbers: &[u32]) -> Result<Self, LayerError> {
        let mut bits = 0;
        for (index, layer) in numbers.iter().enumerate() {
            if *layer >= LAYERS {
                return Err(LayerError { index, layer: *layer });
            }
            bits |= 1 << layer;
        }
        Ok(Self(bits))
    }

    /// Bit k: layer k.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Bit k: layer k.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether both have a layer in common.
    #[inline(always)]
    pub const fn meet(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}
