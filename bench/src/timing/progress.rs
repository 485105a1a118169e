//! How far measuring is: a bar on stderr where that is a terminal, otherwise a line a stage.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Steps of the bar.
const STEPS: u64 = 1000;

/// The bar.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A bar for one stage, which is named.
    pub fn new(stage: &str) -> Self {
        let bar = ProgressBar::new(STEPS);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix} [{bar:32}] {percent:>3} % {elapsed} {msg}")
        {
            bar.set_style(style);
        }
        bar.set_prefix(stage.to_owned());
        if bar.is_hidden() {
            eprintln!("{stage}");
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar }
    }

    /// No bar, for tests.
    #[cfg(test)]
    pub fn hidden() -> Self {
        Self { bar: ProgressBar::hidden() }
    }

    /// What runs next.
    pub(super) fn run(&self, name: &str) {
        self.bar.set_message(name.to_owned());
    }

    /// So much of the stage is done, in `0.0..=1.0`.
    pub(super) fn share(&self, share: f64) {
        self.bar.set_position((share * STEPS as f64) as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
