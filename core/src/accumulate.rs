//! Visibility accumulated over frames whose jitter differs: what is still converges, what moves is dropped.
//!
//! Seed: the temporal jittering of the paper on alias-free shadows and volumetric sources, section 4.2. Lit samples are counted in
//! integers, so that what has been accumulated does not depend on the order of frames, nor on the executor.

use thiserror::Error;

use crate::{
    jitter::Jitter,
    light::{LatticeLight, MAX_SAMPLES},
    ratio::{MOST_WHOLE, float32},
};

/// Most frames that are accumulated, with a light of so many samples: more would not change what f32 can tell.
pub const fn most_frames(samples: u32) -> u32 {
    MOST_WHOLE / if samples > 0 { samples } else { 1 }
}

/// Why a frame is not accumulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum AccumulationError {
    /// There are more, or fewer, receivers than sums.
    #[error("{receivers} lit counts for the sums of {sums} receivers")]
    Receivers {
        /// Lit counts given.
        receivers: usize,
        /// Sums there are.
        sums: usize,
    },
    /// A receiver has more lit samples than the light has samples.
    #[error("lit count {index} is {lit}, of {samples} samples")]
    Lit {
        /// Index of the receiver.
        index: usize,
        /// Its lit count.
        lit: u32,
        /// Samples of the light.
        samples: u32,
    },
}

/// Sums of lit samples over the frames since something moved. `S` holds one a receiver: a vector, or the caller's slice.
///
/// ```
/// use umbra4_core::{AreaLight, Bounds, Lattice, Lift, accumulate::Accumulation, glam::DVec3};
/// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 8, 8)?;
/// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
/// let mut accumulation = Accumulation::new(vec![0; 2]); // two receivers
/// let scene = 1; // another number whenever receivers or occluders are others
/// for lit_counts in [[64, 31], [64, 32]] {
///     let light = light.with_jitter(accumulation.next_jitter()).snap(&lattice, Lift::NONE)?;
///     // lit_counts = executor.lit_counts(&occluders, &light, &receivers)?
///     accumulation.add(scene, &light, &lit_counts)?;
/// }
/// assert_eq!(accumulation.visibility().collect::<Vec<_>>(), [1.0, 63.0 / 128.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Accumulation<S> {
    sums: S,
    frames: u32,
    /// Pattern of the next frame.
    number: u32,
    /// What the sums are of.
    still: Option<(u64, LatticeLight)>,
}

impl<S: AsRef<[u32]> + AsMut<[u32]>> Accumulation<S> {
    /// Of no frame yet. What `sums` holds is not looked at.
    pub fn new(sums: S) -> Self {
        Self { sums, frames: 0, number: 0, still: None }
    }

    /// How the next frame's samples are to be jittered.
    pub fn next_jitter(&self) -> Jitter {
        Jitter::pattern(self.number)
    }

    /// Frames in the sums.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Adds the lit samples of all receivers under `light`. Where the light, but for its jitter, or `scene` is another than
    /// before, what was accumulated is dropped first. After [`most_frames`] nothing is added any more. Returns the frames in
    /// the sums.
    ///
    /// # Errors
    /// As many receivers as there are sums have to be given, and no count above that of the light's samples; else nothing
    /// changes.
    pub fn add(&mut self, scene: u64, light: &LatticeLight, lit: &[u32]) -> Result<u32, AccumulationError> {
        let (sums, samples) = (self.sums.as_mut(), light.sample_count());
        if lit.len() != sums.len() {
            return Err(AccumulationError::Receivers { receivers: lit.len(), sums: sums.len() });
        }
        if let Some((index, &lit)) = lit.iter().enumerate().find(|(_, lit)| **lit > samples) {
            return Err(AccumulationError::Lit { index, lit, samples });
        }
        let still = Some((scene, LatticeLight { jitter: Jitter::NONE, ..*light }));
        self.number = self.number.wrapping_add(1);
        if self.still != still {
            (self.still, self.frames) = (still, 0);
            sums.fill(0);
        }
        if self.frames < most_frames(samples) {
            self.frames += 1;
            for (sum, lit) in sums.iter_mut().zip(lit) {
                *sum += lit;
            }
        }
        Ok(self.frames)
    }

    /// The fraction of lit samples of every receiver, over all frames; 0 before the first.
    pub fn visibility(&self) -> impl Iterator<Item = f32> {
        let samples = self.still.map_or(0, |(_, light)| light.sample_count());
        let whole = self.frames * samples;
        self.sums.as_ref().iter().map(move |&sum| f32::from_bits(float32(if whole > 0 { sum } else { 0 }, whole)))
    }
}

// Sums stay below what a word, and what f32, holds.
const _: () = assert!(most_frames(MAX_SAMPLES * MAX_SAMPLES) * MAX_SAMPLES * MAX_SAMPLES <= MOST_WHOLE);
