//! What is asked about the lights, and how it is found.

use umbra4_core::{AreaLight, Jitter};

use crate::{
    args::{RenderArgs, View},
    error::ProgramError,
    executor::{AnyExecutor, Report},
    fractions::Fractions,
    frames::Frames,
    light::Light,
    lighting,
    on_lattice::OnLattice,
    stages::Stages,
};

/// A light whose samples all emit the same, and its sides.
pub struct Plain<'a> {
    light: &'a Light,
    sides: Vec<AreaLight>,
}

/// All lights as plain rectangles.
///
/// # Errors
/// One of them is something else, which `option` does not go with.
pub fn plain<'a>(option: &'static str, lights: &'a [Light]) -> Result<Vec<Plain<'a>>, ProgramError> {
    let refused =
        |light: &Light| ProgramError::AreaOnly { option, light: format!("{} ({})", light.label, light.kind()) };
    let plain = |light: &'a Light| match light.plain_sides() {
        Some(sides) => Ok(Plain { light, sides }),
        None => Err(refused(light)),
    };
    lights.iter().map(plain).collect()
}

/// What is asked about the lights.
pub enum Asked<'a> {
    /// Which fraction of each reaches the receivers.
    Fractions(&'a [Light]),
    /// The same, over so many frames of jittered samples.
    Frames(Vec<Plain<'a>>, u32),
    /// How many triangles block something of any of them; of jittered samples, of one frame.
    Pairs(Vec<Plain<'a>>, Option<Jitter>),
}

/// What was found.
pub enum Found<'a> {
    /// Of every light, for every receiver.
    Fractions(Vec<Fractions<'a>>),
    /// For every receiver.
    Pairs(Vec<u32>),
}

impl<'a> Asked<'a> {
    /// What the command line asks.
    ///
    /// # Errors
    /// It is asked about plain rectangles, and there are other lights.
    pub fn of(args: &RenderArgs, lights: &'a [Light]) -> Result<Self, ProgramError> {
        match (args.view, args.jitter) {
            (View::Pairs, frames) => {
                Ok(Self::Pairs(plain("--view pairs", lights)?, frames.map(|_| Jitter::pattern(0))))
            }
            (_, Some(frames)) => Ok(Self::Frames(plain("--jitter", lights)?, frames)),
            (_, None) => Ok(Self::Fractions(lights)),
        }
    }

    /// How many frames of jittered samples there are; `None` where samples are regular.
    pub fn frames(&self) -> Option<u32> {
        match self {
            Self::Fractions(_) => None,
            Self::Frames(_, frames) => Some(*frames),
            // How often each receiver is met is a matter of one frame.
            Self::Pairs(_, jitter) => jitter.map(|_| 1),
        }
    }

    /// Finds it.
    ///
    /// # Errors
    /// A light that cannot be put on the lattice; what does not go with casters; the executor's.
    pub fn find(
        &self,
        executor: &AnyExecutor,
        scene: &OnLattice,
        stages: &mut Stages,
    ) -> Result<(Found<'a>, Report), ProgramError> {
        let refused = match self {
            _ if scene.casters.is_none() => None,
            Self::Fractions(_) => None,
            Self::Frames(..) => Some("--jitter"),
            Self::Pairs(..) => Some("--view pairs"),
        };
        if let Some(option) = refused {
            return Err(ProgramError::Casters { with: option.to_owned() });
        }
        let (found, runs, report) = match self {
            Self::Fractions(lights) => {
                let (fractions, report) = stages.run("shadows", || lighting::fractions(executor, lights, scene))?;
                (Found::Fractions(fractions), 1, report)
            }
            Self::Frames(lights, count) => over_frames(lights, *count, executor, scene, stages)?,
            Self::Pairs(lights, jitter) => {
                let (pairs, report) =
                    stages.run("shadows", || pairs(lights, jitter.unwrap_or(Jitter::NONE), executor, scene))?;
                (Found::Pairs(pairs), 1, report)
            }
        };
        stages.split_last(runs, &report);
        Ok((found, report))
    }
}

/// Fractions over frames; how many stages were run, and what they did.
fn over_frames<'a>(
    lights: &[Plain<'_>],
    count: u32,
    executor: &AnyExecutor,
    scene: &OnLattice,
    stages: &mut Stages,
) -> Result<(Found<'a>, usize, Report), ProgramError> {
    let sides: usize = lights.iter().map(|light| light.sides.len()).sum();
    let runs = sides * count as usize;
    stages.expect((runs as u64).saturating_sub(1));
    let (mut all, mut report) = (Vec::new(), Report::default());
    for light in lights {
        let mut sums = vec![0.0; scene.receivers.len()];
        for side in &light.sides {
            // What is wrong with a light is said of that light, before the first frame.
            light.light.snap_side(&side.with_jitter(Jitter::pattern(0)), &scene.lattice)?;
            let mut frames = Frames::new(executor, &scene.lattice, *side, &scene.occluders, &scene.receivers);
            for frame in 1..=count {
                stages.run(&format!("frame {frame} of {count}"), || frames.run())?;
            }
            sums.iter_mut().zip(frames.visibility()).for_each(|(sum, lit)| *sum += lit);
            report.add(&frames.report);
        }
        all.push(Fractions::Plain(sums));
    }
    Ok((Found::Fractions(all), runs, report))
}

/// Triangles that block something of each receiver, summed over lights.
fn pairs(
    lights: &[Plain<'_>],
    jitter: Jitter,
    executor: &AnyExecutor,
    scene: &OnLattice,
) -> Result<(Vec<u32>, Report), ProgramError> {
    let (mut sums, mut report) = (vec![0_u32; scene.receivers.len()], Report::default());
    for light in lights {
        for side in &light.sides {
            let snapped = light.light.snap_side(&side.with_jitter(jitter), &scene.lattice)?;
            let (pairs, done) = executor.pairs_per_receiver(scene.under(&snapped))?;
            report.add(&done);
            sums.iter_mut().zip(pairs).for_each(|(sum, pairs)| *sum = sum.saturating_add(pairs));
        }
    }
    Ok((sums, report))
}
