//! The tables of the page.

use crate::report::{
    equal::Equal,
    facts::grouped,
    methods::Family,
    page::format::{escaped, reading, three_digits},
    plot,
    results::{Entry, Results},
};

/// A cell: text, and class.
type Cell = (String, &'static str);

fn plain(text: String) -> Cell {
    (text, "")
}

fn none() -> Cell {
    ("–".to_owned(), "none")
}

fn row(cells: &[Cell], class: &str) -> String {
    let cells: Vec<String> = cells.iter().map(|(text, class)| format!("<td class=\"{class}\">{text}</td>")).collect();
    format!("<tr class=\"{class}\">{}</tr>\n", cells.concat())
}

fn table(head: &str, rows: &str) -> String {
    format!("<div class=\"card wide\"><table><thead>{head}</thead>\n<tbody>{rows}</tbody></table></div>\n")
}

fn head(names: &[&str]) -> String {
    format!("<tr>{}</tr>", names.iter().map(|name| format!("<th>{name}</th>")).collect::<String>())
}

/// Name with the sign of its curve.
fn name(entry: &Entry) -> String {
    let sign = entry
        .family
        .map(|family| format!("<svg class=\"swatch\" viewBox=\"0 0 16 16\">{}</svg>", plot::sign(family, 8.0, 8.0)));
    let sign = sign.unwrap_or_else(|| "<span class=\"swatch\"></span>".to_owned());
    format!("{sign}{}", escaped(&entry.name))
}

/// Whether a family begins with this row.
fn begins(rows: &[&Entry], i: usize) -> &'static str {
    if i > 0 && rows[i].family != rows[i - 1].family { "first" } else { "" }
}

/// Time, error and counts of every method.
pub fn methods(results: &Results) -> String {
    let head = head(&[
        "method",
        "time, s",
        "time ÷<br>exact 8×8’s",
        "mean<br>error",
        "largest<br>error",
        "FLIP",
        "Pareto<br>front",
        "pairs tested,<br>a receiver",
        "pairs<br>kept",
        "pairs<br>relevant",
        "integer<br>fallbacks",
        "receivers<br>measured",
    ]);
    let entries: Vec<&Entry> = results.all().collect();
    let rows = entries.iter().enumerate().map(|(i, entry)| {
        let seconds = entry.run.seconds();
        let mut cells = vec![
            plain(name(entry)),
            plain(three_digits(seconds)),
            plain(three_digits(seconds / results.unit())),
            plain(three_digits(entry.difference.mean)),
            plain(three_digits(entry.difference.largest)),
            entry.flip.map_or_else(none, |flip| plain(three_digits(flip))),
            (if entry.on_front { "●" } else { "" }.to_owned(), "front"),
        ];
        match entry.pairs() {
            Some(pairs) => cells.extend(pairs.map(|n| plain(three_digits(n)))),
            None => cells.extend([none(), none(), none()]),
        }
        cells.push(entry.run.counts.map_or_else(none, |counts| plain(grouped(counts.fallbacks as usize))));
        cells.push(plain(if entry.one_in > 1 { grouped(entry.receivers) } else { "all".to_owned() }));
        row(&cells, begins(&entries, i))
    });
    table(&head, &rows.collect::<String>())
}

/// Seconds of every stage.
pub fn stages(results: &Results) -> String {
    let mut names: Vec<&str> = Vec::new();
    for (stage, _) in results.all().flat_map(|entry| &entry.run.seconds_by_stage) {
        if !names.contains(&stage.as_str()) {
            names.push(stage);
        }
    }
    let titles: Vec<String> = names.iter().map(|name| escaped(name).replacen(['_', ' '], "<br>", 1)).collect();
    let mut columns = vec!["seconds"];
    columns.extend(titles.iter().map(String::as_str));
    columns.push("sum");
    let entries: Vec<&Entry> = results.all().collect();
    let rows = entries.iter().enumerate().map(|(i, entry)| {
        let mut cells = vec![plain(name(entry))];
        cells.extend(names.iter().map(|name| {
            let stage = entry.run.seconds_by_stage.iter().find(|(stage, _)| stage == name);
            stage.map_or(("·".to_owned(), "none"), |(_, seconds)| plain(format!("{seconds:.3}")))
        }));
        cells.push(plain(format!("{:.3}", entry.run.seconds())));
        row(&cells, begins(&entries, i))
    });
    table(&head(&columns), &rows.collect::<String>())
}

/// The ray tracer at umbra4's time, and at its error.
pub fn equal(results: &Results, rows: &[Equal<'_>]) -> String {
    let rays: Vec<Family> = results.families().filter(|family| family.is_rays()).collect();
    let groups: String = rays.iter().map(|f| format!("<th class=\"group\" colspan=\"4\">{}</th>", f.name())).collect();
    let columns =
        "<th>error at<br>equal time</th><th>÷ umbra4’s</th><th>time, s, at<br>equal error</th><th>÷ umbra4’s</th>";
    let head = format!(
        "<tr><th></th><th></th><th></th>{groups}</tr><tr><th>umbra4</th><th>time, s</th><th>mean<br>error</th>{}</tr>",
        columns.repeat(rays.len())
    );
    let ours: Vec<&Entry> = rows.iter().step_by(rays.len().max(1)).map(|row| row.ours).collect();
    let body = rows.chunks(rays.len().max(1)).enumerate().map(|(i, of_rays)| {
        let entry = ours[i];
        let (seconds, error) = (entry.run.seconds(), entry.difference.mean);
        let mut cells = vec![plain(name(entry)), plain(three_digits(seconds)), plain(three_digits(error))];
        for Equal { error_at_equal_time, seconds_at_equal_error, .. } in of_rays {
            for (value, unit) in [(*error_at_equal_time, error), (*seconds_at_equal_error, seconds)] {
                cells.push(reading(value, three_digits));
                cells.push(reading(value, |value| three_digits(value / unit)));
            }
        }
        row(&cells, begins(&ours, i))
    });
    table(&head, &body.collect::<String>())
}
