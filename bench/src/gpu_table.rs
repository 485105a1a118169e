//! Results on a GPU as Markdown tables and as CSV. Absolute times are those of a named GPU or of nobody: a software driver's
//! are left out.

use std::fmt::Write;

use umbra4_core::stage::TABLE;
use umbra4_wgpu::{Gpu, Loading, Precision};

use crate::image_size::ImageSize;

/// Rays in f32 may miss the true answer where they graze an edge; a larger share of the bits is somebody's mistake.
pub const MOST_DIFFERING: f64 = 1e-3;

/// Bits compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Differing {
    /// All of them.
    pub bits: u64,
    /// Those that differ.
    pub differing: u64,
}

impl Differing {
    /// Lit counts of the same receivers, of lights with so many samples. Bits that differ both ways cancel.
    pub fn of_counts(ours: impl ExactSizeIterator<Item = u32>, theirs: &[u32], samples: u32) -> Self {
        assert_eq!(ours.len(), theirs.len(), "lit counts of different receivers");
        let bits = theirs.len() as u64 * u64::from(samples);
        Self { bits, differing: ours.zip(theirs).map(|(a, &b)| u64::from(a.abs_diff(b))).sum() }
    }

    /// Words of masks, with so many bits in use.
    pub fn of_masks(ours: &[u32], theirs: &[u32], bits: u64) -> Self {
        assert_eq!(ours.len(), theirs.len(), "masks of different receivers");
        Self { bits, differing: ours.iter().zip(theirs).map(|(a, b)| u64::from((a ^ b).count_ones())).sum() }
    }

    fn share(self) -> f64 {
        self.differing as f64 / self.bits.max(1) as f64
    }

    fn cell(self) -> String {
        format!("{} of {} ({:.1e})", self.differing, self.bits, self.share())
    }
}

/// What the rival did.
#[derive(Clone, Copy, Debug)]
pub struct RivalFigures {
    /// Seconds of building its hierarchy on the processor.
    pub build_seconds: f64,
    /// Least seconds of tracing, scaled to all receivers.
    pub seconds: f64,
    /// Receivers that it was measured on.
    pub receivers: usize,
    /// Bits that lit counts differ by.
    pub lit: Differing,
    /// Bits of masks.
    pub masks: Differing,
}

/// umbra4 in one precision on one scene, image and light.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name of the scene.
    pub scene: String,
    /// Triangles in it.
    pub triangles: usize,
    /// Size of the image.
    pub size: ImageSize,
    /// Pixels that see something.
    pub receivers: usize,
    /// Rows and columns of the light.
    pub samples: u32,
    /// umbra4's precision.
    pub precision: Precision,
    /// umbra4's least seconds as the host saw them: uploads and results included.
    pub host_seconds: f64,
    /// Seconds of umbra4's stages on the device; empty where it has no timestamps.
    pub stages: Vec<(&'static str, f64)>,
    /// How kernels were loaded.
    pub loading: Loading,
    /// Least seconds with kernels loaded the other way, where the device can.
    pub other_loading_seconds: Option<f64>,
    /// The rival, where it ran.
    pub rival: Option<RivalFigures>,
}

impl Line {
    /// What wgpu's checks cost: time with them ÷ time without.
    fn checks(&self) -> Option<f64> {
        let ratio = self.seconds() / self.other_loading_seconds?;
        Some(if self.loading == Loading::Checked { ratio } else { ratio.recip() })
    }

    /// All stages on the device, the index included.
    fn device_seconds(&self) -> Option<f64> {
        (!self.stages.is_empty()).then(|| self.stages.iter().map(|(_, seconds)| seconds).sum())
    }

    /// What is compared with the rival, whose time is taken on the same side.
    fn seconds(&self) -> f64 {
        self.device_seconds().unwrap_or(self.host_seconds)
    }

    fn stage(&self, stage: &str) -> Option<f64> {
        self.stages.iter().find(|(known, _)| *known == stage).map(|(_, seconds)| *seconds)
    }

    /// Whether more bits differ from the rival's than rounding explains.
    pub fn is_wrong(&self) -> bool {
        self.rival.is_some_and(|rival| [rival.lit, rival.masks].iter().any(|bits| bits.share() > MOST_DIFFERING))
    }

