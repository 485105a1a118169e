//! What was measured, for a reader.

use std::fmt::Write;

use umbra4_cpu::Isa;

use super::measure::Line;

/// A line a scene, light and table.
pub fn markdown(lines: &[Line]) -> String {
    let mut out = String::from(
        "| scene | samples | rows a pair | cells | plain table, KiB | cells found ÷ rows | plain ÷ rows | plain ÷ fast \
         rows | wrong bits of the plain one | exact ÷ rows | open samples a pair | differing bits |\n",
    );
    let _ = writeln!(out, "|---|{}", "--:|".repeat(11));
    for line in lines {
        let Line { scene, samples, cells, rows, ratios, open, differing, .. } = line;
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "| {scene} | {samples}² | {rows:.1} | {cells}² | {} | {:.2} | {:.2} | {:.2} | {:.2} % | {:.2} | {open:.1} | \
             {differing} |",
            line.bytes >> 10,
            ratios.place,
            ratios.plain,
            ratios.plain / ratios.fast,
            line.wrong * 100.0,
            ratios.repaired,
        );
    }
    let pairs: usize = lines.iter().map(|line| line.pairs).min().unwrap_or(0);
    let _ = writeln!(
        out,
        "\n{}. Rows are core's, exact unless said to be fast. At least {pairs} pairs each. Wrong bits are those of whole \
         masks, ÷ blocked bits. The table with bounds, from which exact masks are made, has twice the bytes.",
        Isa::best(),
    );
    out
}
