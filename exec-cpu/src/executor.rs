//! INTERIM: brute force behind the final interface, so that the program and the tests can be written against it.

use thiserror::Error;
use umbra4_core::{Counts, LatticeLight, MaskWord, exact};

use crate::{Masks, Occluders, Receivers};

/// Exact or plain f32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every bit is certified, or decided in integers.
    #[default]
    Exact,
    /// Plain f32: no certification, no fallback.
    Fast,
}

/// Which index finds the pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Index {
    /// A hierarchy over the triangles, against groups of receivers.
    #[default]
    Hierarchy,
}

/// Why a run is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ExecutorError {
    /// The mask word holds fewer columns than the light has.
    #[error("a light of {columns} columns does not fit words of {bits} bits")]
    WordTooNarrow {
        /// Columns of the light.
        columns: u32,
        /// Bits of the word.
        bits: u32,
    },
    /// The thread pool could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// What a run did.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// Pairs and fallbacks.
    pub counts: Counts,
    /// Seconds spent in each stage, in the order they ran.
    pub seconds_by_stage: Vec<(&'static str, f64)>,
}

/// Runs the stages on CPU threads.
#[derive(Debug, Default)]
pub struct CpuExecutor {
    precision: Precision,
}

impl CpuExecutor {
    /// An executor on as many threads as the machine has, exact, with the default index.
    pub fn new() -> Self {
        Self::default()
    }

    /// Uses `threads` threads of its own.
    ///
    /// # Errors
    /// The system refuses the threads.
    pub fn with_threads(self, threads: usize) -> Result<Self, ExecutorError> {
        let _ = threads;
        Ok(self)
    }

    /// Chooses the precision.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// Chooses the index.
    #[must_use]
    pub fn with_index(self, index: Index) -> Self {
        let _ = index;
        self
    }

    /// Hands the mask of every receiver to `visit(receiver, rows)`, from many threads and in any order, and stores none.
    ///
    /// # Errors
    /// The word is too narrow for the light.
    pub fn visit<W: MaskWord>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        visit: impl Fn(usize, &[W]) + Sync,
    ) -> Result<Statistics, ExecutorError> {
        if light.columns > W::BITS {
            return Err(ExecutorError::WordTooNarrow { columns: light.columns, bits: W::BITS });
        }
        for (r, &p) in receivers.points().iter().enumerate() {
            let mut rows = vec![W::EMPTY; light.rows as usize];
            for (row, word) in rows.iter_mut().enumerate() {
                for column in 0..light.columns {
                    let blocked = exact::behind_light::<exact::Wide>(light, p)
                        || (0..occluders.triangles().len()).any(|t| {
                            occluders
                                .corners(t)
                                .is_some_and(|t| exact::blocks::<exact::Wide>(light, p, t, row as u32, column))
                        });
                    if blocked {
                        *word = word.or(W::span(column, column + 1));
                    }
                }
            }
            visit(r, &rows);
        }
        Ok(Statistics::default())
    }

    /// The masks of all receivers.
    ///
    /// # Errors
    /// The word is too narrow for the light.
    pub fn masks<W: MaskWord>(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Masks<W>, Statistics), ExecutorError> {
        let rows = light.rows as usize;
        let words = std::sync::Mutex::new(vec![W::EMPTY; rows * receivers.len()]);
        let statistics = self.visit::<W>(occluders, light, receivers, |r, mask| {
            if let Ok(mut words) = words.lock() {
                words[r * rows..(r + 1) * rows].copy_from_slice(mask);
            }
        })?;
        Ok((Masks { rows, words: words.into_inner().unwrap_or_default() }, statistics))
    }

    /// The fraction of lit samples of every receiver, in `0.0..=1.0`. Masks are never stored.
    ///
    /// # Errors
    /// As [`CpuExecutor::masks`]; the word is chosen to fit.
    pub fn visibility(
        &self,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Statistics), ExecutorError> {
        let (masks, statistics) = self.masks::<u64>(occluders, light, receivers)?;
        let samples = light.sample_count();
        let lit = masks
            .words()
            .chunks_exact(light.rows as usize)
            .map(|rows| 1.0 - rows.iter().map(|w| w.count()).sum::<u32>() as f32 / samples as f32)
            .collect();
        Ok((lit, statistics))
    }
}