    /// Scene, image, samples and precision.
    fn head(&self) -> String {
        let precision = format!("{:?}", self.precision).to_lowercase();
        format!("| {} | {} | {} | {}² | {precision} |", self.scene, self.triangles, self.size, self.samples)
    }
}

const HEAD: &str = "| scene | triangles | image | samples | precision |";
const RULE: &str = "|---|--:|---|--:|---|";

/// Milliseconds, where they may be told.
fn millis(gpu: &Gpu, seconds: Option<f64>) -> String {
    seconds.filter(|_| !gpu.software).map_or_else(|| "–".to_owned(), |seconds| format!("{:.3}", 1e3 * seconds))
}

/// The tables that a reader reads, and what to know about them.
pub fn markdown(gpu: &Gpu, lines: &[Line]) -> String {
    let mut out = format!("Adapter: {}\n\n", gpu.name);
    if gpu.software {
        out.push_str(
            "This is a software driver: even ratios say little about a GPU, and absolute times are left out.\n\n",
        );
    }
    totals(&mut out, gpu, lines);
    notes(&mut out, lines);
    stages(&mut out, gpu, lines);
    out
}

// Writing to a string cannot fail, here and below.
fn totals(out: &mut String, gpu: &Gpu, lines: &[Line]) {
    let _ = writeln!(
        out,
        "{HEAD} receivers | umbra4 ms, device | umbra4 ms, host | rival ms | rival's build ms, CPU | rival ÷ umbra4 | \
         umbra4 frames/s | checked ÷ passthrough | lit counts differ by | bits of masks that differ |\n\
         {RULE}--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
    );
    for line in lines {
        let rival = line.rival;
        let figure = |get: fn(RivalFigures) -> String| rival.map_or_else(String::new, get);
        let ratio = rival.map_or_else(String::new, |rival| format!("{:.2}", rival.seconds / line.seconds()));
        let checks = line.checks().map_or_else(String::new, |ratio| format!("{ratio:.2}"));
        let frames = if gpu.software { "–".to_owned() } else { format!("{:.1}", line.seconds().recip()) };
        let _ = writeln!(
            out,
            "{} {} | {} | {} | {} | {} | {ratio} | {frames} | {checks} | {} | {} |",
            line.head(),
            line.receivers,
            millis(gpu, line.device_seconds()),
            millis(gpu, Some(line.host_seconds)),
            millis(gpu, rival.map(|rival| rival.seconds)),
            millis(gpu, rival.map(|rival| rival.build_seconds)),
            figure(|rival| rival.lit.cell()),
            figure(|rival| rival.masks.cell()),
        );
    }
}

fn notes(out: &mut String, lines: &[Line]) {
    let on_device = lines.iter().any(|line| !line.stages.is_empty());
    out.push_str("\nTimes are the least of all runs, which were interleaved. ");
    out.push_str(if on_device {
        "Ratio and frames/s are of times on the device, by timestamps: of all stages of umbra4, its index included, and of \
         the rival's rays. umbra4's time on the host also has uploads and results in it."
    } else {
        "The device has no timestamps: umbra4's time is the host's, uploads and results included; the rival's is the \
         host's too, of its rays alone."
    });
    if lines.iter().any(|line| line.rival.is_some()) {
        out.push_str(
            " The rival builds its hierarchy on the processor, once a scene: that is not in the ratio. It counts lit \
             samples, as umbra4 does; masks are compared on some receivers, untimed.",
        );
    }
    if lines.iter().any(|line| line.rival.is_some_and(|rival| rival.receivers < line.receivers)) {
        out.push_str(" It was measured on a random subset of the receivers, in whole 8×8 image tiles, and scaled.");
    }
    out.push('\n');
}

/// Times of stages; shares of their sum on a software driver.
fn stages(out: &mut String, gpu: &Gpu, lines: &[Line]) {
    let mut seen: Vec<&str> = lines.iter().flat_map(|line| &line.stages).map(|(stage, _)| *stage).collect();
    seen.sort_by_key(|stage| TABLE.iter().position(|info| info.name == *stage));
    seen.dedup();
    if seen.is_empty() {
        return;
    }
    let unit = if gpu.software { "%" } else { "ms" };
    let names: String = seen.iter().map(|stage| format!(" {stage} |")).collect();
    let _ = writeln!(out, "\numbra4's stages, {unit}:\n\n{HEAD}{names}\n{RULE}{}", "--:|".repeat(seen.len()));
    for line in lines {
        let _ = write!(out, "{}", line.head());
        for &stage in &seen {
            let cell = line.stage(stage).map_or_else(String::new, |seconds| match line.device_seconds() {
                Some(all) if gpu.software => format!("{:.1}", 1e2 * seconds / all),
                _ => millis(gpu, Some(seconds)),
            });
            let _ = write!(out, " {cell} |");
        }
        out.push('\n');
    }
}

