//! The program's own stages: their times, and a progress bar where someone is watching.

use std::{
    io::{self, Write, stdout},
    time::Instant,
};

use indicatif::{ProgressBar, ProgressStyle};

use crate::executor::Report;

/// Runs stages one after the other, timed.
pub struct Stages {
    bar: ProgressBar,
    done: Report,
}

impl Stages {
    /// `count` stages are to come. The bar draws on stderr, and only where that is a terminal.
    pub fn new(count: u64) -> Self {
        let bar = ProgressBar::new(count);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg:<38} [{bar:32}] {pos}/{len} {elapsed}") {
            bar.set_style(style);
        }
        Self { bar, done: Report::default() }
    }

    /// `count` more stages are to come.
    pub fn expect(&self, count: u64) {
        self.bar.inc_length(count);
    }

    /// Says at once, on standard output, what is about to be done: where nobody can see the bar, too.
    ///
    /// # Errors
    /// Standard output is closed.
    pub fn announce(&self, what: &str) -> io::Result<()> {
        self.bar.suspend(|| {
            let mut out = stdout().lock();
            writeln!(out, "{what}")?;
            out.flush()
        })
    }

    /// Runs one stage.
    pub fn run<T>(&mut self, name: &str, work: impl FnOnce() -> T) -> T {
        self.bar.set_message(name.to_owned());
        self.bar.enable_steady_tick(std::time::Duration::from_millis(100));
        let start = Instant::now();
        let result = work();
        self.done.seconds_by_stage.push((name.to_owned(), start.elapsed().as_secs_f64()));
        self.bar.inc(1);
        result
    }

    /// Puts the executor's stages in the place of the last `runs`, which ran it.
    pub fn split_last(&mut self, runs: usize, report: &Report) {
        let seconds = &mut self.done.seconds_by_stage;
        seconds.truncate(seconds.len().saturating_sub(runs));
        self.done.add(report);
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// Takes the bar away and returns the table.
    pub fn table(self) -> String {
        self.clear();
        let mut table = String::from("stage                seconds\n");
        for (name, seconds) in &self.done.seconds_by_stage {
            table += &format!("{name:<18} {seconds:>9.3}\n");
        }
        table + &format!("{:<18} {:>9.3}\n", "sum", self.done.seconds())
    }
}
