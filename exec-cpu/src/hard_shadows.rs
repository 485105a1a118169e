//! What a light without extent leaves in shadow, as it is handed back.

use std::sync::atomic::{AtomicU32, Ordering};

/// A bit a receiver: 1 where the light is blocked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HardShadows {
    words: Vec<u32>,
    receivers: usize,
}

impl HardShadows {
    /// Number of receivers.
    pub fn len(&self) -> usize {
        self.receivers
    }

    /// True where there are none.
    pub fn is_empty(&self) -> bool {
        self.receivers == 0
    }

    /// Whether the light is blocked from a receiver, or `None` where there is no such receiver.
    pub fn is_blocked(&self, receiver: usize) -> Option<bool> {
        let word = self.words.get(receiver / 32).filter(|_| receiver < self.receivers)?;
        Some(word >> (receiver % 32) & 1 == 1)
    }

    /// All bits: bit n of word w is receiver 32·w + n; bits beyond the last receiver are 0.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// How many receivers the light is blocked from.
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }
}

/// Bits that are set from many threads.
pub(crate) struct ShadowBits {
    words: Vec<AtomicU32>,
    receivers: usize,
}

impl ShadowBits {
    /// All in the light.
    pub(crate) fn new(receivers: usize) -> Self {
        Self { words: (0..receivers.div_ceil(32)).map(|_| AtomicU32::new(0)).collect(), receivers }
    }

    /// Puts a receiver in shadow.
    pub(crate) fn set(&self, receiver: usize) {
        self.words[receiver / 32].fetch_or(1 << (receiver % 32), Ordering::Relaxed);
    }

    pub(crate) fn finish(self) -> HardShadows {
        HardShadows { words: self.words.into_iter().map(AtomicU32::into_inner).collect(), receivers: self.receivers }
    }
}
