//! Compares what a method gave with the reference: visibility, and the picture made of it.

use image::RgbImage;
use umbra4_core::AreaLight;

use crate::{
    error::ProgramError,
    fractions::Fractions,
    light::Light,
    report::{
        difference::Difference,
        flip::Seen,
        maps,
        methods::{Family, Run},
        problem::Problem,
        results::Entry,
        tiles::Choice,
    },
    shade,
};

/// Who is judged.
pub struct Entrant {
    /// Its name.
    pub name: String,
    /// Its curve.
    pub family: Option<Family>,
    /// Light samples each way, or texels.
    pub side: u32,
}

/// Knows the reference.
pub struct Judge<'a> {
    problem: &'a Problem,
    light: AreaLight,
    expected: &'a [f32],
    seen: Seen,
    gain: f64,
}

impl<'a> Judge<'a> {
    /// Judges by the visibilities `expected`; differences are shown `gain` times as large.
    ///
    /// # Errors
    /// A light without area.
    pub fn new(problem: &'a Problem, expected: &'a [f32], gain: f64) -> Result<Self, ProgramError> {
        let light = problem.light(1)?;
        let seen = Seen::new(&shaded(problem, &light, expected));
        Ok(Self { problem, light, expected, seen, gain })
    }

    /// Compares a run.
    ///
    /// # Errors
    /// No receivers; a visibility that is none.
    pub fn entry(&self, entrant: Entrant, choice: &Choice, run: Run) -> Result<Entry, ProgramError> {
        let Entrant { name, family, side } = entrant;
        let difference = Difference::between(&run.visibility, &choice.of(self.expected))?;
        let picture = shaded(self.problem, &self.light, &choice.filled(&run.visibility, self.expected));
        let flip = self.flip(&picture, choice);
        let seen = &self.problem.seen;
        let map = maps::signed(seen, choice, &run.visibility, self.expected, self.gain);
        let shaded = maps::faded(&picture, seen, choice, self.expected.len());
        let (receivers, one_in) = (choice.receivers.len(), choice.one_in);
        Ok(Entry { name, family, side, receivers, one_in, run, difference, flip, on_front: false, shaded, map })
    }

    /// Mean FLIP over the pixels that see nothing but the method's own.
    fn flip(&self, picture: &RgbImage, choice: &Choice) -> Option<f64> {
        let values = self.seen.against(&Seen::new(picture))?;
        let inside = |i: &usize| {
            let i = *i as u32;
            choice.inside(&self.problem.seen, i % picture.width(), i / picture.width())
        };
        let (count, sum) = (0..values.len())
            .filter(inside)
            .fold((0_u32, 0.0), |(count, sum), i| (count + 1, sum + f64::from(values[i])));
        (count > 0).then(|| sum / f64::from(count))
    }
}

/// The picture as a PNG would hold it.
fn shaded(problem: &Problem, light: &AreaLight, visibility: &[f32]) -> RgbImage {
    let (lights, fractions) = ([Light::plain("the light", *light)], [Fractions::Plain(visibility.to_vec())]);
    shade::shaded(&problem.seen, &lights, &fractions, &problem.scene.look()).encoded()
}
