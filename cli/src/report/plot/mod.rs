//! The plot: error against time, both logarithmic, as SVG.

mod axis;
mod marker;
mod place;
mod raster;

use std::fmt::Write;

use crate::report::{
    methods::Family,
    results::{Entry, Results},
};
use axis::{Axis, number};
pub use marker::family as sign;
use place::{Area, Room};
pub use raster::{RasterError, png};

/// Where it is shown decides what is on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// By itself: with a title, and no seconds, which are those of one machine.
    Alone,
    /// On a page that says what it is: with seconds along its upper edge.
    OnPage,
}

/// Family of the letters.
const FONT: &str = "Noto Sans, Segoe UI, Helvetica, Arial, sans-serif";
const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 640.0;
const LEFT: f64 = 88.0;
const RIGHT: f64 = WIDTH - 28.0;
const BOTTOM: f64 = HEIGHT - 66.0;
/// Above the lower edge: there the errors are that no logarithmic axis holds.
const FLOOR: f64 = BOTTOM - 22.0;
const INK: &str = "#222";
const GRAY: &str = "#666";
const FRONT: &str = "#e3c15a";
const SMALL: f64 = 12.5;

/// The plot as SVG; `scene` says of what, where the plot is alone.
pub fn svg(results: &Results, scene: &str, kind: Kind) -> String {
    Plot::new(results, kind).svg(scene)
}

struct Plot<'a> {
    results: &'a Results,
    kind: Kind,
    time: Axis,
    error: Axis,
    top: f64,
    /// Where there is room for texts.
    room: Room,
    out: String,
}

impl<'a> Plot<'a> {
    fn new(results: &'a Results, kind: Kind) -> Self {
        let top = if kind == Kind::OnPage { 124.0 } else { 112.0 };
        let unit = results.unit();
        let time = Axis::around(results.all().map(|m| m.run.seconds() / unit), (LEFT, RIGHT));
        let error = Axis::around(results.methods.iter().map(|m| m.difference.mean), (FLOOR, top));
        let inside = Area { x: LEFT + 2.0, y: top + 2.0, width: RIGHT - LEFT - 4.0, height: BOTTOM - top };
        Self { results, kind, time, error, top, room: Room::new(inside), out: String::new() }
    }

