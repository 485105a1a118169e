//! The least time of every subject, in interleaved runs.

use super::Progress;
use crate::contender::ContenderError;

/// How long and how often every subject is run.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Seconds that every subject is measured for, at least.
    pub seconds: f64,
    /// Runs of every subject, at least.
    pub repeat: usize,
}

/// Something that is run again and again.
pub struct Subject<'a> {
    /// For the reader of the progress.
    pub name: String,
    /// Runs it once; returns the seconds it took.
    pub run: Box<dyn Fn() -> Result<f64, ContenderError> + 'a>,
}

/// What is known of a subject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least {
    /// Seconds of its fastest run.
    pub seconds: f64,
    /// How often it was run.
    pub runs: usize,
}

/// Runs all subjects, always the one that was measured for the shortest time: whatever disturbs the machine disturbs all
/// of them, and all have about the same time to find their least in.
///
/// # Errors
/// Whatever a subject refuses.
pub fn least(subjects: &[Subject<'_>], budget: Budget, progress: &Progress) -> Result<Vec<Least>, ContenderError> {
    let mut results = vec![Least { seconds: f64::MAX, runs: 0 }; subjects.len()];
    let mut spent = vec![0.0; subjects.len()];
    loop {
        let unfinished = |&i: &usize| spent[i] < budget.seconds || results[i].runs < budget.repeat.max(1);
        let next = (0..subjects.len()).filter(unfinished).min_by(|&a, &b| f64::total_cmp(&spent[a], &spent[b]));
        let Some(next) = next else { return Ok(results) };
        progress.run(&subjects[next].name);
        let seconds = (subjects[next].run)()?;
        spent[next] += seconds;
        let Least { seconds: best, runs } = results[next];
        results[next] = Least { seconds: best.min(seconds), runs: runs + 1 };
        let done = |i: usize| {
            let (time, runs) = (spent[i] / budget.seconds, results[i].runs as f64 / budget.repeat.max(1) as f64);
            // Without a least time (0 / 0 and x / 0), runs alone count.
            runs.min(if time.is_finite() { time } else { 1.0 }).min(1.0)
        };
        progress.share((0..subjects.len()).map(done).sum::<f64>() / subjects.len() as f64);
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use std::cell::RefCell;

    use super::*;

    #[test]
    fn runs_are_interleaved_and_the_least_counts() {
        let log = RefCell::new(String::new());
        let subject = |name: &'static str, seconds: [f64; 3]| {
            let log = &log;
            let run = move || {
                let runs = log.borrow().matches(name).count();
                log.borrow_mut().push_str(name);
                Ok(seconds[runs.min(2)])
            };
            Subject { name: name.to_owned(), run: Box::new(run) }
        };
        let subjects = [subject("a", [3.0, 1.0, 2.0]), subject("b", [1.0, 1.0, 1.0])];
        let results = least(&subjects, Budget { seconds: 3.5, repeat: 2 }, &Progress::hidden()).unwrap();
        assert_eq!(results, [Least { seconds: 1.0, runs: 2 }, Least { seconds: 1.0, runs: 4 }]);
        assert_eq!(*log.borrow(), "abbbab");
    }

    #[test]
    fn without_a_least_time_runs_count() {
        let subjects = [Subject { name: String::new(), run: Box::new(|| Ok(0.0)) }];
        let results = least(&subjects, Budget { seconds: 0.0, repeat: 3 }, &Progress::hidden()).unwrap();
        assert_eq!(results, [Least { seconds: 0.0, runs: 3 }]);
    }
}
