//! The plot: error against time, both logarithmic, as SVG.

mod axis;
mod canvas;
mod legend;
mod marker;
mod over_frames;
mod place;
#[cfg(feature = "plot-png")]
mod raster;
#[cfg(not(feature = "plot-png"))]
#[path = "no_raster.rs"]
mod raster;

use std::fmt::Write;

use crate::report::{
    methods::Family,
    results::{Entry, Results},
};
use axis::{Axis, number};
use canvas::{Canvas, GRAY, INK, SMALL, length};
use legend::Item;
pub use marker::family as sign;
pub use over_frames::svg as over_frames;
use place::{Area, Room};
pub use raster::{NOTE, RasterError, png};

/// Where it is shown decides what is on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// By itself: with a title, and no seconds, which are those of one machine.
    Alone,
    /// On a page that says what it is: with seconds along its upper edge.
    OnPage,
}

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 640.0;
const LEFT: f64 = 88.0;
const RIGHT: f64 = WIDTH - 28.0;
const BOTTOM: f64 = HEIGHT - 66.0;
/// Above the lower edge: there the errors are that no logarithmic axis holds.
const FLOOR: f64 = BOTTOM - 22.0;
const FRONT: &str = "#e3c15a";

/// The plot as SVG; `scene` says of what, where the plot is alone.
pub fn svg(results: &Results, scene: &str, kind: Kind) -> String {
    Plot::new(results, kind).svg(scene)
}

struct Plot<'a> {
    results: &'a Results,
    kind: Kind,
    time: Axis,
    error: Axis,
    legend: Vec<Item>,
    top: f64,
    /// Where there is room for texts.
    room: Room,
    canvas: Canvas,
}

impl<'a> Plot<'a> {
    fn new(results: &'a Results, kind: Kind) -> Self {
        let alone = kind == Kind::Alone;
        // The title above, and seconds below, need room.
        let (first, below) = if alone { (58.0, 32.0) } else { (30.0, 46.0) };
        let legend = legend::items(results.families(), (LEFT, first), RIGHT);
        let top = legend.last().map_or(first, |item| item.at.1) + below;
        let unit = results.unit();
        let time = Axis::around(results.all().map(|m| m.run.seconds() / unit), (LEFT, RIGHT));
        let error = Axis::around(results.methods.iter().map(|m| m.difference.mean), (FLOOR, top));
        let inside = Area { x: LEFT + 2.0, y: top + 2.0, width: RIGHT - LEFT - 4.0, height: BOTTOM - top };
        let canvas = Canvas::new((WIDTH, HEIGHT), alone);
        Self { results, kind, time, error, legend, top, room: Room::new(inside), canvas }
    }

    fn svg(mut self, scene: &str) -> String {
        self.legend(scene);
        self.grid();
        self.front();
        self.curves();
        self.canvas.finish()
    }

    /// Above the plot, where no point can be.
    fn legend(&mut self, scene: &str) {
        if self.kind == Kind::Alone {
            self.canvas.text((LEFT, 30.0), "start", 17.0, INK, "The price of accuracy");
            self.canvas.text((RIGHT, 30.0), "end", 13.0, GRAY, scene);
        }
        for Item { family, name, at: (x, y) } in &self.legend {
            let sign = match family {
                Some(family) => marker::family(*family, x + 7.0, y - 4.5),
                None => format!(
                    r##"<path d="M{x:.1} {:.1}h16" stroke="{FRONT}" stroke-width="7" stroke-opacity="0.55"/>"##,
                    y - 4.5
                ),
            };
            self.canvas.put(&sign);
            self.canvas.text((x + legend::INDENT, *y), "start", legend::SIZE, INK, name);
        }
    }