    fn svg(mut self, scene: &str) -> String {
        // Inside of HTML the namespace is known.
        let space = if self.kind == Kind::Alone { r#"xmlns="http://www.w3.org/2000/svg" "# } else { "" };
        self.put(format!(r##"<svg {space}viewBox="0 0 {WIDTH} {HEIGHT}" font-family="{FONT}" fill="{INK}">"##));
        self.put(format!(r##"<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>"##));
        self.legend(scene);
        self.grid();
        self.front();
        self.curves();
        self.put("</svg>".to_owned());
        self.out
    }

    fn put(&mut self, element: String) {
        self.out.push_str(&element);
        self.out.push('\n');
    }

    fn text(&mut self, (x, y): (f64, f64), anchor: &str, size: f64, color: &str, text: &str) {
        self.put(format!(
            r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}" fill="{color}">{text}</text>"#
        ));
    }

    /// Above the plot, where no point can be.
    fn legend(&mut self, scene: &str) {
        let mut y = 30.0;
        if self.kind == Kind::Alone {
            self.text((LEFT, y), "start", 17.0, INK, "The price of accuracy");
            self.text((RIGHT, y), "end", 13.0, GRAY, scene);
            y += 28.0;
        }
        let mut items: Vec<(Option<Family>, String)> =
            self.results.families().map(|family| (Some(family), family.name().to_owned())).collect();
        items.push((None, "Pareto front: nothing is both faster and better".to_owned()));
        let mut x = LEFT;
        for (family, name) in items {
            let width = 22.0 + 13.0 * length(&name) + 26.0;
            if x + width > RIGHT + 12.0 {
                (x, y) = (LEFT, y + 22.0);
            }
            match family {
                Some(family) => self.put(marker::family(family, x + 7.0, y - 4.5)),
                None => {
                    let (end, y) = (x + 16.0, y - 4.5);
                    self.put(format!(
                        r##"<path d="M{x:.1} {y:.1}H{end:.1}" stroke="{FRONT}" stroke-width="7" stroke-opacity="0.55"/>"##
                    ));
                }
            }
            self.text((x + 22.0, y), "start", 13.0, INK, &name);
            x += width;
        }
    }

    fn grid(&mut self) {
        let top = self.top;
        for tick in self.time.ticks() {
            let (x, color) = (self.time.at(tick.value), if tick.labelled { "#dcdcdc" } else { "#f1f1f1" });
            self.put(format!(r##"<path d="M{x:.1} {top}V{BOTTOM}" stroke="{color}"/>"##));
            if tick.labelled {
                self.text((x, BOTTOM + 20.0), "middle", SMALL, GRAY, &number(tick.value));
            }
        }
        for tick in self.error.ticks() {
            let (y, color) = (self.error.at(tick.value), if tick.labelled { "#dcdcdc" } else { "#f1f1f1" });
            self.put(format!(r##"<path d="M{LEFT} {y:.1}H{RIGHT}" stroke="{color}"/>"##));
            if tick.labelled {
                self.text((LEFT - 10.0, y + 4.5), "end", SMALL, GRAY, &number(tick.value));
            }
        }
        self.put(format!(r##"<path d="M{LEFT} {top}V{BOTTOM}H{RIGHT}" fill="none" stroke="#888"/>"##));
        self.text((LEFT - 10.0, BOTTOM + 4.5), "end", SMALL, GRAY, "0");
        let middle = (LEFT + RIGHT) / 2.0;
        let label = "time ÷ time of umbra4 exact with 8×8 samples";
        self.text((middle, HEIGHT - 18.0), "middle", 14.0, INK, label);
        let (x, y) = (24.0, (top + BOTTOM) / 2.0);
        self.put(format!(
            r#"<text transform="translate({x} {y}) rotate(-90)" text-anchor="middle" font-size="14">mean error of visibility</text>"#
        ));
        if self.kind == Kind::OnPage {
            self.seconds();
        }
    }

    /// Seconds, along the upper edge.
    fn seconds(&mut self) {
        let (top, unit) = (self.top, self.results.unit());
        let axis = self.time.scaled(unit);
        self.put(format!(r##"<path d="M{LEFT} {top}H{RIGHT}" stroke="#888"/>"##));
        for tick in axis.ticks() {
            let (x, length) = (axis.at(tick.value), if tick.labelled { 6.0 } else { 3.0 });
            self.put(format!(r##"<path d="M{x:.1} {top}v-{length}" stroke="#888"/>"##));
            if tick.labelled {
                self.text((x, top - 10.0), "middle", SMALL, GRAY, &format!("{} s", number(tick.value)));
            }
        }
    }

    fn place(&self, entry: &Entry) -> (f64, f64) {
        let x = self.time.at(entry.run.seconds() / self.results.unit());
        (x, if entry.difference.mean > 0.0 { self.error.at(entry.difference.mean) } else { BOTTOM })
    }

    /// The border of what can be had: steps from one method of the front to the next.
    fn front(&mut self) {
        let mut on_front: Vec<(f64, f64)> =
            self.results.methods.iter().filter(|m| m.on_front).map(|m| self.place(m)).collect();
        on_front.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(x, y)) = on_front.first() else { return };
        let mut path = format!("M{x:.1} {}V{y:.1}", self.top);
        for (x, y) in &on_front[1..] {
            // Writing to a string does not fail.
            let _ = write!(path, "H{x:.1}V{y:.1}");
        }
        path += &format!("H{RIGHT}");
        let steps = on_front.windows(2).map(|pair| (pair[0], pair[1]));
        if let Some(&(x, y)) = on_front.last() {
            self.room.take_line((x, y), (RIGHT, y));
        }
        for ((x0, y0), (x1, y1)) in steps {
            self.room.take_line((x0, y0), (x1, y0));
            self.room.take_line((x1, y0), (x1, y1));
        }
        self.put(format!(
            r##"<path d="{path}" fill="none" stroke="{FRONT}" stroke-width="7" stroke-opacity="0.55" stroke-linejoin="round"/>"##
        ));
    }

    fn curves(&mut self) {
        let results = self.results;
        for family in results.families() {
            let places: Vec<(f64, f64)> = results.of(family).map(|m| self.place(m)).collect();
            places.iter().for_each(|&(x, y)| self.room.take(Area::around(x, y, marker::HALF + 1.0)));
            places.windows(2).for_each(|pair| self.room.take_line(pair[0], pair[1]));
            let points: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            self.put(format!(
                r#"<polyline points="{}" fill="none" stroke="{}" stroke-width="1.6" stroke-opacity="0.75"/>"#,
                points.join(" "),
                family.color(),
            ));
        }
        for family in results.families() {
            for entry in results.of(family) {
                let (x, y) = self.place(entry);
                let exact = entry.difference.mean > 0.0;
                self.put(if exact { marker::family(family, x, y) } else { marker::no_error(family.color(), x, y) });
            }
        }
        self.reference();
        for family in results.families() {
            for entry in results.of(family) {
                let text = samples(family, entry.side);
                self.label(entry, &text, family.color());
            }
        }
    }

    /// Its error is none by definition: it is on the lower edge.
    fn reference(&mut self) {
        let (x, _) = self.place(&self.results.reference);
        self.put(marker::no_error(GRAY, x, BOTTOM));
        self.room.take(Area::around(x, BOTTOM, 7.0));
        let text = format!("reference, {0}×{0}: error 0", self.results.reference.side);
        self.label(&self.results.reference, &text, GRAY);
    }

    fn label(&mut self, entry: &Entry, text: &str, color: &str) {
        let width = SMALL * length(text);
        if let Some(area) = self.room.beside(self.place(entry), (width, SMALL)) {
            self.text((area.x, area.y + area.height - 2.0), "start", SMALL, color, text);
        }
    }
}

/// About how long a text of size 1 is.
fn length(text: &str) -> f64 {
    let letter = |c| match c {
        'i' | 'j' | 'l' | 'I' | ' ' | ',' | '.' | ':' => 0.265,
        't' | 'f' | 'r' | '²' => 0.38,
        'm' | 'M' | 'w' | 'W' => 0.9,
        'A'..='Z' => 0.65,
        _ => 0.575,
    };
    text.chars().map(letter).sum()
}

/// What is written beside a point: samples each way, or all of them where no grid is meant.
fn samples(family: Family, side: u32) -> String {
    match family {
        Family::JitteredRays => (side * side).to_string(),
        _ => format!("{side}²"),
    }
}
