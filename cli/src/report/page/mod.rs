//! The page: one file that needs no other and no network.

mod format;
mod pictures;
mod tables;
mod text;

use crate::{
    output::OutputError,
    report::{
        equal::Equal,
        facts::{Facts, grouped},
        measure::{LONG, QUICK, ROUNDS},
        plot::{self, Kind},
        results::Results,
    },
};
use format::{escaped, three_digits};
pub use text::text;

const STYLE: &str = include_str!("style.css");

/// The whole page.
///
/// # Errors
/// A picture that cannot be encoded.
pub fn html(results: &Results, equal: &[Equal<'_>], facts: &Facts) -> Result<String, OutputError> {
    let side = results.reference.side;
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>The price of accuracy</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
         <h1>The price of accuracy</h1>\n\
         <p class=\"lead\">The soft shadows of one light, computed in every way there is here: what each costs, and how far \
         it is from {side}×{side} exact light samples a receiver.</p>\n{}\
         <h2>Error against time</h2>\n<div class=\"card\">{}</div>\n{}\
         <h2>Error against frames</h2>\n<div class=\"card small\">{}</div>\n{FRAMES_NOTE}\
         <h2>Every method</h2>\n{}{}\
         <h2>Rays at equal time, and at equal error</h2>\n{}{}\
         <h2>Where the time goes</h2>\n{}\
         <h2>Pictures</h2>\n{}{}</main>\n</body>\n</html>\n",
        head(facts),
        plot::svg(results, "", Kind::OnPage),
        plot_note(results),
        plot::over_frames(results),
        tables::methods(results),
        methods_note(results),
        tables::equal(results, equal),
        EQUAL_NOTE,
        tables::stages(results),
        pictures_note(results),
        pictures::section(results)?,
    ))
}

fn head(facts: &Facts) -> String {
    let facts = facts.iter().map(|(name, value)| {
        let value = if *name == "Command" { format!("<code>{}</code>", escaped(value)) } else { escaped(value) };
        format!("<dt>{name}</dt><dd>{value}</dd>\n")
    });
    format!("<dl>\n{}</dl>\n", facts.collect::<String>())
}

fn plot_note(results: &Results) -> String {
    format!(
        "<p class=\"note\">Lower and farther left is better; both axes are logarithmic. A step to the right along the \
         yellow line is the cheapest way to a smaller error. Numbers beside points are light samples a receiver; of shadow \
         maps, texels; over frames, frames. Errors of 0 have no place on a logarithmic axis: they are drawn as triangles on the lower edge. \
         The reference is one of them by definition; it took {} s.</p>\n",
        three_digits(results.reference.run.seconds())
    )
}

fn methods_note(results: &Results) -> String {
    let some = results
        .methods
        .iter()
        .filter(|m| m.one_in > 1)
        .map(|m| format!("{} (one in {}, {} receivers)", escaped(&m.name), m.one_in, grouped(m.receivers)));
    let some: Vec<String> = some.collect();
    let some = if some.is_empty() {
        String::new()
    } else {
        format!(
            " Some methods would have taken long. They ran on whole tiles of 32×32 pixels, spread over the picture, and their \
             time of tracing is scaled to all receivers; errors are those of the receivers measured, and FLIP that of pixels \
             at least 10 inside such tiles: {}.",
            some.join("; ")
        )
    };
    format!(
        "<p class=\"note\">Time is all there is between the world’s coordinates and the visibility of the receivers: for \
         umbra4 the snap, the index and the masks; for shadow maps the snap, the map, which is drawn anew, and 32×32 light samples (microquads and \
         microtris by rows) or four filter planes (stochastic maps); for rays the BVH (obvhs; of a fast and a slow build, the one with the \
         smaller sum, built on one thread) and the rays, on all threads. Methods took turns {ROUNDS} times, those of more than \
         {QUICK} s twice, of more than {LONG} s once, and the least time counts. Camera rays and shading are not in it. \
         Errors are absolute differences of visibility, which is a share of the light in 0..1, from the reference’s. FLIP is \
         the mean LDR-FLIP of the picture, as 8-bit sRGB, at 67 pixels a degree: 0 for equal pictures, 1 for the most \
         different ones.{some}</p>\n"
    )
}

const FRAMES_NOTE: &str = "<p class=\"note\">8×8 samples a frame, jittered by another pattern in every frame and accumulated \
    while nothing moves; dashed, what regular samples give at once. 64 such frames have as many samples as one of 64×64. Time of \
    so many frames is the sum of all of theirs: each pays for its index again, and all for one snap.</p>\n";

const EQUAL_NOTE: &str = "<p class=\"note\">Read from the measured curves of the rays, between points straight on logarithmic \
    axes. Values in italics with an asterisk are extrapolated: beyond the measured points the curve goes on, as steep as it is \
    from its first to its last point, in the time of tracing alone, and the BVH’s time is added. A dash: the curve does not \
    get there, because building the BVH alone takes longer or because it does not fall. Regular samples are umbra4’s own: with as many of them, rays \
    have its error, but for bits that f32 rays get wrong.</p>\n";

fn pictures_note(results: &Results) -> String {
    format!(
        "<p class=\"note\">Beside each picture, its differences of visibility from the reference, {} times as large: red where \
         it is too bright, blue where it is too dark, white where it is the same, gray where nothing is seen or was measured. \
         All files are in the folder <code>pictures</code> at full size.</p>\n",
        results.gain
    )
}