/// The table that a program reads. Fields of times are empty where the driver is a software one.
pub fn csv(gpu: &Gpu, lines: &[Line]) -> String {
    let stages = TABLE.map(|info| info.name);
    let mut out = String::from(
        "adapter,scene,triangles,width,height,receivers,samples,precision,umbra4_device_seconds,umbra4_host_seconds,\
         rival_seconds,rival_build_seconds,rival_receivers,ratio,checked_over_passthrough,lit_bits,lit_bits_differing,mask_bits,\
         mask_bits_differing",
    );
    for stage in stages {
        let _ = write!(out, ",{stage}_seconds");
    }
    out.push('\n');
    let time = |seconds: Option<f64>| {
        seconds.filter(|_| !gpu.software).map_or_else(String::new, |seconds| seconds.to_string())
    };
    for line in lines {
        let rival = line.rival;
        let figure = |get: fn(RivalFigures) -> String| rival.map_or_else(String::new, get);
        let ratio = rival.map_or_else(String::new, |rival| (rival.seconds / line.seconds()).to_string());
        let checks = line.checks().map_or_else(String::new, |ratio| ratio.to_string());
        let _ = write!(
            out,
            "{:?},{},{},{},{},{},{},{},{},{},{},{},{},{ratio},{checks},{},{},{},{}",
            gpu.name,
            line.scene,
            line.triangles,
            line.size.width,
            line.size.height,
            line.receivers,
            line.samples,
            format!("{:?}", line.precision).to_lowercase(),
            time(line.device_seconds()),
            time(Some(line.host_seconds)),
            time(rival.map(|rival| rival.seconds)),
            time(rival.map(|rival| rival.build_seconds)),
            figure(|rival| rival.receivers.to_string()),
            figure(|rival| rival.lit.bits.to_string()),
            figure(|rival| rival.lit.differing.to_string()),
            figure(|rival| rival.masks.bits.to_string()),
            figure(|rival| rival.masks.differing.to_string()),
        );
        for stage in stages {
            let _ = write!(out, ",{}", time(line.stage(stage)));
        }
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(differing: u64) -> Line {
        let figures = RivalFigures {
            build_seconds: 1.0,
            seconds: 3.0,
            receivers: 10,
            lit: Differing::default(),
            masks: Differing { bits: 10_000, differing },
        };
        Line {
            scene: "tiny".to_owned(),
            triangles: 14,
            size: ImageSize::square(8),
            receivers: 64,
            samples: 8,
            precision: Precision::Exact,
            host_seconds: 9.0,
            stages: vec![("resolve", 1.0), ("reduce", 0.5)],
            loading: Loading::Checked,
            other_loading_seconds: Some(1.25),
            rival: Some(figures),
        }
    }

    #[test]
    fn more_differing_bits_than_rounding_explains_are_wrong() {
        assert!(!line(10).is_wrong());
        assert!(line(11).is_wrong());
    }

    #[test]
    fn times_are_compared_on_the_device_where_they_are_known() {
        assert_eq!(line(0).seconds(), 1.5);
        assert_eq!(Line { stages: Vec::new(), ..line(0) }.seconds(), 9.0);
    }

    #[test]
    fn checks_cost_what_passthrough_saves() {
        assert_eq!(line(0).checks(), Some(1.2));
        let other = Line { loading: Loading::Passthrough, other_loading_seconds: Some(3.0), ..line(0) };
        assert_eq!(other.checks(), Some(2.0));
        assert_eq!(Line { other_loading_seconds: None, ..line(0) }.checks(), None);
    }

    #[test]
    fn differing_bits_are_counted() {
        assert_eq!(Differing::of_masks(&[5, 0], &[4, 8], 64), Differing { bits: 64, differing: 2 });
        assert_eq!(Differing::of_counts([5, 0].into_iter(), &[4, 8], 64), Differing { bits: 128, differing: 9 });
    }
}
