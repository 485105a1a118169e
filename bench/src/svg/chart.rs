//! Lines over two logarithmic axes.

use super::{
    axis::{LogAxis, label},
    element::{Anchor, Picture},
};

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 480.0;
/// The plot's edges, pixels.
const LEFT: f64 = 84.0;
const RIGHT: f64 = WIDTH - 28.0;
const TOP: f64 = 88.0;
const BOTTOM: f64 = HEIGHT - 66.0;
/// Least distance between two labels of the x axis.
const LABEL: f64 = 46.0;
/// Colours and dashes of lines, told apart without colour too.
const STYLES: [(&str, &str); 4] = [("#0b5fa5", "none"), ("#c2410c", "7 4"), ("#15803d", "2 3"), ("#6b21a8", "9 3 2 3")];

/// A line of the chart.
#[derive(Clone, Debug)]
pub struct Line {
    /// What the legend says.
    pub name: String,
    /// (x, y), both positive.
    pub points: Vec<(f64, f64)>,
}

/// A tick of the x axis: the values are measured at few places, and those are named.
#[derive(Clone, Debug)]
pub struct Tick {
    /// Where it is.
    pub x: f64,
    /// What it says; the number itself where this is empty.
    pub text: String,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Over everything.
    pub title: String,
    /// Below the title: what is the same for all points.
    pub setting: String,
    /// Quantity and unit of the x axis.
    pub x: String,
    /// Quantity and unit of the y axis.
    pub y: String,
    /// Ticks of the x axis.
    pub ticks: Vec<Tick>,
    /// Lines, in the order of the legend.
    pub lines: Vec<Line>,
}

impl Chart {
    /// The file.
    pub fn svg(&self) -> String {
        let values = || self.lines.iter().flat_map(|line| &line.points);
        let x = LogAxis::around(values().map(|point| point.0), LEFT, RIGHT);
        let y = LogAxis::around(values().map(|point| point.1), BOTTOM, TOP);
        let mut picture = Picture::new(WIDTH, HEIGHT);
        picture.title([LEFT, 28.0], &self.title);
        picture.text([LEFT, 50.0], Anchor::Start, &self.setting);
        self.legend(&mut picture);
        self.axes(&mut picture, x, y);
        for (line, (color, dashes)) in self.lines.iter().zip(STYLES.iter().cycle()) {
            let drawn = line.points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite());
            let points: Vec<[f64; 2]> = drawn.map(|&(a, b)| [x.place(a), y.place(b)]).collect();
            picture.polyline(&points, color, dashes);
            points.iter().for_each(|&point| picture.dot(point, color));
        }
        picture.finish()
    }

    fn legend(&self, picture: &mut Picture) {
        let mut left = LEFT;
        for (line, (color, dashes)) in self.lines.iter().zip(STYLES.iter().cycle()) {
            picture.polyline(&[[left, 69.0], [left + 30.0, 69.0]], color, dashes);
            picture.dot([left + 15.0, 69.0], color);
            picture.text([left + 38.0, 73.5], Anchor::Start, &line.name);
            // The width of a text is not known here: letters are taken to be 8 pixels wide.
            left += 62.0 + 8.0 * line.name.chars().count() as f64;
        }
    }

    fn axes(&self, picture: &mut Picture, x: LogAxis, y: LogAxis) {
        for value in y.fine() {
            picture.line([LEFT, y.place(value)], [RIGHT, y.place(value)], "#eee");
        }
        for value in y.ticks() {
            let at = y.place(value);
            picture.line([LEFT - 5.0, at], [RIGHT, at], "#ccc");
            picture.text([LEFT - 9.0, at + 4.5], Anchor::End, &label(value));
        }
        let mut free = f64::MIN;
        for tick in self.ticks.iter().filter(|tick| tick.x > 0.0 && tick.x.is_finite()) {
            let at = x.place(tick.x);
            picture.line([at, TOP], [at, BOTTOM + 5.0], "#ccc");
            if at >= free {
                let text = if tick.text.is_empty() { label(tick.x) } else { tick.text.clone() };
                picture.text([at, BOTTOM + 21.0], Anchor::Middle, &text);
                free = at + LABEL;
            }
        }
        picture.line([LEFT, BOTTOM], [RIGHT, BOTTOM], "#222");
        picture.line([LEFT, TOP], [LEFT, BOTTOM], "#222");
        picture.text([0.5 * (LEFT + RIGHT), HEIGHT - 18.0], Anchor::Middle, &self.x);
        picture.upright_text([24.0, 0.5 * (TOP + BOTTOM)], &self.y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<(f64, f64)>) -> Chart {
        let ticks = points.iter().map(|point| Tick { x: point.0, text: String::new() }).collect();
        let lines = vec![Line { name: "a < b".to_owned(), points }];
        let text = |text: &str| text.to_owned();
        Chart { title: text("R&D"), setting: text(""), x: text("x"), y: text("y"), ticks, lines }
    }

    #[test]
    fn a_chart_has_a_dot_a_point_and_escaped_text() {
        let svg = chart(vec![(1.0, 1.0), (10.0, 3.0), (100.0, 9.0)]).svg();
        // One more in the legend.
        assert_eq!(svg.matches("<circle").count(), 4);
        assert!(svg.contains(">R&amp;D</text>") && svg.contains(">a &lt; b</text>") && svg.ends_with("</svg>\n"));
        assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
    }

    #[test]
    fn what_has_no_logarithm_is_left_out() {
        let svg = chart(vec![(1.0, 0.0), (10.0, f64::NAN), (-1.0, 2.0), (5.0, 5.0)]).svg();
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(!chart(Vec::new()).svg().contains("NaN"));
    }
}
