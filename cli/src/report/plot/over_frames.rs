//! A second, small plot: error against frames, beside what more samples in one frame give.

use crate::report::{
    methods::Family,
    plot::{
        axis::{Axis, number},
        canvas::{Canvas, GRAY, INK, SMALL, length},
        marker,
        place::{Area, Room},
    },
    results::{Entry, Results},
};

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 88.0;
const RIGHT: f64 = WIDTH - 28.0;
const TOP: f64 = 16.0;
const BOTTOM: f64 = HEIGHT - 62.0;

/// The plot as SVG; of one frame and more, where they were measured.
pub fn svg(results: &Results) -> String {
    let family = Family::CpuFrames;
    let side = results.of(family).next().map(|entry| entry.side);
    let first = results.of(Family::CpuJittered).filter(|entry| Some(entry.side) == side);
    let frames: Vec<&Entry> = first.chain(results.of(family)).filter(|entry| entry.difference.mean > 0.0).collect();
    let regular: Vec<&Entry> = results.of(Family::CpuExact).filter(|entry| entry.difference.mean > 0.0).collect();
    let across = Axis::around(frames.iter().map(|entry| f64::from(entry.run.frames)), (LEFT, RIGHT));
    let up = Axis::around(frames.iter().chain(&regular).map(|entry| entry.difference.mean), (BOTTOM, TOP));

    let mut canvas = Canvas::new((WIDTH, HEIGHT), false);
    for entry in &frames {
        let x = across.at(entry.run.frames.into());
        canvas.grid_line(&format!("M{x:.1} {TOP}V{BOTTOM}"), true);
        canvas.text((x, BOTTOM + 20.0), "middle", SMALL, GRAY, &entry.run.frames.to_string());
    }
    for tick in up.ticks() {
        let y = up.at(tick.value);
        canvas.grid_line(&format!("M{LEFT} {y:.1}H{RIGHT}"), tick.labelled);
        if tick.labelled {
            canvas.text((LEFT - 10.0, y + 4.5), "end", SMALL, GRAY, &number(tick.value));
        }
    }
    canvas.put(&format!(r##"<path d="M{LEFT} {TOP}V{BOTTOM}H{RIGHT}" fill="none" stroke="#888"/>"##));
    canvas.text(((LEFT + RIGHT) / 2.0, HEIGHT - 16.0), "middle", 14.0, INK, "frames accumulated");
    canvas.text_upwards((24.0, (TOP + BOTTOM) / 2.0), "mean error of visibility");

    let places: Vec<(f64, f64)> =
        frames.iter().map(|entry| (across.at(entry.run.frames.into()), up.at(entry.difference.mean))).collect();
    let mut room = Room::new(Area { x: LEFT + 2.0, y: TOP, width: RIGHT - LEFT - 4.0, height: BOTTOM - TOP });
    places.iter().for_each(|&(x, y)| room.take(Area::around(x, y, marker::HALF + 1.0)));
    places.windows(2).for_each(|pair| room.take_line(pair[0], pair[1]));
    let color = Family::CpuExact.color();
    for entry in &regular {
        let y = up.at(entry.difference.mean);
        canvas.put(&format!(
            r#"<path d="M{LEFT} {y:.1}H{RIGHT}" stroke="{color}" stroke-width="1.6" stroke-dasharray="6 4"/>"#
        ));
        room.take_line((LEFT, y), (RIGHT, y));
    }
    for entry in &regular {
        let text = format!("{}², regular, one frame", entry.side);
        let width = SMALL * length(&text);
        let y = up.at(entry.difference.mean);
        // At the right end, or else at the left one.
        let ends = [RIGHT - width / 2.0 - 4.0, LEFT + width / 2.0 + 4.0];
        if let Some(area) = ends.into_iter().find_map(|x| room.beside((x, y), (width, SMALL))) {
            canvas.text((area.x, area.y + area.height - 2.0), "start", SMALL, color, &text);
        }
    }
    canvas.curve(&places, family.color());
    for &(x, y) in &places {
        canvas.put(&marker::family(family, x, y));
    }
    canvas.finish()
}
