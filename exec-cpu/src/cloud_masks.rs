//! What a cloud's samples are hidden from, as it is handed back.

/// The masks of all receivers before a cloud, receiver-major: bit k of word w is sample `32·w + k`, 1 where it is blocked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CloudMasks {
    pub(crate) width: usize,
    pub(crate) words: Vec<u32>,
}

impl CloudMasks {
    /// Words a receiver.
    pub fn width(&self) -> usize {
        self.width
    }

    /// All words: shape (receivers, words a receiver).
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// The mask of one receiver, or `None` where there is no such receiver.
    pub fn receiver(&self, index: usize) -> Option<&[u32]> {
        self.words.chunks_exact(self.width.max(1)).nth(index)
    }

    /// The words, without a copy.
    pub fn into_words(self) -> Vec<u32> {
        self.words
    }
}
