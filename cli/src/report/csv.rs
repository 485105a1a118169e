//! The numbers of a report, for other programs: comma-separated, with a line of names.

use std::fmt::Write;

use crate::report::{
    curve::Reading,
    equal::Equal,
    results::{Entry, Results},
};

const COLUMNS: &str = "method,samples,map_texels,frames,receivers,one_tile_in,seconds,relative_time,mean_error,max_error,flip,pareto_front,\
    pairs_tested_per_receiver,pairs_kept_per_receiver,pairs_relevant_per_receiver,fallbacks,stage_seconds";

/// A row a method; the reference's is the last.
pub fn methods(results: &Results) -> String {
    let mut out = format!("{COLUMNS}\n");
    for entry in results.all() {
        row(&mut out, entry, results.unit());
    }
    out
}

fn row(out: &mut String, entry: &Entry, unit: f64) {
    let seconds = entry.run.seconds();
    let flip = entry.flip.map(|flip| flip.to_string()).unwrap_or_default();
    let stages: Vec<String> = entry.run.seconds_by_stage.iter().map(|(name, s)| format!("{name}={s:.6}")).collect();
    let pairs = entry.pairs().map_or(",,".to_owned(), |pairs| pairs.map(|n| format!("{n:.3}")).join(","));
    let samples = entry.samples().map(|samples| samples.to_string()).unwrap_or_default();
    let texels = if samples.is_empty() { (entry.side * entry.side).to_string() } else { String::new() };
    let fallbacks = entry.run.counts.map(|counts| counts.fallbacks.to_string()).unwrap_or_default();
    // Writing to a string does not fail.
    let _ = writeln!(
        out,
        "{},{samples},{texels},{},{},{},{seconds:.6},{:.4},{},{},{flip},{},{pairs},{fallbacks},{}",
        quoted(&entry.name),
        entry.run.frames,
        entry.receivers,
        entry.one_in,
        seconds / unit,
        entry.difference.mean,
        entry.difference.largest,
        u8::from(entry.on_front),
        quoted(&stages.join(";")),
    );
}

/// A row for every method of umbra4 and family of rays.
pub fn equal(rows: &[Equal<'_>]) -> String {
    let mut out = "method,seconds,mean_error,rays,rays_error_at_equal_time,extrapolated,rays_seconds_at_equal_error,\
        extrapolated\n"
        .to_owned();
    for row in rows {
        let _ = writeln!(
            out,
            "{},{:.6},{},{},{},{}",
            quoted(&row.ours.name),
            row.ours.run.seconds(),
            row.ours.difference.mean,
            quoted(row.rays.name()),
            reading(row.error_at_equal_time),
            reading(row.seconds_at_equal_error),
        );
    }
    out
}

/// Value, and whether it is extrapolated.
fn reading(reading: Reading) -> String {
    match reading {
        Reading::Measured(value) => format!("{value:e},0"),
        Reading::Beyond(value) => format!("{value:e},1"),
        Reading::Never => ",".to_owned(),
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_quoted_and_readings_told_apart() {
        assert_eq!(quoted("a \"b\", c"), "\"a \"\"b\"\", c\"");
        assert_eq!(reading(Reading::Measured(0.5)), "5e-1,0");
        assert_eq!(reading(Reading::Beyond(2.0)), "2e0,1");
        assert_eq!(reading(Reading::Never), ",");
    }
}
