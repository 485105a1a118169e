//! The table that a reader reads.

use std::fmt::Write;

use super::measure::Line;

/// A line an effect: stages against those of the first, and times ÷ that of the first on each scene.
pub(super) fn markdown(scenes: &[String], measured: &[Vec<Line>]) -> String {
    let mut out = String::from("| effect | stages it adds | stages it spares |");
    for scene in scenes {
        // Writing to a string cannot fail.
        let _ = write!(out, " time, {scene} |");
    }
    out.push_str("\n|---|---|---|");
    out.push_str(&"--:|".repeat(scenes.len()));
    out.push('\n');
    let Some(first) = measured.first() else { return out };
    for (k, line) in first.iter().enumerate() {
        let of_scenes = || measured.iter().filter_map(|lines| Some((lines.first()?, lines.get(k)?)));
        let mut adds: Vec<&str> = Vec::new();
        let mut spares: Vec<&str> = Vec::new();
        for (plain, line) in of_scenes() {
            add_missing(&mut adds, &line.stages, &plain.stages);
            add_missing(&mut spares, &plain.stages, &line.stages);
        }
        let _ = write!(out, "| {} | {} | {} |", line.effect, list(&adds), list(&spares));
        for (plain, line) in of_scenes() {
            let _ = write!(out, " {:.2} |", line.seconds / plain.seconds);
        }
        out.push('\n');
    }
    out.push_str("\nTime: from the mesh on the lattice to what every receiver gets, ÷ that of the first line.\n");
    out
}

/// Adds what is in `some` and not in `others`, once.
fn add_missing<'a>(to: &mut Vec<&'a str>, some: &[&'a str], others: &[&'a str]) {
    for stage in some {
        if !others.contains(stage) && !to.contains(stage) {
            to.push(stage);
        }
    }
}

fn list(stages: &[&str]) -> String {
    stages.iter().map(|stage| format!("`{stage}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_held_against_the_first_line() {
        let line = |effect, seconds, stages: &[&'static str]| Line { effect, seconds, stages: stages.to_vec() };
        let lines = vec![line("plain", 2.0, &["a", "b"]), line("other", 3.0, &["b", "c"])];
        let text = markdown(&["scene".to_owned()], &[lines]);
        assert!(text.contains("| plain |  |  | 1.00 |"), "{text}");
        assert!(text.contains("| other | `c` | `a` | 1.50 |"), "{text}");
    }
}
