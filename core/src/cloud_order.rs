//! The samples of a cloud in the order in which they are worked on: those that follow each other lie together.

use glam::IVec3;

use crate::{
    cloud::{MAX_CLOUD, WORD_BITS},
    order::{BoxCurve, Entry, sort},
    shaft::around,
};

/// Samples along a curve, and which of the caller's they are.
#[derive(Clone, Debug)]
pub struct OrderedCloud {
    samples: [IVec3; MAX_CLOUD],
    /// The code on the curve of each sample, and its index among the caller's.
    entries: [Entry; MAX_CLOUD],
    count: usize,
}

impl OrderedCloud {
    /// Of samples on the lattice, of which the first [`MAX_CLOUD`] count.
    pub fn new(samples: &[IVec3]) -> Self {
        let count = samples.len().min(MAX_CLOUD);
        let curve = BoxCurve::through(around(samples));
        let mut cloud = Self { samples: [IVec3::ZERO; MAX_CLOUD], entries: [Entry::default(); MAX_CLOUD], count };
        let entries = cloud.entries.get_mut(..count).unwrap_or_default();
        for (index, (entry, sample)) in entries.iter_mut().zip(samples).enumerate() {
            *entry = Entry { code: curve.code(sample.to_array()), index: index as u32 };
        }
        sort(entries);
        for (place, entry) in cloud.samples.iter_mut().zip(entries) {
            *place = samples.get(entry.index as usize).copied().unwrap_or_default();
        }
        cloud
    }

    /// The samples in order.
    pub fn samples(&self) -> &[IVec3] {
        self.samples.get(..self.count).unwrap_or(&[])
    }

    /// Adds a mask whose bits are in order to `out`, whose bits are in the caller's order.
    pub fn write(&self, mask: &[u32], out: &mut [u32]) {
        for (word, entries) in mask.iter().zip(self.entries.chunks(WORD_BITS)) {
            let mut bits = *word;
            while bits != 0 {
                let entry = entries.get(bits.trailing_zeros() as usize).copied().unwrap_or_default();
                bits &= bits - 1;
                if let Some(word) = out.get_mut(entry.index as usize / WORD_BITS) {
                    *word |= 1 << (entry.index as usize % WORD_BITS);
                }
            }
        }
    }
}
