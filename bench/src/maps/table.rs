//! The tables that a reader reads.

use std::fmt::Write;

use super::{measure::Measured, ways::OLDER};

/// A table a scene.
pub(super) fn markdown(measured: &[Measured], samples: u32, map: u32) -> String {
    let mut out = String::new();
    for Measured { scene, receivers: [all, penumbrae, umbrae, lit], lines } in measured {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{scene}, light of {samples}² samples, maps of {map}² texels; {all} receivers: {penumbrae} in penumbrae, {umbrae} in full shadow, {lit} lit\n\n\
             | way | time ÷ exact | mean error | ÷ {OLDER} | in penumbrae | light in full shadow | dark where lit |\n\
             |---|--:|--:|--:|--:|--:|--:|"
        );
        let exact = lines.first().map_or(f64::NAN, |line| line.seconds);
        let older = lines.iter().find(|line| line.name == OLDER).map_or(f64::NAN, |line| line.errors.all);
        for line in lines {
            let errors = line.errors;
            let _ = writeln!(
                out,
                "| {} | {:.2} | {:.4} | {:+.0} % | {:.4} | {:.4} | {:.4} |",
                line.name,
                line.seconds / exact,
                errors.all,
                100.0 * (errors.all / older - 1.0),
                errors.penumbrae,
                errors.umbrae,
                errors.lit
            );
        }
        out.push('\n');
    }
    out.push_str("Time: from the mesh on the lattice to every receiver's visibility. Errors: of receivers that do not face away.\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maps::measure::{Errors, Line};

    #[test]
    fn times_are_relative_to_exact_masks_and_errors_to_the_older_approximation() {
        let line = |name, seconds, all| Line { name, seconds, errors: Errors { all, ..Errors::default() } };
        let lines = vec![line("exact masks", 2.0, 0.0), line(OLDER, 1.0, 0.04), line("other", 3.0, 0.01)];
        let text = markdown(&[Measured { scene: "s".to_owned(), receivers: [9, 2, 3, 4], lines }], 8, 64);
        assert!(text.starts_with("s, light of 8² samples, maps of 64² texels; 9 receivers: 2 in penumbrae"), "{text}");
        assert!(text.contains("| other | 1.50 | 0.0100 | -75 % | 0.0000 |"), "{text}");
    }
}
