//! Runs every method, and compares what it gave with the reference.

use std::time::Instant;

use crate::{
    error::ProgramError,
    report::{
        judge::{Entrant, Judge},
        maps,
        methods::{Method, REFERENCE_SIDE, Run, reference},
        problem::Problem,
        results::Results,
        tiles::Choice,
    },
    stages::Stages,
};

/// Methods take turns in so many rounds; the slow ones rest in all but the first two.
pub const ROUNDS: usize = 5;
/// Seconds that a method may take to be in every round.
pub const QUICK: f64 = 1.0;
/// Those of more run once: many frames, over which slow moments even out.
pub const LONG: f64 = 10.0;

/// Stages that [`measure`] runs, but for those it comes to expect itself.
pub fn stages(methods: usize) -> u64 {
    (1 + ROUNDS * methods) as u64
}

/// Runs `methods` and the reference.
///
/// # Errors
/// Whatever a method refuses; a camera that sees nothing.
pub fn measure(problem: &Problem, methods: &[Box<dyn Method>], stages: &mut Stages) -> Result<Results, ProgramError> {
    let expected = stages.run("reference", || reference(problem))?;
    let runs = run_in_turns(problem, methods, stages)?;

    stages.expect(runs.len() as u64);

    let gain = maps::gain(runs.iter().map(|(method, run)| (*method, run)), &expected.visibility);
    let judge = Judge::new(problem, &expected.visibility, gain)?;
    let mut entries = Vec::new();
    for (method, run) in runs {
        let (family, side) = (method.family(), method.side());
        let entrant = Entrant { name: family.method(side, run.frames), family: Some(family), side };
        entries.push(stages.run("compare", || judge.entry(entrant, method.choice(), run))?);
    }
    let name = format!("reference, {REFERENCE_SIDE}×{REFERENCE_SIDE}");
    let entrant = Entrant { name, family: None, side: REFERENCE_SIDE };
    let everyone = Choice::everyone(problem.receivers());
    let reference = judge.entry(entrant, &everyone, expected.clone())?;
    Ok(Results::new(entries, reference, gain))
}

/// Of every method the runs that took the least time. They take turns, so that a slow moment of the machine meets all.
fn run_in_turns<'a>(
    problem: &Problem,
    methods: &'a [Box<dyn Method>],
    stages: &mut Stages,
) -> Result<Vec<(&'a dyn Method, Run)>, ProgramError> {
    let mut best: Vec<Vec<Run>> = vec![Vec::new(); methods.len()];
    let mut took = vec![0.0; methods.len()];
    // The last has all frames.
    let seconds = |runs: &[Run]| runs.last().map_or(f64::INFINITY, Run::seconds);
    for round in 0..ROUNDS {
        for ((method, best), took) in methods.iter().zip(&mut best).zip(&mut took) {
            let rests = round > 1 && *took > QUICK || round > 0 && *took > LONG;
            let name = method.family().method(method.side(), method.frames());
            let start = Instant::now();
            let runs = stages.run(&name, || if rests { Ok(Vec::new()) } else { method.run(problem) })?;
            *took = start.elapsed().as_secs_f64().max(*took);
            if seconds(&runs) < seconds(best) {
                *best = runs;
            }
        }
    }
    let methods = methods.iter().map(AsRef::as_ref);
    Ok(methods.zip(best).flat_map(|(method, runs)| runs.into_iter().map(move |run| (method, run))).collect())
}