    fn grid(&mut self) {
        let top = self.top;
        for tick in self.time.ticks() {
            let x = self.time.at(tick.value);
            self.canvas.grid_line(&format!("M{x:.1} {top}V{BOTTOM}"), tick.labelled);
            if tick.labelled {
                self.canvas.text((x, BOTTOM + 20.0), "middle", SMALL, GRAY, &number(tick.value));
            }
        }
        for tick in self.error.ticks() {
            let y = self.error.at(tick.value);
            self.canvas.grid_line(&format!("M{LEFT} {y:.1}H{RIGHT}"), tick.labelled);
            if tick.labelled {
                self.canvas.text((LEFT - 10.0, y + 4.5), "end", SMALL, GRAY, &number(tick.value));
            }
        }
        self.canvas.put(&format!(r##"<path d="M{LEFT} {top}V{BOTTOM}H{RIGHT}" fill="none" stroke="#888"/>"##));
        self.canvas.text((LEFT - 10.0, BOTTOM + 4.5), "end", SMALL, GRAY, "0");
        let middle = (LEFT + RIGHT) / 2.0;
        let label = "time ÷ time of umbra4 exact with 8×8 samples";
        self.canvas.text((middle, HEIGHT - 18.0), "middle", 14.0, INK, label);
        self.canvas.text_upwards((24.0, (top + BOTTOM) / 2.0), "mean error of visibility");
        if self.kind == Kind::OnPage {
            self.seconds();
        }
    }

    /// Seconds, along the upper edge.
    fn seconds(&mut self) {
        let (top, unit) = (self.top, self.results.unit());
        let axis = self.time.scaled(unit);
        self.canvas.put(&format!(r##"<path d="M{LEFT} {top}H{RIGHT}" stroke="#888"/>"##));
        for tick in axis.ticks() {
            let (x, length) = (axis.at(tick.value), if tick.labelled { 6.0 } else { 3.0 });
            self.canvas.put(&format!(r##"<path d="M{x:.1} {top}v-{length}" stroke="#888"/>"##));
            if tick.labelled {
                self.canvas.text((x, top - 10.0), "middle", SMALL, GRAY, &format!("{} s", number(tick.value)));
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
        self.canvas.put(&format!(
            r##"<path d="{path}" fill="none" stroke="{FRONT}" stroke-width="7" stroke-opacity="0.55" stroke-linejoin="round"/>"##
        ));
    }

    fn curves(&mut self) {
        let results = self.results;
        for family in results.families() {
            let places: Vec<(f64, f64)> = results.of(family).map(|m| self.place(m)).collect();
            places.iter().for_each(|&(x, y)| self.room.take(Area::around(x, y, marker::HALF + 1.0)));
            places.windows(2).for_each(|pair| self.room.take_line(pair[0], pair[1]));
            self.canvas.curve(&places, family.color());
        }
        for family in results.families() {
            for entry in results.of(family) {
                let (x, y) = self.place(entry);
                let exact = entry.difference.mean > 0.0;
                self.canvas.put(&if exact {
                    marker::family(family, x, y)
                } else {
                    marker::no_error(family.color(), x, y)
                });
            }
        }
        self.reference();
        for family in results.families() {
            for entry in results.of(family) {
                self.label(entry, &told_apart_by(family, entry), family.color());
            }
        }
    }

    /// Its error is none by definition: it is on the lower edge.
    fn reference(&mut self) {
        let (x, _) = self.place(&self.results.reference);
        self.canvas.put(&marker::no_error(GRAY, x, BOTTOM));
        self.room.take(Area::around(x, BOTTOM, 7.0));
        let text = format!("reference, {0}×{0}: error 0", self.results.reference.side);
        self.label(&self.results.reference, &text, GRAY);
    }

    fn label(&mut self, entry: &Entry, text: &str, color: &str) {
        let width = SMALL * length(text);
        if let Some(area) = self.room.beside(self.place(entry), (width, SMALL)) {
            self.canvas.text((area.x, area.y + area.height - 2.0), "start", SMALL, color, text);
        }
    }
}

/// What is written beside a point: samples, or texels, each way, or all of them where no grid is meant; or frames.
fn told_apart_by(family: Family, entry: &Entry) -> String {
    match family {
        Family::CpuFrames => entry.run.frames.to_string(),
        Family::JitteredRays => (entry.side * entry.side).to_string(),
        _ => format!("{}²", entry.side),
    }
}
