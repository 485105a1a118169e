//! Occlusion masks as they are handed back.

use umbra4_core::MaskWord;

/// The masks of all receivers, receiver-major: `rows` words a receiver, one word a row of the light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Masks<W> {
    pub(crate) rows: usize,
    pub(crate) words: Vec<W>,
}

impl<W: MaskWord> Masks<W> {
    /// Words a receiver.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// All words: shape (receivers, rows).
    pub fn words(&self) -> &[W] {
        &self.words
    }

    /// The rows of one receiver, or `None` where there is no such receiver.
    pub fn receiver(&self, index: usize) -> Option<&[W]> {
        self.words.chunks_exact(self.rows.max(1)).nth(index)
    }

    /// The words, without a copy.
    pub fn into_words(self) -> Vec<W> {
        self.words
    }
}
