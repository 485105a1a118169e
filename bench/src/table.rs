//! Results as a Markdown table and as CSV.

use std::fmt::Write;

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
    /// Seconds of building.
    pub build_seconds: f64,
    /// Seconds of all masks.
    pub masks_seconds: f64,
    /// Microseconds per receiver, building included.
    pub micros: f64,
    /// `micros` over umbra4's, where umbra4 ran.
    pub ratio: Option<f64>,
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
        "| scene | contender | receivers | build s | masks s | µs/receiver | Mrays/s | time ÷ umbra4's | bits that differ |\n\
         |---|---|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for line in lines {
        let ratio = line.ratio.map_or_else(String::new, |ratio| format!("{ratio:.2}"));
        let differing = line.differing.map_or_else(String::new, |bits| format!("{bits} ({:.1e})", line.share(bits)));
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "| {} | {} | {} | {:.3} | {:.3} | {:.2} | {:.1} | {ratio} | {differing} |",
            line.scene,
            line.contender,
            line.receivers,
            line.build_seconds,
            line.masks_seconds,
            line.micros,
            line.mega_rays(),
        );
    }
    out.push_str("\nµs/receiver and Mrays/s include building, which is shared by all receivers of the image.");
    if lines.iter().any(|line| line.receivers < line.all_receivers) {
        out.push_str(" Rivals were measured on a random subset of the receivers, in whole 8×8 image tiles.");
    }
    out.push('\n');
    out
}

/// The table that a program reads.
pub fn csv(lines: &[Line]) -> String {
    let mut out = String::from(
        "scene,triangles,contender,threads,samples,receivers,all_receivers,build_seconds,masks_seconds,\
         micros_per_receiver,mega_rays_per_second,ratio,differing_bits\n",
    );
    for line in lines {
        let ratio = line.ratio.map_or_else(String::new, |ratio| ratio.to_string());
        let differing = line.differing.map_or_else(String::new, |bits| bits.to_string());
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{},{},{ratio},{differing}",
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
        );
    }
    out
}
