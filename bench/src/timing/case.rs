//! One scene, image and light, on which any contender can be timed.

use crate::{
    contender::{ContenderError, Entry, Run, by_name},
    image_size::ImageSize,
    primary::{Hit, hits},
    problem::{Problem, ProblemError},
    row_word::RowWord,
    scene::Scene,
    subset,
};

/// A scene and its receivers.
#[derive(Clone, Debug)]
pub struct Case {
    scene: Scene,
    hits: Vec<Hit>,
    rival_hits: Vec<Hit>,
}

impl Case {
    /// All receivers of an image; rivals get about `rival_receivers` of them, in whole 8×8 tiles chosen by `seed`.
    pub fn new(scene: Scene, size: ImageSize, rival_receivers: usize, seed: u64) -> Self {
        let hits = hits(&scene.model, &scene.camera, size);
        let rival_hits = subset::tiles(&hits, rival_receivers, seed).into_iter().map(|index| hits[index]).collect();
        Self { scene, hits, rival_hits }
    }

    /// The same receivers in the same scene with another light.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn with<E>(&self, change: impl FnOnce(Scene) -> Result<Scene, E>) -> Result<Self, E> {
        Ok(Self { scene: change(self.scene.clone())?, ..self.clone() })
    }

    /// Poses the problem, for umbra4 and for its rivals.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn pose(&self) -> Result<Posed<'_>, ProblemError> {
        Ok(Posed {
            ours: Problem::new(&self.scene, &self.hits, &self.hits)?,
            theirs: Problem::new(&self.scene, &self.hits, &self.rival_hits)?,
        })
    }
}

/// The problems that contenders are given.
pub struct Posed<'a> {
    ours: Problem<'a>,
    theirs: Problem<'a>,
}

impl Posed<'_> {
    /// Receivers of the image.
    pub fn receivers(&self) -> usize {
        self.ours.receivers.len()
    }

    /// Triangles of the scene.
    pub fn triangles(&self) -> usize {
        self.ours.model.triangles.len()
    }

    /// Seconds that a contender takes once for the masks of all receivers, building included; a rival's masks are scaled
    /// from those receivers that it is given. Words are the narrowest that hold a row.
    ///
    /// # Errors
    /// An unknown contender; whatever it refuses.
    pub fn seconds(&self, contender: &str, threads: usize) -> Result<f64, ContenderError> {
        match self.ours.light.columns {
            ..=16 => self.seconds_in::<u16>(contender, threads),
            17..=32 => self.seconds_in::<u32>(contender, threads),
            _ => self.seconds_in::<u64>(contender, threads),
        }
    }

    fn seconds_in<W: RowWord>(&self, contender: &str, threads: usize) -> Result<f64, ContenderError> {
        let Entry { ours, contender, .. } = by_name::<W>(contender)?;
        let problem = if ours { &self.ours } else { &self.theirs };
        let mut masks = vec![W::EMPTY; problem.receivers.len() * problem.rows()];
        let Run { build, masks, .. } = contender.run(problem, threads, &mut masks)?;
        Ok(build + masks * self.receivers() as f64 / problem.receivers.len().max(1) as f64)
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::scene::{SceneError, tiny};

    #[test]
    fn every_word_is_timed() {
        let case = Case::new(tiny(8), ImageSize::square(24), 64, 1);
        for (rows, columns) in [(8, 8), (8, 32), (3, 64)] {
            let case = case.with(|scene| scene.with_grid(rows, columns)).unwrap();
            let posed = case.pose().unwrap();
            assert_eq!((posed.ours.light.rows, posed.ours.light.columns), (rows, columns));
            assert!(posed.theirs.receivers.len() < posed.receivers());
            for contender in ["umbra4", "umbra4-fast", "obvhs"] {
                assert!(posed.seconds(contender, 1).unwrap() > 0.0);
            }
            assert!(posed.seconds("umbra5", 1).is_err());
        }
        let refused: Result<Case, SceneError> = case.with(|scene| scene.with_samples(65));
        assert!(refused.is_err());
    }
}
