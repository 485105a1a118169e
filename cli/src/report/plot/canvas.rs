//! A drawing in the making: SVG, element by element.

/// Family of the letters.
const FONT: &str = "Noto Sans, Segoe UI, Helvetica, Arial, sans-serif";
/// Colour of what is read first.
pub const INK: &str = "#222";
/// Colour of what is beside it.
pub const GRAY: &str = "#666";
/// Size of numbers.
pub const SMALL: f64 = 12.5;
/// Lines of a grid with a number, and without.
const LINES: [&str; 2] = ["#dcdcdc", "#f1f1f1"];

/// What has been drawn.
pub struct Canvas(String);

impl Canvas {
    /// White; `alone` where it is a file of its own: inside of HTML the namespace is known.
    pub fn new((width, height): (f64, f64), alone: bool) -> Self {
        let space = if alone { r#"xmlns="http://www.w3.org/2000/svg" "# } else { "" };
        let mut canvas = Self(String::new());
        canvas.put(&format!(r##"<svg {space}viewBox="0 0 {width} {height}" font-family="{FONT}" fill="{INK}">"##));
        canvas.put(&format!(r##"<rect width="{width}" height="{height}" fill="#fff"/>"##));
        canvas
    }

    /// Draws an element.
    pub fn put(&mut self, element: &str) {
        self.0.push_str(element);
        self.0.push('\n');
    }

    /// Writes beside a point.
    pub fn text(&mut self, (x, y): (f64, f64), anchor: &str, size: f64, color: &str, text: &str) {
        self.put(&format!(
            r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}" fill="{color}">{text}</text>"#
        ));
    }

    /// Writes upwards, around a point.
    pub fn text_upwards(&mut self, (x, y): (f64, f64), text: &str) {
        self.put(&format!(
            r#"<text transform="translate({x} {y}) rotate(-90)" text-anchor="middle" font-size="14">{text}</text>"#
        ));
    }

    /// A line of the grid: a path.
    pub fn grid_line(&mut self, path: &str, labelled: bool) {
        self.put(&format!(r#"<path d="{path}" stroke="{}"/>"#, LINES[usize::from(!labelled)]));
    }

    /// A line from point to point.
    pub fn curve(&mut self, places: &[(f64, f64)], color: &str) {
        let points: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        self.put(&format!(
            r#"<polyline points="{}" fill="none" stroke="{color}" stroke-width="1.6" stroke-opacity="0.75"/>"#,
            points.join(" "),
        ));
    }

    /// The drawing.
    pub fn finish(mut self) -> String {
        self.put("</svg>");
        self.0
    }
}

/// About how long a text of size 1 is.
pub fn length(text: &str) -> f64 {
    let letter = |c| match c {
        'i' | 'j' | 'l' | 'I' | ' ' | ',' | '.' | ':' => 0.265,
        't' | 'f' | 'r' | '²' => 0.38,
        'm' | 'M' | 'w' | 'W' => 0.9,
        'A'..='Z' => 0.65,
        _ => 0.575,
    };
    text.chars().map(letter).sum()
}
