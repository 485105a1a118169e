//! The pictures of the page, inside of it.

use std::io::Cursor;

use base64::{Engine, prelude::BASE64_STANDARD};
use image::{ImageFormat, RgbImage, imageops};

use crate::{
    output::OutputError,
    report::{
        page::format::{escaped, three_digits},
        results::{Entry, Results},
    },
};

/// Widest picture of a method, and of the reference.
const SMALL: u32 = 256;
const LARGE: u32 = 560;

/// The reference, and then every method beside its differences.
pub fn section(results: &Results) -> Result<String, OutputError> {
    let mut out = format!(
        "<figure class=\"reference\">{}<figcaption>{}</figcaption></figure>\n<div class=\"pictures\">\n",
        inline(&results.reference.shaded, LARGE, "The reference")?,
        escaped(&results.reference.name)
    );
    for entry in &results.methods {
        out += &figure(entry, results.unit())?;
    }
    Ok(out + "</div>\n")
}

fn figure(entry: &Entry, unit: f64) -> Result<String, OutputError> {
    let name = escaped(&entry.name);
    let flip = entry.flip.map(|flip| format!(", FLIP {}", three_digits(flip))).unwrap_or_default();
    Ok(format!(
        "<figure><div class=\"pair\">{}{}</div><figcaption>{name}<br><span>time {} s ({}), mean error {}{flip}</span>\
         </figcaption></figure>\n",
        inline(&entry.shaded, SMALL, &name)?,
        inline(&entry.map, SMALL, &format!("{name}: difference"))?,
        three_digits(entry.run.seconds()),
        three_digits(entry.run.seconds() / unit),
        three_digits(entry.difference.mean),
    ))
}

/// The picture, at most `widest` pixels wide, as part of the page.
fn inline(picture: &RgbImage, widest: u32, text: &str) -> Result<String, OutputError> {
    let width = picture.width().min(widest);
    let height = (u64::from(picture.height()) * u64::from(width) / u64::from(picture.width().max(1))).max(1) as u32;
    let small = imageops::resize(picture, width, height, imageops::FilterType::Triangle);
    let mut bytes = Cursor::new(Vec::new());
    small.write_to(&mut bytes, ImageFormat::Png)?;
    let data = BASE64_STANDARD.encode(bytes.into_inner());
    Ok(format!("<img src=\"data:image/png;base64,{data}\" width=\"{width}\" height=\"{height}\" alt=\"{text}\">"))
}
