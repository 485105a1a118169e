//! Results as a Markdown table and as CSV.

use std::fmt::Write;

use umbra4_core::Counts;

/// Pairs of a receiver and a triangle, per receiver.
#[derive(Clone, Copy, Debug)]
pub struct Pairs {
    /// On which the full-coverage test was asked.
    pub tested: f64,
    /// That passed it.
    pub kept: f64,
    /// Of which at least one sample is blocked.
    pub relevant: f64,
    /// Signs redone in integers, per receiver.
    pub fallbacks: f64,
}

impl Pairs {
    /// Of so many receivers.
    pub fn per_receiver(counts: Counts, receivers: usize) -> Self {
        let per_receiver = |count: u64| count as f64 / receivers.max(1) as f64;
        Self {
            tested: per_receiver(counts.pairs_tested),
            kept: per_receiver(counts.pairs_kept),
            relevant: per_receiver(counts.pairs_relevant),
            fallbacks: per_receiver(counts.fallbacks),
        }
    }
}

/// One contender on one scene.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name of the scene.
    pub scene: String,
    /// Triangles in it.
    pub triangles: usize,
    /// Name of the contender.
    pub contender: String,
    /// Threads it used.
    pub threads: usize,
    /// Rows and columns of the light.
    pub samples: u32,
    /// Receivers that it was measured on.
    pub receivers: usize,
    /// Receivers that umbra4 was measured on; building is divided by these.
    pub all_receivers: usize,
    /// How often it was run.
    pub runs: usize,
    /// Least seconds of building.
    pub build_seconds: f64,
    /// Least seconds of all masks.
    pub masks_seconds: f64,
    /// Microseconds per receiver, building included.
    pub micros: f64,
    /// `micros` over umbra4's, where umbra4 ran.
    pub ratio: Option<f64>,
    /// What umbra4 worked on.
    pub pairs: Option<Pairs>,
    /// Bits that differ from umbra4's, where umbra4 ran.
    pub differing: Option<u64>,
}

impl Line {
    /// Light samples decided per second, in millions: rays, for a ray tracer.
    fn mega_rays(&self) -> f64 {
        f64::from(self.samples * self.samples) / self.micros
    }

    /// Share of the bits that differ.
    fn share(&self, differing: u64) -> f64 {
        differing as f64 / (self.receivers as f64 * f64::from(self.samples * self.samples)).max(1.0)
    }
}

/// The table that a reader reads.
pub fn markdown(lines: &[Line]) -> String {
    let mut out = String::from(
        "| scene | contender | receivers | runs | build s | masks s | µs/receiver | Mrays/s | time ÷ umbra4's | \
         pairs tested, kept, relevant, fallbacks per receiver | bits that differ |\n\
         |---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for line in lines {
        let ratio = line.ratio.map_or_else(String::new, |ratio| format!("{ratio:.2}"));
        let differing = line.differing.map_or_else(String::new, |bits| format!("{bits} ({:.1e})", line.share(bits)));
        let pairs = line.pairs.map_or_else(String::new, |pairs| {
            format!("{:.1}, {:.1}, {:.1}, {:.2}", pairs.tested, pairs.kept, pairs.relevant, pairs.fallbacks)
        });
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} | {:.3} | {:.3} | {:.2} | {:.1} | {ratio} | {pairs} | {differing} |",
            line.scene,
            line.contender,
            line.receivers,
            line.runs,
            line.build_seconds,
            line.masks_seconds,
            line.micros,
            line.mega_rays(),
        );
    }
    out.push_str("\nTimes are the least of all runs. µs/receiver and Mrays/s include building, which is shared by all receivers of the image.");
    if lines.iter().any(|line| line.receivers < line.all_receivers) {
        out.push_str(" Rivals were measured on a random subset of the receivers, in whole 8×8 image tiles.");
    }
    out.push('\n');
    out
}

/// What exactness costs, where both precisions ran: a line a scene.
pub fn precisions(lines: &[Line]) -> String {
    let mut out = String::new();
    for exact in lines.iter().filter(|line| line.contender == "umbra4") {
        let fast = lines.iter().find(|line| line.scene == exact.scene && line.contender == "umbra4-fast");
        let Some((fast, differing)) = fast.and_then(|fast| Some((fast, fast.differing?))) else { continue };
        let _ = writeln!(
            out,
            "- {}: exact ÷ fast {:.3}; {differing} of {} bits differ",
            exact.scene,
            exact.micros / fast.micros,
            fast.receivers as u64 * u64::from(fast.samples * fast.samples),
        );
    }
    out
}

/// The table that a program reads.
pub fn csv(lines: &[Line]) -> String {
    let mut out = String::from(
        "scene,triangles,contender,threads,samples,receivers,all_receivers,build_seconds,masks_seconds,\
         micros_per_receiver,mega_rays_per_second,ratio,differing_bits,runs,pairs_tested,pairs_kept,pairs_relevant,fallbacks\n",
    );
    for line in lines {
        let ratio = line.ratio.map_or_else(String::new, |ratio| ratio.to_string());
        let differing = line.differing.map_or_else(String::new, |bits| bits.to_string());
        let pairs = line.pairs.map_or_else(
            || ",,,".to_owned(),
            |pairs| format!("{},{},{},{}", pairs.tested, pairs.kept, pairs.relevant, pairs.fallbacks),
        );
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{},{},{ratio},{differing},{},{pairs}",
            line.scene,
            line.triangles,
            line.contender,
            line.threads,
            line.samples,
            line.receivers,
            line.all_receivers,
            line.build_seconds,
            line.masks_seconds,
            line.micros,
            line.mega_rays(),
            line.runs,
        );
    }
    out
}
