//! The program's own stages: their times, and a progress bar where someone is watching.

use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use crate::executor::Report;

/// Runs stages one after the other, timed.
pub struct Stages {
    bar: ProgressBar,
    seconds: Vec<(String, f64)>,
}

impl Stages {
    /// `count` stages are to come. The bar draws on stderr, and only where that is a terminal.
    pub fn new(count: u64) -> Self {
        let bar = ProgressBar::new(count);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg:<32} [{bar:32}] {pos}/{len} {elapsed}") {
            bar.set_style(style);
        }
        Self { bar, seconds: Vec::new() }
    }

    /// `count` more stages are to come.
    pub fn expect(&self, count: u64) {
        self.bar.inc_length(count);
    }

    /// Runs one stage.
    pub fn run<T>(&mut self, name: &str, work: impl FnOnce() -> T) -> T {
        self.bar.set_message(name.to_owned());
        self.bar.enable_steady_tick(std::time::Duration::from_millis(100));
        let start = Instant::now();
        let result = work();
        self.seconds.push((name.to_owned(), start.elapsed().as_secs_f64()));
        self.bar.inc(1);
        result
    }

    /// Puts the executor's stages in the place of the one that ran it last.
    pub fn split_last(&mut self, report: &Report) {
        self.seconds.pop();
        self.seconds.extend(report.seconds_by_stage.iter().cloned());
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// Takes the bar away and returns the table.
    pub fn table(self) -> String {
        self.clear();
        let mut table = String::from("stage                seconds\n");
        for (name, seconds) in &self.seconds {
            table += &format!("{name:<18} {seconds:>9.3}\n");
        }
        let sum: f64 = self.seconds.iter().map(|(_, s)| s).sum();
        table + &format!("{:<18} {sum:>9.3}\n", "sum")
    }
}
