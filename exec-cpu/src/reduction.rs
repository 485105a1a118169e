//! What is made of a mask that is not stored.

use umbra4_core::{
    MaskWord,
    emission::{Emission, Weight},
    stage::reduce,
};

use crate::executor::Answer;

/// From the mask of a receiver to a value.
pub(crate) trait Reduction: Sync {
    type Value: Copy + Default + Send;

    fn of<W: MaskWord>(&self, answer: &Answer<'_, W>) -> Self::Value;
}

/// Lit samples.
pub(crate) struct LitCount {
    pub(crate) columns: u32,
}

impl Reduction for LitCount {
    type Value = u32;

    fn of<W: MaskWord>(&self, answer: &Answer<'_, W>) -> u32 {
        if answer.lit { answer.rows.len() as u32 * self.columns } else { reduce::lit_count(answer.rows, self.columns) }
    }
}

/// The fraction of lit samples.
pub(crate) struct Visibility {
    pub(crate) columns: u32,
    /// Lit count → visibility.
    pub(crate) table: Vec<f32>,
}

impl Reduction for Visibility {
    type Value = f32;

    fn of<W: MaskWord>(&self, answer: &Answer<'_, W>) -> f32 {
        self.table[LitCount { columns: self.columns }.of(answer) as usize]
    }
}

/// Triangles that block something.
pub(crate) struct Pairs;

impl Reduction for Pairs {
    type Value = u32;

    fn of<W: MaskWord>(&self, answer: &Answer<'_, W>) -> u32 {
        answer.pairs
    }
}

/// Sums of the weights of lit samples.
impl<S: AsRef<[Weight]> + Sync> Reduction for &Emission<S> {
    type Value = [u32; 3];

    fn of<W: MaskWord>(&self, answer: &Answer<'_, W>) -> [u32; 3] {
        if answer.lit { self.total() } else { self.lit(answer.rows) }
    }
}
