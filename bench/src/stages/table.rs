//! The table that a reader reads.

use std::fmt::Write;

use super::measure::Line;

/// Columns, and the stages that each is the sum of; what is in none is the snap of the mesh, and memory that comes and goes.
const COLUMNS: [(&str, &[&str]); 4] = [
    ("triangles' keys and order", &["key_triangles", "order_triangles", "build_level"]),
    ("silhouette", &["find_silhouette"]),
    ("receivers' keys and order", &["key_receivers", "order_receivers"]),
    ("masks", &["resolve"]),
];

/// Shares of the time, in per cent.
pub(super) fn markdown(lines: &[Line]) -> String {
    let mut out = String::from("| scene | mesh | snap, memory |");
    for (name, _) in COLUMNS {
        // Writing to a string cannot fail.
        let _ = write!(out, " {name} |");
    }
    out.push_str(" pairs that matter | pairs kept | edges kept | floor | time ÷ anew |\n|---|---|");
    out.push_str(&"--:|".repeat(COLUMNS.len() + 6));
    out.push('\n');
    for line in lines {
        let (times, receivers) = (&line.times, line.receivers.max(1) as f64);
        let share = |seconds: f64| 100.0 * seconds / times.seconds;
        let stages = COLUMNS.map(|(_, stages)| times.of(stages));
        let _ = write!(
            out,
            "| {} | {} | {:.0} % |",
            line.scene,
            line.mesh,
            share(times.seconds - stages.iter().sum::<f64>())
        );
        for seconds in stages {
            let _ = write!(out, " {:.0} % |", share(seconds));
        }
        let a_receiver = |count: u64| count as f64 / receivers;
        let anew = lines.iter().find(|other| other.scene == line.scene).map_or(f64::NAN, |anew| anew.times.seconds);
        let _ = writeln!(
            out,
            " {:.2} | {:.2} | {:.2} | {:.0} % | {:.2} |",
            a_receiver(line.relevant),
            a_receiver(times.counts.pairs_kept),
            a_receiver(times.counts.edges_kept),
            share(line.floor),
            times.seconds / anew,
        );
    }
    out.push_str(
        "\nShares of the time from coordinates to the last mask. Pairs and edges: of a receiver. Floor: the pairs that matter, times \
         what rows take for a pair where nothing is certified and edges are at hand, one thread.\n",
    );
    out
}
