//! Many lights in one call, each of its own kind and resolution.

use umbra4_core::{
    LatticeLight, Punctual,
    cloud::Cloud,
    emission::{Emission, Weight},
    glam::IVec3,
};

use crate::{CpuExecutor, ExecutorError, Occluders, Receivers, Statistics, reduction::OfBack};

/// One of the lights of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source<'a> {
    /// A light with an area.
    Area {
        /// The light.
        light: LatticeLight,
        /// Where it shines.
        sides: Sides,
        /// What its samples emit; without, all as much.
        emission: Option<Emission<&'a [Weight]>>,
    },
    /// A light without extent.
    Punctual(Punctual),
    /// A light with a volume.
    Cloud(Cloud<&'a [IVec3]>),
}

/// The sides to which a light with an area shines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Sides {
    /// One.
    #[default]
    Front,
    /// Both, from the same samples ([`LatticeLight::back`]).
    Both,
}

impl From<LatticeLight> for Source<'_> {
    fn from(light: LatticeLight) -> Self {
        Self::Area { light, sides: Sides::Front, emission: None }
    }
}

impl<'a> From<Cloud<&'a [IVec3]>> for Source<'a> {
    fn from(light: Cloud<&'a [IVec3]>) -> Self {
        Self::Cloud(light)
    }
}

impl From<Punctual> for Source<'_> {
    fn from(light: Punctual) -> Self {
        Self::Punctual(light)
    }
}

/// What the receivers get of a light.
#[derive(Clone, Debug, PartialEq)]
pub enum Lit {
    /// It reaches none of them: nothing was run, and nothing is stored.
    Nowhere,
    /// Of every receiver, the fraction of samples that are seen, in `0.0..=1.0`.
    Fractions(Vec<f32>),
    /// Of every receiver, the sum of the weights of samples that are seen, red, green and blue.
    Weights(Vec<[u32; 3]>),
}

impl CpuExecutor {
    /// What all receivers get of each light, in the order of the lights. A light that no receiver lies before costs one look at
    /// every receiver, and no memory.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Lit, Occluders, Receivers};
    /// use umbra4_core::{AreaLight, Bounds, DirectionalLight, Lattice, Lift, glam::{DVec3, Vec3}};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
    ///
    /// let lamp = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?; // shines down
    /// let lamp = lamp.snap(&lattice, Lift::NONE)?;
    /// let sun = DirectionalLight { towards: DVec3::Y }.snap()?;
    /// let lights = [lamp.into(), lamp.back().into(), sun.into()];
    /// let lit = CpuExecutor::new().lights(&occluders, &lights, &receivers)?;
    /// assert!(matches!(&lit[0].0, Lit::Fractions(lit) if lit[0] < 0.5 && lit[1] == 1.0));
    /// assert_eq!(lit[1].0, Lit::Nowhere);
    /// assert_eq!(lit[2].0, Lit::Fractions(vec![0.0, 1.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// An emission of another number of rows or columns than its light's, by the light's place.
    pub fn lights(
        &self,
        occluders: &Occluders,
        lights: &[Source<'_>],
        receivers: &Receivers,
    ) -> Result<Vec<(Lit, Statistics)>, ExecutorError> {
        let lit = |(index, source)| {
            let of_light = |error| ExecutorError::Light { index, source: Box::new(error) };
            self.light_of(occluders, source, receivers).map_err(of_light)
        };
        lights.iter().enumerate().map(lit).collect()
    }

    /// As [`CpuExecutor::lights`], of one light.
    ///
    /// # Errors
    /// An emission of another number of rows or columns than the light's.
    pub fn light_of(
        &self,
        occluders: &Occluders,
        source: &Source<'_>,
        receivers: &Receivers,
    ) -> Result<(Lit, Statistics), ExecutorError> {
        let (light, sides, emission) = match source {
            Source::Area { light, sides, emission } => (light, *sides, emission.as_ref()),
            Source::Punctual(light) => return self.punctual_source(occluders, light, receivers),
            Source::Cloud(_) if receivers.is_empty() => return Ok((Lit::Nowhere, Statistics::default())),
            Source::Cloud(light) => {
                let (fractions, statistics) = self.cloud_visibility(occluders, light, receivers)?;
                return Ok((Lit::Fractions(fractions), statistics));
            }
        };
        let back = (sides == Sides::Both).then(|| light.back());
        let sides = [Some(*light), back].map(|side| side.filter(|side| receivers.meet(*side)));
        let Some(emission) = emission else {
            let run = |side: &LatticeLight, _| self.visibility(occluders, side, receivers);
            return sum(sides, run, |sum, of_back| *sum += of_back)
                .map(|(sums, s)| (Lit::new(sums, Lit::Fractions), s));
        };
        Self::check_emission(light, emission)?;
        let run = |side: &LatticeLight, is_back| match is_back {
            false => self.per_receiver(occluders, side, receivers, emission),
            true => self.per_receiver(occluders, side, receivers, OfBack(emission)),
        };
        let add = |sum: &mut [u32; 3], of_back: [u32; 3]| sum.iter_mut().zip(of_back).for_each(|(sum, x)| *sum += x);
        sum(sides, run, add).map(|(sums, statistics)| (Lit::new(sums, Lit::Weights), statistics))
    }

    fn punctual_source(
        &self,
        occluders: &Occluders,
        light: &Punctual,
        receivers: &Receivers,
    ) -> Result<(Lit, Statistics), ExecutorError> {
        if !receivers.meet(*light) {
            return Ok((Lit::Nowhere, Statistics::default()));
        }
        let (shadows, statistics) = self.hard_shadows(occluders, light, receivers)?;
        let lit = |receiver| if shadows.is_blocked(receiver) == Some(true) { 0.0 } else { 1.0 };
        Ok((Lit::Fractions((0..receivers.len()).map(lit).collect()), statistics))
    }
}

impl Lit {
    fn new<T>(values: Option<Vec<T>>, of: impl FnOnce(Vec<T>) -> Self) -> Self {
        values.map_or(Self::Nowhere, of)
    }
}

/// The values of the sides that are there, added up: a receiver lies before one of them at most. `run` is told whether it is the
/// back.
fn sum<T>(
    sides: [Option<LatticeLight>; 2],
    run: impl Fn(&LatticeLight, bool) -> Result<(Vec<T>, Statistics), ExecutorError>,
    add: impl Fn(&mut T, T),
) -> Result<(Option<Vec<T>>, Statistics), ExecutorError> {
    let (mut sums, mut total): (Option<Vec<T>>, _) = (None, Statistics::default());
    for (side, is_back) in sides.iter().zip([false, true]) {
        let Some(side) = side else { continue };
        let (values, statistics) = run(side, is_back)?;
        total.include(&statistics);
        match &mut sums {
            None => sums = Some(values),
            Some(sums) => sums.iter_mut().zip(values).for_each(|(sum, value)| add(sum, value)),
        }
    }
    Ok((sums, total))
}
