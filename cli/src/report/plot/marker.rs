//! The sign of every family: colour, and a shape that does without it.

use crate::report::methods::Family;

/// Half the width of a sign.
pub const HALF: f64 = 5.5;

/// SVG of a family's sign around a point.
pub fn family(family: Family, x: f64, y: f64) -> String {
    let color = family.color();
    let filled = format!(r##"fill="{color}" stroke="#fff" stroke-width="1""##);
    let hollow = format!(r##"fill="#fff" stroke="{color}" stroke-width="2""##);
    match family {
        Family::CpuExact => circle(x, y, HALF, &filled),
        Family::CpuFast => circle(x, y, HALF - 1.0, &hollow),
        Family::CpuJittered => polygon(&[(x, y - 5.5), (x + 5.5, y), (x, y + 5.5), (x - 5.5, y)], &hollow),
        Family::CpuFrames => stroke(&format!("M{:.1} {y:.1}h11M{x:.1} {:.1}v11", x - 5.5, y - 5.5), color),
        Family::GpuExact => square(x, y, HALF - 0.5, &filled),
        Family::GpuFast => square(x, y, HALF - 1.5, &hollow),
        Family::GpuJittered => stroke(&format!("M{0:.1} {1:.1}l9 9m-9 0l9 -9", x - 4.5, y - 4.5), color),
        Family::Microquads => polygon(&[(x, y - 6.0), (x + 5.5, y + 4.0), (x - 5.5, y + 4.0)], &hollow),
        Family::StochasticMaps => polygon(
            &[
                (x - 5.5, y),
                (x - 2.8, y - 5.0),
                (x + 2.8, y - 5.0),
                (x + 5.5, y),
                (x + 2.8, y + 5.0),
                (x - 2.8, y + 5.0),
            ],
            &filled,
        ),
        Family::GpuMicroquads => stroke(&format!("M{:.1} {y:.1}h9", x - 4.5), color),
        Family::GpuStochasticMaps => stroke(&format!("M{x:.1} {:.1}v9", y - 4.5), color),
        Family::RegularRays => polygon(&[(x, y - 6.5), (x + 6.0, y + 4.5), (x - 6.0, y + 4.5)], &filled),
        Family::JitteredRays => polygon(&[(x, y - 6.5), (x + 6.5, y), (x, y + 6.5), (x - 6.5, y)], &filled),
    }
}

/// SVG of the sign for no error at all: it points to where the axis does not go.
pub fn no_error(color: &str, x: f64, y: f64) -> String {
    let style = format!(r##"fill="#fff" stroke="{color}" stroke-width="1.8""##);
    polygon(&[(x - 6.0, y - 5.0), (x + 6.0, y - 5.0), (x, y + 5.0)], &style)
}

/// Lines along `path`, with a white rim.
fn stroke(path: &str, color: &str) -> String {
    format!(
        r##"<path d="{path}" stroke="#fff" stroke-width="4.6"/><path d="{path}" stroke="{color}" stroke-width="2.6"/>"##
    )
}

fn circle(x: f64, y: f64, radius: f64, style: &str) -> String {
    format!(r#"<circle cx="{x:.1}" cy="{y:.1}" r="{radius}" {style}/>"#)
}

fn square(x: f64, y: f64, half: f64, style: &str) -> String {
    let (left, top, edge) = (x - half, y - half, 2.0 * half);
    format!(r#"<rect x="{left:.1}" y="{top:.1}" width="{edge}" height="{edge}" {style}/>"#)
}

fn polygon(corners: &[(f64, f64)], style: &str) -> String {
    let points: Vec<String> = corners.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    format!(r#"<polygon points="{}" stroke-linejoin="round" {style}/>"#, points.join(" "))
}
