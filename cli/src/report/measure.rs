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
pub const QUICK: f64 = 1.5;

/// Stages that [`measure`] runs.
pub fn stages(methods: usize) -> u64 {
    (1 + ROUNDS * methods + methods) as u64
}

/// Runs `methods` and the reference.
///
/// # Errors
/// Whatever a method refuses; a camera that sees nothing.
pub fn measure(problem: &Problem, methods: &[Box<dyn Method>], stages: &mut Stages) -> Result<Results, ProgramError> {
    let expected = stages.run("reference", || reference(problem))?;
    let runs = run_in_turns(problem, methods, stages)?;

    let gain = maps::gain(methods.iter().zip(&runs).map(|(method, run)| (method.as_ref(), run)), &expected.visibility);
    let judge = Judge::new(problem, &expected.visibility, gain)?;
    let mut entries = Vec::new();
    for (method, run) in methods.iter().zip(runs) {
        let entrant = Entrant { name: method.name(), family: Some(method.family()), side: method.side() };
        entries.push(stages.run("compare", || judge.entry(entrant, method.choice(), run))?);
    }
    let name = format!("reference, {REFERENCE_SIDE}×{REFERENCE_SIDE}");
    let entrant = Entrant { name, family: None, side: REFERENCE_SIDE };
    let everyone = Choice::everyone(problem.receivers());
    let reference = judge.entry(entrant, &everyone, expected.clone())?;
    Ok(Results::new(entries, reference, gain))
}

/// Of every method the run that took the least time. They take turns, so that a slow moment of the machine meets all.
fn run_in_turns(problem: &Problem, methods: &[Box<dyn Method>], stages: &mut Stages) -> Result<Vec<Run>, ProgramError> {
    let mut best: Vec<Option<Run>> = vec![None; methods.len()];
    let mut took = vec![0.0; methods.len()];
    for round in 0..ROUNDS {
        for ((method, best), took) in methods.iter().zip(&mut best).zip(&mut took) {
            let rests = round > 1 && *took > QUICK;
            let start = Instant::now();
            let run = stages.run(&method.name(), || (!rests).then(|| method.run(problem)).transpose())?;
            *took = start.elapsed().as_secs_f64().max(*took);
            if let Some(run) = run
                && best.as_ref().is_none_or(|best| run.seconds() < best.seconds())
            {
                *best = Some(run);
            }
        }
    }
    Ok(best.into_iter().flatten().collect())
}
