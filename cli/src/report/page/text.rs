//! The report for a terminal.

use crate::report::{
    equal::Equal,
    page::format::{reading, three_digits},
    results::Results,
};

/// Every method, and the rays at equal time and equal error.
pub fn text(results: &Results, equal: &[Equal<'_>]) -> String {
    let mut out = format!(
        "{:<38} {:>9} {:>9} {:>10} {:>10} {:>8}\n",
        "method", "seconds", "relative", "mean error", "largest", "FLIP"
    );
    for entry in results.all() {
        let seconds = entry.run.seconds();
        let flip = entry.flip.map_or("-".to_owned(), three_digits);
        out += &format!(
            "{:<38} {seconds:>9.3} {:>9.2} {:>10} {:>10} {flip:>8}{}\n",
            entry.name,
            seconds / results.unit(),
            three_digits(entry.difference.mean),
            three_digits(entry.difference.largest),
            if entry.on_front { " +" } else { "" },
        );
    }
    out += "+ on the Pareto front\n\n";
    out += &format!("{:<38} {:<28} {:>14} {:>10}\n", "rays against", "", "error at its", "time at");
    out += &format!("{:<38} {:<28} {:>14} {:>10}\n", "umbra4", "rays", "time ÷ its", "its error");
    for row in equal {
        let (error, _) = reading(row.error_at_equal_time, |e| three_digits(e / row.ours.difference.mean));
        let (seconds, _) = reading(row.seconds_at_equal_error, |s| three_digits(s / row.ours.run.seconds()));
        out += &format!("{:<38} {:<28} {error:>14} {seconds:>10}\n", row.ours.name, row.rays.name());
    }
    out + "÷ umbra4's; * extrapolated, - not reached\n"
}
