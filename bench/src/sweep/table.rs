//! A sweep as Markdown and as CSV.

use std::fmt::Write;

use super::measure::{OURS, Sweep};

/// The table that a reader reads: a line a scene and number of samples.
pub(super) fn markdown(sweeps: &[Sweep], rivals: &[String], threads: usize) -> String {
    let mut out = String::from("| scene | triangles | samples | umbra4 ÷ umbra4 one line up |");
    if threads > 1 {
        // Writing to a string cannot fail, here and below.
        let _ = write!(out, " {threads} threads ÷ 1 thread |");
    }
    for rival in rivals {
        let _ = write!(out, " {rival} ÷ umbra4 |");
    }
    let columns = 2 + usize::from(threads > 1) + rivals.len();
    let _ = writeln!(out, "\n|---|{}", "--:|".repeat(columns + 1));
    for sweep in sweeps {
        let mut before = None;
        for samples in sweep.samples() {
            let ours = sweep.seconds(samples, OURS, 1);
            let over = |seconds: Option<f64>, unit: Option<f64>, digits: usize| match seconds.zip(unit) {
                Some((seconds, unit)) => format!(" {:.digits$} |", seconds / unit),
                None => " |".to_owned(),
            };
            let _ = write!(out, "| {} | {} | {samples}² |{}", sweep.scene, sweep.triangles, over(ours, before, 2));
            if threads > 1 {
                out.push_str(&over(sweep.seconds(samples, OURS, threads), ours, 2));
            }
            for rival in rivals {
                out.push_str(&over(sweep.seconds(samples, rival, 1), ours, 2));
            }
            out.push('\n');
            before = ours;
        }
    }
    out.push_str(
        "\nTimes of the whole image, building included, the least of interleaved runs; one thread unless said otherwise.\n",
    );
    out
}

/// The table that a program reads: a line a time.
pub(super) fn csv(sweeps: &[Sweep]) -> String {
    let mut out = String::from("scene,triangles,receivers,samples,contender,threads,seconds,runs\n");
    for sweep in sweeps {
        for time in &sweep.times {
            let _ = writeln!(
                out,
                "{},{},{},{},{},{},{},{}",
                sweep.scene,
                sweep.triangles,
                sweep.receivers,
                time.samples,
                time.contender,
                time.threads,
                time.seconds,
                time.runs,
            );
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::{super::measure::Time, *};

    #[test]
    fn ratios_are_those_of_the_times() {
        let time = |samples, contender: &str, threads, seconds| Time {
            samples,
            contender: contender.to_owned(),
            threads,
            seconds,
            runs: 2,
        };
        let times = vec![
            time(32, OURS, 1, 2.0),
            time(32, OURS, 2, 1.0),
            time(32, "slow", 1, 30.0),
            time(64, OURS, 1, 5.0),
            time(64, OURS, 2, 3.0),
            time(64, "slow", 1, 120.0),
        ];
        let sweeps = [Sweep { scene: "tiny".to_owned(), triangles: 14, receivers: 9, times }];
        let text = markdown(&sweeps, &["slow".to_owned()], 2);
        assert!(
            text.contains("| tiny | 14 | 32² | | 0.50 | 15.00 |\n| tiny | 14 | 64² | 2.50 | 0.60 | 24.00 |"),
            "{text}"
        );
        let bars: Vec<usize> = text.lines().take(4).map(|line| line.matches('|').count()).collect();
        assert_eq!(bars, [7; 4], "{text}");
        assert_eq!(csv(&sweeps).lines().count(), 7);
    }
}
